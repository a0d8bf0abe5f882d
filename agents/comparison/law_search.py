"""Search for a torque law's parameters by CMA-ES on the environment's return."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from agents.comparison.evaluation import run_cells
from agents.environments import Keywords, episode_seeds
from agents.learning import runs
from agents.torque_laws import LawParameters
from solar_env.support.minimisation import minimise


@dataclass(frozen=True)
class LawSearch:
    """Search for a torque law's parameters: a budget of `points` candidates, each judged by `episodes` episodes.

    Every generation has new training episodes. Validation episodes compare start, best candidate and final mean.
    """

    law: str
    env_id: str
    env_kwargs: Keywords
    points: int
    episodes: int
    validation_episodes: int
    seed: int
    workers: int
    progress: bool

    def run(self, start: LawParameters, spread: float = 0.25) -> tuple[list[LawParameters], list[float], int]:
        """Search from `start`, with a first standard deviation `spread`, relative to each parameter's range.

        Return the candidates (start, best, final mean), their validation returns, and the number of training episodes.
        """
        validation = episode_seeds("validation", self.seed, self.validation_episodes)
        generations = simulated = 0

        def at(points: Sequence[np.ndarray]) -> list[LawParameters]:
            return [start.from_unit(np.clip(point, 0.0, 1.0)) for point in points]

        def costs(points: Sequence[np.ndarray]) -> list[float]:
            nonlocal generations, simulated
            generations += 1
            simulated += len(points) * self.episodes
            seeds = episode_seeds("training", self.seed, generations * self.episodes)[-self.episodes :]
            return [-value for value in self._returns(at(points), seeds)]

        candidates = at(minimise(costs, start.to_unit(), self.points, self.seed, self.progress, spread))
        return candidates, self._returns(candidates, validation), simulated

    def _returns(self, candidates: Sequence[LawParameters], seeds: Sequence[int]) -> list[float]:
        """Return each candidate's mean return over the episodes with these seeds; it is -inf if an episode fails."""
        shared = {"spec": self.law, "env_id": self.env_id, "env_kwargs": runs.jsonable(self.env_kwargs)}
        cells = [{**shared, "parameters": asdict(each), "seed": seed} for each in candidates for seed in seeds]
        returns = [figures.get("return", -math.inf) for figures in run_cells(cells, self.workers, progress=False)]
        return np.reshape(returns, (len(candidates), len(seeds))).mean(axis=1).tolist()
