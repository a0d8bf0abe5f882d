"""What the networks of an agent see of an observation: angles magnified about the latch, rates in their own unit."""

from collections.abc import Sequence

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor

LIMIT = 2.0
"""Features are clipped to plus and minus this."""

# Name of an entry up to its number -> (centre, scale) of each of its features. A latched joint still has some
# thousandths of its lock angle of play, and an array that lands softly turns by hundredths of a radian a second: next
# to entries of order 1 a network would have to grow large weights to tell such values apart.
_FEATURES: dict[str, tuple[tuple[float, float], ...]] = {
    "theta": ((0.5, 2.0), (1.0, 200.0)),
    "rate": ((0.0, 20.0),),
    "motor_torque": ((0.0, 3.0),),
}


def affine(names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Matrix (features, entries) and offset (features,) of the features of an observation before they are clipped.

    Args:
        names: Name of every entry, as `env.unwrapped.observation_names`.
    """
    rows, offsets = [], []
    for column, name in enumerate(names):
        kind = next((kind for kind in _FEATURES if name.startswith(kind)), None)
        for centre, scale in _FEATURES[kind] if kind else ((0.0, 1.0),):
            row = np.zeros(len(names))
            row[column] = scale
            rows.append(row)
            offsets.append(-centre * scale)
    return np.array(rows, dtype=np.float32), np.array(offsets, dtype=np.float32)


class DriveFeatures(BaseFeaturesExtractor):
    """Features extractor for Stable-Baselines3: a fixed affine map of the observation, clipped; nothing is learned.

    Args:
        observation_space: Of the environment.
        names: Name of every entry of an observation.
    """

    matrix: torch.Tensor
    offset: torch.Tensor

    def __init__(self, observation_space: gymnasium.Space, names: Sequence[str]) -> None:
        matrix, offset = affine(names)
        super().__init__(observation_space, len(offset))
        self.register_buffer("matrix", torch.from_numpy(matrix))
        self.register_buffer("offset", torch.from_numpy(offset))

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Features (n, features) of observations (n, entries)."""
        return torch.clamp(observations @ self.matrix.T + self.offset, -LIMIT, LIMIT)
