"""Deployment of a spacecraft's solar array: multibody simulation with clearance joints, and a Gymnasium environment.

Importing this package registers the environments and loads neither the compiler nor a learning library.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .array import MODELS, ArrayParameters, build
from .hardware import Hardware
from .mechanics.diagnosis import SimulationWarning
from .mechanics.integrators import GeneralizedAlpha, Rosenbrock, RungeKutta
from .registration import register_environments

if TYPE_CHECKING:
    from .deployment import simulate
    from .env import SolarArrayEnv
    from .mechanics.errors import SimulationError
    from .mechanics.simulation import Simulation
    from .mechanics.trajectory import Trajectory
    from .vector_env import SolarArrayVectorEnv

__version__ = "0.1.0"

# Public names whose modules need the compiler: imported on first use.
_LAZY = {
    "simulate": ".deployment",
    "SolarArrayEnv": ".env",
    "SolarArrayVectorEnv": ".vector_env",
    "SimulationError": ".mechanics.errors",
    "Simulation": ".mechanics.simulation",
    "Trajectory": ".mechanics.trajectory",
}

__all__ = [
    "MODELS",
    "ArrayParameters",
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
