"""Features: the inputs that an agent's networks get from an observation."""

from collections.abc import Sequence
from typing import NamedTuple

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor

LIMIT = 3.0
"""Features are clipped to plus and minus this."""

# Name of an entry up to its number -> (centre, scale) of each of its features. A latched joint still has some
# thousandths of its lock angle of play, and an array that lands softly turns by hundredths of a radian a second: next
# to entries of order 1 a network would have to grow large weights to tell such values apart.
_MAGNIFIED: dict[str, tuple[tuple[float, float], ...]] = {
    "theta": ((0.5, 2.0), (1.0, 200.0)),
    "rate": ((0.0, 20.0),),
    "motor_torque": ((0.0, 3.0),),
}


class Features(NamedTuple):
    """Coefficients of `clip(matrix o + offset, -LIMIT, LIMIT)` of entries o.

    They are computed in double precision: differences of entries magnified by hundreds keep four digits in single
    precision, which would then depend on the number of observations that are multiplied together.

    The matrix is (features, entries), the offset (features,), both float64.
    """

    matrix: np.ndarray
    offset: np.ndarray


def observation_features(names: Sequence[str]) -> Features:
    """Make the features of an observation with these entries: each as it is or magnified, angles twice."""
    rows, offsets = [], []
    for column, name in enumerate(names):
        kind = next((kind for kind in _MAGNIFIED if name.startswith(kind)), None)
        for centre, scale in _MAGNIFIED[kind] if kind else ((0.0, 1.0),):
            row = np.zeros(len(names))
            row[column] = scale
            rows.append(row)
            offsets.append(-centre * scale)
    return Features(np.array(rows), np.array(offsets))


class DriveFeatures(BaseFeaturesExtractor):
    """Features extractor for Stable-Baselines3: a fixed map of the observation, without learned parameters."""

    matrix: torch.Tensor
    offset: torch.Tensor

    def __init__(self, observation_space: gymnasium.Space, features: Features) -> None:
        super().__init__(observation_space, len(features.offset))
        for name, array in features._asdict().items():
            self.register_buffer(name, torch.from_numpy(array))

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Compute features (n, features) of observations (n, entries)."""
        return torch.clamp(observations.double() @ self.matrix.T + self.offset, -LIMIT, LIMIT).float()
