"""Tables of the controllers without learning, which tuning, evaluation and help texts use."""

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
"""Name -> class of the drive laws with parameters, which `solar-env tune` finds."""

LAWS: dict[str, type[TorqueLaw]] = {"passive": Passive, **TUNABLE, "servo-untuned": VelocityProfileServo}
"""Name -> class of all drive laws: the controllers without learning."""
