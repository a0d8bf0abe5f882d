"""Deployment of a spacecraft's solar array: multibody simulation with clearance joints, and a Gymnasium environment.

Importing this package registers the environments and loads neither the compiler nor a learning library.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from solar_env.array import MODELS, ArrayParameters, build
from solar_env.environment.hardware import Hardware
from solar_env.environment.registration import register_environments
from solar_env.mechanics.integrators.settings import DormandPrince, GeneralizedAlpha, Rosenbrock, RungeKutta
from solar_env.mechanics.running.diagnosis import SimulationWarning

if TYPE_CHECKING:
    from solar_env.array.deployment import simulate
    from solar_env.environment.env import SolarArrayEnv
    from solar_env.environment.vector_env import SolarArrayVectorEnv
    from solar_env.mechanics.running.errors import SimulationError
    from solar_env.mechanics.running.simulation import Simulation
    from solar_env.mechanics.running.trajectory import Trajectory

__version__ = "0.1.0"

# Public names whose modules need the compiler: imported on first use.
_LAZY = {
    "simulate": ".array.deployment",
    "SolarArrayEnv": ".environment.env",
    "SolarArrayVectorEnv": ".environment.vector_env",
    "SimulationError": ".mechanics.running.errors",
    "Simulation": ".mechanics.running.simulation",
    "Trajectory": ".mechanics.running.trajectory",
}

__all__ = [
    "MODELS",
    "ArrayParameters",
    "DormandPrince",
    "GeneralizedAlpha",
    "Hardware",
    "Rosenbrock",
    "RungeKutta",
    "Simulation",
    "SimulationError",
    "SimulationWarning",
    "SolarArrayEnv",
    "SolarArrayVectorEnv",
    "Trajectory",
    "build",
    "simulate",
]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(importlib.import_module(_LAZY[name], __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


register_environments()
