"""Sampling bands of means."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

_RESAMPLES, _SEED = 2000, 0


def mean_band(values: NDArray[np.float64]) -> tuple[float, float, float]:
    """Mean of (n,) values and its 95 % bootstrap interval (B. Efron, Ann. Statist. 7 (1979) 1): percentiles.

    The same values give the same band. nan for all three if there is no value or one is nan.
    """
    if len(values) == 0 or np.isnan(values).any():
        return math.nan, math.nan, math.nan
    chosen = np.random.default_rng(_SEED).integers(len(values), size=(_RESAMPLES, len(values)))
    low, high = np.quantile(values[chosen].mean(axis=1), [0.025, 0.975])
    return float(values.mean()), float(low), float(high)
