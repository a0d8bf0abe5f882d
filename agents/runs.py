"""Run folders: the files that a training run leaves, and the loading of its policy."""

import json
import platform
import re
import shutil
from collections.abc import Mapping
from datetime import datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import gymnasium
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm

from agents.environments import make_env
from agents.laws.residual import ResidualController
from agents.torque_laws import Controller, Signals

ALGORITHMS: dict[str, type[BaseAlgorithm]] = {"ppo": PPO, "sac": SAC, "td3": TD3}

CONFIG = "config.json"
POLICY = "policy.zip"
CHECKPOINT = "checkpoint"
TIMING = "timing.json"  # written last: the run is complete


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
    """
    name = f"{re.sub(r'[^A-Za-z0-9.-]+', '-', env_id)}__{algo}__{seed}__{datetime.now():%Y%m%d-%H%M%S}"
    folder = Path(out) if out else Path("runs") / name
    if (folder / CONFIG).exists():
        raise FileExistsError(f"{folder} holds a run already; choose another --out, or go on from it with --resume")
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def write_json(path: Path, content: Any) -> None:
    """Write `content` as indented JSON."""
    path.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n")


def read_config(folder: str | Path) -> dict[str, Any]:
    """Read the configuration of the run in `folder`.

    Raises:
        FileNotFoundError: `folder` is not a run folder.
    """
    path = Path(folder) / CONFIG
    if not path.is_file():
        raise FileNotFoundError(f"{folder} is not a run folder: it has no {CONFIG}; train.py writes such folders")
    return json.loads(path.read_text())


def is_complete(folder: str | Path) -> bool:
    """Return whether the training in `folder` has run to its end."""
    return (Path(folder) / TIMING).is_file()


def discard_incomplete(folder: str | Path) -> None:
    """Remove the run in `folder` if it was interrupted; anything else stays."""
    if (Path(folder) / CONFIG).is_file() and not is_complete(folder):
        shutil.rmtree(folder)


def policy_path(folder: str | Path) -> Path:
    """Return the file of the best policy of the run in `folder`.

    Raises:
        FileNotFoundError: There is no run, or it was interrupted before its first validation.
    """
    read_config(folder)
    path = Path(folder) / POLICY
    if not path.is_file():
        raise FileNotFoundError(f"{folder} has no {POLICY}; the run ended before its first validation, resume it")
    return path


def load_policy(folder: str | Path, env: gymnasium.Env) -> Controller:
    """Load the best policy of the run in `folder`, with the law that it adds to if there is one, for use on `env`.

    Raises:
        FileNotFoundError, ValueError: As `load_model`.
    """
    residual, model = read_config(folder)["residual"], load_model(folder, env)
    return ResidualController(model, residual, Signals.of(env)) if residual else model


def load_model(folder: str | Path, env: gymnasium.Env) -> BaseAlgorithm:
    """Load the network of the run in `folder`, for use on `env`. Load only runs you trust: it is a pickle.

    Raises:
        FileNotFoundError: There is no run, or it was interrupted before its first validation.
        ValueError: Observations or actions of `env` have another meaning than in training.
    """
    path, config = policy_path(folder), read_config(folder)
    with make_env(config["env_id"], config["env_kwargs"]) as trained:
        Signals.of(trained).check(env, f"{config['env_id']} with {config['env_kwargs']}")
    return algorithm(config["algo"]).load(path, device="cpu")


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that results depend on."""
    names = ("solar-env", "stable-baselines3", "torch", "gymnasium", "numba", "numpy", "scipy")
    found = {"python": platform.python_version(), "platform": platform.platform()}
    for name in names:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "not installed as a package"
    return found


def jsonable(mapping: Mapping[str, Any]) -> dict[str, Any]:
    """Return `mapping` as it reads after a round trip through JSON (tuples become lists)."""
    return json.loads(json.dumps(mapping))
