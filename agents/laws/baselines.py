"""The baselines by name, with the parameters that tuning has found for a scenario and a model."""

import json
import warnings
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import gymnasium

from agents.torque_laws import (
    BrakeParameters,
    ConstantBrake,
    DamperParameters,
    InputShapedProfile,
    OpenLoopParameters,
    OpenLoopTorque,
    Passive,
    ServoParameters,
    ShapedProfileParameters,
    Signals,
    SoftStartServo,
    TorqueLaw,
    TunableLaw,
    VelocityProfileServo,
    ViscousDamper,
)

CONFIGS = Path(__file__).parents[1] / "configs"
FALLBACK_MODEL = "rigid-clearance"  # whose parameters a model without its own gets

Parameters = BrakeParameters | DamperParameters | ServoParameters | ShapedProfileParameters | OpenLoopParameters

TUNABLE: dict[str, type[TunableLaw[Any]]] = {
    "brake": ConstantBrake,
    "damper": ViscousDamper,
    "servo": VelocityProfileServo,
    "shaped": InputShapedProfile,
    "open-loop": OpenLoopTorque,
    "soft-start": SoftStartServo,
}
BASELINES = ("passive", *TUNABLE, "servo-untuned")


def load_parameters(name: str, env_id: str, model: str) -> Parameters:
    """Tuned parameters of the baseline `name` for a model of `env_id` from ``agents/configs/<name>.json``.

    Parameters are tuned for one model and any number of elements. A model that has none gets those of
    `FALLBACK_MODEL`, with a warning: they deploy the array, but are not the best that the baseline can do there.

    Raises:
        ValueError: the file has no entry for `env_id` that would do, or its keys are not those of the law.
    """
    entry, source = _entry(name, env_id, model)
    if source != model:
        warnings.warn(
            f"no parameters of {name!r} have been tuned for {model}; it gets those for {source}. To tune: "
            + _command(name, env_id, model),
            stacklevel=2,
        )
    try:
        return read_parameters(name, entry["parameters"])
    except ValueError as error:
        raise ValueError(f"{name}.json, {env_id!r}, {source!r}: {error}") from error


def episodes_spent(name: str, env_id: str, model: str) -> int:
    """Training episodes that the parameters of `load_parameters` have cost, those of what they were refined from too.

    Raises:
        ValueError: the file has no entry for `env_id` that would do.
    """
    tuning = _entry(name, env_id, model)[0]["tuning"]
    return tuning.get("training_episodes_with_start", tuning["training_episodes"])


def _entry(name: str, env_id: str, model: str) -> tuple[dict[str, Any], str]:
    """What ``agents/configs/<name>.json`` holds, and for which model."""
    path = CONFIGS / f"{name}.json"
    by_model = (json.loads(path.read_text()) if path.exists() else {}).get(env_id, {})
    source = model if model in by_model else FALLBACK_MODEL
    if source not in by_model:
        raise ValueError(
            f"{path.name} holds no parameters for {env_id!r} with model {model!r}; run: "
            + _command(name, env_id, model)
        )
    return by_model[source], source


def _command(name: str, env_id: str, model: str) -> str:
    return f"python -m agents.tune --controller {name} --env-id {env_id} --model {model}"


def read_parameters(name: str, values: Mapping[str, Any]) -> Parameters:
    """Parameters of the law `name` from values as JSON keeps them.

    Raises:
        ValueError: the keys are not those of the law.
    """
    cls = type(TUNABLE[name].defaults)
    expected = {f.name for f in fields(cls)}
    if set(values) != expected:
        raise ValueError(f"the keys are {sorted(values)}; expected {sorted(expected)}")
    return cls(**{key: tuple(value) if isinstance(value, list) else value for key, value in values.items()})


def make_baseline(name: str, env: gymnasium.Env, parameters: Parameters | None = None) -> TorqueLaw:
    """The baseline `name` for `env`; those of `TUNABLE` take `parameters`.

    By default these are the ones tuned for the environment's own model or, with a warning, those for the rigid
    array with clearance where that model has none; see `load_parameters`.

    Raises:
        ValueError: the name is not one of `BASELINES`, or there are no tuned parameters for the environment.
    """
    signals = Signals.of(env)
    if name == "passive":
        return Passive(signals)
    if name == "servo-untuned":
        return VelocityProfileServo(signals)
    if name not in TUNABLE:
        raise ValueError(f"no baseline {name!r}; available: {', '.join(BASELINES)}")
    unwrapped: Any = env.unwrapped
    return TUNABLE[name](signals, parameters or load_parameters(name, env.spec.id if env.spec else "", unwrapped.model))
