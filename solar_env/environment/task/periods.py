"""A control period, lane by lane; a single environment is a batch of one lane.

Below, `models` and `states` are handles of the arrays of all lanes, `task` is TaskNumbers, and `periods` is Periods.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.environment.task.control import last_latch, missed_deadline
from solar_env.environment.task.observations import observe
from solar_env.environment.task.reward import charge
from solar_env.environment.task.task import SLOWEST, STEEPNESS, TaskNumbers
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.lanes import lane_view, take_ticket
from solar_env.mechanics.integrators.formulations import view_joint_of
from solar_env.mechanics.integrators.run import advance_lanes
from solar_env.mechanics.numerics.by_address import call_at
from solar_env.mechanics.numerics.handles import arrays_of
from solar_env.mechanics.numerics.jit import kernel


class Periods(NamedTuple):
    """The present control periods of all lanes."""

    actions: NDArray[np.float64]  # (lanes, motors) torques in units of the limit, or setpoints of the rate; clipped
    rate_errors: NDArray[np.float64]  # (lanes, samples, motors) of the rates that the drives' loops measure [rad/s]
    loop_torques: NDArray[np.float64]  # (lanes, motors) that the loops ask of the motors [N m]
    end_times: NDArray[np.float64]  # (lanes,) [s]
    sample_ends: NDArray[np.float64]  # (lanes,) until when the drives hold the torques [s]
    samples_left: NDArray[np.int64]  # (lanes,) number of samples of the drives that are not over
    counters: NDArray[np.int64]  # (lanes, 1) of `advance_lanes` in one lane
    accounts: NDArray[np.float64]  # (lanes, terms, 2) of `reward.charge`
    terms: NDArray[np.float64]  # (lanes, terms) of the reward
    rewards: NDArray[np.float64]  # (lanes,) their sums
    exact: NDArray[np.float32]  # (lanes, measured) observations
    terminated: NDArray[np.bool_]  # (lanes,) whether the episode is over


def make_periods(lanes: int, task: TaskNumbers, terms: int, exact: NDArray[np.float32]) -> Periods:
    """Allocate the arrays of some lanes, whose observations `exact` (lanes, measured) are."""
    motors = task.motors.size
    return Periods(
        np.zeros((lanes, motors)),
        np.zeros((lanes, task.samples, motors)),
        np.zeros((lanes, motors)),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes, np.int64),
        np.zeros((lanes, 1), np.int64),
        np.zeros((lanes, terms, 2)),
        np.zeros((lanes, terms)),
        np.zeros(lanes),
        exact,
        np.zeros(lanes, np.bool_),
    )


@kernel
def begin_period(state, task, periods, lane):
    """Forget the peak forces of the last control period, and set when the next one ends.

    It ends after a whole number of control periods, which are counted so that rounding does not build up, or with the
    episode if that ends before.
    """
    for j in range(state.joints.size):
        state.joints[j].recent_peak_force = 0.0
    end = (round(state.clock[0].time / task.control_period) + 1) * task.control_period
    latched_at = last_latch(state.joints)
    last = latched_at + task.settling_window if latched_at == latched_at else task.deadline
    periods.end_times[lane], periods.samples_left[lane] = min(end, last), task.samples


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


@kernel
def begin_sample(model, state, task, periods, lane):
    """Set the motor torques, and until when the drives hold them."""
    sample = task.samples - periods.samples_left[lane]
    for k in range(task.motors.size):
        motor, action = task.motors[k], min(max(periods.actions[lane, k], -1.0), 1.0)
        torque = motor.torque_limit * action
        if motor.rate_gain > 0.0:
            error, before = periods.rate_errors[lane, sample, k], periods.loop_torques[lane, k]
            torque = loop_torque(model, state, motor, action, error, before)
            periods.loop_torques[lane, k] = torque
        set_torque(state, motor, torque)
    end, last = (round(state.clock[0].time / task.sample_period) + 1) * task.sample_period, periods.end_times[lane]
    periods.sample_ends[lane] = end if end < last - 1e-6 * task.sample_period else last


@kernel
def end_period(model, state, task, channels, prices, periods, lane):
    """Charge and observe a period, and tell whether the episode is over.

    It is one window after the last latching, or at a missed deadline.
    """
    periods.rewards[lane] = charge(model, state, task, prices, periods.accounts[lane], periods.terms[lane])
    observe(model, state, task, channels, periods.exact[lane])
    over = state.clock[0].time >= last_latch(state.joints) + task.settling_window
    periods.terminated[lane] = missed_deadline(state, task) or over


@kernel(inlined=False)
def hold_lanes(
    models, states, settings, recorder, arrays, queue, counter, steps_left, statuses,
    address, task, channels, prices, periods,
):  # fmt: skip
    """Hold actions for a control period in lanes one after the other, next to other threads that do the same.

    Args:
        models, states, settings, recorder, arrays, queue, counter, steps_left, statuses: of `advance_lanes`.
        address: of `advance_lanes` for these.
        task: TaskNumbers.
        channels: (measured,) of `observations.channels`.
        prices: (terms,) of `reward.Reward`.
        periods: of all lanes; those that fail keep what they have observed and earned.
    """
    while True:
        ticket = take_ticket(counter)
        if ticket >= queue.size:
            break
        lane = queue[ticket]
        model, state = lane_view(arrays_of(models), lane), lane_view(arrays_of(states), lane)
        # With too few steps left, the last call ended within a sample.
        if statuses[lane] != m.TOO_MANY_STEPS:
            begin_period(state, task, periods, lane)
        while periods.samples_left[lane] > 0:
            if statuses[lane] != m.TOO_MANY_STEPS:
                begin_sample(model, state, task, periods, lane)
            periods.counters[lane, 0] = 0
            call_at(
                address, advance_lanes, models, states, settings, recorder, arrays, queue[ticket : ticket + 1],
                periods.counters[lane], steps_left, statuses, periods.sample_ends,
            )  # fmt: skip
            if statuses[lane] != m.DONE:
                break
            periods.samples_left[lane] -= 1
        if statuses[lane] == m.DONE:
            end_period(model, state, task, channels, prices, periods, lane)


@kernel(inlined=False)
def observe_lanes(models, states, task, channels, lanes, observations):
    """Write the observation of the present state, `observations` (lanes, measured) float32."""
    for lane in lanes:
        model, state = lane_view(arrays_of(models), lane), lane_view(arrays_of(states), lane)
        observe(model, state, task, channels, observations[lane])
