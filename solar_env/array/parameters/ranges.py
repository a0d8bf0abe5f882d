"""Parameters of which only ranges are known: their check, and draws from them.

Environments call them `randomize`; in a file of parameters they are its tables `randomize` and `tolerance`.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from solar_env.array.names import unknown_name
from solar_env.array.parameters.parameters import ArrayParameters
from solar_env.support.numbers import is_number, plain

# Joint rates [rad/s], either way of rest, at which deployments that are meant to be alike are released: impacts are
# chaotic, so that a single deployment says little, and these are far apart from the latching on. In the mean, joint 1
# deploys at 0.13 rad/s.
RELEASE_RATE = 5e-4

# Bounds of a uniform draw: numbers, or one by joint.
Bound = float | tuple[float, ...]
Ranges = Mapping[str, tuple[Bound, Bound]]


def drawn(ranges: Ranges, generator: np.random.Generator) -> dict[str, Any]:
    """Values drawn uniformly from checked ranges, by joint where the bounds are; changes for `with_changes`."""
    values = {name: generator.uniform(low, high) for name, (low, high) in ranges.items()}
    return {name: tuple(value.tolist()) if np.ndim(value) else float(value) for name, value in values.items()}


def checked_ranges(parameters: ArrayParameters, ranges: Ranges) -> Ranges:
    """The ranges with both ends shown to be acceptable values, by joint where the parameter is.

    Raises:
        ValueError: for an unknown parameter, or a range in which not every value is acceptable.
    """
    if not isinstance(ranges, Mapping):
        raise ValueError(f"randomize = {ranges!r} must be a mapping of parameter names to pairs (low, high)")
    checked: dict[str, tuple[Bound, Bound]] = {}
    for name, bounds in ranges.items():
        if name not in vars(parameters):
            raise ValueError(unknown_name("parameter", name, vars(parameters)))
        if name not in ArrayParameters.CONTINUOUS:
            raise ValueError(f"randomize[{name!r}]: {name} is not a real number and cannot be drawn")
        pair: Any = bounds
        if not hasattr(pair, "__len__") or len(pair) != 2:
            raise ValueError(f"randomize[{name!r}] = {bounds!r} must be a pair (low, high)")
        several = any(hasattr(bound, "__len__") for bound in pair)
        by_joint = name in ArrayParameters.DRAWN_BY_JOINT or (several and name in ArrayParameters.BY_JOINT)
        low, high = (_checked_bound(name, bound, len(parameters.joints) if by_joint else None) for bound in pair)
        if not np.all(np.less_equal(low, high)):
            raise ValueError(f"randomize[{name!r}] = {bounds!r} must satisfy low <= high")
        for end in (low, high):
            parameters.with_changes({name: end})
        checked[name] = (low, high)
    # Draws of several parameters may meet at any corner; these are the ones at which two of them can contradict.
    lows, highs = ({name: pair[end] for name, pair in checked.items()} for end in (0, 1))
    corners = [lows, highs] + [
        {**lows, small: highs[small]} for small in ArrayParameters.BELOW_ANOTHER if small in highs
    ]
    for corner in corners:
        parameters.with_changes(corner)
    return checked


def _checked_bound(name: str, bound: Any, joints: int | None) -> Bound:
    """A bound as a number, or with an entry for each of `joints`: the last one given holds for all further ones."""
    bound = plain(bound)
    entries = bound if isinstance(bound, tuple) else (bound,)
    for entry in entries:
        if not (is_number(entry) and math.isfinite(entry)):
            raise ValueError(f"randomize[{name!r}]: the bound {bound!r} must be a finite number")
    if joints is None:
        if len(entries) != 1 or entries is bound:
            raise ValueError(f"randomize[{name!r}]: the bound {bound!r} must be a single number")
        return float(bound)
    if not 1 <= len(entries) <= joints:
        raise ValueError(f"randomize[{name!r}]: the bound {bound!r} must have 1 to {joints} entries, one a joint")
    return tuple(float(entries[min(j, len(entries) - 1)]) for j in range(joints))
