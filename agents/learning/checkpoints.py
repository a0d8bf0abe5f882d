"""Checkpoints: all that a training goes on from, as one file that is written whole or not at all.

A checkpoint holds the model with its optimisers and counters, the environments with their episodes and reward
normalisation, the replay buffer, the states of all random number generators, the best policy and the history of
validations. The one before is kept too, and is taken where the newest is damaged.

They are written between rollouts, where Stable-Baselines3 keeps nothing that it cannot restore: the run that goes on
repeats an uninterrupted one bit for bit, on the same versions and device.
"""

import io
import pickle
import random
import warnings
from contextlib import suppress
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper, VecNormalize

from agents.learning import runs
from agents.learning.callbacks import DeploymentLogger, Validation
from agents.learning.configurations import Configuration
from agents.learning.trust import DamagedFileError, UntrustedFileError, sealed, unsealed
from solar_env.support.files import write_bytes
from solar_env.support.interruption import deaf

# Attributes of environments that belong to the process: files, clocks, and what is made anew.
_OF_THE_PROCESS = {"venv", "class_attributes", "results_writer", "t_start", "stepping_time"}
_SDE = ("exploration_mat", "exploration_matrices")


@dataclass(frozen=True)
class Checkpoint:
    """A training between two rollouts.

    Attributes:
        timesteps: Environment steps so far, those of runs that it goes on from included.
        model: As Stable-Baselines3 saves it.
        lanes: By layer of the vector environment, the outermost first: its attributes.
        replay_buffer: None for PPO.
        random: States of the random number generators, and of the exploration noise.
        policy: The file of the best policy; None before the first validation.
        history: See `Validation.history`.
        terms: See `DeploymentLogger.terms`.
        record: What the configuration file of the run holds; None of older versions.
    """

    timesteps: int
    model: bytes
    lanes: list[dict[str, Any]]
    replay_buffer: Any
    random: dict[str, Any]
    policy: bytes | None
    history: dict[str, Any]
    terms: list[Any]
    record: dict[str, Any] | None = None

    def check(self, folder: str | Path) -> None:
        """Refuse the checkpoint of a run whose configuration file is of another one.

        Raises:
            DamagedFileError: They contradict each other.
        """
        stored, recorded = runs.read_config(folder), runs.jsonable(self.record or {})
        # Fewer or more steps may have been asked for since.
        for name in ("timesteps_before", *(field.name for field in fields(Configuration) if field.name != "timesteps")):
            if name in recorded and stored[name] != recorded[name]:
                here, there = (repr(values[name])[:100] for values in (stored, recorded))
                raise DamagedFileError(
                    f"{Path(folder) / runs.CONFIG} contradicts the checkpoint beside it: {name} is {here}, and was "
                    f"{there}; remove the file, which is then written anew"
                )

    def restore(
        self, config: Configuration, venv: VecEnv, device: str = "cpu", folder: str | Path | None = None
    ) -> BaseAlgorithm:
        """Make the model with its environments; `venv` is a fresh one of the same configuration, without normalisation.

        What is drawn at the beginning of a rollout must be restored then, by `restore_random`. The run's `folder` is
        told in errors.

        Raises:
            DamagedFileError: These versions cannot load the model.
        """
        normalized = VecNormalize(venv, norm_obs=False)
        source = f"the checkpoint of {folder}" if folder else "the checkpoint"
        model: Any = runs.loaded_model(
            config.algo, io.BytesIO(self.model), source, env=normalized, device=device, force_reset=False
        )
        # Only now: to load a model seeds its environment.
        for layer, values in zip(_layers(normalized), self.lanes, strict=True):
            vars(layer).update(values)
        if isinstance(model, OffPolicyAlgorithm):
            model.replay_buffer = self.replay_buffer
            model.replay_buffer.device = model.device
        return model

    def restore_random(self, model: Any) -> None:
        """Set the random number generators, and the exploration noise, as they were when the checkpoint was written."""
        states = self.random
        model.action_space = states["action_space"]
        if states["noise"] is not None:
            vars(model.action_noise).update(vars(states["noise"]))
        vars(_distribution(model)).update(states["distribution"])
        random.setstate(states["python"])
        np.random.set_state(states["numpy"])  # noqa: NPY002 (what Stable-Baselines3 draws from)
        torch.set_rng_state(states["torch"])


def _layers(venv: VecEnv) -> list[VecEnv]:
    """Return a vector environment and all that it wraps."""
    found = [venv]
    while isinstance(found[-1], VecEnvWrapper):
        found.append(found[-1].venv)
    return found


def _distribution(model: Any) -> Any:
    """Return the object that keeps the noise of generalised state-dependent exploration between steps."""
    actor = getattr(model, "actor", None) or model.policy
    return getattr(actor, "action_dist", actor)


def _taken(
    model: Any, validation: Validation, logger: DeploymentLogger, folder: Path, record: dict[str, Any]
) -> Checkpoint:
    file = io.BytesIO()
    model.save(file)
    layers = [
        {name: value for name, value in vars(layer).items() if name not in _OF_THE_PROCESS}
        for layer in _layers(model.get_vec_normalize_env())
    ]
    distribution = vars(_distribution(model))
    states = {
        "action_space": model.action_space,
        "noise": getattr(model, "action_noise", None),
        "distribution": {name: distribution[name].detach() for name in _SDE if name in distribution},
        "python": random.getstate(),
        "numpy": np.random.get_state(),  # noqa: NPY002 (what Stable-Baselines3 draws from)
        "torch": torch.get_rng_state(),
    }
    buffer = getattr(model, "replay_buffer", None)
    best = folder / runs.POLICY
    policy = unsealed(best) if best.is_file() else None
    return Checkpoint(
        model.num_timesteps, file.getvalue(), layers, buffer, states, policy, validation.history, logger.terms, record
    )


def write(folder: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint into a run folder, and keep the one before.

    Raises:
        OSError: It cannot be written; those before are still there.
    """
    newest, previous = (folder / name for name in runs.CHECKPOINTS)
    fresh = newest.with_suffix(".new")
    write_bytes(fresh, sealed(pickle.dumps(checkpoint, protocol=pickle.HIGHEST_PROTOCOL)))
    if newest.is_file():
        newest.replace(previous)
    fresh.replace(newest)


def read(folder: str | Path) -> Checkpoint:
    """Read the newest checkpoint of the run in `folder` that is whole.

    Raises:
        FileNotFoundError: There is none.
        DamagedFileError: All are damaged, or were written by other versions.
        UntrustedFileError: The run was not made on this account.

    Warns:
        UserWarning: The newest is damaged, and the one before is taken.
    """
    found = [path for path in (Path(folder) / name for name in runs.CHECKPOINTS) if path.is_file()]
    if not found:
        raise FileNotFoundError(f"{folder} has no checkpoint to go on from; start a new run")
    for number, path in enumerate(found, start=1):
        try:
            checkpoint = pickle.loads(unsealed(path))
            if not isinstance(checkpoint, Checkpoint):
                raise DamagedFileError(f"{path} holds no checkpoint; start a new run")
        except UntrustedFileError:
            raise
        except Exception as error:  # of bytes that other versions wrote, unpickling may raise anything
            if number == len(found):
                raise DamagedFileError(
                    f"no checkpoint in {folder} can be read, by these versions ({error}); start a new run"
                ) from error
            warnings.warn(f"{path} is damaged; the checkpoint before it is taken", stacklevel=2)
        else:
            return checkpoint
    raise AssertionError


def mend_config(folder: str | Path) -> None:
    """Write the configuration file of a run anew, from its checkpoint, where it is lost or damaged.

    Where there is no checkpoint to take it from nothing is done, and reading it says what is wrong.

    Warns:
        UserWarning: It was written anew.
    """
    try:
        runs.read_config(folder)
    except UntrustedFileError:
        return
    except (FileNotFoundError, DamagedFileError):
        with suppress(FileNotFoundError, DamagedFileError, UntrustedFileError):
            record = read(folder).record
            if record is not None:
                runs.write_config(Path(folder), record)
                warnings.warn(f"{Path(folder) / runs.CONFIG} is written anew, from the checkpoint", stacklevel=2)


class Checkpoints(BaseCallback):
    """Writes checkpoints at the first beginning of a rollout after every `interval` steps, and one at the end.

    Args:
        folder: Of the run.
        record: What its configuration file holds.
        interval: Steps of all environments together; a rollout that is longer sets the distance.
        validation, logger: Of the run.
        restored: Checkpoint that the run goes on from.
    """

    def __init__(
        self,
        folder: Path,
        record: dict[str, Any],
        interval: int,
        validation: Validation,
        logger: DeploymentLogger,
        restored: Checkpoint | None = None,
    ) -> None:
        super().__init__()
        self._folder, self._interval, self._validation, self._deployments = folder, interval, validation, logger
        self._record, self._restored = record, restored
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
            self._deployments.terms = self._restored.terms
            self._restored = None

    def _write(self) -> None:
        with deaf():  # torch takes an interruption for a fault of its own
            write(self._folder, _taken(self.model, self._validation, self._deployments, self._folder, self._record))
        self._latest = self.num_timesteps
