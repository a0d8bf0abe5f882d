"""Parameters that the paper leaves open, with the ranges that are searched."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solar_env.array import ArrayParameters

# rad; latch stiffnesses of different exponents are compared by the torque at this depth.
LATCH_DEPTH = 0.01


@dataclass(frozen=True)
class OpenParameter:
    """A quantity that the paper leaves open.

    Attributes:
        name: of a parameter of the array; or "latch_torque", of the latches at LATCH_DEPTH, and "friction_speed_ratio",
            of the two speeds between which friction sets in.
        low, high: range that is searched.
        unit: of the quantity.
        logarithmic: whether it is searched by its logarithm.
    """

    name: str
    low: float
    high: float
    unit: str = ""
    logarithmic: bool = True

    def value(self, share: float) -> float:
        """The quantity at a share, 0 to 1, of its range."""
        if self.logarithmic:
            return float(self.low * (self.high / self.low) ** share)
        return self.low + (self.high - self.low) * share

    def share(self, value: float) -> float:
        """The share of the range below a value; 0 or 1 outside."""
        low, high, own = np.log([self.low, self.high, value]) if self.logarithmic else (self.low, self.high, value)
        return float(np.clip((own - low) / (high - low), 0.0, 1.0))


# The wear coefficient is not among them: depths are proportional to it, and nothing else hangs on it. Nor are the
# wheels' radii: torques of the loop hang on the ratio and on where a strand goes slack, at twice the preload's torque.
OPEN_PARAMETERS = (
    OpenParameter("hinge_y", -0.5, 0.5, "m", logarithmic=False),
    OpenParameter("cable_torque_ratio", 0.8, 2.2, logarithmic=False),
    OpenParameter("cable_stiffness", 3.0, 500.0, "N m/rad"),
    OpenParameter("cable_preload_force", 5.0, 500.0, "N"),
    OpenParameter("latch_gap", 1e-3, 0.06, "rad"),
    OpenParameter("latch_torque", 0.05, 100.0, "N m"),
    OpenParameter("latch_exponent", 1.0, 2.2, logarithmic=False),
    OpenParameter("latch_damping", 0.3, 100.0, "N m s/rad"),
    OpenParameter("latch_ramp_depth", 1e-4, 0.1, "rad"),
    OpenParameter("friction_speed_zero", 1e-5, 3e-3, "m/s"),
    OpenParameter("friction_speed_ratio", 1.5, 30.0),
)
SLIDING = ("material", "centres", "places")
STIFFNESS = ("table", "eq 40")  # of the paper's Table 1, or by its Eq 40
Readings = Mapping[str, str]

# Sets that have been found by hand, beside the preset; the last one by varying the best of this search.
NAMED: Mapping[str, Mapping[str, float]] = {
    "mid-side": {
        "hinge_y": 0.0, "cable_torque_ratio": 1.17, "cable_stiffness": 180.0, "latch_stiffness": 3e4,
        "latch_exponent": 2.0, "latch_gap": 0.025, "latch_damping": 13.0, "latch_ramp_depth": 0.04,
        "friction_speed_zero": 3e-4, "friction_speed_full": 3e-3,
    },
    "soft latch": {
        "hinge_y": 0.0, "cable_torque_ratio": 1.195, "cable_stiffness": 41.0, "latch_stiffness": 49.0,
        "latch_exponent": 1.09, "latch_gap": 0.0084, "latch_damping": 22.0, "latch_ramp_depth": 0.031,
    },
    "stiff loop": {
        "hinge_y": 0.5, "cable_torque_ratio": 1.28, "cable_stiffness": 750.0, "cable_preload_force": 73.0,
        "latch_stiffness": 1.6e4, "latch_exponent": 1.9, "latch_gap": 0.037, "latch_damping": 12.0,
        "latch_ramp_depth": 0.038, "friction_speed_zero": 4.8e-4, "friction_speed_full": 0.013,
    },
}  # fmt: skip


def parameters_at(point: Sequence[float], readings: Readings) -> ArrayParameters:
    """The array at a point of the unit cube, one share of its range for each of OPEN_PARAMETERS, and with readings."""
    values = {own.name: own.value(share) for own, share in zip(OPEN_PARAMETERS, point, strict=True)}
    values["latch_stiffness"] = values.pop("latch_torque") / LATCH_DEPTH ** values["latch_exponent"]
    values["friction_speed_full"] = values["friction_speed_zero"] * values.pop("friction_speed_ratio")
    changes: dict[str, Any] = {**values, "friction_sliding": readings["sliding"]}
    if readings["stiffness"] == "eq 40":
        changes["contact_stiffness"] = None
    return ArrayParameters.preset("paper").with_changes(changes)


def named(name: str) -> ArrayParameters:
    """The array of a named set; of the preset, "preset"."""
    return ArrayParameters.preset("paper").with_changes(NAMED.get(name, {}))


def quantities(parameters: ArrayParameters) -> dict[str, float]:
    """The open parameters of an array by name."""

    def value(name: str) -> float:
        return float(parameters.by_joint(name, 0))

    found = {
        "latch_torque": value("latch_stiffness") * LATCH_DEPTH ** value("latch_exponent"),
        "friction_speed_ratio": value("friction_speed_full") / value("friction_speed_zero"),
    }
    return {own.name: found[own.name] if own.name in found else value(own.name) for own in OPEN_PARAMETERS}


def point_of(parameters: ArrayParameters) -> list[float]:
    """The point of the unit cube that is nearest to an array."""
    found = quantities(parameters)
    return [own.share(found[own.name]) for own in OPEN_PARAMETERS]
