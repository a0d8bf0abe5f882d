"""Interface of controllers, names and units of signals, base classes of torque laws, and mean opening of two joints."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Generic, Protocol, Self, TypeVar

import gymnasium
import numpy as np

from solar_env.environment.settings import EnvironmentSettings

Entries = Mapping[str, np.ndarray]
"""Observed values (n,) by the name of the entry."""


class Controller(Protocol):
    """The interface that torque laws and Stable-Baselines3 models have in common."""

    @property
    def predict(self) -> Callable[..., tuple[np.ndarray, Any]]:
        """Prediction function with Stable-Baselines3's arguments: observation, state, episode_start, deterministic.

        The function maps observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1) in [-1, 1] and the next state.
        """


@dataclass(frozen=True)
class Signals:
    """Names and units of the observations and actions of an environment.

    Attributes:
        names: Name of every entry of an observation, as `env.unwrapped.observation_names`.
        torque_limit: Motor torque of a unit action [N m].
        deadline: Time by which all joints should latch [s]. Observed times to it and since release are divided by it.
        control_period: Time for which an action is held [s].
        settling_window: Duration of an episode after the last latch [s]. Observed times since then are divided by it.
        driven_joint: Index of the joint that the motor drives; 0 is the root hinge.
        action: Meaning of an action, see `solar_env.environment.task.task.Task`.
        lock_angles: Angle at which each joint latches [rad].
    """

    names: tuple[str, ...]
    torque_limit: float = 0.5
    deadline: float = 20.0
    control_period: float = 0.1
    settling_window: float = 10.0
    driven_joint: int = 0
    action: str = "torque"
    lock_angles: tuple[float, ...] = (math.pi / 2, math.pi)

    @classmethod
    def of(cls, env: gymnasium.Env | EnvironmentSettings) -> Self:
        """Return the `Signals` (names, units) of an environment of this project, given itself or its settings."""
        unwrapped: Any = env.unwrapped if isinstance(env, gymnasium.Env) else env
        _, *of_task, _ = (item.name for item in fields(cls))
        array = unwrapped.parameters if isinstance(env, gymnasium.Env) else unwrapped.array
        return cls(
            tuple(unwrapped.observation_names),
            **{name: getattr(unwrapped.task, name) for name in of_task},
            lock_angles=tuple(joint.lock_angle for joint in array.joints),
        )

    @property
    def driven_lock_angle(self) -> float:
        """Lock angle of the joint that the motor drives [rad]."""
        return self.lock_angles[self.driven_joint]

    def check(self, env: gymnasium.Env, learned_on: str) -> None:
        """Refuse `env` if its signals differ from `self`; the error names `learned_on`, the training environment.

        Raises:
            ValueError: An attribute differs. The torque limit may differ if no action or observation is a torque.
        """
        unitless = self.action != "torque" and "motor_torque" not in self.names  # no signal is in units of torque
        for name, value in vars(Signals.of(env)).items():
            if value != getattr(self, name) and not (name == "torque_limit" and unitless):
                raise ValueError(
                    f"the environment's {name} is {value}; the policy was trained with {getattr(self, name)}, "
                    f"on {learned_on}"
                )


class DeterministicController(ABC):
    """A controller without randomness; subclasses define `act`."""

    @abstractmethod
    def act(self, observation: np.ndarray) -> np.ndarray:
        """Map observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1) in [-1, 1]."""

    def predict(
        self,
        observation: np.ndarray,
        state: tuple[np.ndarray, ...] | None = None,
        episode_start: np.ndarray | None = None,
        deterministic: bool = True,
    ) -> tuple[np.ndarray, tuple[np.ndarray, ...] | None]:
        """Return the actions of `act`, and `state` unchanged; the other arguments are as in `Controller`."""
        return self.act(observation), state


class TorqueLaw(DeterministicController):
    """A memoryless torque law over named observation entries.

    The law reads the entries that `reads` names; "driven" in a name, as in "rate_driven", is the driven joint's number.

    Args:
        signals: Names and units of the environment's observations and actions.

    Raises:
        ValueError: Actions are not torques; or the law reads entries, and one is missing or several hinges are driven.
    """

    reads: ClassVar[tuple[str, ...]] = ()
    """Entries of the observation that the drive law needs."""

    def __init__(self, signals: Signals) -> None:
        several = not isinstance(signals.driven_joint, int)
        if several and self.reads:
            raise ValueError(f"driven_joint = {signals.driven_joint!r}: laws drive one hinge; name one, or train")
        if signals.action != "torque":
            raise ValueError(
                f"{type(self).__name__} is a law of the torque, but the environment's action is {signals.action!r}; "
                "leave the keyword action out"
            )
        names = list(signals.names)
        read = {name: name.replace("driven", str(signals.driven_joint + 1)) for name in self.reads}
        missing = [entry for entry in dict.fromkeys(read.values()) if entry not in names]
        if missing:
            raise ValueError(
                f"{type(self).__name__} reads {', '.join(missing)}, but the observation has only "
                f"{', '.join(names)}; use an array of at least two panels with the 'drive' observation"
            )
        self._column = {name: names.index(entry) for name, entry in read.items()}
        self._latch_columns = [column for column, name in enumerate(names) if name.startswith("latched_")]
        self._signals, self._motors = signals, np.size(signals.driven_joint)

    @abstractmethod
    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        """Return the torques (n,) [N m] for n observations, given as arrays (n,) by name (`entries`).

        `all_latched` (n,) is true where all joints have latched.
        """

    def act(self, observation: np.ndarray) -> np.ndarray:
        """Map observations (n_obs,) or (n, n_obs) to actions (motors,) or (n, motors), clipped to [-1, 1]."""
        batch = np.atleast_2d(np.asarray(observation, dtype=np.float64))
        entries = {name: batch[:, column] for name, column in self._column.items()}
        all_latched = np.all(batch[:, self._latch_columns] > 0.5, axis=1)
        torque = np.broadcast_to(self._torque(entries, all_latched), len(batch))
        action = np.clip(torque / self._signals.torque_limit, -1.0, 1.0).astype(np.float32)[:, None]
        action = np.repeat(action, self._motors, axis=1)
        return action if np.ndim(observation) == 2 else action[0]


def bounded(default: float | tuple[float, ...], lower: float, upper: float) -> Any:
    """Return a dataclass field for a torque law's parameter, with default and the bounds of each number in tuning."""
    return field(default=default, metadata={"bounds": (lower, upper)})


@dataclass(frozen=True)
class LawParameters:
    """Parameters of a torque law, each a number or a tuple of numbers declared with `bounded`."""

    @classmethod
    def bounds(cls) -> np.ndarray:
        """Return the bounds (numbers, 2) of all numbers in the parameters, least and greatest, in the fields' order."""
        defaults: list[Any] = [f.default for f in fields(cls)]
        return np.repeat([f.metadata["bounds"] for f in fields(cls)], [np.size(d) for d in defaults], axis=0)

    @classmethod
    def from_unit(cls, unit: np.ndarray) -> Self:
        """Make parameters from numbers (numbers,) in [0, 1], linearly within their bounds."""
        low, high = cls.bounds().T
        numbers = iter((low + np.asarray(unit) * (high - low)).tolist())
        defaults: list[Any] = [f.default for f in fields(cls)]
        return cls(*(tuple(next(numbers) for _ in d) if isinstance(d, tuple) else next(numbers) for d in defaults))

    def to_unit(self) -> np.ndarray:
        """Return the numbers (numbers,) in [0, 1] from which `from_unit` makes these parameters."""
        low, high = self.bounds().T
        return (np.concatenate([np.atleast_1d(value) for value in vars(self).values()]) - low) / (high - low)

    @classmethod
    def from_json(cls, values: Mapping[str, object]) -> Self:
        """Make parameters from the values of a JSON object.

        Raises:
            ValueError: The keys are not the names of the parameters.
        """
        expected = {f.name for f in fields(cls)}
        if set(values) != expected:
            raise ValueError(f"the keys are {sorted(values)}; expected {sorted(expected)}")
        return cls(**{key: tuple(value) if isinstance(value, list) else value for key, value in values.items()})


P = TypeVar("P", bound=LawParameters)


class TunableLaw(TorqueLaw, Generic[P]):
    """A `TorqueLaw` whose constructor also takes tunable parameters, by default the class attribute `defaults`."""

    defaults: P

    def __init__(self, signals: Signals, parameters: P | None = None) -> None:
        super().__init__(signals)
        self.parameters = self.defaults if parameters is None else parameters


OPENING = ("theta_1", "theta_2", "rate_1", "rate_2")
"""Observed entries from which a law computes the opening."""


def weighted_opening(
    entries: Entries, joint_2_weight: float, lock_angles: Sequence[float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the weighted opening of both joints in units of lock angles, its rate, and the joints' rate difference.

    All are (n,), the rates in 1/s; `entries` are the values (n,) of n observations by name. Joint 1 has weight
    1 - `joint_2_weight`. The difference is joint 1 minus joint 2.
    """
    rate_1, rate_2 = (entries[f"rate_{i + 1}"] / lock_angles[i] for i in range(2))
    opening = entries["theta_1"] + joint_2_weight * (entries["theta_2"] - entries["theta_1"])
    return opening, rate_1 + joint_2_weight * (rate_2 - rate_1), rate_1 - rate_2
