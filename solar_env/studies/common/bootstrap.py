"""Confidence intervals of means, by bootstrap resampling (B. Efron, Ann. Statist. 7 (1979) 1)."""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEWEST = 4
"""Least number of values for which an interval is given."""

_RESAMPLES, _SEED = 2000, 0


def resampled_means(values: Array) -> Array:
    """Return the (resamples, ...) means of bootstrap resamples of (n, ...) values; drawn indices depend on n alone."""
    count = len(values)
    chosen = np.random.default_rng(_SEED).multinomial(count, np.full(count, 1.0 / count), size=_RESAMPLES)
    return np.asarray(np.tensordot(chosen / count, values, axes=1))


def mean_band(values: Array) -> tuple[float, float, float]:
    """Return the mean of (n,) values, and the low and high end of its 95 % percentile bootstrap interval.

    The same values give the same interval. All three results are nan if there are no values, or a value is nan.
    """
    if len(values) == 0 or np.isnan(values).any():
        return math.nan, math.nan, math.nan
    low, high = np.quantile(resampled_means(values), [0.025, 0.975])
    return float(values.mean()), float(low), float(high)
