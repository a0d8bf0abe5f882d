"""Minimisation over the unit cube by CMA-ES."""

from collections.abc import Callable, Sequence

import cma
import numpy as np
from rich.console import Console

from solar_env.support.progress import counting_bar


def minimise(
    objective: Callable[[Sequence[np.ndarray]], Sequence[float]],
    start: np.ndarray,
    points: int,
    seed: int,
    progress: bool = True,
    spread: float = 0.25,
) -> list[np.ndarray]:
    """Minimise a noisy objective over the unit cube by CMA-ES (N. Hansen, 2016, arXiv:1604.00772).

    `objective` maps a generation of points to costs, at most `points` points in all. `progress` shows a progress bar;
    `spread` is the first generation's standard deviation in each direction. Return the start, the best point seen, and
    the final mean of the search. If `points` is less than one generation, a ValueError is raised.
    """
    # By default pycma draws from NumPy's global generator, which a training run during the search reseeds.
    normal = np.random.RandomState(seed + 1).randn
    options = {"bounds": [0, 1], "seed": np.nan, "randn": normal, "verbose": -9}
    search = cma.CMAEvolutionStrategy(start, spread, options)
    generations = points // search.popsize
    if generations < 1:
        raise ValueError(f"a budget of {points} points holds no generation; give at least {search.popsize}")
    with counting_bar(Console(stderr=True, quiet=not progress)) as bar:
        task = bar.add_task("points", total=generations * search.popsize)
        for _ in range(generations):
            asked = search.ask()
            costs = list(objective(asked))
            search.tell(asked, costs)
            bar.update(task, advance=len(asked), description=f"points, best of the last {min(costs):.4g}")
    return [np.asarray(start), search.result.xbest, search.result.xfavorite]
