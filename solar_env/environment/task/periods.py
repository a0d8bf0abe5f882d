"""Beginning and end of a control period, lane by lane; a single environment is a batch of one lane.

Below, `models` and `states` are arrays of all lanes, `task` is TaskNumbers, and `lanes` (k,) names those meant.
"""

import math

from solar_env.environment.task.control import last_latch, missed_deadline
from solar_env.environment.task.observations import observe
from solar_env.environment.task.reward import charge
from solar_env.environment.task.task import SLOWEST, STEEPNESS
from solar_env.mechanics.arrays.lanes import lane_view
from solar_env.mechanics.integrators.formulations import view_joint_of
from solar_env.mechanics.numerics.jit import kernel


@kernel(inlined=False)
def begin_periods(states, task, lanes, end_times):
    """Forget the peak forces of the last control period, and write when the next one ends, `end_times` (lanes,) [s].

    It ends after a whole number of control periods, which are counted so that rounding does not build up, or with the
    episode if that ends before.
    """
    for lane in lanes:
        state = lane_view(states, lane)
        for j in range(state.joints.size):
            state.joints[j].recent_peak_force = 0.0
        end = (round(state.clock[0].time / task.control_period) + 1) * task.control_period
        latched_at = last_latch(state.joints)
        end_times[lane] = min(end, latched_at + task.settling_window if latched_at == latched_at else task.deadline)


@kernel
def loop_torque(model, state, motor, action, rate_error, before):
    """Torque that the drive's rate loop asks of the motor [N m]: within the limit, and filtered.

    The action is the rate's setpoint, in [-1, 1]; `before` is what the loop asked at its last sample [N m].
    """
    rate = view_joint_of(model)(model, state, motor.joint).rate + rate_error
    torque = motor.rate_gain * (SLOWEST * math.sinh(STEEPNESS * action) - rate)
    return before + motor.rate_response * (min(max(torque, -motor.torque_limit), motor.torque_limit) - before)


@kernel
def set_torque(state, motor, torque):
    """Set the torque that a motor reaches of the one asked for until the next sample, by its lag and rate limit."""
    driven = state.joints[motor.joint]
    if motor.response < 1.0:
        torque = driven.motor_torque + motor.response * (torque - driven.motor_torque)
    change = motor.largest_change
    torque = min(max(torque, driven.motor_torque - change), driven.motor_torque + change)
    if driven.motor_torque != torque:
        driven.motor_torque = torque
        state.clock[0].acceleration_current = 0


@kernel(inlined=False)
def begin_samples(models, states, task, lanes, actions, rate_errors, loop_torques, end_times, sample_ends):
    """Set the motor torques, and write until when the drives hold them, `sample_ends` (lanes,) [s].

    Args:
        models, states, task, lanes: as above.
        actions: (lanes, motors) torques in units of the limit, or setpoints of the rate; clipped to [-1, 1].
        rate_errors: (lanes, motors) of the rates that the drives' loops measure [rad/s].
        loop_torques: (lanes, motors) that the loops ask of the motors [N m]; brought up to date.
        end_times: (lanes,) ends of the control period [s].
        sample_ends: written.
    """
    for lane in lanes:
        model, state = lane_view(models, lane), lane_view(states, lane)
        for k in range(task.motors.size):
            motor, action = task.motors[k], min(max(actions[lane, k], -1.0), 1.0)
            torque = motor.torque_limit * action
            if motor.rate_gain > 0.0:
                torque = loop_torque(model, state, motor, action, rate_errors[lane, k], loop_torques[lane, k])
                loop_torques[lane, k] = torque
            set_torque(state, motor, torque)
        end = (round(state.clock[0].time / task.sample_period) + 1) * task.sample_period
        sample_ends[lane] = end if end < end_times[lane] - 1e-6 * task.sample_period else end_times[lane]


@kernel(inlined=False)
def end_periods(models, states, task, channels, prices, lanes, accounts, terms, rewards, observations, terminated):
    """Charge and observe a period that has ended.

    Args:
        models, states, task, lanes: as above.
        channels: (measured,) of `observations.channels`.
        prices: (terms,) of `reward.Reward`.
        accounts: (lanes, terms, 2) of `reward.charge`; updated.
        terms: (lanes, terms) of the reward; written, as is all that follows.
        rewards: (lanes,) their sums.
        observations: (lanes, measured) float32.
        terminated: (lanes,) whether the episode is over: one window after the last latching, or at a missed deadline.
    """
    for lane in lanes:
        model, state = lane_view(models, lane), lane_view(states, lane)
        rewards[lane] = charge(model, state, task, prices, accounts[lane], terms[lane])
        observe(model, state, task, channels, observations[lane])
        over = state.clock[0].time >= last_latch(state.joints) + task.settling_window
        terminated[lane] = missed_deadline(state, task) or over


@kernel(inlined=False)
def observe_lanes(models, states, task, channels, lanes, observations):
    """Write the observation of the present state, `observations` (lanes, measured) float32."""
    for lane in lanes:
        observe(lane_view(models, lane), lane_view(states, lane), task, channels, observations[lane])
