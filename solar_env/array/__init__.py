"""The deployable solar array: its parameters with their sources and presets, and the mechanism that they describe.

``parameters`` holds the values and their checks, ``construction`` turns them into a mechanism, ``methods`` says which
integrator a model gets, ``deployment`` simulates one, ``ladder`` chooses the cheapest model for a question.

Imports ``mechanics`` alone. A new parameter is a field of ``ArrayParameters`` and its use in ``construction``.
"""

from solar_env.array.construction import build, main_body_corners
from solar_env.array.parameters import (
    DEFAULT_ELEMENTS,
    MODELS,
    PRESETS,
    ArrayParameters,
    check_elements,
    check_model,
    has_flexible_panels,
)

__all__ = [
    "DEFAULT_ELEMENTS",
    "MODELS",
    "PRESETS",
    "ArrayParameters",
    "build",
    "check_elements",
    "check_model",
    "has_flexible_panels",
    "main_body_corners",
]
