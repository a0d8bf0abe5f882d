"""A torque against the rate of the driven joint."""

from dataclasses import dataclass

import numpy as np

from agents.torque_laws import Entries, LawParameters, TunableLaw, bounded


@dataclass(frozen=True)
class DamperParameters(LawParameters):
    """Parameters of `ViscousDamper`.

    Attributes:
        damping: Torque per rate of the driven joint until the last joint has latched [N m s/rad].
        postlock_damping: Torque per rate of the driven joint from then on [N m s/rad].
    """

    damping: float = bounded(1.0, 0.0, 6.0)
    postlock_damping: float = bounded(1.0, 0.0, 10.0)


class ViscousDamper(TunableLaw[DamperParameters]):
    """A torque against the rate of the driven joint, as the rotary dampers of spring-driven hinges exert it."""

    reads = ("rate_driven",)
    defaults = DamperParameters()

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        return -np.where(all_latched, p.postlock_damping, p.damping) * entries["rate_driven"]
