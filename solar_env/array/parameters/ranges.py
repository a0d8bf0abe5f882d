"""Ranges of parameters that are not known exactly: checks of the ranges, and random sampling from them.

The environments' keyword for ranges, and the table of ranges in a parameter file, are called `randomize`.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from solar_env.array.parameters.parameters import ArrayParameters
from solar_env.array.parameters.rows import entry_of
from solar_env.support.values import check_name, is_number, plain

# Greatest change of an initial joint rate [rad/s], up or down, between the otherwise equal deployments of an ensemble.
# Impacts are chaotic, so that a single deployment says little; after the latching even these changes lead to very
# different motions. For comparison, joint 1 deploys at 0.13 rad/s on average.
RELEASE_RATE = 5e-4

# Bound of a range for uniform sampling: a number, or one number per joint.
Bound = float | tuple[float, ...]
Ranges = Mapping[str, tuple[Bound, Bound]]
_BELOW_ANOTHER = ("clearance", "friction_speed_zero")  # parameters that must stay below another parameter


def drawn(ranges: Ranges, generator: np.random.Generator) -> dict[str, float | tuple[float, ...]]:
    """Sample each parameter uniformly from its range, and return the values by name; bounds by joint give tuples."""
    values = {name: generator.uniform(low, high) for name, (low, high) in ranges.items()}
    return {name: tuple(value.tolist()) if np.ndim(value) else float(value) for name, value in values.items()}


def checked_ranges(parameters: ArrayParameters, ranges: Ranges) -> Ranges:
    """Check that the array can have all values in the ranges, and return the ranges.

    Bounds of a parameter that is sampled separately for each joint are returned as tuples with an entry per joint.

    Raises:
        ValueError: a parameter is unknown, or the array cannot have all values in a range.
    """
    if not isinstance(ranges, Mapping):
        raise ValueError(f"randomize = {ranges!r} must be a mapping of parameter names to pairs (low, high)")
    checked: dict[str, tuple[Bound, Bound]] = {}
    for name, pair in ranges.items():
        told = f"randomize[{name!r}]"
        check_name("parameter", name, vars(parameters))
        if name not in ArrayParameters.CONTINUOUS:
            raise ValueError(f"{told}: {name} is not a real number and cannot be drawn")
        bounds: Any = pair
        if not hasattr(bounds, "__len__") or len(bounds) != 2:
            raise ValueError(f"{told} = {bounds!r} must be a pair (low, high)")
        several = any(hasattr(bound, "__len__") for bound in bounds)
        by_joint = name in ArrayParameters.DRAWN_BY_JOINT or (several and name in ArrayParameters.BY_JOINT)
        array = parameters if by_joint else None
        low, high = (_spread(f"{told}: the bound {bound!r}", bound, array) for bound in bounds)
        if not np.all(np.less_equal(low, high)):
            raise ValueError(f"{told} = {bounds!r} must satisfy low <= high")
        for end in (low, high):
            parameters.with_changes({name: end})
        checked[name] = (low, high)
    # Samples may reach any corner of the ranges; at the corners below, two parameters can contradict each other.
    lows, highs = ({name: pair[end] for name, pair in checked.items()} for end in (0, 1))
    for corner in (lows, highs, *({**lows, small: highs[small]} for small in _BELOW_ANOTHER if small in highs)):
        parameters.with_changes(corner)
    return checked


def _spread(told: str, given: Any, array: ArrayParameters | None) -> Bound:
    """Check the bound `given` of a range; return a number, or one per joint of `array`. Errors begin with `told`."""
    value = plain(given)
    entries = value if isinstance(value, tuple) else (value,)
    if not all(is_number(entry) and math.isfinite(entry) for entry in entries):
        raise ValueError(f"{told} must be a finite number")
    if array is None:
        if entries is value:
            raise ValueError(f"{told} must be a single number")
        return float(entries[0])
    if not 1 <= len(entries) <= array.joint_count:
        raise ValueError(f"{told} must have 1 to {array.joint_count} entries, one a joint")
    return tuple(float(entry_of(entries, j, array.panel_count)) for j in range(array.joint_count))
