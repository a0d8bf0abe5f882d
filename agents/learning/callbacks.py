"""Callbacks of a training run: physical figures in the log, validation on fixed episodes, checkpoints."""

import time
from collections import defaultdict
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from stable_baselines3.common.callbacks import BaseCallback, EvalCallback
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from agents import runs
from agents.rollout import episode_figures

LOGGED = (
    "latched",
    "latch_times_s",
    "peak_postlock_force_N",
    "postlock_impulse_Ns",
    "postlock_sliding_work_J",
    "wear_depth_max_m",
    "motor_work_J",
)


class DeploymentLogger(BaseCallback):
    """Logs reward terms and physical figures of finished training episodes, as means between log lines."""

    def _on_training_start(self) -> None:
        self._terms: list[defaultdict[str, float]] = [defaultdict(float) for _ in range(self.training_env.num_envs)]

    def _on_step(self) -> bool:
        for terms, info, done in zip(self._terms, self.locals["infos"], self.locals["dones"], strict=True):
            for name, value in info["reward_terms"].items():
                terms[name] += value
            if done:
                self._log_episode(info, terms)
                terms.clear()
        return True

    def _log_episode(self, info: Mapping[str, Any], terms: Mapping[str, float]) -> None:
        figures = episode_figures(info["deployment"], terms)
        self.logger.record_mean("episode/return", figures["return"])
        for name in terms:
            self.logger.record_mean(f"episode/reward_{name}", figures[f"reward_{name}"])
        for name in LOGGED:
            if name in figures and np.isfinite(figures[name]):
                self.logger.record_mean(f"deployment/{name}", float(figures[name]))


class Call(BaseCallback):
    """Calls a function with the model at every step, or on the events of another callback."""

    def __init__(self, function: Callable[[Any], object]) -> None:
        super().__init__()
        self._function = function

    def _on_step(self) -> bool:
        self._function(self.model)
        return True


def save_checkpoint(folder: Path, model: Any) -> None:
    """Save the model, the reward normalisation and, for off-policy algorithms, the replay buffer."""
    checkpoint = folder / runs.CHECKPOINT
    checkpoint.mkdir(exist_ok=True)
    model.save(checkpoint / "model.zip")
    model.get_vec_normalize_env().save(str(checkpoint / "vecnormalize.pkl"))
    if isinstance(model, OffPolicyAlgorithm):
        model.save_replay_buffer(checkpoint / "replay_buffer.pkl")


class Validation(EvalCallback):
    """Stable-Baselines3's `EvalCallback` that begins with the untrained policy, or where an earlier run ended.

    The policy kept of an agent that adds to a law is thereby never worse, in validation, than the law.

    Attributes:
        wall_time: Wall time of all validations so far [s].
    """

    wall_time = 0.0

    def _on_training_start(self) -> None:
        if not self.evaluations_timesteps:
            self._on_step()

    def _on_step(self) -> bool:
        start = time.perf_counter()
        goes_on = super()._on_step()
        self.wall_time += time.perf_counter() - start
        return goes_on

    def restore(self, log: Path) -> None:
        """Continue the history in `log`, an `evaluations.npz`, and its best mean return."""
        with np.load(log) as history:
            self.evaluations_timesteps = history["timesteps"].tolist()
            self.evaluations_results = history["results"].tolist()
            self.evaluations_length = history["ep_lengths"].tolist()
        self.best_mean_reward = max(float(np.mean(returns)) for returns in self.evaluations_results)
