"""A push from release to the last latch."""

import numpy as np

from agents.torque_laws import Entries, TorqueLaw


class Push(TorqueLaw):
    """A tenth of the greatest torque until the last joint has latched."""

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        return np.where(all_latched, 0.0, 0.1 * self._signals.torque_limit)
