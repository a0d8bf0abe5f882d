"""Run folders: the files that a training run leaves, and the loading of its policy."""

import io
import json
import re
import warnings
from collections.abc import Mapping
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm

from agents.environments import NAMESPACE, environment_settings, make_env
from agents.learning.trust import (
    SEAL,
    DamagedFileError,
    UntrustedFileError,
    check_record,
    sealed,
    sealed_record,
    trust,
    unsealed,
)
from agents.learning.weight_search import CMAES, WeightSearch
from agents.torque_laws import Signals
from solar_env.support.files import check_name, make_folder, write_bytes, write_text
from solar_env.support.interruption import deaf
from solar_env.support.numbers import is_whole_number
from solar_env.support.plain_arrays import read_arrays, read_json
from solar_env.support.rules import Rule, check_values

LIBRARIES = ("gymnasium", "stable-baselines3", "torch")  # whose versions policies depend on, beside those of all
ALGORITHMS: dict[str, type[BaseAlgorithm]] = {
    "ppo": PPO,
    "sac": SAC,
    "td3": TD3,
    "ars": WeightSearch,
    "cma-es": CMAES,
}

_RULES = (
    Rule(("algo",), lambda value: value in [*ALGORITHMS], f"one of {', '.join(ALGORITHMS)}"),
    Rule(
        ("env_id",),
        lambda value: isinstance(value, str) and value.startswith(NAMESPACE),
        "an environment of solar_env",
    ),
    Rule(("command",), lambda value: isinstance(value, str), "a text"),
    Rule(("env_kwargs", "hyperparameters", "versions"), lambda value: isinstance(value, dict), "a mapping"),
    Rule(("n_envs", "timesteps"), lambda value: is_whole_number(value, 1), "a positive whole number"),
    Rule(("seed", "timesteps_before"), lambda value: is_whole_number(value, 0), "a whole number, not negative"),
    Rule(("resumed_from",), lambda value: value is None or isinstance(value, str), "a folder or null"),
)

CONFIG = "config.json"
POLICY = "policy.zip"
CHECKPOINTS = ("checkpoint.pkl", "checkpoint-previous.pkl")  # newest first
EVALUATIONS = "evaluations.npz"
HISTORY = ("timesteps", "results", "ep_lengths")  # its arrays
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
        OSError: It cannot be made.
    """
    name = f"{re.sub(r'[^A-Za-z0-9.-]+', '-', env_id)}__{algo}__{seed}__{datetime.now():%Y%m%d-%H%M%S}"
    folder = Path(out) if out else Path("runs") / name
    check_name(folder)
    if (folder / CONFIG).exists():
        raise FileExistsError(f"{folder} holds a run already; choose another --out, or go on from it with --resume")
    return make_folder(folder)


def write_json(path: Path, content: Any) -> None:
    """Write `content` as indented JSON."""
    write_text(path, json.dumps(content, indent=2, allow_nan=False) + "\n")


def write_config(folder: Path, record: Mapping[str, Any]) -> None:
    """Write the configuration of a run, sealed as one that was made on this account."""
    write_json(folder / CONFIG, sealed_record(record))


class Record(dict[str, Any]):
    """Content of a run's configuration file: a DamagedFileError tells what is asked for and not there."""

    def __init__(self, values: Mapping[str, Any], path: Path) -> None:
        super().__init__(values)
        self._path = path

    def __missing__(self, name: str) -> Any:
        raise DamagedFileError(f"{self._path} says nothing of {name}: an older version trained it; train it anew")


def read_config(folder: str | Path) -> Record:
    """Read the configuration of the run in `folder`.

    Raises:
        FileNotFoundError: `folder` is not a run folder.
        DamagedFileError: The file is not whole, describes no run, or has a value of another kind.
        UntrustedFileError: The run was not made on this account, and not taken over by `trust_run`.
    """
    path = Path(folder) / CONFIG
    if not path.is_file():
        raise FileNotFoundError(f"{folder} is not a run folder: it has no {CONFIG}; train.py writes such folders")
    try:
        record = read_json(path)
    except ValueError as error:
        raise DamagedFileError(str(error)) from error
    if not isinstance(record, dict) or not {"env_id", "env_kwargs", "algo"} <= set(record):
        raise DamagedFileError(f"{path} describes no training run; name a folder that train.py has written")
    check_record(record, path)
    if record.get("residual"):
        raise DamagedFileError(f"{path} is of an agent that adds to a law, as none does any more; train anew")
    try:
        check_values(record, _RULES)
    except ValueError as error:
        raise DamagedFileError(f"{path}: {error}, or train the run anew") from error
    return Record({name: value for name, value in record.items() if name != SEAL}, path)


def trust_run(folder: str | Path) -> None:
    """Take over a run that was made elsewhere: seal its files as this user's. Only for runs whose author you trust.

    Raises:
        FileNotFoundError: `folder` is not a run folder.
        DamagedFileError: One of its files is not whole.
        OSError: A file cannot be written.
    """
    with suppress(UntrustedFileError):
        read_config(folder)
    trust(Path(folder), CONFIG, (POLICY, *CHECKPOINTS))


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


def check_policy(folder: str | Path) -> None:
    """Refuse a run whose policy cannot be loaded, before any work that needs it.

    Raises:
        FileNotFoundError, DamagedFileError, UntrustedFileError: As `load_policy`.
    """
    _saved_policy(folder)


def _saved_policy(folder: str | Path) -> BaseAlgorithm:
    path, config = policy_path(folder), read_config(folder)
    model = loaded_model(config["algo"], io.BytesIO(unsealed(path)), path, device="cpu")
    observed = environment_settings(config["env_id"], config["env_kwargs"]).observation_space()
    if model.observation_space != observed:
        entries, others = (space.shape for space in (model.observation_space, observed))
        raise DamagedFileError(
            f"{path} observes {entries} values that are not the {others} of the {CONFIG} beside it; train anew"
        )
    return model


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


def save_policy(folder: Path, model: BaseAlgorithm) -> None:
    """Write the network as the best one of the run in `folder`."""
    file = io.BytesIO()
    with deaf():  # torch takes an interruption for a fault of its own
        model.save(file)
        write_bytes(folder / POLICY, sealed(file.getvalue()))


def load_policy(folder: str | Path, env: gymnasium.Env) -> BaseAlgorithm:
    """Load the best policy of the run in `folder`, for use on `env`: a pickle, of runs of this account alone.

    Raises:
        FileNotFoundError: There is no run, or it was interrupted before its first validation.
        DamagedFileError: The policy's file is not whole, or other versions wrote it.
        UntrustedFileError: The run was not made on this account, see `trust_run`.
        ValueError: Observations or actions of `env` have another meaning than in training.
    """
    policy, config = _saved_policy(folder), read_config(folder)
    with make_env(config["env_id"], config["env_kwargs"]) as trained:
        Signals.of(trained).check(env, f"{config['env_id']} with {config['env_kwargs']}")
    return policy


def loaded_model(algo: str, file: io.BytesIO, source: str | Path, **keywords: Any) -> BaseAlgorithm:
    """Load what Stable-Baselines3 saved of a model; keywords are those of its `load`, `source` is told in errors.

    Raises:
        DamagedFileError: It is damaged, of another algorithm, or these versions cannot load it.
    """
    kind = algorithm(algo)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", "Could not deserialize")
            return kind.load(file, **keywords)
    except Exception as error:  # of what other versions saved, unpickling may raise anything
        reason = " ".join(str(error).replace(f"the file {file!r}", "it").split())[:200]
        raise DamagedFileError(
            f"{source} holds no model of {algo} that these versions can load ({reason}); train anew, or install the "
            f"versions that its {CONFIG} names"
        ) from error


def linear_weights(folder: str | Path, env: gymnasium.Env) -> list[float]:
    """Weights of the best policy of a search over weights, to begin another training on `env` with.

    Raises:
        FileNotFoundError, DamagedFileError, UntrustedFileError: As `load_policy`.
        ValueError: The run was no such search, or observations or actions of `env` have another meaning.
    """
    model = load_policy(folder, env)
    if not isinstance(model, WeightSearch):
        searches = ", ".join(name for name, cls in ALGORITHMS.items() if issubclass(cls, WeightSearch))
        raise ValueError(
            f"{folder} is a run of {read_config(folder)['algo']}; training can begin with one of {searches}"
        )
    return torch.nn.utils.parameters_to_vector(model.policy.parameters()).tolist()


def jsonable(mapping: Mapping[str, Any]) -> dict[str, Any]:
    """Return `mapping` as it reads after a round trip through JSON (tuples become lists)."""
    return json.loads(json.dumps(mapping))
