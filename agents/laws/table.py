"""The table of controllers without learning; tuning, evaluation and help texts follow it."""

from typing import Any

from agents.laws.feedback import Passive, ProportionalDerivative, ViscousDamper
from agents.laws.servo import SoftStartServo, VelocityProfileServo
from agents.torque_laws import TorqueLaw, TunableLaw

TUNABLE: dict[str, type[TunableLaw[Any]]] = {
    "damper": ViscousDamper,
    "servo": VelocityProfileServo,
    "soft-start": SoftStartServo,
    "pd": ProportionalDerivative,
}
"""Name -> class of the laws whose parameters are those that `solar-env tune` has found."""

LAWS: dict[str, type[TorqueLaw]] = {"passive": Passive, **TUNABLE, "servo-untuned": VelocityProfileServo}
"""Name -> class of all controllers without learning."""
