"""The task in a simulation: the motors' torques, the drives' own rate loops, the end of an episode."""

import math

from solar_env.environment.task.task import SLOWEST, STEEPNESS
from solar_env.mechanics.integrators.formulations import view_joint_of
from solar_env.mechanics.numerics.jit import kernel


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
