"""Search over the weights of a policy by the returns of whole episodes: CMA-ES with the interface of Stable-Baselines3.

Returns of whole episodes rank the candidates; no gradient must bridge the delay between actions and latching.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cma
import numpy as np
import torch
from sb3_contrib import ARS
from sb3_contrib.common.vec_env.async_eval import AsyncEval
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv

from agents.policies.saved_models import read_model

BETWEEN, FINALISTS = 10, 2  # generations between judging rounds, and candidates that are judged beside the mean
ACTIVATIONS = {"relu": torch.nn.ReLU, "tanh": torch.nn.Tanh}


class CMAES(ARS):
    """CMA-ES over policy weights (N. Hansen, 2016, arXiv:1604.00772), with the best candidate so far as the policy.

    The policy is a hyperbolic tangent of a linear function, or the policy of `start`, of which only the last layer is
    searched. The mean of the distribution wanders over a rough landscape, and a single episode may flatter a candidate.
    Every few generations the mean and the best candidates since the last round are therefore judged: each runs an
    episode in every environment, the same episodes in all rounds. The best of all judged candidates is the policy.

    Args:
        policy, env: See `stable_baselines3.common.base_class.BaseAlgorithm`. Candidates are compared on the same
            episodes; the number of episodes is the number of environments divided by `population`, at least one.
        population: Candidates of a generation.
        deviation: Standard deviation of every weight in the first generation; by default 0.3, or 0.05 with `start`.
        start: Model of Stable-Baselines3 (.zip) to begin with.
        policy_kwargs: Keywords of the policy.
        keywords: See `sb3_contrib.ARS`.

    Raises:
        FileNotFoundError, ValueError: The model `start` does not exist, or does not fit this environment.
    """

    env: Any  # None in the base class before an environment is set

    def __init__(
        self,
        policy: str,
        env: VecEnv,
        population: int = 16,
        deviation: float | None = None,
        start: str | None = None,
        policy_kwargs: dict[str, Any] | None = None,
        **keywords: Any,
    ) -> None:
        self.population, self.deviation = population, deviation or (0.05 if start else 0.3)
        self._start = read_model(Path(start)) if start else None
        of_policy: dict[str, Any] = {"net_arch": []}
        if self._start:
            of_policy["net_arch"] = [layer.biases.size for layer in self._start.layers[:-1]]
            of_policy["activation_fn"] = ACTIVATIONS[self._start.activation]
            of_policy["squash_output"] = self._start.output == "tanh"
        super().__init__(policy, env, policy_kwargs={**of_policy, **(policy_kwargs or {})}, **keywords)

    def _setup_model(self) -> None:
        super()._setup_model()
        self.searched = self.n_params
        if self._start:
            begin = np.concatenate([part.ravel() for layer in self._start.layers for part in layer])
            if begin.size != self.n_params:
                raise ValueError(f"start has {begin.size} weights, a policy of this environment {self.n_params}")
            self.policy.load_from_vector(begin)
            self.searched = sum(part.size for part in self._start.layers[-1])
        self.search: Any = None  # the search begins later, at the weights that the policy then has
        self.seen: list[tuple[float, np.ndarray]] = []
        self.best_return = -math.inf

    def _excluded_save_params(self) -> list[str]:
        return [*super()._excluded_save_params(), "search", "seen", "_start"]

    def _begin(self) -> None:
        """Begin a search around the weights of the policy."""
        self.weights: Any = torch.nn.utils.parameters_to_vector(self.policy.parameters()).detach()
        # By default pycma draws from NumPy's global generator.
        options: dict[str, object] = {"popsize": self.population, "seed": np.nan, "verbose": -9}
        options["randn"] = np.random.RandomState(self.seed).randn
        mean = self.weights.numpy()[-self.searched :].astype(float)
        self.search = cma.CMAEvolutionStrategy(mean, self.deviation, options)

    def _do_one_update(self, callback: BaseCallback, async_eval: AsyncEval | None) -> None:
        callback.on_rollout_start()
        if self.search is None:
            self._begin()
        asked, env = self.search.ask(), self.env
        episodes = max(env.num_envs // self.population, 1)  # episodes of each candidate, the same for all
        first = (self.seed or 0) + env.num_envs + self._n_updates * episodes
        tries = [(searched, first + episode) for searched in asked for episode in range(episodes)]
        returns = self._returns(tries, callback).reshape(-1, episodes).mean(axis=1)
        self.search.tell(asked, (-returns).tolist())
        self.seen += zip(returns.tolist(), asked, strict=True)
        self._n_updates += 1
        if self._n_updates % BETWEEN == 0 or self.num_timesteps >= self._total_timesteps:
            best = sorted(self.seen, key=lambda pair: -pair[0])[:FINALISTS]
            for searched in (self.search.mean, *(searched for _, searched in best)):
                self._judge(searched, callback)
            self.seen.clear()
        self.logger.record("train/deviation", self.search.sigma)
        callback.on_rollout_end()

    def _judge(self, searched: np.ndarray, callback: BaseCallback) -> None:
        """Run an episode with weights `searched` in every environment, and compare the mean return with `best_return`.

        A higher mean return becomes `best_return`, and the policy gets the weights.
        """
        first = self.seed or 0
        tries = [(searched, first + episode) for episode in range(self.env.num_envs)]
        mean_return = float(self._returns(tries, callback).mean())
        if mean_return > self.best_return:
            self.best_return = mean_return
            self.weights = torch.as_tensor(self._whole(searched))
            self.policy.load_from_vector(self.weights.numpy())

    def _whole(self, searched: np.ndarray) -> np.ndarray:
        """Return the policy's weights (n_params,), with the last ones replaced by a candidate's weights `searched`."""
        return np.concatenate([self.weights.numpy()[: -self.searched], searched]).astype(np.float32)

    def _returns(self, tries: Sequence[tuple[np.ndarray, int]], callback: BaseCallback) -> np.ndarray:
        """Run an episode of each pair (candidate, seed) in the environments; return the episodes' returns (tries,)."""
        count = self.env.num_envs
        parts = [tries[first : first + count] for first in range(0, len(tries), count)]
        return np.concatenate([self._round(part, callback) for part in parts])

    def _round(self, tries: Sequence[tuple[np.ndarray, int]], callback: BaseCallback) -> np.ndarray:
        env = self.env
        returns, running = np.zeros(env.num_envs), np.arange(env.num_envs) < len(tries)
        # Stable-Baselines3 has no method that seeds environments one by one.
        env.unwrapped._seeds = [seed for _, seed in tries] + [0] * (env.num_envs - len(tries))
        observations = env.reset()
        while running.any():
            actions = np.zeros((env.num_envs, *env.action_space.shape), dtype=np.float32)
            for lane in np.flatnonzero(running).tolist():
                self.policy.load_from_vector(self._whole(tries[lane][0]))
                actions[lane] = self.policy.predict(observations[lane], deterministic=True)[0]
            observations, rewards, dones, _ = env.step(actions)
            returns += np.where(running, rewards, 0.0)
            self.num_timesteps += int(running.sum())
            self.policy.load_from_vector(self.weights.numpy())  # weights that callbacks validate and save
            callback.on_step()
            running &= ~dones
        return returns[: len(tries)]
