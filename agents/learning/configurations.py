"""Configurations of training runs: those in agents/configs, with single values replaced by those asked for."""

import inspect
import math
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.on_policy_algorithm import OnPolicyAlgorithm

from agents.environments import INTERFACE, check_episode_seeds, environment_settings, with_sampling
from agents.laws.baselines import CONFIGS
from agents.learning import runs
from agents.learning.features import observation_features
from agents.learning.weight_search import WeightSearch, all_weights
from solar_env.support.numbers import is_number, is_whole_number
from solar_env.support.plain_arrays import read_json
from solar_env.support.rules import Rule, check_values

# Arguments of the Stable-Baselines3 classes that are no hyperparameters.
NOT_HYPERPARAMETERS = {"policy", "env", "seed", "device", "verbose", "tensorboard_log", "_init_setup_model"}
# Nor do replay buffers save memory that tell episodes cut off from those that ended, as these here do.
NOT_HYPERPARAMETERS |= {"optimize_memory_usage"} | {
    f"{kind}_buffer_{part}" for kind in ("replay", "rollout") for part in ("class", "kwargs")
}
# What is no hyperparameter of Stable-Baselines3: of all algorithms, and of those that have an action noise.
FIRST_WEIGHTS = "first_weights"
OF_ACTION_NOISE = {"exploration_noise", "actor_learning_rate"}
_GREATEST_COUNT = 10**9


@dataclass(frozen=True)
class Configuration:
    """Complete settings of a training run: it follows from these alone.

    Attributes:
        algo: Name of the algorithm, one of `agents.learning.runs.ALGORITHMS`.
        env_id: Environment id.
        env_kwargs: Environment keywords, with the ranges to randomise.
        seed: Run seed; networks, exploration and episodes follow from it.
        n_envs: Environments stepped together.
        timesteps: Environment steps to train for; those of a run that goes on with a complete one come on top of its.
        hyperparameters: Keywords of the Stable-Baselines3 class, and for SAC and TD3 `actor_learning_rate`, in place
            of the `learning_rate` that is then the critics' alone, `exploration_noise`, the standard deviation of an
            action noise, and for all algorithms `first_weights`, see `agents.learning.models.make_model`; those of
            agents/configs are left out where observation or action are others or the policy is not linear. Learning
            rates are those of the first update and fall linearly to zero; a resumed run takes them up at the share of
            all steps, earlier ones included, that is left.
    """

    algo: str
    env_id: str
    env_kwargs: dict[str, Any]
    seed: int
    n_envs: int
    timesteps: int
    hyperparameters: dict[str, Any]


def entry(algo: str, env_id: str) -> dict[str, Any]:
    """Read the entry of `agents/configs/<algo>.json` for `env_id`.

    Raises:
        ValueError: There is no algorithm of this name, or no entry.
    """
    runs.algorithm(algo)
    entries = read_json(CONFIGS / f"{algo}.json")
    if env_id not in entries:
        raise ValueError(f"{algo}.json has no hyperparameters for {env_id!r}; it has {', '.join(entries)}")
    found: dict[str, Any] = entries[env_id]
    return found


def complete(
    algo: str,
    env_id: str,
    env_kwargs: Mapping[str, Any],
    seed: int,
    n_envs: int | None = None,
    timesteps: int | None = None,
    hyperparameters: Mapping[str, Any] | None = None,
) -> Configuration:
    """Complete a request with the values in `agents/configs/<algo>.json` for its environment, in place of each None.

    Args:
        algo, env_id, env_kwargs, seed, n_envs, timesteps: See `Configuration`.
        hyperparameters: Values in place of single ones of the file, and of single "policy_kwargs" of its.

    Raises:
        ValueError: Algorithm, environment, one of its keywords or a hyperparameter is unknown, or a number is
            out of range.
    """
    asked = {"n_envs": n_envs, "timesteps": timesteps}
    found = entry(algo, env_id)
    _check_hyperparameters(algo, hyperparameters or {})
    counts = {name: found[name] if number is None else number for name, number in asked.items()}
    for name, number in counts.items():
        _check_positive(name, number)
    check_episode_seeds(seed, counts["n_envs"])
    interface = {name: found[name] for name in INTERFACE if name in found}
    keywords = with_sampling({**interface, **env_kwargs}, env_id)
    chosen = {**found["hyperparameters"], **(hyperparameters or {})}
    if "policy_kwargs" in found["hyperparameters"]:
        chosen["policy_kwargs"] = {**found["hyperparameters"]["policy_kwargs"], **chosen["policy_kwargs"]}
    _check_networks(algo, chosen)
    asked_weights = (hyperparameters or {}).get(FIRST_WEIGHTS)
    if asked_weights is not None:
        _check_first_weights(algo, env_id, chosen, keywords)
    elif not _begins_as_usual(algo, env_id, chosen, keywords, interface):
        chosen.pop(FIRST_WEIGHTS, None)
    _check_batches(algo, chosen, counts["n_envs"])
    return Configuration(algo, env_id, runs.jsonable(keywords), seed, hyperparameters=chosen, **counts)


def searches_weights(algo: str) -> bool:
    """Whether an algorithm searches the weights of a policy by whole episodes.

    Raises:
        ValueError: There is no such algorithm.
    """
    return issubclass(runs.algorithm(algo), WeightSearch)


def stored_configuration(folder: str | Path) -> Configuration:
    """Read the configuration of the run in `folder`.

    Raises:
        FileNotFoundError: `folder` holds no run.
        ValueError: The run is of an older version that recorded less.
    """
    stored = runs.read_config(folder)
    return Configuration(**{field.name: stored[field.name] for field in fields(Configuration)})


def resumed_configuration(folder: str | Path, timesteps: int | None = None) -> Configuration:
    """Make the configuration that goes on with the run in `folder`.

    A run that was interrupted goes on to its end, or until it has trained for `timesteps`; one that is complete trains
    for `timesteps` more, by default as many as before.

    Raises:
        FileNotFoundError, ValueError: As `stored_configuration`, or the number of steps is not positive.
    """
    previous = stored_configuration(folder)
    timesteps = previous.timesteps if timesteps is None else timesteps
    _check_positive("timesteps", timesteps)
    return replace(previous, timesteps=timesteps)


def _check_positive(name: str, number: int) -> None:
    if number < 1:
        raise ValueError(f"{name} is {number}; give a positive number")


def _is_finite(value: Any) -> bool:
    return is_number(value) and abs(value) < math.inf


def _is_positive(value: Any) -> bool:
    return _is_finite(value) and value > 0


def _is_automatic(value: Any) -> bool:
    """Whether it is "auto", or "auto_" with the positive number to begin with, as SAC's `ent_coef` may be."""
    found = re.fullmatch(r"auto(?:_([\d.]+(?:[eE][+-]?\d+)?))?", value) if isinstance(value, str) else None
    try:
        return found is not None and (found[1] is None or 0.0 < float(found[1]) < math.inf)
    except ValueError:
        return False


# That an entropy coefficient may be automatic is a matter of the algorithm, see `_check_hyperparameters`.
_RULES = (
    Rule(
        ("learning_rate", "exploration_noise", "vf_coef", "target_policy_noise", "target_noise_clip"),
        lambda value: _is_finite(value) and value >= 0,
        "a positive number, or 0 for none",
    ),
    Rule(
        ("actor_learning_rate", "clip_range", "delta_std", "deviation", "max_grad_norm"),
        _is_positive,
        "a positive number",
    ),
    Rule(
        (
            *("batch_size", "buffer_size", "n_epochs", "n_steps", "policy_delay", "train_freq"),
            *("n_delta", "n_top", "generations_between", "finalists"),
            *("target_update_interval", "stats_window_size"),
        ),
        lambda value: is_whole_number(value, 1) and value <= _GREATEST_COUNT,
        f"a positive whole number, at most {_GREATEST_COUNT:,}",
    ),
    Rule(
        ("gradient_steps", "sde_sample_freq"),  # -1 says "as many as"
        lambda value: is_whole_number(value, -1) and value != 0,
        "a positive whole number, or -1",
    ),
    Rule(("population",), lambda value: is_whole_number(value, 2), "a whole number, at least 2"),
    Rule(("learning_starts",), lambda value: is_whole_number(value, 0), "a whole number, not negative"),
    Rule(("gamma", "tau"), lambda value: _is_positive(value) and value <= 1, "a number above 0, at most 1"),
    Rule(("gae_lambda",), lambda value: _is_finite(value) and 0 <= value <= 1, "a number from 0 to 1"),
    Rule(
        ("clip_range_vf", "target_kl"),
        lambda value: value is None or _is_positive(value),
        "a positive number, or None",
    ),
    Rule(("target_entropy",), lambda value: _is_finite(value) or value == "auto", "a number, or auto"),
    Rule(
        ("use_sde", "use_sde_at_warmup", "normalize_advantage"), lambda value: isinstance(value, bool), "true or false"
    ),
    Rule(("policy_kwargs",), lambda value: isinstance(value, Mapping), "a dictionary"),
    Rule(
        (FIRST_WEIGHTS,),
        lambda value: value is None or all(map(_is_finite, value if isinstance(value, list) else [value])),
        "a number, or one for each of the first entries observed",
    ),
)


def _check_hyperparameters(algo: str, values: Mapping[str, Any]) -> None:
    """Refuse names that the algorithm does not have, and values that would fail in the middle of a training."""
    kind = runs.algorithm(algo)
    accepted = set(inspect.signature(kind).parameters) - NOT_HYPERPARAMETERS | {FIRST_WEIGHTS}
    if "action_noise" in accepted:
        accepted = accepted - {"action_noise"} | OF_ACTION_NOISE
    for name in values:
        if name not in accepted:
            raise ValueError(f"{algo} has no hyperparameter {name!r}; it has {', '.join(sorted(accepted))}")
    automatic = not issubclass(kind, OnPolicyAlgorithm)
    entropy = Rule(
        ("ent_coef",),
        lambda value: _is_finite(value) or (automatic and _is_automatic(value)),
        "a number, or auto for sac",
    )
    check_values(values, (*_RULES, entropy), "hyperparameter")


def _check_networks(algo: str, chosen: Mapping[str, Any]) -> None:
    """Refuse keywords of the policy of which it makes no networks: by making them, for an observation of a few entries.

    Raises:
        ValueError: Networks cannot be made.
    """
    keywords = chosen.get("policy_kwargs")
    if keywords is None:
        return
    policy: Any = runs.algorithm(algo).policy_aliases["MlpPolicy"]
    box = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
    # What the algorithm gives its policy beside the keywords.
    given = {"use_sde": chosen.get("use_sde", False)} if "use_sde" in inspect.signature(policy).parameters else {}
    try:
        with torch.random.fork_rng(devices=[]), warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            policy(box, gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32), lambda _: 1e-3, **given, **keywords)
    except Exception as error:  # whatever PyTorch makes of what nobody has thought of
        reason = " ".join(str(error).split())[:200]
        raise ValueError(
            f"hyperparameter policy_kwargs is {keywords!r}, of which no networks can be made ({reason}); give keywords "
            f"of Stable-Baselines3's {policy.__name__}"
        ) from error


def _is_linear(algo: str, chosen: Mapping[str, Any]) -> bool:
    """Whether hyperparameters are of a policy without hidden layers."""
    if searches_weights(algo):
        return True
    layers = chosen.get("policy_kwargs", {}).get("net_arch")
    if layers is None:  # Stable-Baselines3 has hidden ones of its own
        return False
    return not (layers.get("pi") if isinstance(layers, Mapping) else layers)


def _check_first_weights(algo: str, env_id: str, chosen: Mapping[str, Any], keywords: Mapping[str, Any]) -> None:
    """Refuse first weights that are not those of entries in a linear policy.

    Raises:
        ValueError: The policy has hidden layers, there are more weights than entries, or a network sees one magnified.
    """
    weights = chosen[FIRST_WEIGHTS]
    if not _is_linear(algo, chosen):
        raise ValueError(
            f"hyperparameter {FIRST_WEIGHTS} is {weights!r}, of a linear policy, and this one has hidden layers; "
            "leave it out, or let policy_kwargs have net_arch without any for the policy"
        )
    names = environment_settings(env_id, keywords).observation_names
    count = all_weights(weights, len(names)).nonzero()[0].max(initial=-1) + 1
    matrix = observation_features(names[:count]).matrix if count else np.eye(0)
    if not searches_weights(algo) and not np.array_equal(matrix, np.eye(count)):
        raise ValueError(
            f"hyperparameter {FIRST_WEIGHTS} is {weights!r}, and the networks of {algo} see {', '.join(names[:count])} "
            "magnified; leave it out, or observe landing first"
        )


def _begins_as_usual(
    algo: str, env_id: str, chosen: Mapping[str, Any], keywords: Mapping[str, Any], usual: Mapping[str, Any]
) -> bool:
    """Whether the first weights of agents/configs, of the `usual` interface, are of these entries and this action."""
    weights = chosen.get(FIRST_WEIGHTS)
    if weights is None or not _is_linear(algo, chosen):
        return False
    count = len(weights) if isinstance(weights, list) else 1
    here, there = (environment_settings(env_id, asked) for asked in (keywords, usual))
    return here.action == there.action and here.observation_names[:count] == there.observation_names[:count]


def _check_batches(algo: str, chosen: Mapping[str, Any], n_envs: int) -> None:
    """Refuse batches of a single step, whose advantages cannot be normalised.

    Raises:
        ValueError: There would be such.
    """
    if not issubclass(runs.algorithm(algo), OnPolicyAlgorithm) or not chosen.get("normalize_advantage", True):
        return
    for name, factor in (("batch_size", 1), ("n_steps", n_envs)):
        if chosen[name] * factor < 2:
            raise ValueError(f"hyperparameter {name} is {chosen[name]}; give at least 2, to normalise advantages by")
