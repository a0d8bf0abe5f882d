"""The table of controllers without learning; tuning, evaluation, suites and help texts follow it."""

from dataclasses import dataclass
from typing import Any

from agents.laws.brake import ConstantBrake
from agents.laws.damper import ViscousDamper
from agents.laws.open_loop import OpenLoopTorque
from agents.laws.passive import Passive
from agents.laws.pd import ProportionalDerivative
from agents.laws.servo import VelocityProfileServo
from agents.laws.shaped import InputShapedProfile
from agents.laws.soft_start import SoftStartServo
from agents.torque_laws import TorqueLaw, TunableLaw


@dataclass(frozen=True)
class Row:
    """A controller without learning: the class of a torque law."""

    cls: type[TorqueLaw]
    tuned: bool = False  # whether the parameters are those that `solar-env tune` has found


LAWS: dict[str, Row] = {
    "passive": Row(Passive),
    "brake": Row(ConstantBrake, tuned=True),
    "damper": Row(ViscousDamper, tuned=True),
    "servo": Row(VelocityProfileServo, tuned=True),
    "shaped": Row(InputShapedProfile, tuned=True),
    "open-loop": Row(OpenLoopTorque, tuned=True),
    "soft-start": Row(SoftStartServo, tuned=True),
    "pd": Row(ProportionalDerivative, tuned=True),
    "servo-untuned": Row(VelocityProfileServo),
}
"""Name of a controller without learning -> its row."""

TUNABLE: dict[str, type[TunableLaw[Any]]] = {
    name: row.cls for name, row in LAWS.items() if row.tuned and issubclass(row.cls, TunableLaw)
}
"""Name -> class of the laws with tuned parameters."""
