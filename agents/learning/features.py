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
_WHOLE: dict[str, tuple[tuple[float, float], ...]] = {
    "theta": ((0.5, 2.0), (1.0, 200.0)),
    "rate": ((0.0, 20.0),),
    "motor_torque": ((0.0, 3.0),),
}

APPROACH_BEGINS, APPROACH_IS_FULL = 0.85, 0.95  # opening of joint 1, in units of its lock angle
LEAST_DEVIATION = 0.05  # of a principal component, next to entries of unit deviation


class Features(NamedTuple):
    """Coefficients of `clip(matrix o + offset, -LIMIT, LIMIT) clip(gate_matrix o + gate_offset, 0, 1)` of entries o.

    They are computed in double precision: differences of entries magnified by thousands keep three digits in single
    precision, which would then depend on the number of observations that are multiplied together.

    Matrices are (features, entries), offsets (features,), all float64.
    """

    matrix: np.ndarray
    offset: np.ndarray
    gate_matrix: np.ndarray
    gate_offset: np.ndarray


def whole_motion(names: Sequence[str]) -> Features:
    """Make features for an agent that commands the whole torque: each entry, angles also magnified about the latch."""
    rows, offsets = [], []
    for column, name in enumerate(names):
        kind = next((kind for kind in _WHOLE if name.startswith(kind)), None)
        for centre, scale in _WHOLE[kind] if kind else ((0.0, 1.0),):
            row = np.zeros(len(names))
            row[column] = scale
            rows.append(row)
            offsets.append(-centre * scale)
    return Features(np.array(rows), np.array(offsets), np.zeros((len(rows), len(names))), np.ones(len(rows)))


def landing(names: Sequence[str], observations: np.ndarray, driven_joint: int = 0) -> Features:
    """Make features for an agent that adds to a law: the variation of its observations while it lands the array.

    There are two sets, for the approach to the latches and for the latched array, each with a 1 and the principal
    components of the observations of that phase, all of unit variance. Noise on the weights of a linear policy
    explores them alike, where raw entries, nearly proportional to each other, would only make it push one way or the
    other.

    Args:
        names: Name of every entry of an observation.
        observations: Observations (n, entries) of episodes of the law.
        driven_joint: Index of the joint that the motor works on.

    Raises:
        ValueError: The law has not come near the latches or has not latched all joints.
    """
    sets = []
    for gate in _gates(names, driven_joint):
        seen = observations @ gate[0] + gate[1] > 0.5
        if np.count_nonzero(seen) < 2:
            raise ValueError(
                "the law that the agent adds to does not land the array: it is observed in "
                f"{np.count_nonzero(seen)} of {len(observations)} periods near the latches or latched; tune it first"
            )
        rows, offsets = _standardised(names, observations[seen])
        sets.append((rows, offsets, np.tile(gate[0], (len(rows), 1)), np.full(len(rows), gate[1])))
    return Features(*(np.concatenate(parts) for parts in zip(*sets, strict=True)))


def _gates(names: Sequence[str], driven_joint: int) -> list[tuple[np.ndarray, float]]:
    """Return weights (entries,) and offset of the gates of both sets of `landing`."""
    approach, latched = np.zeros(len(names)), np.array([float(name.startswith("latched_")) for name in names])
    slope = 1.0 / (APPROACH_IS_FULL - APPROACH_BEGINS)
    for name, weight in (("theta", slope), ("latched", -slope)):
        approach[names.index(f"{name}_{driven_joint + 1}")] = weight
    return [(approach, -slope * APPROACH_BEGINS), (latched, 1.0 - latched.sum())]


def _standardised(names: Sequence[str], observations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return matrix and offset of a 1 and the principal components of observations (n, entries), of unit variance."""
    # In single precision the mean of thousands of latched angles would be off by a tenth of their deviation.
    observations = observations.astype(np.float64)
    mean, deviation = observations.mean(axis=0), observations.std(axis=0)
    varies = (deviation > 1e-6) & np.array([not name.startswith("latched") for name in names])
    scale = np.where(varies, 1.0 / np.where(varies, deviation, 1.0), 0.0)
    _, deviations, directions = np.linalg.svd((observations - mean) * scale, full_matrices=False)
    deviations = deviations / np.sqrt(len(observations))
    kept = deviations > LEAST_DEVIATION
    components = directions[kept] / deviations[kept, None] * scale
    matrix = np.concatenate([np.zeros((1, len(names))), components])
    return matrix, np.concatenate([np.ones(1), -components @ mean])


class DriveFeatures(BaseFeaturesExtractor):
    """Features extractor for Stable-Baselines3: a fixed map of the observation, without learned parameters."""

    matrix: torch.Tensor
    offset: torch.Tensor
    gate_matrix: torch.Tensor
    gate_offset: torch.Tensor

    def __init__(self, observation_space: gymnasium.Space, features: Features) -> None:
        super().__init__(observation_space, len(features.offset))
        for name, array in features._asdict().items():
            self.register_buffer(name, torch.from_numpy(array))

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Compute features (n, features) of observations (n, entries)."""
        seen = observations.double()
        values = torch.clamp(seen @ self.matrix.T + self.offset, -LIMIT, LIMIT)
        return (values * torch.clamp(seen @ self.gate_matrix.T + self.gate_offset, 0.0, 1.0)).float()
