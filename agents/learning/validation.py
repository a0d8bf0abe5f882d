"""Validation of a training on fixed episodes, by which the best policy is chosen."""

import io
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
from solar_env.support.files import write_bytes


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
        every: Steps of an environment between two validations.
        episodes: Of a validation.
        config: Of the run.
    """

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
        # Write to memory first: `np.savez` is not atomic.
        table: Any = io.BytesIO()
        self.log_path = table
        goes_on = super()._on_step()
        if table.getvalue():
            write_bytes(self._log, table.getvalue())
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
