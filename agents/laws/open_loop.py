"""A torque over time, without feedback."""

from dataclasses import dataclass

import numpy as np

from agents.torque_laws import Entries, LawParameters, TunableLaw, bounded


@dataclass(frozen=True)
class OpenLoopParameters(LawParameters):
    """Parameters of `OpenLoopTorque`.

    Attributes:
        torques: Torques at equal distances from the start to the deadline [N m].
    """

    torques: tuple[float, ...] = bounded((0.0,) * 16, -0.5, 0.5)


class OpenLoopTorque(TunableLaw[OpenLoopParameters]):
    """A torque over time, linear between given values, without feedback; none after the deadline."""

    reads = ("time_to_deadline",)
    defaults = OpenLoopParameters()

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        to_go = entries["time_to_deadline"]
        torques = self.parameters.torques
        torque = np.interp(1.0 - to_go, np.linspace(0.0, 1.0, len(torques)), torques)
        return np.where(to_go > 0.0, torque, 0.0)
