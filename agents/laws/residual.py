"""Agents that add to a tuned torque law instead of commanding the whole torque."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from agents.laws.baselines import episodes_spent, load_parameters
from agents.laws.table import TUNABLE
from agents.torque_laws import Controller, DeterministicController, Signals, TorqueLaw
from solar_env.support.numbers import is_number, is_whole_number

DEFAULT_LAW = "servo"


def residual_on(scale: float, law: str, env_id: str, model: str, recorded: int) -> dict[str, Any]:
    """Describe a residual on a law as it is tuned now: the law, its parameters and their cost, and the scale.

    Args:
        scale: Greatest action that the agent adds, as a share of the torque limit.
        law: Name in `agents.laws.table.TUNABLE`.
        env_id: Environment id.
        model: Model whose tuned parameters to take.
        recorded: Episodes of the law that training looks at, beyond those that tuning it took.

    Raises:
        ValueError: The scale is not in (0, 1], or there is no such law, or it has no parameters for the environment.
    """
    _check_scale(scale)
    _check_law(law)
    return {
        "law": law,
        "parameters": asdict(load_parameters(law, env_id, model)),
        "tuning_episodes": episodes_spent(law, env_id, model) + recorded,
        "scale": scale,
    }


def base_law(residual: Mapping[str, Any], signals: Signals) -> TorqueLaw:
    """Make the law that a residual is added to.

    Raises:
        ValueError: The description is not one of `residual_on`; the message names the key or value.
    """
    if set(residual) != {"law", "parameters", "tuning_episodes", "scale"}:
        raise ValueError(
            f"residual has the keys {sorted(residual)}; expected law, parameters, tuning_episodes and scale"
        )
    _check_law(residual["law"])
    _check_scale(residual["scale"])
    if not is_whole_number(residual["tuning_episodes"], 0):
        raise ValueError(f"residual tuning_episodes is {residual['tuning_episodes']!r}; expected a whole number")
    law = TUNABLE[residual["law"]]
    return law(signals, law.defaults.from_json(residual["parameters"]))


def _check_law(law: Any) -> None:
    if not isinstance(law, str) or law not in TUNABLE:
        raise ValueError(f"residual law is {law!r}; available: {', '.join(TUNABLE)}")


def _check_scale(scale: Any) -> None:
    if not is_number(scale) or not 0.0 < scale <= 1.0:
        raise ValueError(f"residual = {scale!r}; give a share of the torque limit above 0 and up to 1")


def added(base: np.ndarray, action: np.ndarray, scale: float) -> np.ndarray:
    """Return the base action plus the agent's, in units of the torque limit; any shape."""
    return np.clip(base + np.float32(scale) * np.clip(action, -1.0, 1.0), -1.0, 1.0)


class ResidualController(DeterministicController):
    """A policy together with the law that it adds to, as `residual_on` describes it; errors are those of `base_law`."""

    def __init__(self, policy: Controller, residual: Mapping[str, Any], signals: Signals) -> None:
        self._policy, self._law, self._scale = policy, base_law(residual, signals), residual["scale"]

    def act(self, observation: np.ndarray) -> np.ndarray:
        """Map observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1) in [-1, 1]."""
        action, _ = self._policy.predict(observation, deterministic=True)
        return added(self._law.act(observation), action, self._scale)
