"""Statistics of an ensemble: mean, high quantile and discretisation error; and rounding to the digits that are certain.

The high quantile is of a lognormal distribution, as is usual for shock loads (NASA-HDBK-7005, "Dynamic environmental
criteria", 2001, section 6), with its one-sided upper tolerance bound by the noncentral t distribution.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from solar_env.studies.common.bootstrap import FEWEST, mean_band

Array = NDArray[np.float64]

QUANTILE, CONFIDENCE = 0.99, 0.95


@dataclass(frozen=True)
class Figure:
    """Statistics of a quantity over an ensemble of runs: mean, 99 % quantile, and error of the model level.

    Mean and error have 95 % intervals, the quantile an upper bound. With fewer than four values the intervals, the
    quantile and its bound are nan. Quantile and bound are also nan if a value is not positive.
    """

    mean: float
    low: float  # 95 % interval of the mean
    high: float
    quantile: float  # value that 99 % of runs stay below
    quantile_bound: float  # upper bound of the quantile, with 95 % confidence
    model_error: float  # mean of the finest level minus the mean of this level, over the same members
    model_half_width: float  # half of the 95 % interval of the model error
    runs: int

    @property
    def half_width(self) -> float:
        """Half the width of the mean's 95 % interval; nan without an interval."""
        return 0.5 * (self.high - self.low)


def figure_of(level: Array, finer: Array) -> Figure:
    """Return the statistics of an ensemble's (n,) values: mean, 99 % quantile and discretisation error, as a `Figure`.

    `level` has the values at a model level, `finer` the same members' at a finer one; nan is left out. The mean of
    `finer` - `level` is the discretisation error. Means have 95 % intervals, the quantile a 95 % upper bound.
    """
    values, paired = (members[np.isfinite(members)] for members in (level, finer - level))
    error, low, high = _band(paired)
    return Figure(*_band(values), *high_quantile(values), error, 0.5 * (high - low), len(values))


def _band(values: Array) -> tuple[float, float, float]:
    mean, low, high = mean_band(values)
    return (mean, low, high) if len(values) >= FEWEST else (mean, math.nan, math.nan)


def high_quantile(values: Array) -> tuple[float, float]:
    """Return the 99 % quantile of (n,) lognormal values and its 95 % upper bound; nan if n < FEWEST or a value <= 0."""
    count = len(values)
    if count < FEWEST or values.min() <= 0.0:
        return math.nan, math.nan
    logarithms = np.log(values)
    mean, deviation = float(logarithms.mean()), float(logarithms.std(ddof=1))
    z = float(stats.norm.ppf(QUANTILE))
    factor = float(stats.nct.ppf(CONFIDENCE, count - 1, z * math.sqrt(count))) / math.sqrt(count)
    return math.exp(mean + z * deviation), math.exp(mean + factor * deviation)


def rounded(value: float, uncertainty: float) -> str:
    """Format a value with the digits that its uncertainty allows: the last digit shown is the first uncertain one.

    One more is shown if the uncertainty begins with a 1. At least one is shown, and two if the uncertainty is unknown.
    """
    if not (math.isfinite(value) and math.isfinite(uncertainty)) or value == 0.0:
        return shortened(value)
    if uncertainty == 0.0:
        return f"{value:.6g}"
    last = math.floor(math.log10(uncertainty))
    last -= uncertainty / 10.0**last < 2.0
    digits = math.floor(math.log10(abs(value))) - last + 1
    return shortened(value, max(digits, 1))


def shortened(value: float, digits: int = 2) -> str:
    """Format a number with `digits` significant digits; nan becomes "-", and infinity "infinitely many"."""
    if not math.isfinite(value):
        return "-" if math.isnan(value) else "infinitely many"
    if value == 0.0 or 1e-4 <= abs(value) < 1e6:
        return np.format_float_positional(value, digits, unique=False, fractional=False).rstrip(".")
    return f"{value:.{digits - 1}e}"


def counted(number: float) -> str:
    """Format a number with two significant digits, and from 10,000 on with commas, as in "17,000,000"."""
    return f"{float(f'{number:.2g}'):,.0f}" if 1e4 <= number < 1e15 else shortened(number)
