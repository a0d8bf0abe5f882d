"""Figures of an array before it is run: the torque that its hinges have left, and its frequencies when deployed."""

import math
from collections.abc import Mapping
from typing import Any

from solar_env.array import ArrayParameters
from solar_env.array.construction import build_deployed
from solar_env.array.motorization import FACTORS, MARGIN, motorization
from solar_env.mechanics.analysis.linearization import natural_frequencies

_LEVEL = "flexible-ideal:8 elements"  # whose first frequencies have all digits that are shown
_RIGID_MOTIONS = 3  # of an array whose hub is free
_SHOWN = 3


def first_frequencies(parameters: ArrayParameters, held: bool) -> list[float]:
    """Compute the first frequencies [Hz] of the deployed array, latched without play, with its hub held or free."""
    deployed = build_deployed(parameters.with_changes({"body_fixed": held, "initial_spin": 0.0}), _LEVEL)
    found = natural_frequencies(deployed)[0 if held else _RIGID_MOTIONS :]
    return [float(frequency) for frequency in found[:_SHOWN]]


def statics(parameters: ArrayParameters, factors: Mapping[str, Any] | None = None) -> list[str]:
    """State in two lines what the hinges' torques are beside those asked for, and the deployed array's frequencies.

    Raises:
        ValueError: As `motorization`.
    """
    used = {**FACTORS, **(factors or {})}
    counted = ", ".join(f"{name} {value:g}" for name, value in used.items())
    found = motorization(parameters, factors)
    hinges = "; ".join(map(str, found))
    if all(math.isinf(hinge.ratio[0]) for hinge in found):
        hinges = "no friction, harness or damper is given, and no hinge has anything to overcome"
    held, free = (
        ", ".join(f"{frequency:.3g}" for frequency in first_frequencies(parameters, held)) for held in (True, False)
    )
    return [
        f"Motorization: {hinges} ({MARGIN:g} times the resistances, with the uncertainty factors of ECSS-E-ST-33-01C: "
        f"{counted}).",
        f"Deployed and latched, the array vibrates at {held} Hz with its hub held, at {free} Hz with it free.",
    ]
