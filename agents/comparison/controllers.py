"""Controllers by name: baselines, the receding-horizon search, shipped policies, run folders."""

from pathlib import Path
from typing import Any

import gymnasium

from agents import runs, shipped
from agents.laws.baselines import BASELINES, TUNABLE, episodes_spent, make_baseline
from agents.laws.receding_horizon import RecedingHorizon
from agents.torque_laws import Controller

SEARCH = "receding-horizon"
UNTRAINED = (*BASELINES, SEARCH)


def load_controller(spec: str, env: gymnasium.Env) -> Controller:
    """The controller that `spec` names, for use on `env`.

    Args:
        spec: One of `UNTRAINED`, a shipped policy, or a run folder. Load only runs you trust: they are pickles.
        env: Environment of this project.

    Raises:
        FileNotFoundError: it is none of these.
        ValueError: it does not fit the environment.
    """
    if spec == SEARCH:
        return RecedingHorizon(env, make_baseline("servo", env))
    if spec in BASELINES:
        return make_baseline(spec, env)
    if spec in shipped.available():
        policy = shipped.load_shipped(spec)
        policy.check(env)
        return policy
    _check_run(spec)
    return runs.load_policy(spec, env)


def resolved(spec: str) -> str:
    """The same controller from any working directory: a name as it is, a run folder as an absolute path."""
    return spec if spec in UNTRAINED or spec in shipped.available() else str(Path(spec).resolve())


def policy_files(spec: str) -> list[Path]:
    """The files that determine a trained controller; none for the others.

    Raises:
        FileNotFoundError: `spec` names no controller.
    """
    if spec in UNTRAINED:
        return []
    if spec in shipped.available():
        return [shipped.SHIPPED / spec / name for name in (shipped.ARRAYS, shipped.DESCRIPTION)]
    return [runs.policy_path(spec), Path(spec) / runs.CONFIG]


def effort(spec: str, env_id: str, model: str) -> str | None:
    """What was simulated to tune or train a controller for an environment; None for nothing.

    Raises:
        FileNotFoundError: `spec` names no controller.
        ValueError: as `load_parameters`.
    """
    if spec in UNTRAINED:
        return f"{episodes_spent(spec, env_id, model):,} episodes" if spec in TUNABLE else None
    if spec in shipped.available():
        description = shipped.load_shipped(spec).description
        steps, residual = description.training_steps, description.residual
    else:
        config = runs.read_config(spec)
        steps, residual = config["timesteps_before"] + config["timesteps"], config["residual"]
    of_law = f" and {residual['tuning_episodes']:,} episodes for the law" if residual else ""
    return f"{steps:,} steps{of_law}"


def trained_in(spec: str) -> str | None:
    """Environment id that a controller was trained on; None if it was not trained.

    Raises:
        FileNotFoundError: `spec` names no controller.
    """
    training = _training(spec)
    return training["env_id"] if training else None


def trained_on(spec: str) -> dict[str, Any] | None:
    """Environment keywords that a controller was trained with; None if it was not trained.

    Raises:
        FileNotFoundError: `spec` names no controller.
    """
    training = _training(spec)
    return training["env_kwargs"] if training else None


def observation_of(spec: str) -> dict[str, Any]:
    """The environment keyword "observation" that a controller was trained with; nothing if it was not trained.

    Raises:
        FileNotFoundError: `spec` names no controller.
    """
    trained = trained_on(spec) or {}
    return {"observation": trained["observation"]} if "observation" in trained else {}


def _training(spec: str) -> dict[str, Any] | None:
    """What is kept of a controller's training; None if it was not trained."""
    if spec in UNTRAINED:
        return None
    if spec in shipped.available():
        return vars(shipped.load_shipped(spec).description)
    _check_run(spec)
    return runs.read_config(spec)


def _check_run(spec: str) -> None:
    """Refuse what is neither a run folder nor, since it came to this, any other controller.

    Raises:
        FileNotFoundError: there is no run folder of this name.
    """
    if not (Path(spec) / runs.CONFIG).is_file():
        known = ", ".join((*UNTRAINED, *shipped.available()))
        raise FileNotFoundError(f"no controller {spec!r}: it is no run folder of train.py, and none of {known}")
