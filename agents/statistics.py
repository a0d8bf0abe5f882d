"""Interquartile means, probabilities of improvement, and bootstrap intervals over episodes and training runs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats


@dataclass(frozen=True)
class Estimate:
    """A mean, its confidence interval, and the extremes of the sample."""

    mean: float
    lower: float
    upper: float
    minimum: float
    maximum: float
    count: int


def interquartile_mean(values: np.ndarray, axis: int = -1) -> np.ndarray:
    """Mean of the middle half of `values` along `axis`."""
    return stats.trim_mean(values, 0.25, axis=axis)


def estimate(
    runs: Sequence[np.ndarray],
    seed: int = 0,
    resamples: int = 2000,
    confidence: float = 0.95,
    mean: Callable[[np.ndarray], np.ndarray] = interquartile_mean,
) -> Estimate:
    """A mean over all episodes of all runs, by default the interquartile one, with a two-stage bootstrap interval.

    A resample draws runs with replacement, then, within every drawn run, episodes with replacement, as many
    as a run has on average (Davison and Hinkley, Bootstrap Methods and their Application, 1997, section 3.8).
    So the interval covers the variation between training runs where there are several, and that between
    episodes alone where there is one. NaN episodes are left out; without any other, the estimate is NaN.

    Args:
        runs: One array of episode figures for each training run; a baseline has one run.
        seed: Seed of the resampling.
        resamples: Number of bootstrap resamples.
        confidence: Coverage of the interval.
        mean: Reduces the last axis.
    """
    finite = [np.asarray(run, dtype=float)[np.isfinite(run)] for run in runs]
    finite = [run for run in finite if len(run)]
    if not finite:
        nan = float("nan")
        return Estimate(nan, nan, nan, nan, nan, count=0)
    pooled = np.concatenate(finite)
    lengths = np.array([len(run) for run in finite])
    starts = np.cumsum(lengths) - lengths
    per_run = round(len(pooled) / len(finite))

    rng = np.random.default_rng(seed)
    drawn = rng.integers(len(finite), size=(resamples, len(finite), 1))
    within = (rng.random((resamples, len(finite), per_run)) * lengths[drawn]).astype(int)
    sample = pooled[starts[drawn] + within].reshape(resamples, -1)
    lower, upper = np.quantile(mean(sample), [0.5 - confidence / 2, 0.5 + confidence / 2])
    return Estimate(
        mean=float(mean(pooled)),
        lower=float(lower),
        upper=float(upper),
        minimum=float(pooled.min()),
        maximum=float(pooled.max()),
        count=len(pooled),
    )


def improvement(runs: Sequence[np.ndarray], references: Sequence[np.ndarray]) -> Estimate:
    """Probability of doing better than a reference on the same episode, with its interval; a tie counts half.

    The paired form of what R. Agarwal et al. compare algorithms by (Deep Reinforcement Learning at the Edge of the
    Statistical Precipice, 2021, doi:10.48550/arXiv.2108.13264).

    Args:
        runs: Scores, higher being better; one array for each training run.
        references: Those of the reference on the same episodes.
    """
    better = [0.5 * (1.0 + np.sign(mine - other)) for mine, other in zip(runs, references, strict=True)]
    return estimate(better, mean=lambda values: np.mean(values, axis=-1))
