"""The control task: limits and times, the motors' torques, the drives' own rate loops, the end of an episode."""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.array.names import unknown_name
from solar_env.environment.hardware import Hardware, response
from solar_env.mechanics.integrators.formulations import view_joint_of
from solar_env.mechanics.numerics.jit import kernel
from solar_env.support.numbers import is_number, is_whole_number

ACTIONS = ("torque", "rate")
# An action a of "rate" asks for a rate of SLOWEST sinh(STEEPNESS a): evenly spaced in its logarithm, and signed. The
# fastest, 0.27 rad/s, is twice what a deployment in time takes; rates of a soft landing are a thousandth of it.
SLOWEST, STEEPNESS = 5e-4, 7.0  # [rad/s], -

# A motor: the index of its joint, its greatest torque [N m], the share of the way to a new torque that it goes between
# two samples and the greatest change of its torque in that time [N m]; the gain of its rate loop [N m s/rad], 0 where
# actions are torques, and the share of the way that the loop's filter goes.
_MOTOR = ("torque_limit", "response", "largest_change", "rate_gain", "rate_response")
motor_type = np.dtype((np.record, np.dtype([("joint", "i8"), *((name, "f8") for name in _MOTOR)], align=True)))


class TaskNumbers(NamedTuple):
    """A `Task` for kernels: times [s], and a row of `motor_type` for each motor."""

    control_period: float
    deadline: float
    postlock_window: float
    sample_period: float
    motors: NDArray[Any]


@dataclass(frozen=True)
class Task:
    """Limits and times of the task, and the hinge that the motor sits on.

    Attributes:
        torque_limit: greatest motor torque [N m].
        control_period: time between two actions [s].
        deadline: time by which every joint must have latched [s].
        postlock_window: time after the last latching during which the episode goes on [s].
        driven_joint: index of the joint that the motor works on; 0 is the root hinge.
        action: "torque", in units of the torque limit, or "rate": the setpoint 5e-4 sinh(7 a) rad/s, from -0.27 to
            0.27, of the rate loop of the hinge drive, whose torque is `Hardware.rate_loop_gain` times the error of the
            rate, at most the torque limit, anew `Hardware.rate_loop_frequency` times in a second, and filtered.

    Raises:
        ValueError: on construction, for a value out of range.
    """

    torque_limit: float
    control_period: float
    deadline: float
    postlock_window: float
    driven_joint: int = 0
    action: str = "torque"

    def __post_init__(self) -> None:
        if self.action not in ACTIONS:
            raise ValueError(unknown_name("the action", self.action, ACTIONS))
        for name in ("torque_limit", "control_period", "deadline", "postlock_window"):
            value = getattr(self, name)
            if not (is_number(value) and 0.0 < value < math.inf):
                raise ValueError(f"{name} = {value!r} must be a positive finite number")
        for name in ("postlock_window", "deadline"):
            if getattr(self, name) < self.control_period:
                raise ValueError(
                    f"{name} = {getattr(self, name)!r} s is below control_period = {self.control_period!r} s"
                )
        if not is_whole_number(self.driven_joint, 0):
            raise ValueError(
                f"driven_joint = {self.driven_joint!r} must be the index of a joint, a whole number from 0"
            )

    @property
    def driven_joints(self) -> tuple[int, ...]:
        """Joint of each motor; an action has an entry for each."""
        return (self.driven_joint,)

    def samples(self, hardware: Hardware) -> int:
        """Samples of the drive in a control period: 1 where actions are torques.

        Raises:
            ValueError: if the samples of the rate loop do not fill a control period.
        """
        if self.action == "torque":
            return 1
        samples = self.control_period * hardware.rate_loop_frequency
        if round(samples) < 1 or not math.isclose(samples, round(samples), rel_tol=1e-9):
            raise ValueError(
                f"rate_loop_frequency = {hardware.rate_loop_frequency!r} Hz makes {samples:g} samples of a control "
                f"period of {self.control_period!r} s; give one that makes a whole number, at least 1"
            )
        return round(samples)

    def numbers(self, hardware: Hardware) -> TaskNumbers:
        """The task, with the drives that it is done with, as the kernels take it."""
        period = self.control_period / self.samples(hardware)
        drive = (
            self.torque_limit,
            response(hardware.motor_lag, period),
            hardware.torque_rate_limit * period,
            hardware.rate_loop_gain if self.action == "rate" else 0.0,
            response(hardware.rate_loop_lag, period),
        )
        motors = np.array([(joint, *drive) for joint in self.driven_joints], dtype=motor_type)
        deadline, window = float(self.deadline), float(self.postlock_window)
        return TaskNumbers(float(self.control_period), deadline, window, period, motors)


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
def begin_period(state, task):
    """Forget the peak forces of the last control period, and return when the next one ends [s].

    It ends after a whole number of control periods, which are counted so that rounding does not build up, or with the
    episode if that ends before.
    """
    for j in range(state.joints.size):
        state.joints[j].recent_peak_force = 0.0
    end = (round(state.clock[0].time / task.control_period) + 1) * task.control_period
    latched_at = last_latch(state.joints)
    return min(end, latched_at + task.postlock_window if latched_at == latched_at else task.deadline)


@kernel(single_caller=True)
def loop_torque(model, state, motor, action, rate_error, before):
    """Torque that the drive's rate loop asks of the motor [N m]: within the limit, and filtered.

    Args:
        model, state: of the array.
        motor: row of `motor_type`.
        action: the rate's setpoint, in [-1, 1].
        rate_error: of the rate that the loop measures [rad/s].
        before: what the loop asked at its last sample [N m].
    """
    rate = view_joint_of(model)(model, state, motor.joint).rate + rate_error
    torque = motor.rate_gain * (SLOWEST * math.sinh(STEEPNESS * action) - rate)
    return before + motor.rate_response * (min(max(torque, -motor.torque_limit), motor.torque_limit) - before)


@kernel(single_caller=True)
def set_torque(state, motor, torque):
    """Set the torque that a motor, with its lag and its rate limit, reaches of the one asked for until the next sample.

    Args:
        state: of the array.
        motor: row of `motor_type`.
        torque: that is asked of the motor [N m].
    """
    driven = state.joints[motor.joint]
    if motor.response < 1.0:
        torque = driven.motor_torque + motor.response * (torque - driven.motor_torque)
    change = motor.largest_change
    torque = min(max(torque, driven.motor_torque - change), driven.motor_torque + change)
    if driven.motor_torque != torque:
        driven.motor_torque = torque
        state.clock[0].acceleration_current = 0


@kernel(single_caller=True)
def begin_sample(model, state, task, actions, rate_errors, loop_torques, period_end):
    """Set the motors' torques, and return until when the drives hold them [s].

    Args:
        model, state: of the array.
        task: TaskNumbers.
        actions: (motors,) torques in units of the limit, or setpoints of the rate; clipped to [-1, 1].
        rate_errors: (motors,) of the rates that the drives' loops measure [rad/s].
        loop_torques: (motors,) that the loops ask of the motors [N m]; brought up to date.
        period_end: end of the control period [s].
    """
    for k in range(task.motors.size):
        motor, action = task.motors[k], min(max(actions[k], -1.0), 1.0)
        torque = motor.torque_limit * action
        if motor.rate_gain > 0.0:
            torque = loop_torque(model, state, motor, action, rate_errors[k], loop_torques[k])
            loop_torques[k] = torque
        set_torque(state, motor, torque)
    end = (round(state.clock[0].time / task.sample_period) + 1) * task.sample_period
    return end if end < period_end - 1e-6 * task.sample_period else period_end


@kernel(inner=True)
def missed_deadline(state, task):
    """Whether a joint is still open at the deadline."""
    latched_at = last_latch(state.joints)
    return latched_at != latched_at and state.clock[0].time >= task.deadline


@kernel(single_caller=True)
def has_ended(state, task):
    """Whether the episode is over: one window after the last latching, or at a missed deadline."""
    return missed_deadline(state, task) or state.clock[0].time >= last_latch(state.joints) + task.postlock_window
