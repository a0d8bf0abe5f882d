"""Environments that controllers are tuned, trained and evaluated on: their keywords, their settings, their seeds."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Literal

import gymnasium

import solar_env  # noqa: F401  (registers the environment ids)
from solar_env.array import MODELS, has_flexible_panels
from solar_env.array.parameters.ranges import RELEASE_RATE
from solar_env.environment.registration import DEPLOY
from solar_env.environment.settings import EnvironmentSettings
from solar_env.support.numbers import plain

NAMESPACE = "solar_env/"  # of the environment ids
DEFAULT_ENV_ID = DEPLOY

# The nominal scenario is deterministic, and impacts are chaotic: the figures of a single deployment would be arbitrary.
# Episodes therefore differ in the rates at which the joints are released, as the members of all ensembles here. In the
# place of a hinge by micrometres would not do: they would share their first seconds, and the errors of these.
SAMPLED = "initial_rate"

# They say what is observed, what an action is and how long it holds: each controller has its own.
INTERFACE = ("observation", "action", "control_period")

# One of them says how panels are modelled, and two may contradict each other.
PANEL_KEYWORDS = ("panels", "elements", "modes")

Purpose = Literal["training", "validation", "evaluation"]
_BLOCKS: dict[Purpose, int] = {"training": 0, "validation": 1, "evaluation": 2}
_BLOCK_SIZE = 1_000_000_000
EPISODES_PER_SEED = 10_000


def with_sampling(env_kwargs: Mapping[str, Any], env_id: str = DEFAULT_ENV_ID) -> dict[str, Any]:
    """Return `env_kwargs` with the joints' release rates drawn, unless they or the scenario name ranges to draw from.

    Raises:
        ValueError: The environment refuses its keywords; `max_episode_steps` would cut episodes off before the landing;
            or the scenario is given as a keyword, while tuned parameters are found by environment id.
    """
    if "scenario" in env_kwargs:
        raise ValueError(
            f"scenario={env_kwargs['scenario']!r}: what is tuned and trained for a scenario is found by environment id;"
            f" leave the keyword out and choose --env-id, one of {', '.join(_registered())}"
        )
    if "max_episode_steps" in env_kwargs:
        raise ValueError(
            "episodes that max_episode_steps cuts off have no landing to judge; set deadline and postlock_window"
        )
    if "randomize" in env_kwargs:
        return dict(env_kwargs)
    settings = environment_settings(env_id, env_kwargs)
    if settings.randomize:
        return dict(env_kwargs)
    nominal = settings.array.for_each_joint(SAMPLED)
    low, high = (tuple(rate + change for rate in nominal) for change in (-RELEASE_RATE, RELEASE_RATE))
    return {"randomize": {SAMPLED: (low, high)}, **env_kwargs}


def without_sampling(env_kwargs: Mapping[str, Any], env_id: str = DEFAULT_ENV_ID) -> dict[str, Any]:
    """Return `env_kwargs`, also as JSON keeps them, without the range that `with_sampling` has added.

    Raises:
        ValueError: As `with_sampling`.
    """
    asked = {name: value for name, value in env_kwargs.items() if name != "randomize"}
    drawn = {name: plain(bounds) for name, bounds in env_kwargs.get("randomize", {}).items()}
    return asked if with_sampling(asked, env_id).get("randomize") == drawn else dict(env_kwargs)


def completed(given: Mapping[str, Any], usual: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keywords `given` with those of `usual` that they lack, but for its panels where they name any or none.

    A rigid model names none.
    """
    model = given.get("model")
    rigid = model in MODELS and not has_flexible_panels(model)
    left_out = PANEL_KEYWORDS if rigid or any(name in given for name in PANEL_KEYWORDS) else ()
    return {**{name: value for name, value in usual.items() if name not in left_out}, **given}


def with_model(
    env_kwargs: Mapping[str, Any],
    model: str | None = None,
    elements: int | None = None,
    env_id: str = DEFAULT_ENV_ID,
    default: Mapping[str, Any] | None = None,
    *,
    panels: str | None = None,
    modes: int | None = None,
) -> dict[str, Any]:
    """Return `env_kwargs` with the options `--model`, `--panels`, `--elements` and `--modes` that are not None.

    Where no model is named, that of `default` is taken, with its panels unless others are named.
    `model="auto"` is replaced by the level that it stands for, so that a record says what was simulated even after the
    ladder has been measured anew.

    Raises:
        ValueError: `env_kwargs` hold another value of an option, rigid panels were asked for more than a model, or the
            environment refuses the keywords.
    """
    options = {"model": model, "panels": panels, "elements": elements, "modes": modes}
    given = {name: value for name, value in options.items() if value is not None}
    for name, value in given.items():
        if env_kwargs.get(name, value) != value:
            raise ValueError(f"--{name} {value} contradicts --env-kwargs {name}={env_kwargs[name]}; give one of them")
    chosen = {**env_kwargs, **given}
    if "model" not in chosen:
        chosen = completed(chosen, default or {})
    if chosen.get("model") in MODELS and not has_flexible_panels(chosen["model"]):
        for name in given.keys() - {"model"}:
            raise ValueError(f"--{name} {given[name]}: panels of {chosen['model']} have none; name a flexible model")
    if chosen.get("model") == "auto":
        level = environment_settings(env_id, chosen)
        kept = {name: value for name, value in chosen.items() if name not in ("question", "tolerance")}
        chosen = {**kept, "model": level.model, **level.level[1].keywords_of(level.model)}
    return chosen


def environment_settings(
    env_id: str = DEFAULT_ENV_ID, env_kwargs: Mapping[str, Any] | None = None
) -> EnvironmentSettings:
    """Check the keywords of an environment and return its settings, such as model and task, without making it.

    Raises:
        ValueError: As `make_env`.
    """

    def settings(**keywords: Any) -> EnvironmentSettings:
        return EnvironmentSettings.of({**gymnasium.spec(env_id).kwargs, **keywords})

    return _made(settings, env_id, env_kwargs)


def make_env(env_id: str = DEFAULT_ENV_ID, env_kwargs: Mapping[str, Any] | None = None) -> gymnasium.Env:
    """Make an environment by `gymnasium.make`; a refusal says what to do.

    Raises:
        ValueError: The id is not registered, or the environment refuses a keyword or its value.
    """
    return _made(partial(gymnasium.make, env_id), env_id, env_kwargs)


def make_vector_env(
    num_envs: int, env_id: str = DEFAULT_ENV_ID, env_kwargs: Mapping[str, Any] | None = None
) -> gymnasium.vector.VectorEnv:
    """Make the native vector environment by `gymnasium.make_vec`; a refusal says what to do.

    Raises:
        ValueError: As `make_env`.
    """
    return _made(partial(gymnasium.make_vec, env_id, num_envs), env_id, env_kwargs)


def _made(make: Callable[..., Any], env_id: str, env_kwargs: Mapping[str, Any] | None) -> Any:
    if env_id not in gymnasium.registry:  # Gymnasium itself imports the module that an id names
        raise ValueError(f"no environment {env_id!r} is registered; available: {', '.join(_registered())}")
    try:
        return make(**dict(env_kwargs or {}))
    except (TypeError, ValueError, gymnasium.error.Error) as error:
        raise ValueError(f"environment {env_id!r} refused its keywords {dict(env_kwargs or {})}: {error}") from error


def _registered() -> list[str]:
    return sorted(name for name in gymnasium.registry if name.startswith(NAMESPACE))


def check_episode_seeds(seed: int, count: int) -> None:
    """Refuse a seed or a number of episodes for which the blocks of `episode_seeds` would overlap.

    Raises:
        ValueError: `seed` is outside 0 .. 99 999 or `count` outside 1 .. 10 000.
    """
    seeds_per_block = _BLOCK_SIZE // EPISODES_PER_SEED
    if not 0 <= seed < seeds_per_block:
        raise ValueError(f"seed is {seed}; choose one from 0 to {seeds_per_block - 1}")
    if not 1 <= count <= EPISODES_PER_SEED:
        raise ValueError(f"the number of episodes is {count}; choose one from 1 to {EPISODES_PER_SEED}")


def episode_seeds(purpose: Purpose, seed: int, count: int) -> list[int]:
    """List `count` environment seeds; those of two purposes, or of two values of `seed`, never coincide.

    Raises:
        ValueError: As `check_episode_seeds`.
    """
    check_episode_seeds(seed, count)
    start = _BLOCKS[purpose] * _BLOCK_SIZE + seed * EPISODES_PER_SEED
    return list(range(start, start + count))
