"""A trained policy with the description of its training, as a controller."""

from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np

from agents.policies.network import PolicyNetwork
from agents.torque_laws import DeterministicController, Signals
from solar_env.support.numbers import check_types


@dataclass(frozen=True)
class Description:
    """Content of `policy.json`: all of a trained policy but the network's arrays.

    Attributes:
        algorithm: Name in `agents.learning.runs.ALGORITHMS`.
        feature_limit, activation, output, mean_limit: See `PolicyNetwork`.
        training_steps: Environment steps of its training, with those of the runs that it was resumed from.
        env_id: Environment that it was trained on.
        env_kwargs: Keywords of that environment.
        observation_names: Name of every entry, in order; they stand in the comment of a C header.
        torque_limit, deadline, control_period, postlock_window: See `Signals`.

    Raises:
        ValueError: On construction, for a value of another kind, a module in the environment's id, or a unit that is
            not positive.
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
        check_types(self)
        if ":" in self.env_id:  # Gymnasium imports what stands before it
            raise ValueError(f"env_id is {self.env_id!r}; give an environment id that names no module")
        for name in ("torque_limit", "deadline", "control_period", "postlock_window"):
            if getattr(self, name) <= 0.0:
                raise ValueError(f"{name} is {getattr(self, name)}; give a positive number")

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
        if (network.inputs, network.outputs) != (len(names), 1):
            raise ValueError(
                f"the layers map {network.inputs} inputs to {network.outputs} outputs; expected {len(names)} inputs, "
                f"one for each of the observation's {', '.join(names)}, and 1 output, the action"
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
