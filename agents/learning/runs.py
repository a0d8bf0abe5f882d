"""Run folders: settings and results of training runs. Reading a run folder executes no code from it."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from datetime import datetime
from pathlib import Path

import gymnasium
import numpy as np

from agents.environments import NAMESPACE, Keywords, environment_settings, episode_seeds, with_sampling
from agents.policies.network import PolicyNetwork
from agents.policies.saved_models import read_model
from agents.torque_laws import Signals
from solar_env.support.files import write_text
from solar_env.support.plain_arrays import read_arrays, read_json
from solar_env.support.values import check_types

SHIPPED = Path(__file__).parents[1] / "policies"  # folders of the policies that come with the package
LIBRARIES = ("gymnasium", "stable-baselines3", "torch")  # libraries of a run, beside the simulator's libraries
CONFIG = "config.json"
BEST, LAST = "best_model.zip", "last_model.zip"  # Stable-Baselines3's models: the best and the last in validation
EVALUATIONS = "evaluations.npz"  # file of Stable-Baselines3's EvalCallback
HISTORY = ("timesteps", "results", "ep_lengths")  # arrays in EVALUATIONS


@dataclass(frozen=True)
class Configuration:
    """Complete settings of a training run, which determine the run.

    Attributes:
        algo: Name of the algorithm, one of `agents.learning.training.ALGORITHMS`.
        env_id: Environment id.
        env_kwargs: Environment keywords, with the ranges to randomise.
        seed: Run seed; networks, exploration and episodes follow from it.
        n_envs: Environments stepped together.
        timesteps: Environment steps to train for.
        hyperparameters: Keywords of the algorithm's class that replace its defaults.
        command: Command line that began the run.
        versions: Versions of the packages.

    Raises:
        ValueError: On construction, if a value has a wrong type or range, or the environment is not of this project.
    """

    algo: str
    env_id: str
    env_kwargs: Keywords
    seed: int
    n_envs: int
    timesteps: int
    hyperparameters: Keywords
    command: str = ""
    versions: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_types(self)
        if not self.env_id.startswith(NAMESPACE):
            raise ValueError(f"env_id is {self.env_id!r}; give an environment of solar_env")
        for name in ("n_envs", "timesteps"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} is {getattr(self, name)}; give a positive number")
        object.__setattr__(self, "env_kwargs", jsonable(with_sampling(self.env_kwargs, self.env_id)))
        episode_seeds("training", self.seed, self.n_envs)  # refuses a seed out of range


def new_run_folder(out: str | Path | None, config: Configuration) -> Path:
    """Return the folder of a new run: `out`, or `runs/<id>__<algo>__<seed>__<timestamp>` if `out` is None.

    Raises:
        FileExistsError: The folder holds a run already.
    """
    env_id = re.sub(r"[^A-Za-z0-9.-]+", "-", config.env_id)
    name = f"{env_id}__{config.algo}__{config.seed}__{datetime.now():%Y%m%d-%H%M%S}"
    folder = Path(out) if out else Path("runs") / name
    if (folder / CONFIG).exists():
        raise FileExistsError(f"{folder} holds a run already; choose another --out, or go on from it with --resume")
    return folder


def write_json(path: Path, content: object) -> None:
    """Write `content` as indented JSON."""
    write_text(path, json.dumps(content, indent=2, allow_nan=False) + "\n")


def read_config(folder: str | Path) -> Configuration:
    """Read the configuration of the run in `folder`.

    Raises:
        FileNotFoundError: `folder` is not a run folder.
        ValueError: The file is damaged, describes no run, or has a value of a wrong type or range.
    """
    path = Path(folder) / CONFIG
    if not path.is_file():
        raise FileNotFoundError(f"{folder} is not a run folder: it has no {CONFIG}; train.py writes such folders")
    record = read_json(path)
    expected = {each.name for each in fields(Configuration)}
    if not isinstance(record, dict) or set(record) != expected:
        raise ValueError(f"{path} describes no training run: it needs {', '.join(sorted(expected))}; train anew")
    try:
        return Configuration(**record)
    except ValueError as error:
        raise ValueError(f"{path}: {error}, or train the run anew") from error


def read_evaluations(folder: Path) -> dict[str, np.ndarray]:
    """Read a run's n validations, by the names in `HISTORY`: steps (n,), returns and lengths of episodes (n, episodes).

    Raises:
        OSError: The file cannot be read.
        ValueError: The file is damaged, or holds no such history.
    """
    path = folder / EVALUATIONS
    try:
        arrays = read_arrays(path, lambda name: name in HISTORY)
        if set(arrays) != set(HISTORY) or arrays["results"].ndim != 2:
            raise ValueError(f"it holds {sorted(arrays)}")
    except ValueError as error:
        raise ValueError(f"{path} is no history of validations ({error}); train the run anew") from error
    return arrays


def shipped() -> list[str]:
    """List the names of the shipped policies, which come with this package."""
    return sorted(path.parent.name for path in SHIPPED.glob(f"*/{CONFIG}"))


def folder_of(name: str | Path) -> Path:
    """Return the folder of the shipped policy `name`, or the path `name` if no shipped policy has that name."""
    return SHIPPED / name if str(name) in shipped() else Path(name)


def best_policy(name: str | Path) -> PolicyNetwork:
    """Read the best policy of a run folder, a policy of this package by its name, or a saved model (.zip).

    Raises:
        FileNotFoundError: The run does not exist, or was interrupted before its first validation.
        ValueError: A file is damaged; the message names the file.
    """
    if str(name).endswith(".zip"):
        return read_model(name)
    read_config(folder := folder_of(name))
    if not (folder / BEST).is_file():
        raise FileNotFoundError(f"{folder} has no policy; the run ended before its first validation, resume it")
    return read_model(folder / BEST)


def check(config: Configuration, env: gymnasium.Env) -> None:
    """Refuse an environment whose observations or actions have another meaning than in the training run.

    Raises:
        ValueError: As in `Signals.check`.
    """
    trained = Signals.of(environment_settings(config.env_id, config.env_kwargs))
    trained.check(env, f"{config.env_id} with {config.env_kwargs}")


def jsonable(mapping: Mapping[str, object]) -> Keywords:
    """Return `mapping` as it reads after a round trip through JSON (tuples become lists)."""
    return json.loads(json.dumps(mapping))
