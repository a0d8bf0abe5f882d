"""The table of features: formulas of what the sensors show, of order one, for agents that learn."""

from collections.abc import Mapping
from functools import cache
from types import CodeType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
MEASURED = ("theta", "rate", "latched", "time_to_deadline")
"""Observables that features are made of."""

# Words of the formulas beside functions, and what they mean.
FORMULA_WORDS = {
    "approach": "1 until all joints have latched, then 0",
    "near": "approach * max(0, min(1, (0.3 - d) / 0.2))",
    "far": "approach - near",
    "d_j": "1 - (angle of joint j) / (its lock angle), as measured",
    "r_j": "(rate of joint j) / (its lock angle), as measured [1/s]",
    "d, r": "means of d_j and r_j over the joints",
    "ahead_d, ahead_r": "d_1 or r_1 minus the mean of those of the other joints; 0 if there are none",
    "left, time": "time to the deadline, by which all joints must have latched, and since the release [s]",
    "L(x, u)": "sign(x) ln(1 + |x| / u)",
}


def words(measured: Mapping[str, Values], lock_angles: Values, deadline: float) -> dict[str, object]:
    """The values of the words of the formulas in several arrays, (lanes, joints) or (lanes, 1), at one moment.

    Measured, by the names in `MEASURED`, are (lanes, joints) angles in units of the lock angles [rad], rates [rad/s]
    and latch switches, and the time left (lanes, 1) in units of the deadline [s].
    """
    d_j, r_j, left = 1.0 - measured["theta"], measured["rate"] / lock_angles, measured["time_to_deadline"]
    d, r = (values.mean(axis=1, keepdims=True) for values in (d_j, r_j))
    approach = 1.0 - np.all(measured["latched"] > 0.5, axis=1, keepdims=True)
    near = approach * np.clip((0.3 - d) / (0.3 - 0.1), 0.0, 1.0)
    return {
        "approach": approach,
        "near": near,
        "far": approach - near,
        "d_j": d_j,
        "r_j": r_j,
        "d": d,
        "r": r,
        "ahead_d": _ahead(d_j),
        "ahead_r": _ahead(r_j),
        "left": left * deadline,
        "time": (1.0 - left) * deadline,
        "L": _signed_logarithm,
        "ln": np.log,
        "asinh": np.arcsinh,
        "max": np.maximum,
        "min": np.minimum,
    }


def _ahead(values: Values) -> Values:
    """(lanes, 1) by how much the first joint exceeds the mean of the others; 0 where it is alone."""
    return values[:, :1] - values[:, 1:].mean(axis=1, keepdims=True) if values.shape[1] > 1 else np.zeros_like(values)


def _signed_logarithm(values: Values, unit: float) -> Values:
    return np.sign(values) * np.log1p(np.abs(values) / unit)


class Feature(NamedTuple):
    """A function of what the sensors show, by the name that an observation lists.

    Attributes:
        low, high: bounds in the unit, to which it is clipped.
        formula: what it is, in Python and in the words of `FORMULA_WORDS`.
        by_joint: whether there is one entry a joint.
    """

    name: str
    meaning: str
    unit: str
    low: float
    high: float
    formula: str
    by_joint: bool = False

    def of(self, words: Mapping[str, object]) -> Values:
        """Its values, (lanes, joints), or (lanes, 1) where it is not by joint."""
        return eval(_compiled(self.formula), {"__builtins__": {}}, words)


@cache
def _compiled(formula: str) -> CodeType:
    return compile(formula, formula, "eval")


# What the way there and the landing are described by, under names that follow theirs.
_QUANTITIES = (
    Feature("opening", "twice the mean opening less 0.8", "lock angle", -4, 4, "2 * (0.2 - d)"),
    Feature("distance", "mean distance to the lock, logarithmic", "-", -8, 8, "(L(d, 2e-4) - 4) / 2"),
    Feature("rate", "mean opening rate, logarithmic", "-", -16, 8, "(L(r, 3e-4) - 5)"),
    Feature("lead", "opening of joint 1 beyond the others, logarithmic", "-", -8, 8, "L(-ahead_d, 2e-4) / 2"),
    Feature(
        *("lead_rate", "opening rate of joint 1 beyond the others, logarithmic", "-", -8, 8),
        "(L(ahead_r, 3e-4) / 3)",
    ),
    Feature(
        *("deceleration", "rate squared over twice the distance, logarithmic", "-", -8, 8),
        "(L(max(r, 0) * max(r, 0) / (2 * max(d, 2e-4)), 1e-4) - 4) / 2",
    ),
    Feature(
        *("time_needed", "time still needed at this rate over the time left, logarithmic", "-", -8, 8),
        "ln(max(max(d, 0) / (max(r, 3e-4) * max(left, 0.1)), 1e-3))",
    ),
)

# Shares of the time until the last latch: of the way there, and of the landing.
_SHARES = {
    "far": "up to 0.7 of the opening, fading out to 0.9, then 0",
    "near": "from 0.9 of the opening to the last latch, fading in from 0.7, else 0",
}
_AFTER = "after the last latch, before it 0"


def _features_of(share: str, when: str) -> list[Feature]:
    """A share of the time, and each of the quantities times that share."""
    shared = [
        row._replace(name=f"{share}_{row.name}", meaning=f"{row.meaning}, {when}", formula=f"{share} * {row.formula}")
        for row in _QUANTITIES
    ]
    return [Feature(share, f"1 {when}", "-", 0, 1, share), *shared]


FEATURES: tuple[Feature, ...] = (
    Feature("distance", "distance to the lock, logarithmic", "-", -5, 5, "asinh(d_j / 0.01) / 2 - 1", True),
    Feature("speed", "opening rate, logarithmic", "-", -5, 5, "asinh(r_j / 0.002) / 2 - 1", True),
    *(row for share, when in _SHARES.items() for row in _features_of(share, when)),
    Feature("start", "16 at release, linearly to 0 within 0.2 s, then 0", "-", 0, 16, "16 * max(0, 1 - time / 0.2)"),
    Feature(
        *("settling_rate", f"opening rate, logarithmic, {_AFTER}", "-", -4, 4),
        *("(1 - approach) * L(r_j, 3e-4) / 4", True),
    ),
    Feature(
        *("settling_distance", f"distance to the lock, logarithmic, {_AFTER}", "-", -4, 4),
        *("(1 - approach) * L(d_j, 2e-4) / 3", True),
    ),
)
