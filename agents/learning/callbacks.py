"""Callbacks of a training run: physical figures in the log, validation on fixed episodes, checkpoints."""

import io
import time
from collections import defaultdict
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from stable_baselines3.common.callbacks import BaseCallback, EvalCallback
from stable_baselines3.common.vec_env import VecEnv

from agents.learning import runs
from agents.learning.extraction import policy_of
from agents.learning.runs import Configuration
from agents.policies import shipped
from agents.rollout import episode_figures
from solar_env.support.files import write_bytes

LOGGED = (
    "latched",
    "latch_times_s",
    "peak_prelatch_force_N",
    "peak_postlock_force_N",
    "postlock_impulse_Ns",
    "sliding_work_J",
    "postlock_sliding_work_J",
    "wear_depth_max_m",
    "motor_work_J",
)


class DeploymentLogger(BaseCallback):
    """Logs reward terms and physical figures of finished training episodes, as means between log lines.

    Attributes:
        terms: By lane, sums of the reward's terms over the present episode.
    """

    def _on_training_start(self) -> None:
        self.terms: list[defaultdict[str, float]] = [defaultdict(float) for _ in range(self.training_env.num_envs)]

    def _on_step(self) -> bool:
        for terms, info, done in zip(self.terms, self.locals["infos"], self.locals["dones"], strict=True):
            for name, value in info["reward_terms"].items():
                terms[name] += value
            if done:
                # There are no figures of an episode that a failure has ended.
                if "deployment" in info:
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


class Validation(EvalCallback):
    """Stable-Baselines3's `EvalCallback` that begins with the untrained policy, or where an earlier run ended.

    It ends with the policy of the last step. The policy kept is never worse, in validation, than what training began
    with.

    Args:
        env: As for `EvalCallback`.
        folder: Of the run, for `evaluations.npz` and the best policy.
        every: Steps of all environments together between two validations.
        episodes: Of a validation.
        config: Of the run.

    Attributes:
        wall_time: Wall time of all validations so far [s].
    """

    wall_time = 0.0
    _COUNTERS = ("n_calls", "best_mean_reward", "last_mean_reward")
    _LISTS = ("evaluations_timesteps", "evaluations_results", "evaluations_length")

    def __init__(self, env: VecEnv, folder: Path, every: int, episodes: int, config: Configuration) -> None:
        keep = Call(lambda model: shipped.save(folder, policy_of(model, config)))
        super().__init__(env, keep, None, episodes, every, None, verbose=0)
        self._log = folder / runs.EVALUATIONS

    def _on_training_start(self) -> None:
        if not self.evaluations_timesteps:
            self._validate()

    def _on_training_end(self) -> None:
        if self.evaluations_timesteps[-1] != self.num_timesteps:
            self._validate()

    def _validate(self) -> None:
        """Validate now, whatever the number of calls."""
        calls, self.n_calls = self.n_calls, 0
        self._on_step()
        self.n_calls = calls

    def _on_step(self) -> bool:
        start = time.perf_counter()
        # Into memory first: NumPy's way to a file is not whole or not at all.
        table: Any = io.BytesIO()
        self.log_path = table
        goes_on = super()._on_step()
        if table.getvalue():
            write_bytes(self._log, table.getvalue())
        self.wall_time += time.perf_counter() - start
        return goes_on

    @property
    def history(self) -> dict[str, Any]:
        """Everything that later validations depend on; it can be set to go on from there."""
        counters = {name: getattr(self, name) for name in self._COUNTERS}
        return counters | {name: np.array(getattr(self, name)) for name in self._LISTS}

    @history.setter
    def history(self, history: Mapping[str, Any]) -> None:
        vars(self).update({name: history[name] for name in self._COUNTERS})
        vars(self).update({name: list(history[name]) for name in self._LISTS})
