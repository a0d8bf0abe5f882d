"""Deployment of a spacecraft's solar array: multibody simulation with clearance joints, and a Gymnasium environment.

Importing this package registers the environments; it imports neither Numba nor a learning library. `simulate` runs one
deployment. `gymnasium.make("solar_env/Deploy-v2")` makes one environment, `gymnasium.make_vec` a vector of them.

Names at the top level: `ArrayParameters` (`solar_env.array.parameters`) describes an array, `read_parameters` reads
parameters from a file, `build` makes the array's mechanism. `MODELS` lists the levels of model fidelity by name;
`cheapest_level` names the cheapest one that is accurate enough. `simulate` returns a `Trajectory`; a `Simulation`
advances step by step with an integrator: `RungeKutta`, `Rosenbrock`, `ModalRadau` or `GeneralizedAlpha`.
`SolarArrayEnv` and `SolarArrayVectorEnv` are the environments; `Hardware` describes sensors and motors. A run that
cannot continue raises `SimulationError`; a doubtful result causes a `SimulationWarning`.

.. include:: ../.github/CONTRIBUTING.md
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from solar_env.array import MODELS as MODELS
from solar_env.array import ArrayParameters as ArrayParameters
from solar_env.array import build as build
from solar_env.array import cheapest_level as cheapest_level
from solar_env.array import read_parameters as read_parameters
from solar_env.environment.hardware import Hardware as Hardware
from solar_env.environment.registration import register_environments
from solar_env.mechanics.integrators.settings import GeneralizedAlpha as GeneralizedAlpha
from solar_env.mechanics.integrators.settings import ModalRadau as ModalRadau
from solar_env.mechanics.integrators.settings import Rosenbrock as Rosenbrock
from solar_env.mechanics.integrators.settings import RungeKutta as RungeKutta
from solar_env.mechanics.running.diagnosis import SimulationWarning as SimulationWarning

if TYPE_CHECKING:
    from solar_env.array.deployment import simulate as simulate
    from solar_env.environment.env import SolarArrayEnv as SolarArrayEnv
    from solar_env.environment.vector_env import SolarArrayVectorEnv as SolarArrayVectorEnv
    from solar_env.mechanics.running.errors import SimulationError as SimulationError
    from solar_env.mechanics.running.simulation import Simulation as Simulation
    from solar_env.mechanics.running.trajectory import Trajectory as Trajectory

__version__ = "0.2.0"

_PUBLIC = (
    *("ArrayParameters", "GeneralizedAlpha", "Hardware", "MODELS", "ModalRadau", "Rosenbrock"),
    *("RungeKutta", "SimulationWarning", "build", "cheapest_level", "read_parameters"),
)
# Public names whose modules need the compiler; these are imported on first use.
_LAZY = {
    "simulate": ".array.deployment",
    "SolarArrayEnv": ".environment.env",
    "SolarArrayVectorEnv": ".environment.vector_env",
    "SimulationError": ".mechanics.running.errors",
    "Simulation": ".mechanics.running.simulation",
    "Trajectory": ".mechanics.running.trajectory",
}


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(importlib.import_module(_LAZY[name], __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*_PUBLIC, *_LAZY, "__version__"])


register_environments()
