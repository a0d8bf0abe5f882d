"""Torque laws: controllers without learning, behind Stable-Baselines3's `predict` interface."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

import gymnasium
import numpy as np

from solar_env.environment.task import Task


class Controller(Protocol):
    """What baselines and Stable-Baselines3 models have in common."""

    def predict(
        self,
        observation: np.ndarray,
        state: tuple[np.ndarray, ...] | None = None,
        episode_start: np.ndarray | None = None,
        deterministic: bool = False,
    ) -> tuple[np.ndarray, tuple[np.ndarray, ...] | None]:
        """Map observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1) in [-1, 1]."""
        ...


@dataclass(frozen=True)
class Signals:
    """What a controller needs to know of an environment.

    Attributes:
        names: Name of every entry of an observation, as `env.unwrapped.observation_names`.
        torque_limit: Motor torque of a unit action [N m].
        deadline: Unit of the observed time [s].
        control_period: For which an action is held [s].
        postlock_window: Unit of the observed time since the last latch [s].
        driven_joint: Index of the joint that the motor works on; 0 is the root hinge.
    """

    names: tuple[str, ...]
    torque_limit: float = 0.5
    deadline: float = 20.0
    control_period: float = 0.1
    postlock_window: float = 10.0
    driven_joint: int = 0

    @classmethod
    def of(cls, env: gymnasium.Env) -> "Signals":
        """Those of an environment of this project."""
        unwrapped: Any = env.unwrapped
        return cls.seen(unwrapped.observation_names, unwrapped.task)

    @classmethod
    def seen(cls, names: Sequence[str], task: Task) -> "Signals":
        """Those of observations with these entries, in this task."""
        return cls(tuple(names), **vars(task))

    def check(self, env: gymnasium.Env, learned_on: str) -> None:
        """Refuse an environment in which observations or actions mean something else than here.

        Args:
            env: Environment of this project.
            learned_on: Where these signals come from, for the message.

        Raises:
            ValueError: the entries of an observation, or the units or the period of actions or observations, differ.
        """
        for name, value in vars(Signals.of(env)).items():
            if value != getattr(self, name):
                raise ValueError(
                    f"the environment's {name} is {value}; the policy was trained with {getattr(self, name)}, "
                    f"on {learned_on}"
                )


class TorqueLaw(ABC):
    """A memoryless torque law over named observation entries.

    It `reads` entries by their names; "driven" in the place of a joint's number is the joint that the motor works on.

    Args:
        signals: What the environment observes and takes.

    Raises:
        ValueError: an entry that the law reads is not observed.
    """

    reads: tuple[str, ...] = ()

    def __init__(self, signals: Signals) -> None:
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
        self._signals = signals

    @abstractmethod
    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        """Torque (n,) [N m] from named entries (n,); `all_latched` (n,): where every joint has."""

    def predict(
        self,
        observation: np.ndarray,
        state: tuple[np.ndarray, ...] | None = None,
        episode_start: np.ndarray | None = None,
        deterministic: bool = False,
    ) -> tuple[np.ndarray, tuple[np.ndarray, ...] | None]:
        """Map observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1), clipped to [-1, 1]."""
        batch = np.atleast_2d(np.asarray(observation, dtype=np.float64))
        entries = {name: batch[:, column] for name, column in self._column.items()}
        all_latched = np.all(batch[:, self._latch_columns] > 0.5, axis=1)
        torque = np.broadcast_to(self._torque(entries, all_latched), len(batch))
        action = np.clip(torque / self._signals.torque_limit, -1.0, 1.0).astype(np.float32)[:, None]
        return (action if np.ndim(observation) == 2 else action[0]), state


P = TypeVar("P")


class TunableLaw(TorqueLaw, Generic[P]):
    """A torque law with parameters to tune.

    Args:
        signals: What the environment observes and takes.
        parameters: A dataclass of the law's own; None: its untuned `defaults`.

    Raises:
        ValueError: as `TorqueLaw`.
    """

    defaults: P

    def __init__(self, signals: Signals, parameters: P | None = None) -> None:
        super().__init__(signals)
        self.parameters = self.defaults if parameters is None else parameters


class Passive(TorqueLaw):
    """Zero torque: the springs deploy the array alone."""

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        return np.zeros(len(all_latched))


def _bounded(default: float, lower: float, upper: float) -> Any:
    return field(default=default, metadata={"bounds": (lower, upper)})


@dataclass(frozen=True)
class BrakeParameters:
    """Parameters of `ConstantBrake`; the field metadata hold the range that tuning searches.

    Attributes:
        torque: Magnitude of the torque against the direction of opening [N m].
        onset: Opening of the driven joint, in units of its lock angle, from which the torque acts (0: from the start).
    """

    torque: float = _bounded(0.03, 0.0, 0.5)
    onset: float = _bounded(0.0, 0.0, 1.0)


class ConstantBrake(TunableLaw[BrakeParameters]):
    """A constant torque against opening until the last joint has latched, then none."""

    reads = ("theta_driven",)
    defaults = BrakeParameters()

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        acts = (entries["theta_driven"] >= self.parameters.onset) & ~all_latched
        return np.where(acts, -self.parameters.torque, 0.0)


@dataclass(frozen=True)
class DamperParameters:
    """Parameters of `ViscousDamper`; the field metadata hold the range that tuning searches.

    Attributes:
        damping: Torque per rate of the driven joint until the last joint has latched [N m s/rad].
        postlock_damping: The same from then on.
    """

    damping: float = _bounded(1.0, 0.0, 6.0)
    postlock_damping: float = _bounded(1.0, 0.0, 10.0)


class ViscousDamper(TunableLaw[DamperParameters]):
    """A torque against the rate of the driven joint, as the rotary dampers of spring-driven hinges exert it."""

    reads = ("rate_driven",)
    defaults = DamperParameters()

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        return -np.where(all_latched, p.postlock_damping, p.damping) * entries["rate_driven"]


# Lock angles of joint 1, and of those further out [rad].
_LOCK_ANGLES = (math.pi / 2, math.pi)
_READ = ("theta_1", "theta_2", "theta_driven", "rate_1", "rate_2", "rate_driven")


def _opening(entries: Mapping[str, np.ndarray], joint_2_weight: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Weighted opening of both joints in units of their lock angles, its rate [1/s], and the rates' difference."""
    rate_1, rate_2 = (entries[f"rate_{i + 1}"] / _LOCK_ANGLES[i] for i in range(2))
    opening = entries["theta_1"] + joint_2_weight * (entries["theta_2"] - entries["theta_1"])
    return opening, rate_1 + joint_2_weight * (rate_2 - rate_1), rate_1 - rate_2


RESERVE = 0.5  # time before the deadline by which the servo wants to be done [s]
LEAST_TIME = 0.1  # in which it tries to, once that is over [s]


@dataclass(frozen=True)
class ServoParameters:
    """Parameters of `VelocityProfileServo`; the field metadata hold the range that tuning searches.

    Opening is measured in units of the lock angle (0 folded, 1 locked), opening rates in 1/s.

    Attributes:
        cruise_rate: Opening rate of the profile far from latching [1/s].
        latch_rate: Opening rate of the profile at the lock angle [1/s].
        deceleration: Deceleration of the profile ahead of the lock angle [1/s^2].
        gain: Torque per opening-rate error [N m s].
        joint_2_weight: Share of joint 2 in the opening that follows the profile; joint 1 has the rest.
        difference_damping: Torque on joint 1 against the opening-rate difference of the joints, which the
            cable loop makes oscillate [N m s].
        postlock_damping: Torque per rate of the driven joint after the last latch [N m s/rad].
        postlock_stiffness: Torque from then on per angle of the driven joint off its lock angle [N m/rad]: a latched
            joint still has play, which the array would swing across.
        smoothing: Share of the motor torque that is kept from one control period to the next: a low-pass filter. The
            rates shake with the panels and the journals, and a motor that has held the springs back until the last
            latch and lets go at once has them throw the array across the play.
    """

    cruise_rate: float = _bounded(0.08, 0.05, 0.2)
    latch_rate: float = _bounded(0.015, 0.001, 0.06)
    deceleration: float = _bounded(0.004, 0.0005, 0.02)
    gain: float = _bounded(20.0, 1.0, 80.0)
    joint_2_weight: float = _bounded(0.5, 0.0, 1.0)
    difference_damping: float = _bounded(0.0, 0.0, 40.0)
    postlock_damping: float = _bounded(0.0, 0.0, 10.0)
    postlock_stiffness: float = _bounded(0.0, 0.0, 20.0)
    smoothing: float = _bounded(0.0, 0.0, 0.95)


class VelocityProfileServo(TunableLaw[ServoParameters]):
    """Feedback that makes the opening follow a velocity profile which slows down towards latching.

    The profile is the one of constant deceleration, ``min(cruise, sqrt(latch^2 + 2 deceleration (1 - s)))``
    over the opening ``s``, but never slower than what is left of it takes to be done `RESERVE` ahead of the deadline.
    Joint 2 reaches its lock angle through the cable loop, not with joint 1; a profile for joint 1 alone does not lower
    the impact, so ``s`` mixes both. The torque is zero on the profile, and filtered.
    """

    reads = (*_READ, "motor_torque", "time_to_deadline")
    defaults = ServoParameters()

    def reference_rate(self, opening: np.ndarray, time_left: np.ndarray | float = np.inf) -> np.ndarray:
        """Opening rate of the profile [1/s].

        Args:
            opening: In units of the lock angle, any shape.
            time_left: Before the deadline [s], of the same shape.
        """
        p = self.parameters
        to_go = np.maximum(1.0 - opening, 0.0)
        profile = np.minimum(p.cruise_rate, np.sqrt(p.latch_rate**2 + 2.0 * p.deceleration * to_go))
        return np.maximum(profile, to_go / np.maximum(time_left - RESERVE, LEAST_TIME))

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        opening, rate, difference = _opening(entries, p.joint_2_weight)
        time_left = self._signals.deadline * entries["time_to_deadline"]
        deploying = p.gain * (self.reference_rate(opening, time_left) - rate) - p.difference_damping * difference
        off_lock = _LOCK_ANGLES[min(self._signals.driven_joint, 1)] * (entries["theta_driven"] - 1.0)
        holding = -p.postlock_damping * entries["rate_driven"] - p.postlock_stiffness * off_lock
        now = self._signals.torque_limit * entries["motor_torque"]
        return p.smoothing * now + (1.0 - p.smoothing) * np.where(all_latched, holding, deploying)


@dataclass(frozen=True)
class ShapedProfileParameters:
    """Parameters of `InputShapedProfile`; the field metadata hold the range that tuning searches.

    Opening is measured in units of the lock angle (0 folded, 1 locked), opening rates in 1/s.

    Attributes:
        duration: Time that the profile takes before it is shaped [s].
        latch_rate: Opening rate at its end [1/s].
        vibration_period: Period of the vibration that the shaper is not to excite [s]; 0 shapes nothing.
        gain: Torque per opening-rate error [N m s].
        stiffness: Torque per opening error [N m].
        joint_2_weight: Share of joint 2 in the opening that follows the profile; joint 1 has the rest.
        postlock_damping: Torque per rate of the driven joint after the last latch [N m s/rad].
    """

    duration: float = _bounded(15.0, 6.0, 19.5)
    latch_rate: float = _bounded(0.01, 0.001, 0.06)
    vibration_period: float = _bounded(1.0, 0.0, 4.0)
    gain: float = _bounded(20.0, 1.0, 80.0)
    stiffness: float = _bounded(2.0, 0.0, 20.0)
    joint_2_weight: float = _bounded(0.5, 0.0, 1.0)
    postlock_damping: float = _bounded(1.0, 0.0, 10.0)


class InputShapedProfile(TunableLaw[ShapedProfileParameters]):
    """Feedback that makes the opening follow a motion over time, shaped not to excite a vibration.

    The motion is the cubic from rest to the latch rate. The shaper of zero vibration for an undamped mode averages it
    with itself half a period later (N. C. Singer and W. P. Seering, Preshaping Command Inputs to Reduce System
    Vibration, J. Dyn. Syst. Meas. Control 112 (1990) 76-82, doi:10.1115/1.2894142).
    """

    reads = (*_READ, "time_to_deadline")
    defaults = ShapedProfileParameters()

    def reference(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Opening in units of the lock angle and its rate [1/s] at a time [s]; any shape."""
        first, later = self._unshaped(time), self._unshaped(time - 0.5 * self.parameters.vibration_period)
        return 0.5 * (first[0] + later[0]), 0.5 * (first[1] + later[1])

    def _unshaped(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        p = self.parameters
        u = np.clip(time / p.duration, 0.0, 1.0)
        end = p.latch_rate * p.duration
        beyond = np.maximum(time - p.duration, 0.0)
        opening = u * u * (3.0 - 2.0 * u) + end * u * u * (u - 1.0) + p.latch_rate * beyond
        return opening, (6.0 * u * (1.0 - u) + end * u * (3.0 * u - 2.0)) / p.duration

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        opening, rate, _ = _opening(entries, p.joint_2_weight)
        wanted, wanted_rate = self.reference((1.0 - entries["time_to_deadline"]) * self._signals.deadline)
        deploying = p.gain * (wanted_rate - rate) + p.stiffness * (wanted - opening)
        return np.where(all_latched, -p.postlock_damping * entries["rate_driven"], deploying)


_KNOTS = 16


@dataclass(frozen=True)
class OpenLoopParameters:
    """Parameters of `OpenLoopTorque`; the field metadata hold the range that tuning searches.

    Attributes:
        torques: At equal distances from the start to the deadline [N m].
    """

    torques: tuple[float, ...] = field(default=(0.0,) * _KNOTS, metadata={"bounds": (-0.5, 0.5)})


class OpenLoopTorque(TunableLaw[OpenLoopParameters]):
    """A torque over time, linear between given values, that looks at nothing but the clock; none after the deadline."""

    reads = ("time_to_deadline",)
    defaults = OpenLoopParameters()

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        to_go = entries["time_to_deadline"]
        torques = self.parameters.torques
        torque = np.interp(1.0 - to_go, np.linspace(0.0, 1.0, len(torques)), torques)
        return np.where(to_go > 0.0, torque, 0.0)


@dataclass(frozen=True)
class SoftStartParameters(ServoParameters):
    """Parameters of `SoftStartServo`; the field metadata hold the range that tuning searches.

    Attributes:
        torques: Every 4/3 s from the start of the deployment [N m].
        handover: When the servo begins to take over [s].
        blending: Time that it takes for that [s].
    """

    torques: tuple[float, ...] = field(default=(0.0,) * 12, metadata={"bounds": (-0.5, 0.5)})
    handover: float = _bounded(12.0, 8.0, 15.0)
    blending: float = _bounded(2.0, 0.1, 5.0)


class SoftStartServo(VelocityProfileServo):
    """A servo that lands the array, after a torque over time that starts it gently.

    The servo alone has the array hurry at once, to have time for the landing, and nearly all wear of a soft deployment
    comes from that. The last latch ends what is left of the torque over time.
    """

    parameters: SoftStartParameters
    defaults = SoftStartParameters()

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        time = (1.0 - entries["time_to_deadline"]) * self._signals.deadline
        of_time = np.interp(time, np.arange(len(p.torques)) * 4.0 / 3.0, p.torques)
        of_servo = np.where(all_latched, 1.0, np.clip((time - p.handover) / p.blending, 0.0, 1.0))
        return (1.0 - of_servo) * of_time + of_servo * super()._torque(entries, all_latched)
