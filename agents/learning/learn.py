"""Training through Stable-Baselines3, from a configuration to a run folder."""

import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from rich.console import Console
from stable_baselines3.common.callbacks import CallbackList
from stable_baselines3.common.logger import configure
from stable_baselines3.common.vec_env import VecEnv, VecMonitor, VecNormalize

from agents.environments import episode_seeds
from agents.learning import checkpoints, runs
from agents.learning.callbacks import Call, DeploymentLogger, Validation
from agents.learning.models import make_model
from agents.learning.runs import Configuration, stored_configuration
from agents.learning.vec_env import FixedSeeds, LogarithmicCharges, NativeVecEnv
from solar_env.support.campaigns import Workers, each_done
from solar_env.support.files import make_folder, write_bytes
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


@dataclass(frozen=True)
class Training:
    """A training to run."""

    config: Configuration
    folder: Path  # existing, without a run
    resume: str | Path | None = None  # folder of the run to go on from; may be the same
    command: str = ""  # command line to record
    device: str = "cpu"  # Torch's name of it
    progress: bool = True  # show a progress bar
    threads: int | None = None  # greatest number that steps environments; None: one per processor
    checkpoint_interval: int = CHECKPOINT_INTERVAL  # environment steps


@dataclass(frozen=True)
class _Beginning:
    """Where a training begins: the run and checkpoint that it goes on from, its steps before, and those left."""

    source: str | Path | None
    checkpoint: checkpoints.Checkpoint | None
    before: int
    left: int


def train(training: Training) -> None:
    """Train and fill the run folder with policy, checkpoints, configuration and logs.

    A run that was interrupted goes on to its end, and repeats one that was not, bit for bit, on the same versions and
    device: from its checkpoint, or from its beginning where it had none yet. One that is complete trains for as many
    steps as the configuration says once more.

    Raises:
        FileNotFoundError, DamagedFileError: There is no checkpoint to go on from, see `checkpoints.read`.
        ValueError: The algorithm refuses its hyperparameters, or the run has trained for more steps than are asked for.
        OSError: A file cannot be written; the checkpoints before are still there.
        KeyboardInterrupt: Ctrl-C; a note says what was kept.
    """
    config, folder = training.config, training.folder
    torch.set_num_threads(1)  # small networks: more threads only contend
    start = time.perf_counter()
    beginning = _beginning(training)
    model = _model(training, beginning)
    runs.write_json(folder / runs.CONFIG, _record(training, beginning))
    model.set_logger(configure(str(folder / "tensorboard"), ["tensorboard"]))
    validation, logger, restored = _validation(training), DeploymentLogger(), beginning.checkpoint
    saving = checkpoints.Checkpoints(folder, training.checkpoint_interval, validation, logger, restored)
    if restored:
        validation.history = restored.history
        for name, content in restored.policy.items():
            write_bytes(folder / name, content)
    try:
        with keeping(saving.kept), counting_bar(Console(stderr=True, quiet=not training.progress)) as bar:
            task = bar.add_task("steps", total=config.timesteps, completed=config.timesteps - beginning.left)
            shown = Call(lambda model: bar.advance(task, model.n_envs))
            callbacks = CallbackList([logger, validation, shown, saving])
            model.learn(beginning.left, callbacks, reset_num_timesteps=not restored)
    finally:
        model.logger.close()
        validation.eval_env.close()
        model.env.close()
    timing = {
        "wall_time_s": time.perf_counter() - start,
        "stepping_s": model.env.unwrapped.stepping_time,
        "validation_s": validation.wall_time,
    }
    timing["learning_s"] = timing["wall_time_s"] - timing["stepping_s"] - timing["validation_s"]
    runs.write_json(folder / runs.TIMING, {"timesteps": model.num_timesteps, **timing})


def _beginning(training: Training) -> _Beginning:
    """Find where a training begins.

    Raises:
        FileNotFoundError, DamagedFileError: As `checkpoints.read`.
        ValueError: The run has trained for more steps than are asked for.
    """
    asked = training.config.timesteps
    source = _source(training.resume) if training.resume else None
    if source is None:
        return _Beginning(None, None, 0, asked)
    restored = checkpoints.read(source)
    stored = runs.read_config(source)
    before = restored.timesteps if runs.is_complete(source) else int(stored["timesteps_before"])
    left = before + asked - restored.timesteps
    # Rollouts are whole: a run that was interrupted as it ended may have more steps than were asked for.
    if left < 0 and asked < stored["timesteps"]:
        raise ValueError(
            f"timesteps is {asked}: {source} has trained for {restored.timesteps - before} steps; give more"
        )
    return _Beginning(source, restored, before, max(left, 0))


def _model(training: Training, beginning: _Beginning) -> Any:
    """Make the model with its environments, or restore it; a training that is refused leaves no log behind."""
    restored = beginning.checkpoint
    log = training.folder / (f"{restored.timesteps}.monitor.csv" if restored else "monitor.csv")
    venv = make_training_env(training.config, log, training.threads)
    try:
        if restored:
            return restored.restore(training.config, venv, training.device, beginning.source or "")
        return make_model(training.config, venv, training.device)
    except BaseException:
        venv.close()
        log.unlink()
        raise


def _record(training: Training, beginning: _Beginning) -> dict[str, Any]:
    """Content of the configuration file."""
    return {
        **asdict(training.config),
        "resumed_from": str(beginning.source) if beginning.source else None,
        "timesteps_before": beginning.before,
        "command": training.command,
        "versions": versions(*runs.LIBRARIES),
    }


def _validation(training: Training) -> Validation:
    config = training.config
    # The mean of a search wanders: more of them are looked at.
    validations = VALIDATIONS_OF_WEIGHTS if config.algo in runs.SEARCHES else VALIDATIONS
    interval = max(config.timesteps // validations, min(config.timesteps, SHORTEST_VALIDATION_INTERVAL))
    every = max(interval // config.n_envs, 1)
    env = make_validation_env(config, training.threads)
    return Validation(env, training.folder, every, VALIDATION_EPISODES, config)


def has_checkpoint(folder: Path) -> bool:
    """Return whether the run in `folder` can go on."""
    return any((folder / name).is_file() for name in runs.CHECKPOINTS)


def _source(resume: str | Path) -> str | Path | None:
    """The run with the checkpoint that the run `resume` goes on from: itself, or the one that it was begun with.

    None is the beginning: it was interrupted before its first checkpoint.
    """
    if has_checkpoint(Path(resume)) or runs.is_complete(resume):
        return resume
    begun_with: str | None = runs.read_config(resume).get("resumed_from")
    return begun_with


def train_missing(
    wanted: Mapping[Path, Configuration],
    command: str,
    device: str,
    workers: Workers,
    progress: bool = True,
    checkpoint_interval: int = CHECKPOINT_INTERVAL,
) -> None:
    """Train those of the runs `wanted`, run folder -> configuration, that are not complete, side by side on `workers`.

    Those that were interrupted go on.

    Raises:
        ValueError: A run has another configuration.
    """
    for folder, config in wanted.items():
        if (folder / runs.CONFIG).is_file() and asdict(stored_configuration(folder)) != runs.jsonable(asdict(config)):
            raise ValueError(f"{folder} holds a run with another configuration; choose another --out")
    for folder in wanted:
        if runs.is_complete(folder):
            runs.best_policy(folder)
            runs.read_evaluations(folder)
    # One thread each and no bar of their own: they run side by side.
    missing = [
        Training(
            config, folder, folder if has_checkpoint(folder) else None, command, device, False, 1, checkpoint_interval
        )
        for folder, config in wanted.items()
        if not runs.is_complete(folder)
    ]
    for training in missing:
        make_folder(training.folder)
    with counting_bar(Console(stderr=True, quiet=not progress)) as bar:
        task = bar.add_task("runs", total=len(wanted), completed=len(wanted) - len(missing))
        for _ in each_done(train, missing, workers):
            bar.advance(task)
