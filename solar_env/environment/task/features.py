"""The table of features: measured values on asinh scales, which resolve the small values shortly before a latching."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]


class Feature(NamedTuple):
    """A quantity that observations list by its name, computed by `function` from an observable's measured value.

    Attributes:
        low, high: bounds of the clipped feature, in its unit.
        source: name of the observable whose measured value is the argument of `function`.
        function: maps measured values (environments,) and the joint's lock angle [rad] to feature values of this shape.
    """

    name: str
    meaning: str
    unit: str
    low: float
    high: float
    source: str
    function: Callable[[Values, float], Values]
    by_joint: bool = True


def _distance(theta: Values, lock_angle: float) -> Values:
    return np.arcsinh((1.0 - theta) / 0.01) / 2.0 - 1.0


def _speed(rate: Values, lock_angle: float) -> Values:
    return np.arcsinh(rate / lock_angle / 0.002) / 2.0 - 1.0


FEATURES = (
    Feature("distance", "asinh(distance to the lock / 0.01 lock angles) / 2 - 1", "-", -5, 5, "theta", _distance),
    Feature("speed", "asinh(opening rate / 0.002 lock angles a second) / 2 - 1", "-", -5, 5, "rate", _speed),
)
