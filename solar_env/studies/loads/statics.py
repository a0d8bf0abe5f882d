"""Properties of an array that need no simulation: torque margins of its hinges, natural frequencies when deployed."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, ParameterFile
from solar_env.array.construction import build_deployed
from solar_env.array.motorization import FACTORS, MARGIN, UNHURRIED, listed, motorization, weakest
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.analysis.linearization import natural_modes
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.studies.loads.sensitivity import OF_THE_LAWS

_LEVEL = "flexible-ideal:8 elements"  # level whose first frequencies are right in all digits shown
_RIGID_MOTIONS = 3  # rigid motions of an array whose hub is free
_SHOWN = 3  # modes shown per wing; with the hub held, mirrored wings have the same modes


@dataclass(frozen=True)
class Modes:
    """First vibration modes of the deployed array, whose ideal joints are held by springs as stiff as the latches.

    Attributes:
        frequencies: natural frequencies [Hz].
        axes: (1 + modes, points, 2) axis of the first wing from its inner hinge to its end [m]: undeformed, then in
            each mode with a greatest displacement of a tenth of the wing's length.
    """

    frequencies: Sequence[float]
    axes: NDArray[np.float64]


def first_modes(parameters: ArrayParameters, held: bool) -> Modes:
    """Return `Modes`: frequencies [Hz] and shapes of a deployed array's first 3 * wings modes; `held` fixes the hub."""
    at_rest = parameters.with_changes({"body_fixed": held, "initial_spin": 0.0, "gravity": 0.0})
    deployed = build_deployed(at_rest, _LEVEL)
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


def statics(array: ParameterFile, factors: Mapping[str, Any] | None = None) -> list[str]:
    """Return sentences on driving and required torques, natural frequencies, and parameters left at their defaults.

    Raises:
        ValueError: `factors`, changes to the uncertainty factors FACTORS, has an unknown name or a value not above 0.
    """
    used = {**FACTORS, **(factors or {})}
    counted = ", ".join(f"{name} {value:g}" for name, value in used.items())
    parameters, default = array.parameters, ArrayParameters()
    kept = [
        name
        for name in ArrayParameters.CONTINUOUS
        if name not in OF_THE_LAWS and any(default.entries(name)) and default.entries(name) == parameters.entries(name)
    ]
    found = motorization(weakest(*array), factors)
    hinges = listed(found)
    unhindered = all(math.isinf(hinge.ratio[0]) for hinge in found)
    if unhindered:
        hinges = "no friction, harness or damper is given, and no hinge has anything to overcome"
    latched = " and latched" if all(parameters.for_each_joint("latching")) else " and held at its stops"
    loops = "with its cable loops " if len(found) > len(parameters.joints) else ""
    held, free = (
        ", ".join(dict.fromkeys(f"{frequency:.3g}" for frequency in first_modes(parameters, held).frequencies))
        for held in (True, False)
    )
    absent = " No hinge friction or harness torque is given, and none is counted."
    given = any(parameters.for_each_joint("hinge_friction_torque")) or any(parameters.harness_torque)
    return [
        f"Motorization: {hinges} (1 is enough: driving torque divided by {MARGIN:g} times the resistances, springs "
        f"and resistances at the worst ends of the drawn ranges, and the uncertainty factors of ECSS-E-ST-33-01C for "
        f"resistances: {counted}; dampers at the rate of an opening in {UNHURRIED:g} s; without the friction of the "
        f"pins).{'' if given or unhindered else absent}",
        f"Deployed{latched}, {loops}the array vibrates at {held} Hz with its hub held, at {free} Hz with it free.",
        *([f"These values are the default array's; check that they are yours: {', '.join(kept)}."] if kept else []),
    ]
