"""Interquartile means, probabilities of improvement, and bootstrap intervals over episodes and training runs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats


@dataclass(frozen=True)
class Estimate:
    """A mean with its 95 % confidence interval (`lower`, `upper`), and the extremes and the size of the sample."""

    mean: float
    lower: float
    upper: float
    minimum: float
    maximum: float
    count: int


def interquartile_mean(values: np.ndarray) -> np.ndarray:
    """Return the mean of the middle half of `values` along the last axis."""
    return stats.trim_mean(values, 0.25, axis=-1)


def estimate(
    runs: Sequence[np.ndarray],
    resamples: int = 2000,
    mean: Callable[[np.ndarray], np.ndarray] = interquartile_mean,
) -> Estimate:
    """Return mean (by default interquartile) and 95 % bootstrap interval, an `Estimate`, over all episodes of all runs.

    Every run has the same episodes. A resample picks runs and, independently, episodes, both with replacement, and
    takes these episodes of these runs (A. B. Owen, The pigeonhole bootstrap, Ann. Appl. Stat. 1 (2007) 386-411,
    doi:10.1214/07-AOAS122). The interval therefore covers the variation between training runs, if there are several,
    and the variation between episodes, even if common to all runs. With few runs, bootstrap intervals are too narrow:
    for two equally good algorithms with five runs each, only nine tenths of the intervals of their difference contain
    zero. NaN values are left out; without other values the estimate is NaN.

    Args:
        runs: One array (episodes,) of values for each training run; a baseline has one run. In comparisons with
            another controller the arrays are (references, episodes): values relative to each run of that controller,
            called a reference. References are resampled, too.
        resamples: Number of bootstrap resamples.
        mean: Function that reduces the last axis.

    Raises:
        ValueError: The runs have different numbers of episodes.
    """
    figures = np.stack([np.atleast_2d(np.asarray(run, dtype=float)) for run in runs])
    known = figures[np.isfinite(figures)]
    if not known.size:
        nan = float("nan")
        return Estimate(nan, nan, nan, nan, nan, count=0)
    if len(figures) == figures.shape[1] == 1:
        figures = known[None, None]

    rng = np.random.default_rng(0)
    count, references, episodes = figures.shape
    drawn_runs = rng.integers(count, size=(resamples, count, 1, 1))
    drawn_episodes = rng.integers(episodes, size=(resamples, 1, 1, episodes))
    drawn_references = rng.integers(references, size=(resamples, 1, references, 1))
    sample = figures[drawn_runs, drawn_references, drawn_episodes].reshape(resamples, -1)
    if np.isfinite(figures).all():
        means = mean(sample)
    else:
        means = np.array([mean(row[np.isfinite(row)]) for row in sample if np.isfinite(row).any()])
    lower, upper = np.quantile(means, [0.025, 0.975])
    return Estimate(
        mean=float(mean(known)),
        lower=float(lower),
        upper=float(upper),
        minimum=float(known.min()),
        maximum=float(known.max()),
        count=known.size,
    )


def difference(runs: Sequence[np.ndarray], references: Sequence[np.ndarray]) -> Estimate:
    """Estimate the interquartile mean of run minus reference run on the same episodes, over all pairs of such runs.

    Runs and references are arrays of values (episodes,) on the same episodes. The `Estimate` has a 95 % interval.
    """
    return estimate([mine - np.stack(references) for mine in runs])


def improvement(runs: Sequence[np.ndarray], references: Sequence[np.ndarray]) -> Estimate:
    """Estimate the probability, with 95 % interval, that a run beats a reference on the same episode; a tie is half.

    This is the paired form of the measure of R. Agarwal et al. (Deep Reinforcement Learning at the Edge of the
    Statistical Precipice, 2021, doi:10.48550/arXiv.2108.13264). Runs and references are arrays of returns (episodes,).
    """
    better = [0.5 * (1.0 + np.sign(mine - np.stack(references))) for mine in runs]
    return estimate(better, mean=lambda values: np.mean(values, axis=-1))
