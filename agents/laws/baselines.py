"""Torque laws by name, with the parameters that tuning has found for an environment id and a model."""

import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import gymnasium

from agents.configs import CONFIGS
from agents.laws.table import LAWS, TUNABLE
from agents.torque_laws import Controller, LawParameters, Signals
from solar_env.array import ModelLevel
from solar_env.support.files import write_text
from solar_env.support.plain_arrays import read_json

FALLBACK_MODEL = "rigid-clearance"
"""Model whose tuned parameters serve the models without tuned parameters."""


class UntunedWarning(UserWarning):
    """Warning that a law uses parameters that were tuned for another model, or for a motor on another hinge."""


def load_parameters(name: str, env_id: str, model: str) -> LawParameters:
    """Read the tuned parameters of the law `name` for a model of `env_id` from `agents/configs/<name>.json`.

    `model` is a name such as "flexible-clearance", without a number of modes or elements. A model without tuned
    parameters gets, with a warning, parameters for `FALLBACK_MODEL`, which deploy the array but are not the best.

    Raises:
        ValueError: The file has no usable entry for `env_id`, or its keys are not the law's parameters.
    """
    entry, source = _entry(name, env_id, model)
    if source != model:
        warnings.warn(
            f"no parameters of {name!r} have been tuned for {model}; it gets those for {source}",
            UntunedWarning,
            stacklevel=2,
        )
    try:
        return TUNABLE[name].defaults.from_json(entry["parameters"])
    except ValueError as error:
        raise ValueError(f"{name}.json, {env_id!r}, {source!r}: {error}") from error


def store_parameters(name: str, env_id: str, model: str, entry: Mapping[str, object]) -> Path:
    """Write a tuning result to the law's JSON file, under its environment id and model; return the file's path."""
    entries, path = _entries(name), CONFIGS / f"{name}.json"
    entries.setdefault(env_id, {})[model] = entry
    write_text(path, json.dumps(entries, indent=2, allow_nan=False) + "\n")
    return path


def tuning_of(name: str, env_id: str, model: str) -> dict[str, Any]:
    """Return the record of the tuning run that found the parameters that `load_parameters` reads."""
    return _entry(name, env_id, model)[0]["tuning"]


def _entries(name: str) -> dict[str, Any]:
    """Read a law's tuning results, nested by environment id and the array's model; return {} if there is no file."""
    path = CONFIGS / f"{name}.json"
    return read_json(path) if path.exists() else {}


def _entry(name: str, env_id: str, model: str) -> tuple[dict[str, Any], str]:
    """Return a law's stored parameters and tuning record for `model`, else `FALLBACK_MODEL`, and that model's name."""
    entries, (stem, _, _) = _entries(name), env_id.rpartition("-")
    by_model = entries.get(env_id) or entries.get(f"{stem}-v1", {})
    source = model if model in by_model else FALLBACK_MODEL
    if source not in by_model:
        raise ValueError(
            f"{name}.json holds no parameters for {env_id!r} with model {model!r}; run: solar-env tune "
            f"--controller {name} --env-id {env_id} --model {model}"
        )
    return by_model[source], source


def make_baseline(name: str, env: gymnasium.Env, parameters: LawParameters | None = None) -> Controller:
    """Make the torque law `name` for `env`; laws of `TUNABLE` take `parameters`.

    By default the parameters are the ones tuned for the environment's model. A model without tuned parameters gets,
    with a warning, the parameters for the rigid array with clearance; see `load_parameters`.

    Raises:
        ValueError: The name is not in `LAWS`, or no parameters have been tuned for the environment.
    """
    if name not in LAWS:
        raise ValueError(f"no baseline {name!r}; available: {', '.join(LAWS)}")
    signals = Signals.of(env)
    if name not in TUNABLE:
        return LAWS[name](signals)
    if signals.driven_joint in range(1, len(signals.lock_angles)) and not parameters:
        warnings.warn(
            f"{name!r} was tuned with the motor on the root hinge, not on joint {signals.driven_joint + 1}; tune it: "
            f"solar-env tune --controller {name} --env-kwargs driven_joint={signals.driven_joint}",
            UntunedWarning,
            stacklevel=2,
        )
    model: str = ModelLevel.of(env.unwrapped.model).name  # type: ignore[attr-defined]
    return TUNABLE[name](signals, parameters or load_parameters(name, env.spec.id if env.spec else "", model))
