"""Run folders: what a training run is asked for and what it leaves. Reading a run folder executes nothing."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from datetime import datetime
from pathlib import Path

import numpy as np
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm

from agents.configs import CONFIGS
from agents.environments import INTERFACE, NAMESPACE, Keywords, episode_seeds, with_sampling
from agents.learning.weight_search import CMAES, WeightSearch
from agents.policies import shipped
from agents.policies.shipped import ShippedPolicy
from solar_env.support.files import make_folder, write_text
from solar_env.support.plain_arrays import read_arrays, read_json
from solar_env.support.values import check_types

LIBRARIES = ("gymnasium", "stable-baselines3", "torch")  # whose versions policies depend on, beside those of all
ALGORITHMS: dict[str, type[BaseAlgorithm]] = {
    "ppo": PPO,
    "sac": SAC,
    "td3": TD3,
    "ars": WeightSearch,
    "cma-es": CMAES,
}
SEARCHES = ("ars", "cma-es")  # over the weights of a policy, by whole episodes
FIRST_WEIGHTS = "first_weights"

CONFIG = "config.json"
POLICY = (shipped.ARRAYS, shipped.DESCRIPTION)  # of the best policy
CHECKPOINTS = ("checkpoint.npz", "checkpoint-previous.npz")  # newest first
EVALUATIONS = "evaluations.npz"
HISTORY = ("timesteps", "results", "ep_lengths")  # its arrays
TIMING = "timing.json"  # written last: the run is complete


@dataclass(frozen=True)
class Configuration:
    """Complete settings of a training run, from which it follows, and where it came from.

    Attributes:
        algo: Name of the algorithm, one of `ALGORITHMS`.
        env_id: Environment id.
        env_kwargs: Environment keywords, with the ranges to randomise.
        seed: Run seed; networks, exploration and episodes follow from it.
        n_envs: Environments stepped together.
        timesteps: Environment steps to train for; those of a run that goes on with a complete one come on top of its.
        hyperparameters: Keywords of the Stable-Baselines3 class, and those of `agents.learning.models.make_model`.
        command: Command line that began the run.
        versions: Versions of the packages.
        resumed_from: Folder of the run that this one went on from.
        timesteps_before: Environment steps of that run.

    Raises:
        ValueError: On construction, for a value of another kind, an unknown algorithm, or no environment of this
            project.
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
    resumed_from: str | None = None
    timesteps_before: int = 0

    def __post_init__(self) -> None:
        check_types(self)
        check_algorithm(self.algo)
        if not self.env_id.startswith(NAMESPACE):
            raise ValueError(f"env_id is {self.env_id!r}; give an environment of solar_env")
        for name in ("n_envs", "timesteps"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} is {getattr(self, name)}; give a positive number")


def check_algorithm(name: str) -> None:
    """Refuse a name that is not in `ALGORITHMS`, by a ValueError."""
    if name not in ALGORITHMS:
        raise ValueError(f"no algorithm {name!r}; available: {', '.join(ALGORITHMS)}")


def complete(
    algo: str,
    env_id: str,
    env_kwargs: Mapping[str, object],
    seed: int,
    n_envs: int | None = None,
    timesteps: int | None = None,
    hyperparameters: Mapping[str, object] | None = None,
) -> Configuration:
    """Complete a request with the values in `agents/configs/<algo>.json` for its environment, in place of each None.

    The first weights of the file are those of its policy and interface: with others they are left out.

    Args:
        algo, env_id, env_kwargs, seed, n_envs, timesteps: See `Configuration`.
        hyperparameters: Values in place of single ones of the file, and of single "policy_kwargs" of its. The algorithm
            refuses wrong ones when the model is made.

    Raises:
        ValueError: Algorithm, environment or one of its keywords is unknown, or a number is out of range.
    """
    check_algorithm(algo)
    entries = read_json(CONFIGS / f"{algo}.json")
    if env_id not in entries:
        raise ValueError(f"{algo}.json has no hyperparameters for {env_id!r}; it has {', '.join(entries)}")
    found, asked = entries[env_id], dict(hyperparameters or {})
    interface = {name: found[name] for name in INTERFACE if name in found}
    usual: Keywords = dict(found["hyperparameters"])
    keywords = with_sampling({**interface, **env_kwargs}, env_id)
    if isinstance(of_policy := asked.get("policy_kwargs"), dict):
        asked["policy_kwargs"] = {**usual.get("policy_kwargs", {}), **of_policy}
    if _signals(keywords) != _signals(interface) or "net_arch" in str(of_policy):
        usual.pop(FIRST_WEIGHTS, None)
    lanes = found["n_envs"] if n_envs is None else n_envs
    steps = found["timesteps"] if timesteps is None else timesteps
    config = Configuration(algo, env_id, jsonable(keywords), seed, lanes, steps, {**usual, **asked})
    episode_seeds("training", seed, config.n_envs)  # refuses a seed without any
    return config


def _signals(keywords: Keywords) -> tuple[object, object]:
    """Return the first group of entries that is observed, and what an action is."""
    observation = keywords.get("observation", "")
    return observation if isinstance(observation, str) else observation[0], keywords.get("action")


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


def write_json(path: Path, content: object) -> None:
    """Write `content` as indented JSON."""
    write_text(path, json.dumps(content, indent=2, allow_nan=False) + "\n")


def read_config(folder: str | Path) -> Configuration:
    """Read the configuration of the run in `folder`.

    Raises:
        FileNotFoundError: `folder` is not a run folder.
        ValueError: The file is not whole, describes no run, or has a value of another kind.
    """
    path = Path(folder) / CONFIG
    if not path.is_file():
        raise FileNotFoundError(f"{folder} is not a run folder: it has no {CONFIG}; train.py writes such folders")
    record = read_json(path)
    expected = {each.name for each in fields(Configuration)}
    if not isinstance(record, dict) or set(record) != expected:
        raise ValueError(
            f"{path} describes no training run: it needs {', '.join(sorted(expected))}; train the run anew"
        )
    try:
        return Configuration(**record)
    except ValueError as error:
        raise ValueError(f"{path}: {error}, or train the run anew") from error


def is_complete(folder: str | Path) -> bool:
    """Return whether the training in `folder` has run to its end."""
    return (Path(folder) / TIMING).is_file()


def read_evaluations(folder: Path) -> dict[str, np.ndarray]:
    """Read the history of a run's validations: steps (n,), and returns and lengths (n, episodes).

    Raises:
        OSError: The file cannot be read.
        ValueError: It is not whole, or no such history.
    """
    path = folder / EVALUATIONS
    try:
        arrays = read_arrays(path, lambda name: name in HISTORY)
        if set(arrays) != set(HISTORY) or arrays["results"].ndim != 2:
            raise ValueError(f"it holds {sorted(arrays)}")
    except ValueError as error:
        raise ValueError(f"{path} is no history of validations ({error}); train the run anew") from error
    return arrays


def best_policy(folder: str | Path) -> ShippedPolicy:
    """Read the best policy of the run in `folder`.

    Raises:
        FileNotFoundError: There is no run, or it was interrupted before its first validation.
        ValueError: A file is not whole; the message names it.
    """
    if not (Path(folder) / shipped.DESCRIPTION).is_file():
        read_config(folder)
        raise FileNotFoundError(f"{folder} has no policy; the run ended before its first validation, resume it")
    try:
        return shipped.load_shipped(Path(folder).resolve())
    except ValueError as error:
        raise ValueError(f"{error}; resume the run, or train it anew") from error


def jsonable(mapping: Mapping[str, object]) -> Keywords:
    """Return `mapping` as it reads after a round trip through JSON (tuples become lists)."""
    return json.loads(json.dumps(mapping))
