"""The table of controllers without learning; tuning, evaluation, suites and help texts follow it."""

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

TUNABLE: dict[str, type[TunableLaw[Any]]] = {
    "brake": ConstantBrake,
    "damper": ViscousDamper,
    "servo": VelocityProfileServo,
    "shaped": InputShapedProfile,
    "open-loop": OpenLoopTorque,
    "soft-start": SoftStartServo,
    "pd": ProportionalDerivative,
}
"""Name -> class of the laws whose parameters are those that `solar-env tune` has found."""

LAWS: dict[str, type[TorqueLaw]] = {"passive": Passive, **TUNABLE, "servo-untuned": VelocityProfileServo}
"""Name -> class of all controllers without learning."""
