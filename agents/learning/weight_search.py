"""Search over the weights of a linear policy by whole episodes: CMA-ES, and ARS with a candidate in every lane.

Noise on the weights tries one behaviour for a whole deployment. Candidates are compared by the returns of their
episodes alone, so that neither the flat cost of missed deadlines nor the delay between a landing and its cost stands in
the way of a gradient.
"""

import math
from collections.abc import Sequence
from typing import Any

import cma
import numpy as np
import torch
from sb3_contrib import ARS
from sb3_contrib.common.vec_env.async_eval import AsyncEval
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv

Progress = dict[str, Any]


def all_weights(first: float | Sequence[float], entries: int) -> np.ndarray:
    """The weights (entries,) that a linear policy begins with: the first ones as given, the others zero."""
    given = np.atleast_1d(np.asarray(first, dtype=float))
    return np.pad(given, (0, entries - given.size))


class WeightSearch(ARS):
    """ARS of sb3-contrib that evaluates as many candidates at once as there are environments.

    The policy is linear without a bias, `clip(weights observation, -1, 1)`. It begins with weights of the first entries
    of the observation: the first two of "landing" are the shares of the way there and of the landing.

    Args:
        first_weights: Weights of the first entries at the beginning, one or more, all others being zero.
        keywords: See `sb3_contrib.ARS`.

    Raises:
        ValueError: on construction, if there are more weights than entries.
    """

    def __init__(self, policy: str, env: VecEnv, first_weights: float | Sequence[float] = 0.0, **keywords: Any) -> None:
        self.first_weights = first_weights
        super().__init__(policy, env, **keywords)

    def _setup_model(self) -> None:
        super()._setup_model()
        self._use(all_weights(self.first_weights, self.n_params))

    def _use(self, weights: np.ndarray) -> None:
        """Let the policy have the weights (entries,)."""
        vector = np.asarray(weights, dtype=np.float32)
        self.weights: Any = torch.from_numpy(vector)
        self.policy.load_from_vector(vector)

    def set_parameters(self, *args: Any, **kwargs: Any) -> None:
        """Load parameters, see `BaseAlgorithm`; the search goes on from the policy's weights."""
        super().set_parameters(*args, **kwargs)
        self.weights = torch.nn.utils.parameters_to_vector(self.policy.parameters()).detach().clone()

    def _do_one_update(self, callback: BaseCallback, async_eval: AsyncEval | None) -> None:
        callback.on_rollout_start()  # before anything is drawn: checkpoints are written here
        # ARS itself counts the steps that are left of a training that goes on as if they were all.
        self._update_current_progress_remaining(self.num_timesteps, self._total_timesteps)
        super()._do_one_update(callback, async_eval)
        callback.on_rollout_end()

    def evaluate_candidates(
        self, candidate_weights: torch.Tensor, callback: BaseCallback, async_eval: AsyncEval | None
    ) -> torch.Tensor:
        """Run an episode of every candidate (candidates, entries); returns their returns (candidates,)."""
        weights = candidate_weights.numpy()
        env: Any = self.env
        parts = (weights[first : first + env.num_envs] for first in range(0, len(weights), env.num_envs))
        returns = np.concatenate([self._returns(part, callback) for part in parts])
        return torch.as_tensor(returns, dtype=torch.float32)

    def _returns(self, weights: np.ndarray, callback: BaseCallback) -> np.ndarray:
        """Returns (k,) of candidates (k, entries) that fit into the environments."""
        env: Any = self.env
        returns, running = np.zeros(len(weights)), np.ones(len(weights), dtype=bool)
        observations = env.reset()
        while running.any():
            # Lanes without a candidate are kept folded, and cost as much time as the others.
            actions = np.full((env.num_envs, 1), -1.0, dtype=np.float32)
            linear = np.einsum("ij,ij->i", observations[: len(weights)], weights)
            actions[: len(weights), 0] = np.where(running, np.clip(linear, -1.0, 1.0), -1.0)
            observations, rewards, dones, _ = env.step(actions)
            returns += np.where(running, rewards[: len(weights)], 0.0)
            self.num_timesteps += int(running.sum())
            callback.on_step()
            running &= ~dones[: len(weights)]
        return returns


class CMAES(WeightSearch):
    """CMA-ES over the weights (N. Hansen, 2016, arXiv:1604.00772), whose policy is the best candidate so far.

    The mean of the distribution wanders over a rough landscape, and a single episode flatters. Every few generations
    the best candidates since the last time and the mean therefore have a round each, an episode in every environment,
    the same ones every time, and the policy is the best of all that have had one. The last generation is followed by
    rounds too, which are beyond the steps asked for. As many environments as candidates waste no time.

    Args:
        population: Candidates of a generation.
        deviation: Standard deviation of every weight in the first generation.
        generations_between: Generations from one round to the next.
        finalists: Candidates that have a round beside the mean.
        keywords: See `WeightSearch`.
    """

    def __init__(
        self,
        policy: str,
        env: VecEnv,
        population: int = 16,
        deviation: float = 0.1,
        generations_between: int = 22,
        finalists: int = 2,
        **keywords: Any,
    ) -> None:
        self.population, self.deviation = population, deviation
        self.generations_between, self.finalists = generations_between, finalists
        super().__init__(policy, env, **keywords)

    def _setup_model(self) -> None:
        super()._setup_model()
        # Left to itself pycma draws from NumPy's global generator.
        options: dict[str, object] = {"popsize": self.population, "seed": np.nan, "verbose": -9}
        options["randn"] = np.random.RandomState(self.seed).randn
        self.search: Any = cma.CMAEvolutionStrategy(self.weights.numpy().astype(float), self.deviation, options)
        self.told: list[np.ndarray] = []
        self.seen: list[tuple[float, np.ndarray]] = []
        self.best_return: float = -math.inf
        self.rounds = 0

    @property
    def progress(self) -> Progress:
        """All that the search goes on from but the policy's weights.

        A fresh search that is told the same returns once more comes to the same distribution, and so to the same bits.
        """
        told = np.array(self.told).reshape(-1, self.population)
        return {"told": told, "since": len(self.seen), "best_return": self.best_return, "rounds": self.rounds}

    @progress.setter
    def progress(self, progress: Progress) -> None:
        for returns in progress["told"]:
            self._tell(self.search.ask(), returns)
        self.seen = self.seen[len(self.seen) - progress["since"] :]
        self.best_return, self.rounds = progress["best_return"], progress["rounds"]

    def _tell(self, asked: Sequence[np.ndarray], returns: np.ndarray) -> None:
        self.search.tell(asked, (-returns).tolist())
        self.told.append(returns)
        self.seen += zip(returns.tolist(), asked, strict=True)

    def _do_one_update(self, callback: BaseCallback, async_eval: AsyncEval | None) -> None:
        callback.on_rollout_start()
        asked = self.search.ask()
        self._tell(asked, self._evaluated(asked, callback))
        self._n_updates += 1
        is_last = self.num_timesteps >= self._total_timesteps
        if self._n_updates % self.generations_between == 0 or is_last:
            best = sorted(self.seen, key=lambda pair: -pair[0])[: self.finalists]
            for weights in (self.search.mean, *(weights for _, weights in best)):
                self._judge(weights, callback)
            self.seen.clear()
            self.rounds += 1
            env: Any = self.env
            env.seed((self.seed or 0) + (1 + self.rounds) * env.num_envs)
        self.logger.record("train/deviation", self.search.sigma)
        callback.on_rollout_end()

    def _judge(self, weights: np.ndarray, callback: BaseCallback) -> None:
        """Let weights have a round; they become the policy's if none did better in theirs."""
        env: Any = self.env
        env.seed(self.seed or 0)
        mean_return = float(self._evaluated(np.tile(weights, (env.num_envs, 1)), callback).mean())
        if mean_return > self.best_return:
            self.best_return = mean_return
            self._use(weights)

    def _evaluated(self, candidates: Sequence[np.ndarray] | np.ndarray, callback: BaseCallback) -> np.ndarray:
        """Returns (candidates,) of an episode of each of the weights (candidates, entries)."""
        weights = torch.from_numpy(np.asarray(candidates, dtype=np.float32))
        return self.evaluate_candidates(weights, callback, None).numpy()
