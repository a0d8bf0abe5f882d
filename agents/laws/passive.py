"""The passive deployment: no motor torque."""

from collections.abc import Mapping

import numpy as np

from agents.torque_laws import TorqueLaw


class Passive(TorqueLaw):
    """Zero torque: the springs deploy the array alone."""

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        return np.zeros(len(all_latched))
