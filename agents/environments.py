"""Environments on which controllers are tuned, trained and evaluated: keywords, settings and episode seeds."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Literal

import gymnasium

import solar_env  # noqa: F401  (registers the environment ids)
from solar_env.array import RELEASE_RATE
from solar_env.environment.registration import DEPLOY
from solar_env.environment.settings import EnvironmentSettings

NAMESPACE = "solar_env/"  # beginning of the environment ids
DEFAULT_ENV_ID = DEPLOY
Keywords = dict[str, Any]

# Model of evaluations and searches: its peak forces have converged, and no flexible level is cheaper.
MODEL: Mapping[str, str] = {"model": "flexible-clearance"}
# Algorithms that learn from single steps need more episodes than the cost of flexible panels allows.
RIGID: Mapping[str, str] = {"model": "rigid-clearance"}

# The nominal scenario is deterministic, and impacts are chaotic: the results of a single deployment would be arbitrary.
# Episodes therefore differ in the joints' release rates, like the members of all ensembles in this project. Moving a
# hinge by micrometres would not suffice: episodes would share their first seconds, and the errors of these seconds.
SAMPLED = "initial_rate"

# Keywords of observation, action and control period, in which controllers differ.
INTERFACE = ("observation", "action", "control_period")
OF_LAWS: Mapping[str, object] = {"observation": "drive", "action": "torque", "control_period": 0.1}

Purpose = Literal["training", "validation", "evaluation"]
_BLOCKS: dict[Purpose, int] = {"training": 0, "validation": 1, "evaluation": 2}
_BLOCK_SIZE = 1_000_000_000
EPISODES_PER_SEED = 10_000


def with_sampling(env_kwargs: Mapping[str, object], env_id: str = DEFAULT_ENV_ID) -> Keywords:
    """Return `env_kwargs` with random release rates of joints, unless `env_kwargs` or the scenario give random ranges.

    Raises:
        ValueError: The environment refuses a keyword. `env_kwargs` contains `max_episode_steps`, which would cut
            episodes off before joints latch. `env_kwargs` contains `scenario`; choose the scenario by the environment
            id, because tuned parameters are looked up by id.
    """
    if "scenario" in env_kwargs:
        raise ValueError(
            f"scenario={env_kwargs['scenario']!r}: what is tuned and trained for a scenario is found by environment id;"
            f" leave the keyword out and choose --env-id, one of {', '.join(_registered())}"
        )
    if "max_episode_steps" in env_kwargs:
        raise ValueError(
            "episodes that max_episode_steps cuts off have no landing to judge; set deadline and settling_window"
        )
    if "randomize" in env_kwargs:
        return dict(env_kwargs)
    settings = environment_settings(env_id, env_kwargs)
    if settings.randomize:
        return dict(env_kwargs)
    nominal = settings.array.for_each_joint(SAMPLED)
    low, high = (tuple(rate + change for rate in nominal) for change in (-RELEASE_RATE, RELEASE_RATE))
    return {"randomize": {SAMPLED: (low, high)}, **env_kwargs}


def with_interface(env_kwargs: Mapping[str, object], controller: str, interface: Mapping[str, object]) -> Keywords:
    """Return `env_kwargs` with a controller's interface: observation, action and control period.

    Raises:
        ValueError: `env_kwargs` contain a keyword of the interface with another value; the error names `controller`.
    """
    for name, value in interface.items():
        if env_kwargs.get(name, value) != value:
            raise ValueError(
                f"--env-kwargs {name}={env_kwargs[name]!r} does not go with --controllers {controller}, which has "
                f"{name}={value!r}: leave out one of them"
            )
    return {**env_kwargs, **interface}


def environment_settings(
    env_id: str = DEFAULT_ENV_ID, env_kwargs: Mapping[str, object] | None = None
) -> EnvironmentSettings:
    """Check the keywords of an environment; return its settings, such as model and task, without making it.

    Raises:
        ValueError: As in `make_env`.
    """

    def settings(**keywords: object) -> EnvironmentSettings:
        return EnvironmentSettings.of({**gymnasium.spec(env_id).kwargs, **keywords})

    return _made(settings, env_id, env_kwargs)


def make_env(env_id: str = DEFAULT_ENV_ID, env_kwargs: Mapping[str, object] | None = None) -> gymnasium.Env:
    """Make an environment by `gymnasium.make`, with errors that say what to do.

    Raises:
        ValueError: The id is not registered, or the environment refuses a keyword or its value.
    """
    return _made(partial(gymnasium.make, env_id), env_id, env_kwargs)


def _made(make: Callable[..., Any], env_id: str, env_kwargs: Mapping[str, object] | None) -> Any:
    if env_id not in gymnasium.registry:  # Gymnasium itself would import the module that an id names
        raise ValueError(f"no environment {env_id!r} is registered; available: {', '.join(_registered())}")
    try:
        return make(**dict(env_kwargs or {}))
    except (TypeError, ValueError, gymnasium.error.Error) as error:
        names = ", ".join(env_kwargs or {})
        raise ValueError(f"environment {env_id!r} refused one of its keywords ({names}): {error}") from error


def _registered() -> list[str]:
    return sorted(name for name in gymnasium.registry if name.startswith(NAMESPACE))


def episode_seeds(purpose: Purpose, seed: int, count: int) -> list[int]:
    """List `count` environment seeds; two purposes, or two values of `seed`, never have a seed in common.

    Raises:
        ValueError: `seed` is outside 0 .. 99 999 or `count` outside 1 .. 10 000.
    """
    seeds_per_block = _BLOCK_SIZE // EPISODES_PER_SEED
    if not 0 <= seed < seeds_per_block:
        raise ValueError(f"seed is {seed}; choose one from 0 to {seeds_per_block - 1}")
    if not 1 <= count <= EPISODES_PER_SEED:
        raise ValueError(f"the number of episodes is {count}; choose one from 1 to {EPISODES_PER_SEED}")
    start = _BLOCKS[purpose] * _BLOCK_SIZE + seed * EPISODES_PER_SEED
    return list(range(start, start + count))
