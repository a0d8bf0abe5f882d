"""The table of features: sensor readings, scaled so that values that decide a landing are of order one."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]


class Feature(NamedTuple):
    """A function of the sensor reading of each joint, by the name that an observation lists.

    Attributes:
        low, high: bounds in the unit, to which it is clipped.
        source: name of the observable that it is a function of.
        function: from what the sensor shows (lanes,) and the joint's lock angle [rad] to values (lanes,).
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
