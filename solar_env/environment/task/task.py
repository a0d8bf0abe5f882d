"""The control task: limits and durations, the motor's torque in a control period, the end of an episode."""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from solar_env.environment.hardware import Hardware
from solar_env.mechanics.numerics.jit import kernel


class TaskNumbers(NamedTuple):
    """A `Task` for kernels, with what the motor can do in a period: share of the way, and greatest change."""

    torque_limit: float
    control_period: float
    deadline: float
    postlock_window: float
    driven_joint: int
    motor_response: float
    largest_change: float


@dataclass(frozen=True)
class Task:
    """Limits and durations of the task, and the hinge that the motor sits on.

    Attributes:
        torque_limit: greatest motor torque [N m].
        control_period: time between two actions [s].
        deadline: time by which every joint must have latched [s].
        postlock_window: time after the last latching during which the episode goes on [s].
        driven_joint: index of the joint that the motor works on; 0 is the root hinge.

    Raises:
        ValueError: on construction, for a value out of range.
    """

    torque_limit: float = 0.5
    control_period: float = 0.1
    deadline: float = 20.0
    postlock_window: float = 10.0
    driven_joint: int = 0

    def __post_init__(self) -> None:
        for name in ("torque_limit", "control_period", "deadline", "postlock_window"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < value < math.inf:
                raise ValueError(f"{name} = {value!r} must be a positive finite number")
        for name in ("postlock_window", "deadline"):
            if getattr(self, name) < self.control_period:
                raise ValueError(
                    f"{name} = {getattr(self, name)!r} s is below control_period = {self.control_period!r} s"
                )
        joint: object = self.driven_joint
        if isinstance(joint, bool) or not isinstance(joint, int) or joint < 0:
            raise ValueError(f"driven_joint = {joint!r} must be the index of a joint, a whole number from 0")

    def numbers(self, hardware: Hardware) -> TaskNumbers:
        """The task, with the motor that it is done with, as the kernels take it."""
        numbers: dict[str, Any] = {name: float(value) for name, value in vars(self).items()}
        numbers["driven_joint"] = self.driven_joint
        response, rate = hardware.motor_response(self.control_period), hardware.torque_rate_limit
        return TaskNumbers(**numbers, motor_response=response, largest_change=float(rate * self.control_period))


@kernel(single_caller=True)
def last_latch(joint_states):
    """Time of the last latching [s], or nan while a joint is open."""
    latest = -math.inf
    for j in range(joint_states.size):
        if not joint_states[j].latched:
            return math.nan
        latest = max(latest, joint_states[j].latch_time)
    return latest


@kernel(single_caller=True)
def begin_period(state, task, action):
    """Set the motor torque for an action, and return when its period ends [s].

    The torque is the one that the motor, with its lag and its rate limit, reaches in the period. The period ends after
    a whole number of control periods, which are counted so that rounding does not build up, or with the episode if that
    ends before.
    """
    own, clock = state.joints[task.driven_joint], state.clock[0]
    torque = task.torque_limit * min(max(action, -1.0), 1.0)
    if task.motor_response < 1.0:
        torque = own.motor_torque + task.motor_response * (torque - own.motor_torque)
    change = task.largest_change
    torque = min(max(torque, own.motor_torque - change), own.motor_torque + change)
    if own.motor_torque != torque:
        own.motor_torque = torque
        clock.acceleration_current = 0
    for j in range(state.joints.size):
        state.joints[j].recent_peak_force = 0.0
    end = (round(clock.time / task.control_period) + 1) * task.control_period
    latched_at = last_latch(state.joints)
    return min(end, latched_at + task.postlock_window if latched_at == latched_at else task.deadline)


@kernel(inner=True)
def missed_deadline(state, task):
    """Whether a joint is still open at the deadline."""
    latched_at = last_latch(state.joints)
    return latched_at != latched_at and state.clock[0].time >= task.deadline


@kernel(single_caller=True)
def has_ended(state, task):
    """Whether the episode is over: one window after the last latching, or at a missed deadline."""
    return missed_deadline(state, task) or state.clock[0].time >= last_latch(state.joints) + task.postlock_window
