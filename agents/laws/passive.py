"""The passive deployment: no motor torque."""

import numpy as np

from agents.torque_laws import Entries, TorqueLaw


class Passive(TorqueLaw):
    """Zero torque: the springs deploy the array alone."""

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        return np.zeros(len(all_latched))
