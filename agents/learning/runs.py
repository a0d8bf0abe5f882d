"""Run folders: the files that a training run leaves, none of which executes anything when it is read."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import datetime
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm

from agents.environments import NAMESPACE
from agents.learning.weight_search import CMAES, WeightSearch
from agents.policies import shipped
from agents.policies.policy import ShippedPolicy
from solar_env.support.files import make_folder, write_text
from solar_env.support.numbers import check_types, is_whole_number
from solar_env.support.plain_arrays import read_arrays, read_json

LIBRARIES = ("gymnasium", "stable-baselines3", "torch")  # whose versions policies depend on, beside those of all
ALGORITHMS: dict[str, type[BaseAlgorithm]] = {
    "ppo": PPO,
    "sac": SAC,
    "td3": TD3,
    "ars": WeightSearch,
    "cma-es": CMAES,
}
SEARCHES = ("ars", "cma-es")  # over the weights of a policy, by whole episodes

CONFIG = "config.json"
POLICY = (shipped.ARRAYS, shipped.DESCRIPTION)  # of the best policy
CHECKPOINTS = ("checkpoint.npz", "checkpoint-previous.npz")  # newest first
EVALUATIONS = "evaluations.npz"
HISTORY = ("timesteps", "results", "ep_lengths")  # its arrays
TIMING = "timing.json"  # written last: the run is complete


class DamagedFileError(ValueError):
    """A file that is not as it was written."""


@dataclass(frozen=True)
class Configuration:
    """Complete settings of a training run: it follows from these alone.

    Attributes:
        algo: Name of the algorithm, one of `ALGORITHMS`.
        env_id: Environment id.
        env_kwargs: Environment keywords, with the ranges to randomise.
        seed: Run seed; networks, exploration and episodes follow from it.
        n_envs: Environments stepped together.
        timesteps: Environment steps to train for; those of a run that goes on with a complete one come on top of its.
        hyperparameters: Keywords of the Stable-Baselines3 class, and those of `agents.learning.models.make_model`.

    Raises:
        ValueError: On construction, for a value of another kind, an unknown algorithm, or no environment of this
            project.
    """

    algo: str
    env_id: str
    env_kwargs: dict[str, Any]
    seed: int
    n_envs: int
    timesteps: int
    hyperparameters: dict[str, Any]

    def __post_init__(self) -> None:
        check_types(self)
        algorithm(self.algo)
        if not self.env_id.startswith(NAMESPACE):
            raise ValueError(f"env_id is {self.env_id!r}; give an environment of solar_env")
        for name in ("n_envs", "timesteps"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} is {getattr(self, name)}; give a positive number")


@dataclass(frozen=True)
class _Origin:
    """What a configuration file says beside the configuration."""

    command: str
    versions: dict[str, Any]
    resumed_from: str | None
    timesteps_before: int

    def __post_init__(self) -> None:
        check_types(self)


def algorithm(name: str) -> type[BaseAlgorithm]:
    """Return the Stable-Baselines3 class called `name`.

    Raises:
        ValueError: There is none.
    """
    if name not in ALGORITHMS:
        raise ValueError(f"no algorithm {name!r}; available: {', '.join(ALGORITHMS)}")
    return ALGORITHMS[name]


def new_run_folder(out: str | Path | None, env_id: str, algo: str, seed: int) -> Path:
    """Create `out`, or `runs/<id>__<algo>__<seed>__<timestamp>` where it is None.

    Raises:
        FileExistsError: The folder holds a run already.
        OSError: It cannot be made.
    """
    name = f"{re.sub(r'[^A-Za-z0-9.-]+', '-', env_id)}__{algo}__{seed}__{datetime.now():%Y%m%d-%H%M%S}"
    folder = Path(out) if out else Path("runs") / name
    if (folder / CONFIG).exists():
        raise FileExistsError(f"{folder} holds a run already; choose another --out, or go on from it with --resume")
    return make_folder(folder)


def write_json(path: Path, content: Any) -> None:
    """Write `content` as indented JSON."""
    write_text(path, json.dumps(content, indent=2, allow_nan=False) + "\n")


def read_config(folder: str | Path) -> dict[str, Any]:
    """Read the configuration of the run in `folder`, with its command, versions and origin.

    Raises:
        FileNotFoundError: `folder` is not a run folder.
        DamagedFileError: The file is not whole, describes no run, or has a value of another kind.
    """
    path = Path(folder) / CONFIG
    if not path.is_file():
        raise FileNotFoundError(f"{folder} is not a run folder: it has no {CONFIG}; train.py writes such folders")
    try:
        record = read_json(path)
        if not isinstance(record, dict):
            raise ValueError(f"{path} describes no training run; name a folder that train.py has written")
        for kind in (Configuration, _Origin):
            names = [field.name for field in fields(kind)]
            for name in names:
                if name not in record:
                    raise ValueError(f"{path} says nothing of {name}; train the run anew")
            try:
                kind(**{name: record[name] for name in names})
            except ValueError as error:
                raise ValueError(f"{path}: {error}, or train the run anew") from error
    except ValueError as error:
        raise DamagedFileError(str(error)) from error
    return record


def stored_configuration(folder: str | Path) -> Configuration:
    """Read the configuration of the run in `folder`.

    Raises:
        FileNotFoundError, DamagedFileError: As `read_config`.
    """
    stored = read_config(folder)
    return Configuration(**{field.name: stored[field.name] for field in fields(Configuration)})


def is_complete(folder: str | Path) -> bool:
    """Return whether the training in `folder` has run to its end."""
    return (Path(folder) / TIMING).is_file()


def steps_taken(folder: str | Path) -> int:
    """Return the environment steps of a run, with those of the runs that it was resumed from.

    Of a run that is not complete those that were asked for; rollouts are whole, so that more are taken.

    Raises:
        DamagedFileError: Its files do not tell them.
    """
    config, timing = read_config(folder), Path(folder) / TIMING
    asked: int = config["timesteps_before"] + config["timesteps"]
    if not timing.is_file():
        return asked
    record = read_json(timing)
    steps: Any = record.get("timesteps", asked) if isinstance(record, dict) else None
    if not is_whole_number(steps, 0):
        raise DamagedFileError(f"{timing} is damaged: it does not tell the steps of the training; train the run anew")
    return int(steps)


def read_evaluations(folder: Path) -> dict[str, np.ndarray]:
    """Read the history of a run's validations: steps (n,), and returns and lengths (n, episodes).

    Raises:
        OSError: The file cannot be read.
        DamagedFileError: It is not whole, or no such history.
    """
    path = folder / EVALUATIONS
    try:
        arrays = read_arrays(path, lambda name: name in HISTORY)
        if set(arrays) != set(HISTORY) or arrays["results"].ndim != 2:
            raise ValueError(f"it holds {sorted(arrays)}")
    except ValueError as error:
        raise DamagedFileError(f"{path} is no history of validations ({error}); train the run anew") from error
    return arrays


def best_policy(folder: str | Path) -> ShippedPolicy:
    """Read the best policy of the run in `folder`.

    Raises:
        FileNotFoundError: There is no run, or it was interrupted before its first validation.
        DamagedFileError: A file is not whole; the message names it.
    """
    if not (Path(folder) / shipped.DESCRIPTION).is_file():
        read_config(folder)
        raise FileNotFoundError(f"{folder} has no policy; the run ended before its first validation, resume it")
    try:
        return shipped.load_shipped(Path(folder).resolve())
    except ValueError as error:
        raise DamagedFileError(f"{error}; resume the run, or train it anew") from error


def load_policy(folder: str | Path, env: gymnasium.Env) -> ShippedPolicy:
    """Load the best policy of the run in `folder`, for use on `env`.

    Raises:
        FileNotFoundError, DamagedFileError: As `best_policy`.
        ValueError: Observations or actions of `env` have another meaning than in training.
    """
    policy = best_policy(folder)
    policy.check(env)
    return policy


def linear_weights(folder: str | Path, env: gymnasium.Env) -> list[float]:
    """Weights of the best policy of a search over weights, to begin another training on `env` with.

    Raises:
        FileNotFoundError, DamagedFileError: As `load_policy`.
        ValueError: The run was no such search, or observations or actions of `env` have another meaning.
    """
    policy = load_policy(folder, env)
    if (algo := policy.description.algorithm) not in SEARCHES:
        raise ValueError(f"{folder} is a run of {algo}; training can begin with one of {', '.join(SEARCHES)}")
    return policy.network.layers[-1].weights.ravel().tolist()


def jsonable(mapping: Mapping[str, Any]) -> dict[str, Any]:
    """Return `mapping` as it reads after a round trip through JSON (tuples become lists)."""
    return json.loads(json.dumps(mapping))
