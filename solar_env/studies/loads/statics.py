"""Figures of an array before it is run: the torque that its hinges have left, and its frequencies when deployed."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.array.construction import build_deployed
from solar_env.array.motorization import FACTORS, MARGIN, motorization
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.analysis.linearization import natural_modes
from solar_env.mechanics.equations.build import compile_mechanism

_LEVEL = "flexible-ideal:8 elements"  # whose first frequencies have all digits that are shown
_RIGID_MOTIONS = 3  # of an array whose hub is free
_SHOWN = 3  # of each wing: mirrored ones have the same, with the hub held


@dataclass(frozen=True)
class Modes:
    """First vibrations of the deployed array, latched without play.

    Attributes:
        frequencies: [Hz].
        axes: of every panel of the first wing, from its inner hinge to its end, deployed and in every mode at its
            turning point (1 + modes, points, 2) [m]; a tenth of the wing's length is the greatest displacement.
    """

    frequencies: Sequence[float]
    axes: NDArray[np.float64]


def first_modes(parameters: ArrayParameters, held: bool) -> Modes:
    """Compute the first modes of the deployed array, with its hub held or free."""
    deployed = build_deployed(parameters.with_changes({"body_fixed": held, "initial_spin": 0.0}), _LEVEL)
    first = 0 if held else _RIGID_MOTIONS
    frequencies, shapes = natural_modes(deployed)
    model, state = compile_mechanism(deployed)
    wing = [joint.panel for joint in parameters.joints[: parameters.panel_count]]

    def axis(q: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([centreline(model, q, panel) for panel in wing])

    rest, step = axis(state.q), 1e-6 * model.length_scale
    length = sum(parameters.panel(k).length for k in range(parameters.panel_count))
    axes = [rest]
    for shape in shapes.T[first : first + _SHOWN * parameters.wings]:
        moved = axis(state.q + step * shape / np.abs(shape).max()) - rest
        axes.append(rest + 0.1 * length * moved / np.hypot(*moved.T).max())
    return Modes(frequencies[first : first + _SHOWN * parameters.wings].tolist(), np.array(axes))


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
        ", ".join(dict.fromkeys(f"{frequency:.3g}" for frequency in first_modes(parameters, held).frequencies))
        for held in (True, False)
    )
    return [
        f"Motorization: {hinges} ({MARGIN:g} times the resistances, with the uncertainty factors of ECSS-E-ST-33-01C: "
        f"{counted}).",
        f"Deployed and latched, the array vibrates at {held} Hz with its hub held, at {free} Hz with it free.",
    ]
