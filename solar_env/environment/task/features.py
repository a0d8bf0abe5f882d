"""The table of features: functions of what the sensors show, of order one, for agents that learn."""

from collections.abc import Callable, Mapping
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


class Shown(NamedTuple):
    """Readings of the sensors of several arrays at one moment, and what follows from them.

    Distances to the lock and rates are in units of the lock angles, (lanes, joints); all else is (lanes, 1).

    Attributes:
        distances: of the joints to their locks.
        rates: of their opening [1/s].
        approach: 1 until all joints have latched, then 0.
        near: 0 up to 0.7 of the opening, from 0.9 on 1, linear between, and 0 after the last latch.
        far: the rest of the approach.
        start: 1 at release, linearly to 0 at the end of the start, then 0.
        distance, rate: means over the joints.
        deceleration: with which the opening would just stop at the lock [1/s^2]; 0 where it is closing or beyond.
        time_needed: share of the time left that the rest of the opening takes at this rate.
    """

    distances: Values
    rates: Values
    approach: Values
    near: Values
    far: Values
    start: Values
    distance: Values
    rate: Values
    deceleration: Values
    time_needed: Values


def shown(measured: Mapping[str, Values], lock_angles: Values, deadline: float) -> Shown:
    """Features that follow from the readings of the sensors.

    Args:
        measured: by the names in `MEASURED`: (lanes, joints) angles in units of the lock angles, rates [rad/s] and
            latch switches, (lanes, 1) time left in units of the deadline.
        lock_angles: (joints,) [rad].
        deadline: [s].
    """
    distances, rates, left = 1.0 - measured["theta"], measured["rate"] / lock_angles, measured["time_to_deadline"]
    distance, rate = (values.mean(axis=1, keepdims=True) for values in (distances, rates))
    opening_rate = np.maximum(rate, 0.0)
    approach = 1.0 - np.all(measured["latched"] > 0.5, axis=1, keepdims=True)
    near = approach * np.clip((FAR - distance) / (FAR - NEAR), 0.0, 1.0)
    return Shown(
        distances,
        rates,
        approach,
        near,
        far=approach - near,
        start=np.maximum(1.0 - (1.0 - left) * deadline / START, 0.0),
        distance=distance,
        rate=rate,
        deceleration=opening_rate**2 / (2.0 * np.maximum(distance, DISTANCE)),
        time_needed=np.maximum(distance, 0.0) / (np.maximum(rate, RATE) * np.maximum(left * deadline, 0.1)),
    )


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
        lambda s: signed_logarithm(s.rate, RATE) - 5.0,
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
_SHARES = {
    "far": "up to 0.7 of the opening, fading out to 0.9, then 0",
    "near": "from 0.9 of the opening to the last latch, fading in from 0.7, else 0",
}
_AFTER = "after the last latch, before it 0"


def _shared(share: str, quantity: Feature) -> Feature:
    """The feature that is a share times a quantity."""
    return Feature(
        f"{share}_{quantity.name}".removesuffix("_"),
        f"{quantity.meaning}{', ' if quantity.name else ' '}{_SHARES[share]}",
        quantity.unit, quantity.low, quantity.high,
        lambda s: getattr(s, share) * quantity.of(s),
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
