"""A constant torque against opening."""

from dataclasses import dataclass

import numpy as np

from agents.torque_laws import Entries, LawParameters, TunableLaw, bounded


@dataclass(frozen=True)
class BrakeParameters(LawParameters):
    """Parameters of `ConstantBrake`.

    Attributes:
        torque: Magnitude of the torque against the direction of opening [N m].
        onset: Opening of the driven joint, in units of its lock angle, from which the torque acts (0: from the start).
    """

    torque: float = bounded(0.03, 0.0, 0.5)
    onset: float = bounded(0.0, 0.0, 1.0)


class ConstantBrake(TunableLaw[BrakeParameters]):
    """A constant torque against opening until the last joint has latched, then none."""

    reads = ("theta_driven",)
    defaults = BrakeParameters()

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        acts = (entries["theta_driven"] >= self.parameters.onset) & ~all_latched
        return np.where(acts, -self.parameters.torque, 0.0)
