"""The table of features: functions of what the sensors show, of order one, for agents that learn."""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Values = NDArray[Any]
DISTANCE = 2e-4  # below which a distance to the lock, in units of the lock angle, counts as proportional
RATE = 3e-4  # the same of an opening rate [1/s]; 5e-4 rad/s of the root hinge
FAR, NEAR = 0.3, 0.1
"""Mean distances to the lock, in units of the lock angle, from which the approach is far and up to which it is near."""
START, AT_RELEASE = 0.2, 16.0
"""Duration of the start [s]; what is shown of it at release, so that weights of the size of others reverse a drive."""
MEASURED = ("theta", "rate", "latched", "time_to_deadline")
"""Observables that features are made of."""


def signed_logarithm(values: Values, unit: float) -> Values:
    """`sign(x) ln(1 + |x| / unit)`: proportional where x is small, logarithmic where it is large."""
    return np.sign(values) * np.log1p(np.abs(values) / unit)


class Shown:
    """Readings of the sensors of several arrays at one moment, and the opening that follows from them.

    Args:
        measured: by the names in `MEASURED`: (lanes, joints) angles in units of the lock angles, rates [rad/s] and
            latch switches, (lanes, 1) time left in units of the deadline.
        lock_angles: (joints,) [rad].
        deadline: [s].

    Attributes:
        distances: (lanes, joints) to the lock, in units of the lock angle.
        rates: (lanes, joints) of the opening [1/s].
        time_to_deadline: (lanes, 1) in units of the deadline.
    """

    def __init__(self, measured: Mapping[str, Values], lock_angles: Values, deadline: float) -> None:
        self.distances, self.rates = 1.0 - measured["theta"], measured["rate"] / lock_angles
        self._latched, self.time_to_deadline, self._deadline = (
            measured["latched"],
            measured["time_to_deadline"],
            deadline,
        )

    @cached_property
    def approach(self) -> Values:
        """(lanes, 1) 1 until all joints have latched, then 0."""
        return 1.0 - np.all(self._latched > 0.5, axis=1, keepdims=True)

    @cached_property
    def near(self) -> Values:
        """(lanes, 1) 0 up to 0.7 of the opening, from 0.9 on 1, linear between, and 0 after the last latch."""
        return self.approach * np.clip((FAR - self.distance) / (FAR - NEAR), 0.0, 1.0)

    @property
    def far(self) -> Values:
        """(lanes, 1) the rest of the approach: 1 minus `near` until the last latch, then 0."""
        return self.approach - self.near

    @property
    def start(self) -> Values:
        """(lanes, 1) 1 at release, linearly to 0 at the end of the start, then 0."""
        return np.maximum(1.0 - (1.0 - self.time_to_deadline) * self._deadline / START, 0.0)

    @cached_property
    def distance(self) -> Values:
        """(lanes, 1) mean distance to the lock, in units of the lock angle."""
        return self.distances.mean(axis=1, keepdims=True)

    @cached_property
    def opening_rate(self) -> Values:
        """(lanes, 1) mean rate of the opening [1/s]."""
        return self.rates.mean(axis=1, keepdims=True)

    @property
    def deceleration(self) -> Values:
        """(lanes, 1) with which the opening would just stop at the lock [1/s^2]; 0 where it is closing or beyond."""
        return np.maximum(self.opening_rate, 0.0) ** 2 / (2.0 * np.maximum(self.distance, DISTANCE))

    @property
    def time_needed(self) -> Values:
        """(lanes, 1) share of the time left that the rest of the opening takes at this rate."""
        left = np.maximum(self.time_to_deadline * self._deadline, 0.1)
        return np.maximum(self.distance, 0.0) / (np.maximum(self.opening_rate, RATE) * left)


def ahead(values: Values) -> Values:
    """(lanes, 1) by how much the first joint exceeds the mean of the others; 0 where it is alone."""
    if values.shape[1] == 1:
        return np.zeros_like(values)
    return values[:, :1] - values[:, 1:].mean(axis=1, keepdims=True)


class Feature(NamedTuple):
    """A function of what the sensors show.

    Attributes:
        name: that an observation lists.
        meaning: for the documentation.
        unit: as observed.
        low, high: bounds to which it is clipped.
        of: maps what is shown to (lanes, joints), or (lanes, 1) where it is not by joint.
        formula: the same for who writes it in another language, in the words of `FORMULA_WORDS`.
        by_joint: whether there is one entry a joint.
    """

    name: str
    meaning: str
    unit: str
    low: float
    high: float
    of: Callable[[Shown], Values]
    formula: str
    by_joint: bool = False

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy and pickle by the name, for functions without one cannot be pickled."""
        return feature, (self.name,)


def feature(name: str) -> Feature:
    """Row of the table of features."""
    return next(row for row in FEATURES if row.name == name)


# Words of the formulas, and what they mean.
FORMULA_WORDS = {
    "approach": "1 until all joints have latched, then 0",
    "near": "approach * max(0, min(1, (0.3 - d) / 0.2))",
    "far": "approach - near",
    "d_j": "1 - (angle of joint j) / (its lock angle), as measured",
    "r_j": "(rate of joint j) / (its lock angle), as measured [1/s]",
    "d, r": "means of d_j and r_j over the joints",
    "ahead_d, ahead_r": "d_1 or r_1 minus the mean of those of the other joints; 0 if there are none",
    "deadline": "time by which all joints must have latched [s]",
    "left": "time to the deadline [s]",
    "L(x, u)": "sign(x) ln(1 + |x| / u)",
}

# What the way there and the landing are described by, under names that follow theirs.
_QUANTITIES = (
    Feature("", "1", "-", 0, 1, lambda s: np.ones_like(s.distance), "1"),
    Feature(
        "opening", "twice the mean opening less 0.8", "lock angle", -4, 4,
        lambda s: 2.0 * (0.2 - s.distance),
        "2 * (0.2 - d)",
    ),
    Feature(
        "distance", "mean distance to the lock, logarithmic", "-", -8, 8,
        lambda s: (signed_logarithm(s.distance, DISTANCE) - 4.0) / 2.0,
        "(L(d, 2e-4) - 4) / 2",
    ),
    Feature(
        "rate", "mean opening rate, logarithmic", "-", -16, 8,
        lambda s: signed_logarithm(s.opening_rate, RATE) - 5.0,
        "(L(r, 3e-4) - 5)",
    ),
    Feature(
        "lead", "opening of joint 1 beyond the others, logarithmic", "-", -8, 8,
        lambda s: signed_logarithm(-ahead(s.distances), DISTANCE) / 2.0,
        "L(-ahead_d, 2e-4) / 2",
    ),
    Feature(
        "lead_rate", "opening rate of joint 1 beyond the others, logarithmic", "-", -8, 8,
        lambda s: signed_logarithm(ahead(s.rates), RATE) / 3.0,
        "L(ahead_r, 3e-4) / 3",
    ),
    Feature(
        "deceleration", "rate squared over twice the distance, logarithmic", "-", -8, 8,
        lambda s: (signed_logarithm(s.deceleration, 1e-4) - 4.0) / 2.0,
        "(L(max(r, 0) * max(r, 0) / (2 * max(d, 2e-4)), 1e-4) - 4) / 2",
    ),
    Feature(
        "time_needed", "time still needed at this rate over the time left, logarithmic", "-", -8, 8,
        lambda s: np.log(np.maximum(s.time_needed, 1e-3)),
        "ln(max(max(d, 0) / (max(r, 3e-4) * max(left, 0.1)), 1e-3))",
    ),
)  # fmt: skip

# Shares of the time until the last latch: of the way there, and of the landing.
_SHARES: dict[str, tuple[Callable[[Shown], Values], str]] = {
    "far": (lambda s: s.far, "up to 0.7 of the opening, fading out to 0.9, then 0"),
    "near": (lambda s: s.near, "from 0.9 of the opening to the last latch, fading in from 0.7, else 0"),
}
_AFTER = "after the last latch, before it 0"


def _shared(share: str, quantity: Feature) -> Feature:
    """The feature that is a share times a quantity."""
    of_share, while_ = _SHARES[share]
    return Feature(
        f"{share}_{quantity.name}".removesuffix("_"),
        f"{quantity.meaning} {while_}" if not quantity.name else f"{quantity.meaning}, {while_}",
        quantity.unit, quantity.low, quantity.high,
        lambda s: of_share(s) * quantity.of(s),
        f"{share} * {quantity.formula}" if quantity.name else share,
    )  # fmt: skip


FEATURES: tuple[Feature, ...] = (
    *(_shared(share, quantity) for share in _SHARES for quantity in _QUANTITIES),
    Feature(
        "start", "16 at release, linearly to 0 within 0.2 s, then 0", "-", 0, 16,
        lambda s: AT_RELEASE * s.start,
        "16 * max(0, 1 - (deadline - left) / 0.2)",
    ),
    Feature(
        "settling_rate", f"opening rate, logarithmic, {_AFTER}", "-", -4, 4,
        lambda s: (1.0 - s.approach) * signed_logarithm(s.rates, RATE) / 4.0,
        "(1 - approach) * L(r_j, 3e-4) / 4", True,
    ),
    Feature(
        "settling_distance", f"distance to the lock, logarithmic, {_AFTER}", "-", -4, 4,
        lambda s: (1.0 - s.approach) * signed_logarithm(s.distances, DISTANCE) / 3.0,
        "(1 - approach) * L(d_j, 2e-4) / 3", True,
    ),
)  # fmt: skip
