"""Checkpoints: all that a training goes on from, as one file that is written whole or not at all.

A checkpoint holds the weights, the optimisers and the counters of the model, the environments with their episodes and
reward normalisation, the replay buffer, the states of all random number generators, the best policy and the history of
validations: arrays and JSON, of which the model is built anew by its configuration. The one before is kept too, and is
taken where the newest is damaged.

They are written between rollouts, where Stable-Baselines3 keeps nothing that it cannot restore: the run that goes on
repeats an uninterrupted one bit for bit, on the same versions and device.
"""

import random
import warnings
from collections import defaultdict
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper, VecNormalize

from agents.learning import runs
from agents.learning.callbacks import DeploymentLogger, Validation
from agents.learning.models import make_model
from agents.learning.runs import Configuration, DamagedFileError
from agents.learning.storage import packed, unpacked
from agents.learning.vec_env import NativeVecEnv
from agents.learning.weight_search import CMAES
from solar_env.support.files import write_bytes
from solar_env.support.interruption import deaf

_COUNTERS = (
    *("num_timesteps", "_episode_num", "_n_updates"),
    *("_last_obs", "_last_original_obs", "_last_episode_starts"),
)
# Of the layers around the environments.
_SUMS = ("returns", "_costs", "episode_returns", "episode_lengths", "episode_count")
_SDE = ("exploration_mat", "exploration_matrices")


@dataclass(frozen=True)
class Checkpoint:
    """A training between two rollouts, in values that `storage` keeps.

    Attributes:
        timesteps: Environment steps so far, those of runs that it goes on from included.
        model: Counters, weights and states of the optimisers, and progress of a search.
        layers: By layer of the vector environment, the outermost first: its sums and statistics.
        lanes: See `NativeVecEnv.lanes`.
        replay_buffer: Arrays and counters; empty for agents without one.
        random: States of the random number generators, and of the exploration noise.
        policy: Content of the files of the best policy; empty before the first validation.
        history: See `Validation.history`.
        terms: See `DeploymentLogger.terms`.
    """

    timesteps: int
    model: dict[str, Any]
    layers: list[dict[str, Any]]
    lanes: dict[str, Any]
    replay_buffer: dict[str, Any]
    random: dict[str, Any]
    policy: dict[str, bytes]
    history: dict[str, Any]
    terms: list[dict[str, float]]

    def restore(
        self, config: Configuration, venv: VecEnv, device: str = "cpu", folder: str | Path = ""
    ) -> BaseAlgorithm:
        """Make the model with its environments; `venv` is a fresh one of the same configuration, without normalisation.

        What is drawn at the beginning of a rollout must be restored then, by `restore_random`. The run's `folder` is
        told in errors.

        Raises:
            ValueError: The configuration is refused, see `make_model`.
            DamagedFileError: The checkpoint is not of this configuration.
        """
        model: Any = make_model(config, venv, device)
        model.env.reset()
        try:
            for layer, values in zip(_layers(model), self.layers, strict=True):
                vars(layer).update(values["sums"])
                if values["statistics"]:
                    vars(layer.ret_rms).update(values["statistics"])
            model.env.unwrapped.lanes = self.lanes
            model.set_parameters(self.model["parameters"], device=device)
            for name, value in self.model["variables"].items():
                getattr(model, name).data.copy_(value)
            vars(model).update(self.model["counters"])
            if self.model["progress"]:
                model.progress = self.model["progress"]
            if self.replay_buffer:
                vars(model.replay_buffer).update(self.replay_buffer)
        except Exception as error:  # whatever the libraries make of values of another model
            reason = " ".join(str(error).split())[:200]
            raise DamagedFileError(
                f"the checkpoint of {folder} does not fit the {runs.CONFIG} beside it ({reason}); start a new run"
            ) from error
        return model

    def restore_random(self, model: Any) -> None:
        """Set the random number generators, and the exploration noise, as they were when the checkpoint was written."""
        states = self.random
        model.action_space._np_random = states["action_space"]
        noise = {name: value.to(model.device) for name, value in states["distribution"].items()}
        vars(_distribution(model)).update(noise)
        random.setstate(states["python"])
        np.random.set_state(states["numpy"])  # noqa: NPY002 (what Stable-Baselines3 draws from)
        torch.set_rng_state(states["torch"])


def _layers(model: Any) -> list[VecEnvWrapper]:
    """Return what is around the environments of a model."""
    found = [model.get_vec_normalize_env()]
    while isinstance(found[-1].venv, VecEnvWrapper):
        found.append(found[-1].venv)
    return found


def _distribution(model: Any) -> Any:
    """Return the object that keeps the noise of generalised state-dependent exploration between steps."""
    actor = getattr(model, "actor", None) or model.policy
    return getattr(actor, "action_dist", actor)


def _of_model(model: Any) -> dict[str, Any]:
    _, variables = model._get_torch_save_params()
    return {
        "counters": {name: vars(model)[name] for name in _COUNTERS if name in vars(model)},
        "parameters": model.get_parameters(),
        "variables": {name: getattr(model, name) for name in variables},
        "progress": model.progress if isinstance(model, CMAES) else {},
    }


def _of_layer(layer: VecEnvWrapper) -> dict[str, Any]:
    statistics = layer.ret_rms if isinstance(layer, VecNormalize) else None
    return {
        "sums": {name: vars(layer)[name] for name in _SUMS if name in vars(layer)},
        "statistics": {name: vars(statistics)[name] for name in ("mean", "var", "count")} if statistics else {},
    }


def _of_buffer(buffer: Any) -> dict[str, Any]:
    """Return the arrays of a replay buffer, and the place of the next step."""
    kept = (np.ndarray, int)
    return {name: value for name, value in vars(buffer).items() if isinstance(value, kept)} if buffer else {}


def _random_states(model: Any) -> dict[str, Any]:
    distribution = vars(_distribution(model))
    return {
        "action_space": model.action_space.np_random,
        "distribution": {name: distribution[name] for name in _SDE if name in distribution},
        "python": random.getstate(),
        "numpy": np.random.get_state(),  # noqa: NPY002 (what Stable-Baselines3 draws from)
        "torch": torch.get_rng_state(),
    }


def taken(model: Any, validation: Validation, logger: DeploymentLogger, folder: Path) -> Checkpoint:
    """Take a checkpoint of a training between two rollouts."""
    native: NativeVecEnv = model.env.unwrapped
    best = {name: (folder / name).read_bytes() for name in runs.POLICY if (folder / name).is_file()}
    return Checkpoint(
        timesteps=model.num_timesteps,
        model=_of_model(model),
        layers=[_of_layer(layer) for layer in _layers(model)],
        lanes=native.lanes,
        replay_buffer=_of_buffer(getattr(model, "replay_buffer", None)),
        random=_random_states(model),
        policy=best,
        history=validation.history,
        terms=[dict(terms) for terms in logger.terms],
    )


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
        DamagedFileError: All are damaged, or were written by other versions.

    Warns:
        UserWarning: The newest is damaged, and the one before is taken.
    """
    found = [path for path in (Path(folder) / name for name in runs.CHECKPOINTS) if path.is_file()]
    if not found:
        raise FileNotFoundError(f"{folder} has no checkpoint to go on from; start a new run")
    for number, path in enumerate(found, start=1):
        try:
            content = unpacked(path)
            return Checkpoint(**{field.name: content[field.name] for field in fields(Checkpoint)})
        except (ValueError, KeyError, TypeError) as error:
            if number == len(found):
                raise DamagedFileError(
                    f"no checkpoint in {folder} can be read, by these versions ({error}); start a new run"
                ) from error
            warnings.warn(f"{path} is damaged; the checkpoint before it is taken", stacklevel=2)
    raise AssertionError


class Checkpoints(BaseCallback):
    """Writes checkpoints at the first beginning of a rollout after every `interval` steps, and one at the end.

    Args:
        folder: Of the run.
        interval: Steps of all environments together; a rollout that is longer sets the distance.
        validation, logger: Of the run.
        restored: Checkpoint that the run goes on from.
    """

    def __init__(
        self,
        folder: Path,
        interval: int,
        validation: Validation,
        logger: DeploymentLogger,
        restored: Checkpoint | None = None,
    ) -> None:
        super().__init__()
        self._folder, self._interval, self._validation, self._deployments = folder, interval, validation, logger
        self._restored = restored
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
        if self._restored is not None:
            self._restored.restore_random(self.model)
            self._deployments.terms = [defaultdict(float, terms) for terms in self._restored.terms]
            self._restored = None

    def _write(self) -> None:
        with deaf():  # torch takes an interruption for a fault of its own
            write(self._folder, taken(self.model, self._validation, self._deployments, self._folder))
        self._latest = self.num_timesteps
