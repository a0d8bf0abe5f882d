"""A trained policy with the description of its training, as a controller."""

from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np

from agents.policies.network import PolicyNetwork
from agents.torque_laws import DeterministicController, Signals
from solar_env.support.numbers import is_number, is_whole_number
from solar_env.support.rules import Rule, check_values


def _is_finite(value: Any) -> bool:
    return is_number(value) and abs(value) < 1e300


_RULES = (
    Rule(("algorithm", "activation", "output"), lambda value: isinstance(value, str), "a name"),
    # Gymnasium imports what stands before a colon.
    Rule(
        ("env_id",),
        lambda value: isinstance(value, str) and ":" not in value,
        "an environment id that names no module",
    ),
    Rule(("feature_limit",), _is_finite, "a number"),
    Rule(
        ("torque_limit", "deadline", "control_period", "postlock_window"),
        lambda value: _is_finite(value) and value > 0.0,
        "a positive number",
    ),
    Rule(("mean_limit",), lambda value: value is None or _is_finite(value), "a number or null"),
    Rule(("training_steps",), lambda value: is_whole_number(value, 0), "a whole number, not negative"),
    Rule(("env_kwargs",), lambda value: isinstance(value, dict), "a mapping"),
    Rule(
        ("observation_names",),
        # They stand in the comment of a C header.
        lambda value: isinstance(value, tuple) and all(isinstance(name, str) and name.isidentifier() for name in value),
        "a list of names of letters, digits and underscores",
    ),
)


@dataclass(frozen=True)
class Description:
    """Content of `policy.json`: all of a shipped policy but the network's arrays.

    Attributes:
        algorithm: Name in `agents.learning.runs.ALGORITHMS`.
        feature_limit, activation, output, mean_limit: See `PolicyNetwork`.
        training_steps: Environment steps of its training, with those of the runs that it was resumed from.
        env_id: Environment that it was trained on.
        env_kwargs: Keywords of that environment.
        observation_names: Name of every entry, in order.
        torque_limit, deadline, control_period, postlock_window: See `Signals`.
    """

    algorithm: str
    feature_limit: float
    activation: str
    output: str
    mean_limit: float | None
    training_steps: int
    env_id: str
    env_kwargs: dict[str, Any]
    observation_names: tuple[str, ...]
    torque_limit: float
    deadline: float
    control_period: float
    postlock_window: float

    def __post_init__(self) -> None:
        check_values(vars(self), _RULES)

    @property
    def signals(self) -> Signals:
        """Names and units of the environment that it was trained on."""
        units = (self.torque_limit, self.deadline, self.control_period, self.postlock_window)
        keywords = {name: self.env_kwargs[name] for name in ("driven_joint", "action") if name in self.env_kwargs}
        return Signals(self.observation_names, *units, **keywords)


class ShippedPolicy(DeterministicController):
    """A trained policy as a controller.

    Raises:
        ValueError: The network does not fit the observation or the action.
    """

    def __init__(self, network: PolicyNetwork, description: Description) -> None:
        names = description.observation_names
        if network.inputs != len(names):
            raise ValueError(
                f"layer 1: weights have shape {network.layers[0].weights.shape}; expected {len(names)} inputs, one for "
                f"each of the observation's {', '.join(names)}"
            )
        if network.outputs != 1:
            raise ValueError(
                f"layer {len(network.layers)}: there are {network.outputs} outputs; expected 1, the torque"
            )
        self.network = network
        self.description = description

    def act(self, observation: np.ndarray) -> np.ndarray:
        """Map observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1); see `PolicyNetwork.act`."""
        return self.network.act(observation)

    def check(self, env: gymnasium.Env) -> None:
        """Refuse an environment whose observations or actions have another meaning than in training.

        Raises:
            ValueError: As `Signals.check`.
        """
        self.description.signals.check(env, f"{self.description.env_id} with {self.description.env_kwargs}")
