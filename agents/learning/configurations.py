"""What is to be trained: the configurations in agents/configs, with what is asked for in place of what they say."""

import inspect
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from agents import runs
from agents.environments import EPISODES_PER_SEED, episode_seeds, make_env, with_sampling
from agents.laws.baselines import CONFIGS
from agents.laws.residual import DEFAULT_LAW, residual_on

# Arguments of the Stable-Baselines3 classes that say other things than how to learn.
NOT_HYPERPARAMETERS = {"policy", "env", "seed", "device", "verbose", "tensorboard_log", "_init_setup_model"} | {
    f"{kind}_buffer_{part}" for kind in ("replay", "rollout") for part in ("class", "kwargs")
}
COUNTS = {"batch_size", "buffer_size", "n_epochs", "n_steps", "policy_delay", "train_freq"}
SHARES = {"gamma", "tau"}


@dataclass(frozen=True)
class Configuration:
    """What determines a training run.

    Attributes:
        algo: Name of the algorithm: ppo, sac or td3.
        env_id: Environment id.
        env_kwargs: Environment keywords, with the ranges to randomise.
        seed: Run seed; networks, exploration and episodes follow from it.
        n_envs: Environments stepped together.
        timesteps: Environment steps to train for; those of a resumed run come on top of earlier ones.
        hyperparameters: Keywords of the Stable-Baselines3 class, and for SAC and TD3 `actor_learning_rate`, in place
            of the `learning_rate` that is then the critics' alone, and `exploration_noise`, the standard deviation of
            an action noise, see `learn.make_model`. Learning rates are those of the first update and fall
            linearly to zero; a resumed run takes them up at the share of all steps, earlier ones included, that is
            left.
        residual: What the agent adds to, see `agents.laws.residual.residual_on`; None if it commands the whole torque.
        landings: Episodes of that law alone that training begins with, see `agents.learning.landings`; 0 without a law.
        segments: Number of times that training has been resumed.
    """

    algo: str
    env_id: str
    env_kwargs: dict[str, Any]
    seed: int
    n_envs: int
    timesteps: int
    hyperparameters: dict[str, Any]
    residual: dict[str, Any] | None = None
    landings: int = 0
    segments: int = 0

    def __post_init__(self) -> None:
        recorded = (self.segments + 1) * self.landings
        if recorded > EPISODES_PER_SEED:
            raise ValueError(
                f"landings is {self.landings}: with those of runs it goes on from that makes {recorded}, but a seed "
                f"has {EPISODES_PER_SEED:,} episodes; give fewer, or begin a new run"
            )


def entry(algo: str, env_id: str, whole: bool = False) -> dict[str, Any]:
    """What ``agents/configs/<algo>.json`` holds for `env_id`.

    That is for an agent that adds to a law; if it commands the `whole` torque, what is under "whole_torque" goes first.

    Raises:
        ValueError: there is nothing for it.
    """
    entries = json.loads((CONFIGS / f"{algo}.json").read_text())
    if env_id not in entries:
        raise ValueError(f"{algo}.json has no hyperparameters for {env_id!r}; it has {', '.join(entries)}")
    found = dict(entries[env_id])
    of_whole = found.pop("whole_torque")
    if whole:
        found.pop("search", None)
        found |= of_whole
    return found


def configuration(
    algo: str,
    env_id: str,
    env_kwargs: Mapping[str, Any],
    seed: int,
    n_envs: int | None = None,
    timesteps: int | None = None,
    hyperparameters: Mapping[str, Any] | None = None,
    residual: float | None = None,
    landings: int | None = None,
    law: str | None = None,
    law_model: str | None = None,
) -> Configuration:
    """The configuration in ``agents/configs/<algo>.json`` for `env_id`, with what is given here in its place.

    Args:
        algo, env_id, env_kwargs, seed, n_envs, timesteps: See `Configuration`.
        hyperparameters: In place of single ones of the configuration's, and single "policy_kwargs" of its.
        residual: Greatest action that the agent adds to the law, as a share of the torque limit; 0: no law.
        landings: See `Configuration`; there are none without a law.
        law: What the agent adds to, a name in `agents.laws.baselines.TUNABLE`; None: the servo.
        law_model: Model whose tuned parameters the law has; None: that of the environment.

    Raises:
        ValueError: algorithm, environment, one of its keywords or a hyperparameter is unknown, or a number is
            out of range.
    """
    accepted = set(inspect.signature(runs.algorithm(algo)).parameters) - NOT_HYPERPARAMETERS
    if "action_noise" in accepted:
        accepted = accepted - {"action_noise"} | {"exploration_noise", "actor_learning_rate"}
    scale = entry(algo, env_id)["residual"] if residual is None else residual
    found = entry(algo, env_id, whole=not scale)
    for name, value in (hyperparameters or {}).items():
        if name not in accepted:
            raise ValueError(f"{algo} has no hyperparameter {name!r}; it has {', '.join(sorted(accepted))}")
        _check_hyperparameter(name, value)
    n_envs = found["n_envs"] if n_envs is None else n_envs
    timesteps = found["timesteps"] if timesteps is None else timesteps
    _check_positive("n_envs", n_envs)
    _check_positive("timesteps", timesteps)
    env_kwargs = {"observation": found["observation"], **env_kwargs}
    # Refuse a wrong seed or environment keyword now, not once a run folder exists.
    episode_seeds("training", seed, n_envs)
    with make_env(env_id, env_kwargs) as env:
        model = env.get_wrapper_attr("model")
    if landings and not scale:
        raise ValueError(f"landings is {landings}, but with residual 0 there is no law to land the array; leave it out")
    if law and not scale:
        raise ValueError(f"law is {law!r}, but with residual 0 the agent adds to none; leave one of them out")
    recorded = (found["landings"] if landings is None else landings) if scale else 0
    if scale:
        _check_positive("landings", recorded)
    chosen = {**found["hyperparameters"], **(hyperparameters or {})}
    if "policy_kwargs" in found["hyperparameters"]:
        chosen["policy_kwargs"] = {**found["hyperparameters"]["policy_kwargs"], **chosen["policy_kwargs"]}
    return Configuration(
        algo=algo,
        env_id=env_id,
        env_kwargs=runs.jsonable(with_sampling(env_kwargs, env_id)),
        seed=seed,
        n_envs=n_envs,
        timesteps=timesteps,
        hyperparameters=chosen,
        residual=residual_on(scale, law or DEFAULT_LAW, env_id, law_model or model, recorded) if scale else None,
        landings=recorded,
    )


def stored_configuration(folder: str | Path) -> Configuration:
    """The configuration of the run in `folder`.

    Raises:
        FileNotFoundError: `folder` holds no run.
        ValueError: the run is of a version that kept less.
    """
    stored = runs.read_config(folder)
    names = inspect.signature(Configuration).parameters
    if missing := [name for name in names if name not in stored]:
        raise ValueError(f"{folder} says nothing of {', '.join(missing)}: an older version trained it; train it anew")
    return Configuration(**{name: stored[name] for name in names})


def resumed_configuration(folder: str | Path, timesteps: int | None = None) -> Configuration:
    """The configuration of the run in `folder`, to train on for `timesteps`, by default as many as before.

    What it records of its law's landings is counted with what the law has cost.

    Raises:
        FileNotFoundError, ValueError: as `stored_configuration`.
        ValueError: the number of steps is not positive, or there are no episodes left to record.
    """
    previous = stored_configuration(folder)
    timesteps = previous.timesteps if timesteps is None else timesteps
    _check_positive("timesteps", timesteps)
    residual = previous.residual
    if residual is not None:
        residual = {**residual, "tuning_episodes": residual["tuning_episodes"] + previous.landings}
    return replace(previous, timesteps=timesteps, segments=previous.segments + 1, residual=residual)


def _check_positive(name: str, number: int) -> None:
    if number < 1:
        raise ValueError(f"{name} is {number}; give a positive number")


def _check_hyperparameter(name: str, value: Any) -> None:
    """What Stable-Baselines3 would only notice in the middle of a training, if at all."""
    number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    if name == "learning_rate" and not (number and value >= 0):
        raise ValueError(f"hyperparameter {name} is {value!r}; give a positive number, or 0 to learn nothing")
    if name == "exploration_noise" and not (number and value >= 0):
        raise ValueError(f"hyperparameter {name} is {value!r}; give a positive number, or 0 for none")
    if name == "policy_kwargs" and not isinstance(value, Mapping):
        raise ValueError(f"hyperparameter {name} is {value!r}; give a dictionary")
    if name == "actor_learning_rate" and not (number and value > 0):
        raise ValueError(f"hyperparameter {name} is {value!r}; give a positive number")
    if name in COUNTS and not (number and value == int(value) >= 1):
        raise ValueError(f"hyperparameter {name} is {value!r}; give a positive whole number")
    if name in SHARES and not (number and 0 < value <= 1):
        raise ValueError(f"hyperparameter {name} is {value!r}; give a number above 0, at most 1")
