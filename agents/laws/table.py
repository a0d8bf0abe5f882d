"""The table of controllers without learning; tuning, evaluation, residual agents, suites and help texts follow it."""

from dataclasses import dataclass
from typing import Any

from agents.laws.brake import ConstantBrake
from agents.laws.damper import ViscousDamper
from agents.laws.open_loop import OpenLoopTorque
from agents.laws.passive import Passive
from agents.laws.pd import ProportionalDerivative
from agents.laws.receding_horizon import RecedingHorizon
from agents.laws.servo import VelocityProfileServo
from agents.laws.shaped import InputShapedProfile
from agents.laws.soft_start import SoftStartServo
from agents.torque_laws import TorqueLaw, TunableLaw


@dataclass(frozen=True)
class Row:
    """A controller without learning: the class of a torque law, or of a search that needs the simulator."""

    cls: type[TorqueLaw] | type[RecedingHorizon]
    tuned: bool = False  # whether the parameters are those that `solar-env tune` has found
    base: str | None = None  # name of the law that a search improves on; None for a torque law


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
    "receding-horizon": Row(RecedingHorizon, base="servo"),
}
"""Name of a controller without learning -> its row."""

BASELINES = tuple(name for name, row in LAWS.items() if row.base is None)
"""Names of the torque laws, which need nothing but observations."""

TUNABLE: dict[str, type[TunableLaw[Any]]] = {
    name: row.cls for name, row in LAWS.items() if row.tuned and issubclass(row.cls, TunableLaw)
}
"""Name -> class of the laws with tuned parameters."""
