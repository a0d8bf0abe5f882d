"""Errors of a level's answers against the reference's, with bootstrap bands.

Means of ensembles are compared, member by member: the same member is perturbed alike at all levels, and what the level
does not change cancels. The bands are those of B. Efron, Ann. Statist. 7 (1979) 1, over the members, widened for small
ensembles as T. C. Hesterberg, Am. Stat. 69 (2015) 371, doi:10.1080/00031305.2015.1089789, has it.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from solar_env.studies.common.bootstrap import resampled_means

Array = NDArray[np.float64]

_COVERAGE = 0.95


def mean_error(level: Array, reference: Array, scale: Array) -> tuple[float, float]:
    """Greatest distance between the means of two ensembles, and the half-width of its simultaneous 95 % band.

    Args:
        level, reference: (n, k, d) answers of the same n members: k quantities, each a vector of d components.
        scale: (k,) what distances are taken relative to.

    Returns:
        The error, and what sampling may add to it: with 95 % probability no quantity's true distance exceeds their sum.
    """
    differences = level - reference
    mean = differences.mean(axis=0)
    deviations = _widening(len(level)) * (resampled_means(differences) - mean)
    error, scattered = (np.linalg.norm(vectors, axis=-1) / scale for vectors in (mean, deviations))
    return float(error.max()), float(np.quantile(scattered.max(axis=-1), _COVERAGE))


def _widening(count: int) -> float:
    """Student's quantile over the normal one, times sqrt(n / (n - 1)); a single member has no band to widen."""
    if count == 1:
        return 1.0
    share = 0.5 * (1.0 + _COVERAGE)
    return float(stats.t.ppf(share, count - 1) / stats.norm.ppf(share)) * math.sqrt(count / (count - 1))


def ranking_error(level: Array, reference: Array) -> tuple[float, float]:
    """Share of discordant pairs of controllers (M. G. Kendall, Biometrika 30 (1938) 81), and its 95 % half-width.

    Both tables are (n, controllers, measures) of the same members; the controllers are ranked by each measure for
    itself. A pair that a level cannot tell apart counts half.
    """
    share = float(discordant_share(level.mean(axis=0), reference.mean(axis=0)))
    resampled = discordant_share(resampled_means(level), resampled_means(reference))
    return share, float(np.quantile(np.abs(resampled - share), _COVERAGE))


def discordant_share(level: Array, reference: Array) -> Array:
    """(...) shares of the pairs that two (..., controllers, measures) tables of means rank differently."""
    first, second = np.triu_indices(reference.shape[-2], k=1)
    signs = [np.sign(table[..., first, :] - table[..., second, :]) for table in (level, reference)]
    return np.asarray((1.0 - signs[0] * signs[1]).mean(axis=(-2, -1)) / 2.0)
