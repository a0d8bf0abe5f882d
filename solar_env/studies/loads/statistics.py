"""Figures of an ensemble: mean with its interval, a high quantile, the model's error, in as many digits as they have.

The high quantile is that of a lognormal distribution, as is usual for shock loads (NASA-HDBK-7005, "Dynamic
environmental criteria", 2001, section 6), with its one-sided upper tolerance bound by the noncentral t distribution.
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
    """A quantity over an ensemble; nan for what the runs do not tell.

    Attributes:
        mean, low, high: with the 95 % interval of the mean.
        quantile: 99 % of runs stay below.
        quantile_bound: upper bound of that, with 95 % confidence.
        model_error: mean of the next finer level minus this one, over the same members.
        model_low, model_high: 95 % interval of that.
        runs: of the level.
    """

    mean: float
    low: float
    high: float
    quantile: float
    quantile_bound: float
    model_error: float
    model_low: float
    model_high: float
    runs: int

    @property
    def half_width(self) -> float:
        """Half of the mean's interval; nan without one."""
        return 0.5 * (self.high - self.low)

    @property
    def model_half_width(self) -> float:
        """Half of the model error's interval; nan without one."""
        return 0.5 * (self.model_high - self.model_low)


def figure_of(level: Array, finer: Array) -> Figure:
    """The figure of a quantity.

    Args:
        level: (n,) values of the members.
        finer: (n,) values of the same members at the next finer level; may be empty. Members with nan do not count.
    """
    nan = math.nan
    paired = finer - level if len(finer) == len(level) else np.zeros(0)
    values, paired = level[np.isfinite(level)], paired[np.isfinite(paired)]
    if len(values) == 0:
        return Figure(nan, nan, nan, nan, nan, nan, nan, nan, 0)
    mean, low, high = mean_band(values)
    if len(values) < FEWEST:
        low = high = nan
    quantile, bound = high_quantile(values)
    error, error_low, error_high = mean_band(paired)
    if len(paired) < FEWEST:
        error_low = error_high = nan
    return Figure(mean, low, high, quantile, bound, error, error_low, error_high, len(values))


def high_quantile(values: Array) -> tuple[float, float]:
    """The 99 % quantile of a lognormal distribution of (n,) values, and its upper bound with 95 % confidence.

    nan for both if there are fewer than FEWEST values, or one is not positive.
    """
    count = len(values)
    if count < FEWEST or values.min() <= 0.0:
        return math.nan, math.nan
    logarithms = np.log(values)
    mean, deviation = float(logarithms.mean()), float(logarithms.std(ddof=1))
    z = float(stats.norm.ppf(QUANTILE))
    factor = float(stats.nct.ppf(CONFIDENCE, count - 1, z * math.sqrt(count))) / math.sqrt(count)
    return math.exp(mean + z * deviation), math.exp(mean + factor * deviation)


def rounded(value: float, uncertainty: float) -> str:
    """A value with the digits that an uncertainty leaves it: the last one shown is the first that is uncertain.

    One more where the uncertainty begins with a 1. Two digits where no uncertainty is known.
    """
    if not math.isfinite(value):
        return "-"
    if not math.isfinite(uncertainty) or uncertainty < 0.0:
        return shortened(value)
    if uncertainty == 0.0:
        return f"{value:.6g}"
    exponent = math.floor(math.log10(uncertainty))
    if uncertainty / 10.0**exponent < 2.0:
        exponent -= 1
    shown = round(value, -exponent)
    if exponent > 6 or abs(shown) >= 1e6 or 0.0 < abs(shown) < 1e-4:
        leading = math.floor(math.log10(abs(shown))) if shown else exponent
        return f"{shown:.{max(leading - exponent, 0)}e}"
    return f"{shown:.{max(-exponent, 0)}f}"


def shortened(value: float, digits: int = 2) -> str:
    """A figure with few digits and no more zeros than needed."""
    if not math.isfinite(value):
        return "-" if math.isnan(value) else "infinitely many"
    if value == 0.0:
        return "0"
    shown = float(f"{value:.{digits}g}")
    places = max(digits - 1 - math.floor(math.log10(abs(shown))), 0)
    return f"{shown:.{places}f}" if 1e-3 <= abs(shown) < 1e5 else f"{shown:.{digits - 1}e}"


def counted(number: float) -> str:
    """A great number in words and two digits, as in "17 million"."""
    if not 1e4 <= number < 1e15:
        return shortened(number)
    shown = float(f"{number:.2g}")
    size, word = next(((size, word) for size, word in _SIZES if shown >= size), (1.0, ""))
    return f"{shown / size:,.3g} {word}" if word else f"{shown:,.0f}"


_SIZES = ((1e12, "trillion"), (1e9, "billion"), (1e6, "million"))
