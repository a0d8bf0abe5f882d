"""Configurations of training runs: those in agents/configs, with single values replaced by those asked for."""

from collections.abc import Mapping
from typing import Any

from agents.environments import INTERFACE, check_episode_seeds, environment_settings, with_sampling
from agents.laws.baselines import CONFIGS
from agents.learning import runs
from agents.learning.runs import Configuration as Configuration
from solar_env.support.plain_arrays import read_json

FIRST_WEIGHTS = "first_weights"


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

    The first weights of the file are left out where observation or action are others or the policy is not linear.

    Args:
        algo, env_id, env_kwargs, seed, n_envs, timesteps: See `Configuration`.
        hyperparameters: Values in place of single ones of the file, and of single "policy_kwargs" of its. The algorithm
            refuses its own when the model is made.

    Raises:
        ValueError: Algorithm, environment or one of its keywords is unknown, a number is out of range, or first weights
            are asked for and the policy is not linear.
    """
    runs.algorithm(algo)
    entries = read_json(CONFIGS / f"{algo}.json")
    if env_id not in entries:
        raise ValueError(f"{algo}.json has no hyperparameters for {env_id!r}; it has {', '.join(entries)}")
    found, asked = entries[env_id], dict(hyperparameters or {})
    interface = {name: found[name] for name in INTERFACE if name in found}
    keywords = with_sampling({**interface, **env_kwargs}, env_id)
    chosen = {**found["hyperparameters"], **asked}
    if isinstance(asked.get("policy_kwargs"), dict):
        chosen["policy_kwargs"] = {**found["hyperparameters"].get("policy_kwargs", {}), **asked["policy_kwargs"]}
    linear = algo in runs.SEARCHES or _is_linear(chosen.get("policy_kwargs"))
    if asked.get(FIRST_WEIGHTS) is not None and not linear:
        raise ValueError(
            f"hyperparameter {FIRST_WEIGHTS} is of a linear policy, and this one has hidden layers; leave it out, or "
            "let policy_kwargs have net_arch without any for the policy"
        )
    left_out = FIRST_WEIGHTS not in asked and not (linear and _sees_the_same(chosen, env_id, keywords, interface))
    if left_out or chosen.get(FIRST_WEIGHTS) is None:
        chosen.pop(FIRST_WEIGHTS, None)
    counts = {
        "n_envs": found["n_envs"] if n_envs is None else n_envs,
        "timesteps": found["timesteps"] if timesteps is None else timesteps,
    }
    config = Configuration(algo, env_id, runs.jsonable(keywords), seed, hyperparameters=chosen, **counts)
    check_episode_seeds(seed, config.n_envs)
    return config


def _is_linear(policy_kwargs: Any) -> bool:
    """Whether keywords are of a policy without hidden layers; Stable-Baselines3 itself has some."""
    layers = policy_kwargs.get("net_arch") if isinstance(policy_kwargs, dict) else None
    return layers is not None and not (layers.get("pi") if isinstance(layers, dict) else layers)


def _sees_the_same(chosen: Mapping[str, Any], env_id: str, keywords: Any, usual: Any) -> bool:
    """Whether the entries of the first weights, and the action, are those of the `usual` interface."""
    count = len(chosen.get(FIRST_WEIGHTS, ()))
    here, there = (environment_settings(env_id, asked) for asked in (keywords, usual))
    return here.action == there.action and here.observation_names[:count] == there.observation_names[:count]
