"""Errors of a level's answers against the reference's, with bootstrap bands. Plain NumPy.

Means of ensembles are compared; the bands are those of B. Efron, Ann. Statist. 7 (1979) 1, over the ensembles' members,
widened by the square root of n / (n - 1) for ensembles of n members.
"""

import math

import numpy as np
from numpy.typing import NDArray

from solar_env.studies.common.bootstrap import resampled_means

Array = NDArray[np.float64]

_COVERAGE = 0.95


def mean_error(level: Array, reference: Array, scale: Array) -> tuple[float, float]:
    """Greatest distance between the means of two ensembles, and the half-width of its simultaneous 95 % band.

    Args:
        level: (n, k, d) answers of n members: k quantities, each a vector of d components.
        reference: (m, k, d).
        scale: (k,) what distances are taken relative to.

    Returns:
        The error, and what sampling may add to it: with 95 % probability no quantity's true distance exceeds their sum.
    """
    difference = level.mean(axis=0) - reference.mean(axis=0)
    deviations = _deviations(level, 1) - _deviations(reference, 2)
    return float(_relative(difference, scale).max()), _quantile(_relative(deviations, scale).max(axis=-1))


def own_half_width(reference: Array, scale: Array) -> float:
    """Half-width of the simultaneous 95 % band of an ensemble's own mean; arguments as in `mean_error`."""
    return _quantile(_relative(_deviations(reference, 2), scale).max(axis=-1))


def ranking_error(level: Array, reference: Array) -> tuple[float, float]:
    """Share of discordant pairs of controllers (M. G. Kendall, Biometrika 30 (1938) 81), and its 95 % half-width.

    Args:
        level: (n, controllers, measures) by which the controllers are ranked, each measure for itself.
        reference: (m, controllers, measures).

    Returns:
        The share over all pairs and measures; a pair that a level cannot tell apart counts half.
    """
    share = float(discordant_share(level.mean(axis=0), reference.mean(axis=0)))
    resampled = discordant_share(resampled_means(level, 1), resampled_means(reference, 2))
    return share, _quantile(np.abs(resampled - share))


def own_ranking_half_width(reference: Array) -> float:
    """Share of discordant pairs that 95 % of the resampled rankings do not exceed against the ranking of the means."""
    return _quantile(discordant_share(resampled_means(reference, 2), reference.mean(axis=0)))


def discordant_share(level: Array, reference: Array) -> Array:
    """(...) shares of the pairs that two (..., controllers, measures) tables of means rank differently."""
    first, second = np.triu_indices(reference.shape[-2], k=1)
    signs = [np.sign(table[..., first, :] - table[..., second, :]) for table in (level, reference)]
    return np.asarray((1.0 - signs[0] * signs[1]).mean(axis=(-2, -1)) / 2.0)


def _relative(vectors: Array, scale: Array) -> Array:
    return np.asarray(np.sqrt((vectors**2).sum(axis=-1)) / scale)


def _deviations(values: Array, stream: int) -> Array:
    """(resamples, ...) deviations of resampled means of (n, ...) values from their mean; zero for a single one."""
    count = len(values)
    if count == 1:
        return np.zeros((1, *values.shape[1:]))
    return (resampled_means(values, stream) - values.mean(axis=0)) * math.sqrt(count / (count - 1))


def _quantile(values: Array) -> float:
    return float(np.quantile(values, _COVERAGE))
