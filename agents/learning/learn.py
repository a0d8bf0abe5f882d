"""Training through Stable-Baselines3: environments, model, callbacks, and what a run folder keeps of it."""

import io
import time
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from rich.console import Console
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback, CallbackList, EvalCallback
from stable_baselines3.common.logger import configure
from stable_baselines3.common.vec_env import VecEnv, VecMonitor, VecNormalize

from agents.environments import episode_seeds
from agents.learning import checkpoints, runs
from agents.learning.models import make_model, policy_of
from agents.learning.runs import Configuration
from agents.learning.vec_env import FixedSeeds, LogarithmicCharges, NativeVecEnv
from agents.policies import shipped
from solar_env.support.files import write_bytes
from solar_env.support.interruption import keeping
from solar_env.support.progress import counting_bar
from solar_env.support.versions import versions

VALIDATION_EPISODES = 24
VALIDATIONS, VALIDATIONS_OF_WEIGHTS = 5, 12
CHECKPOINT_INTERVAL = 2000  # environment steps; a rollout that is longer sets the distance
SHORTEST_VALIDATION_INTERVAL = 2000  # environment steps; a validation takes about as many itself
CHARGE_SCALE = 0.5  # above the cost of any soft landing; see `LogarithmicCharges`


def make_training_env(config: Configuration, monitor: Path | None = None, threads: int | None = None) -> VecEnv:
    """Make `n_envs` environments with `LogarithmicCharges`, on `threads` threads, by default one per processor.

    The CSV file `monitor` logs finished episodes, with their true returns.
    """
    lanes = NativeVecEnv(config.n_envs, config.env_id, {**config.env_kwargs, "num_threads": threads})
    return LogarithmicCharges(VecMonitor(lanes, str(monitor) if monitor else None), CHARGE_SCALE)


def make_validation_env(config: Configuration, threads: int | None = None) -> VecNormalize:
    """Make an environment for every validation episode, the same ones at every reset, with unnormalised rewards."""
    first = episode_seeds("validation", config.seed, VALIDATION_EPISODES)[0]
    lanes = NativeVecEnv(VALIDATION_EPISODES, config.env_id, {**config.env_kwargs, "num_threads": threads})
    return VecNormalize(VecMonitor(FixedSeeds(lanes, first)), training=False, norm_obs=False, norm_reward=False)


class Call(BaseCallback):
    """Calls a function with the model at every step, or on the events of another callback."""

    def __init__(self, function: Callable[[BaseAlgorithm], object]) -> None:
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
        console: Where every validation leaves a line.
    """

    _COUNTERS = ("n_calls", "best_mean_reward", "last_mean_reward")
    _LISTS = ("evaluations_timesteps", "evaluations_results", "evaluations_length")

    def __init__(
        self, env: VecEnv, folder: Path, every: int, episodes: int, config: Configuration, console: Console
    ) -> None:
        keep = Call(lambda model: shipped.write_policy(folder, policy_of(model, config)))
        super().__init__(env, keep, None, episodes, every, None, verbose=0)
        self._log, self._console = folder / runs.EVALUATIONS, console

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
            told = f"step {self.num_timesteps}: return {self.last_mean_reward:.4g} in validation"
            self._console.print(told, highlight=False)
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


@dataclass(frozen=True)
class Training:
    """A training to run."""

    config: Configuration
    folder: Path  # existing, without a run
    resume: str | Path | None = None  # folder of the run to go on from; may be the same
    command: str = ""  # command line to record
    progress: bool = True  # show a progress bar, and a line after every validation
    threads: int | None = None  # greatest number that steps environments; None: one per processor
    checkpoint_interval: int = CHECKPOINT_INTERVAL  # environment steps


def train(training: Training) -> None:
    """Train and fill the run folder with policy, checkpoints, configuration and logs.

    A run that was interrupted goes on to its end, and repeats one that was not, bit for bit, on the same versions:
    from its checkpoint, or from its beginning where it had none yet. One that is complete trains for as many
    steps as the configuration says once more.

    Raises:
        FileNotFoundError: There is no checkpoint to go on from.
        ValueError: The algorithm refuses its hyperparameters, the run has trained for more steps than are asked for, or
            no checkpoint can be read, see `checkpoints.read`.
        OSError: A file cannot be written; the checkpoints before are still there.
        KeyboardInterrupt: Ctrl-C; a note says what was kept.
    """
    folder, threads = training.folder, training.threads
    torch.set_num_threads(1)  # small networks: more threads only contend
    start = time.perf_counter()
    config, begun, left = _beginning(training)
    model = _model(config, begun, training)
    runs.write_json(folder / runs.CONFIG, asdict(config))
    model.set_logger(configure(str(folder / "tensorboard"), ["tensorboard"]))
    # The mean of a search wanders: more of them are looked at.
    validations = VALIDATIONS_OF_WEIGHTS if config.algo in runs.SEARCHES else VALIDATIONS
    interval = max(config.timesteps // validations, min(config.timesteps, SHORTEST_VALIDATION_INTERVAL))
    every = max(interval // config.n_envs, 1)
    console = Console(stderr=True, quiet=not training.progress)
    with closing(model.env), closing(model.logger), closing(make_validation_env(config, threads)) as validation_env:
        validation = Validation(validation_env, folder, every, VALIDATION_EPISODES, config, console)
        saving = checkpoints.Checkpoints(folder, training.checkpoint_interval, validation, begun)
        if begun:
            validation.history = begun["history"]
            for name, content in begun["policy"].items():
                write_bytes(folder / name, content)
        with keeping(saving.kept), counting_bar(console) as bar:
            task = bar.add_task("steps", total=config.timesteps, completed=config.timesteps - left)
            shown = Call(lambda model: bar.advance(task, model.n_envs))
            model.learn(left, CallbackList([validation, shown, saving]), reset_num_timesteps=not begun)
    runs.write_json(
        folder / runs.TIMING, {"timesteps": model.num_timesteps, "wall_time_s": time.perf_counter() - start}
    )


def _beginning(training: Training) -> tuple[Configuration, checkpoints.Checkpoint | None, int]:
    """Find what a run records of itself, the checkpoint that it goes on from, and the steps that are left."""
    asked, source = training.config.timesteps, _source(training.resume)
    config = replace(training.config, command=training.command, versions=versions(*runs.LIBRARIES))
    if source is None:
        return replace(config, resumed_from=None, timesteps_before=0), None, asked
    begun, stored = checkpoints.read(source), runs.read_config(source)
    before = begun["timesteps"] if runs.is_complete(source) else stored.timesteps_before
    left = before + asked - begun["timesteps"]
    # Rollouts are whole: a run that was interrupted as it ended may have more steps than were asked for.
    if left < 0 and asked < stored.timesteps:
        raise ValueError(
            f"timesteps is {asked}: {source} has trained for {begun['timesteps'] - before} steps; give more"
        )
    return replace(config, resumed_from=str(source), timesteps_before=before), begun, max(left, 0)


def _source(resume: str | Path | None) -> str | Path | None:
    """The run with the checkpoint that the run `resume` goes on from: itself, or the one that it was begun with.

    None is the beginning: it was interrupted before its first checkpoint.
    """
    if resume is None or has_checkpoint(Path(resume)) or runs.is_complete(resume):
        return resume
    return runs.read_config(resume).resumed_from


def has_checkpoint(folder: Path) -> bool:
    """Return whether the run in `folder` can go on."""
    return any((folder / name).is_file() for name in runs.CHECKPOINTS)


def _model(config: Configuration, begun: checkpoints.Checkpoint | None, training: Training) -> Any:
    """Make the model with its environments, or restore it; a training that is refused leaves no log behind."""
    log = training.folder / (f"{begun['timesteps']}.monitor.csv" if begun else "monitor.csv")
    venv = make_training_env(config, log, training.threads)
    try:
        return checkpoints.restored(begun, config, venv, training.resume or "") if begun else make_model(config, venv)
    except BaseException:
        venv.close()
        log.unlink()
        raise
