"""Checkpoints: all that a training goes on from, as one file that is written whole or not at all.

A checkpoint holds the weights, the optimisers and the counters of the model, the environments with their episodes and
reward normalisation, the replay buffer, the states of all random number generators, the best policy and the history of
validations: arrays and JSON, of which the model is built anew by its configuration. The one before is kept too, and is
taken where the newest is damaged.

They are written between rollouts, where Stable-Baselines3 keeps nothing that it cannot restore: the run that goes on
repeats an uninterrupted one bit for bit, on the same versions.
"""

import random
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper, VecNormalize

from agents.learning import runs
from agents.learning.models import make_model
from agents.learning.runs import Configuration
from agents.learning.storage import packed, unpacked
from agents.learning.weight_search import CMAES
from solar_env.support.files import write_bytes
from solar_env.support.interruption import deaf

Checkpoint = dict[str, Any]
"""A training between two rollouts, in values that `storage` keeps, as `taken` returns it."""

_COUNTERS = (
    *("num_timesteps", "_episode_num", "_n_updates"),
    *("_last_obs", "_last_original_obs", "_last_episode_starts"),
)
# Of the layers around the environments.
_SUMS = ("returns", "_costs", "episode_returns", "episode_lengths", "episode_count")
_SDE = ("exploration_mat", "exploration_matrices")


def taken(model: Any, validation: Any, folder: Path) -> Checkpoint:
    """Take a checkpoint of a training between two rollouts."""
    _, variables = model._get_torch_save_params()
    buffer = getattr(model, "replay_buffer", None)
    return {
        "timesteps": model.num_timesteps,
        "counters": _some(model, _COUNTERS),
        "parameters": model.get_parameters(),
        "variables": {name: getattr(model, name) for name in variables},
        "progress": model.progress if isinstance(model, CMAES) else {},
        "layers": [{"sums": _some(layer, _SUMS), "statistics": _statistics(layer)} for layer in _layers(model)],
        "lanes": model.env.unwrapped.lanes,
        "replay_buffer": {name: value for name, value in vars(buffer).items() if isinstance(value, (np.ndarray, int))}
        if buffer
        else {},
        "random": {
            "action_space": model.action_space.np_random,
            "distribution": _some(_distribution(model), _SDE),
            "python": random.getstate(),
            "numpy": np.random.get_state(),  # noqa: NPY002 (what Stable-Baselines3 draws from)
            "torch": torch.get_rng_state(),
        },
        "policy": {name: (folder / name).read_bytes() for name in runs.POLICY if (folder / name).is_file()},
        "history": validation.history,
    }


def restored(checkpoint: Checkpoint, config: Configuration, venv: VecEnv, folder: str | Path = "") -> BaseAlgorithm:
    """Make the model with its environments; `venv` is a fresh one of the same configuration, without normalisation.

    What is drawn at the beginning of a rollout must be restored then, by `restore_random`. The run's `folder` is
    told in errors.

    Raises:
        ValueError: The configuration is refused, see `make_model`, or the checkpoint is not of this configuration.
    """
    model: Any = make_model(config, venv)
    model.env.reset()
    try:
        for layer, values in zip(_layers(model), checkpoint["layers"], strict=True):
            vars(layer).update(values["sums"])
            if values["statistics"]:
                vars(layer.ret_rms).update(values["statistics"])
        model.env.unwrapped.lanes = checkpoint["lanes"]
        model.set_parameters(checkpoint["parameters"], device="cpu")
        for name, value in checkpoint["variables"].items():
            getattr(model, name).data.copy_(value)
        vars(model).update(checkpoint["counters"])
        if checkpoint["progress"]:
            model.progress = checkpoint["progress"]
        if checkpoint["replay_buffer"]:
            vars(model.replay_buffer).update(checkpoint["replay_buffer"])
    except Exception as error:  # whatever the libraries make of values of another model
        reason = " ".join(str(error).split())[:200]
        raise ValueError(
            f"the checkpoint of {folder} does not fit the {runs.CONFIG} beside it ({reason}); start a new run"
        ) from error
    return model


def restore_random(checkpoint: Checkpoint, model: BaseAlgorithm) -> None:
    """Set the random number generators, and the exploration noise, as they were when the checkpoint was written."""
    states = checkpoint["random"]
    model.action_space._np_random = states["action_space"]
    vars(_distribution(model)).update(states["distribution"])
    random.setstate(states["python"])
    np.random.set_state(states["numpy"])  # noqa: NPY002 (what Stable-Baselines3 draws from)
    torch.set_rng_state(states["torch"])


def _some(thing: object, names: tuple[str, ...]) -> dict[str, object]:
    return {name: vars(thing)[name] for name in names if name in vars(thing)}


def _statistics(layer: VecEnvWrapper) -> dict[str, object]:
    return _some(layer.ret_rms, ("mean", "var", "count")) if isinstance(layer, VecNormalize) else {}


def _layers(model: Any) -> list[VecEnvWrapper]:
    """Return what is around the environments of a model, the outermost first."""
    found = [model.get_vec_normalize_env()]
    while isinstance(found[-1].venv, VecEnvWrapper):
        found.append(found[-1].venv)
    return found


def _distribution(model: BaseAlgorithm) -> object:
    """Return the object that keeps the noise of generalised state-dependent exploration between steps."""
    actor = getattr(model, "actor", None) or model.policy
    return getattr(actor, "action_dist", actor)


def write(folder: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint into a run folder, and keep the one before.

    Raises:
        OSError: It cannot be written; those before are still there.
    """
    newest, previous = (folder / name for name in runs.CHECKPOINTS)
    fresh = newest.with_suffix(".new")
    write_bytes(fresh, packed(checkpoint))
    if newest.is_file():
        newest.replace(previous)
    fresh.replace(newest)


def read(folder: str | Path) -> Checkpoint:
    """Read the newest checkpoint of the run in `folder` that is whole.

    Raises:
        FileNotFoundError: There is none.
        ValueError: All are damaged.

    Warns:
        UserWarning: The newest is damaged, and the one before is taken.
    """
    found = [path for path in (Path(folder) / name for name in runs.CHECKPOINTS) if path.is_file()]
    if not found:
        raise FileNotFoundError(f"{folder} has no checkpoint to go on from; start a new run")
    reason = ""
    for path in found:
        try:
            content = unpacked(path)
            if isinstance(content, dict) and isinstance(content.get("timesteps"), int):
                return content
            reason = "it is none of a training"
        except ValueError as error:
            reason = str(error)
        if path != found[-1]:
            warnings.warn(f"{path} is damaged; the checkpoint before it is taken", stacklevel=2)
    raise ValueError(f"no checkpoint in {folder} can be read ({reason}); start a new run")


class Checkpoints(BaseCallback):
    """Writes checkpoints at the first beginning of a rollout after every `interval` steps, and one at the end.

    Args:
        folder: Of the run.
        interval: Steps of all environments together; a rollout that is longer sets the distance.
        validation: Of the run.
        begun: Checkpoint that the run goes on from.
    """

    def __init__(self, folder: Path, interval: int, validation: Any, begun: Checkpoint | None = None) -> None:
        super().__init__()
        self._folder, self._interval, self._validation, self._begun = folder, interval, validation, begun
        self._latest: int | None = None

    def kept(self) -> str:
        """Say what an interruption has left, and how to go on."""
        if self._latest is None:
            return f"no checkpoint was due yet; solar-env train --resume {self._folder} begins where this one began"
        return f"kept the checkpoint of step {self._latest}; solar-env train --resume {self._folder} goes on"

    def _on_step(self) -> bool:
        return True

    def _on_rollout_start(self) -> None:
        self._restore()
        if self._latest is None or self.num_timesteps - self._latest >= self._interval:
            self._write()

    def _on_training_end(self) -> None:
        self._restore()
        self._write()

    def _restore(self) -> None:
        if self._begun is not None:
            restore_random(self._begun, self.model)
            self._begun = None

    def _write(self) -> None:
        with deaf():  # torch takes an interruption for its fault
            write(self._folder, taken(self.model, self._validation, self._folder))
        self._latest = self.num_timesteps
