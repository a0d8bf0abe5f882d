"""A control period, lane by lane; a single environment is a batch of one lane.

Below, `models` and `states` are handles of the arrays of all lanes, `task` is a lane's TaskNumbers, and `periods` is
Periods.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.environment.task.control import all_latched, end_of_episode
from solar_env.environment.task.drive import MEMORY, TaskNumbers, asked_torque, numbers_of, set_torque
from solar_env.environment.task.observations import observe
from solar_env.environment.task.reward import charge
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.lanes import lane_view, take_ticket
from solar_env.mechanics.integrators.run import advance_lanes
from solar_env.mechanics.numerics.by_address import call_at
from solar_env.mechanics.numerics.handles import arrays_of
from solar_env.mechanics.numerics.jit import kernel

_SAME = 1e-6  # of a period: less is the rounding of the time


class Periods(NamedTuple):
    """The present control periods of all lanes."""

    actions: NDArray[np.float64]  # (lanes, motors) torques in units of the limit, or setpoints of the rate; clipped
    rate_errors: NDArray[np.float64]  # (lanes, samples, motors) of the rates that the drives' loops measure [rad/s]
    drives: NDArray[np.float64]  # (lanes, motors, MEMORY) what they remember
    end_times: NDArray[np.float64]  # (lanes,) [s]
    sample_ends: NDArray[np.float64]  # (lanes,) until when the drives hold the torques [s]
    samples: NDArray[np.int64]  # (lanes,) number of samples of the drives that are over
    counters: NDArray[np.int64]  # (lanes, 1) of `advance_lanes` in one lane
    accounts: NDArray[np.float64]  # (lanes, terms, 2) of `reward.charge`
    terms: NDArray[np.float64]  # (lanes, terms) of the reward
    rewards: NDArray[np.float64]  # (lanes,) their sums
    exact: NDArray[np.float32]  # (lanes, measured) observations
    terminated: NDArray[np.bool_]  # (lanes,) whether the episode is over


def settling_samples(task: TaskNumbers) -> int:
    """Return the number of samples of the drives in a settling window, the first and last ones cut short."""
    return math.ceil(task.settling_window / task.sample_period) + 1


def make_periods(lanes: int, task: TaskNumbers, terms: int, exact: NDArray[np.float32]) -> Periods:
    """Allocate the arrays of some lanes; `exact` (lanes, measured) holds their observations."""
    motors = task.motors.shape[-1]
    return Periods(
        np.zeros((lanes, motors)),
        np.zeros((lanes, task.samples + (settling_samples(task) if task.drive_settles else 0), motors)),
        np.zeros((lanes, motors, MEMORY)),
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
    """Forget the peak forces of the last control period, and set the end of the next one.

    It ends after a whole number of control periods, which are counted so that rounding does not build up, or with the
    episode if that ends before.
    """
    for j in range(state.joints.size):
        state.joints[j].recent_peak_force = 0.0
    end = (math.floor(state.clock[0].time / task.control_period + _SAME) + 1) * task.control_period
    last = end_of_episode(state, task)
    periods.end_times[lane] = last if last < end + _SAME * task.control_period else end
    periods.samples[lane] = 0


@kernel
def begin_sample(model, state, task, periods, lane):
    """Set the motor torques, and until when the drives hold them."""
    settling, sample = task.drive_settles and all_latched(state.joints), periods.samples[lane]
    for k in range(task.motors.size):
        motor, action = task.motors[k], min(max(periods.actions[lane, k], -1.0), 1.0)
        memory, error = periods.drives[lane, k], periods.rate_errors[lane, sample, k]
        set_torque(state, motor, asked_torque(model, state, task, motor, memory, action, error, settling))
    samples, last = math.floor(state.clock[0].time / task.sample_period + _SAME) + 1, periods.end_times[lane]
    end = samples * task.sample_period
    periods.sample_ends[lane] = end if end < last - _SAME * task.sample_period else last


@kernel
def end_period(model, state, task, channels, prices, periods, lane):
    """Charge and observe a period, and record whether the episode is over.

    An episode is over a settling window after the last latching, or when the time for latching is up.
    """
    periods.rewards[lane] = charge(model, state, task, prices, periods.accounts[lane], periods.terms[lane])
    observe(model, state, task, channels, periods.drives[lane], periods.exact[lane])
    periods.terminated[lane] = state.clock[0].time >= end_of_episode(state, task)


@kernel(inlined=False)
def hold_lanes(
    models, states, settings, recorder, arrays, queue, counter, steps_left, statuses,
    address, tasks, channels, prices, periods,
):  # fmt: skip
    """Hold actions for a control period in lanes one after the other, next to other threads that do the same.

    Args:
        models, states, settings, recorder, arrays, queue, counter, steps_left, statuses: of `advance_lanes`.
        address: of `advance_lanes` for these.
        tasks: TaskNumbers of all lanes.
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
        task = numbers_of(tasks, lane)
        # With too few steps left, the last call ended within a sample.
        if statuses[lane] != m.TOO_MANY_STEPS:
            begin_period(state, task, periods, lane)
        while state.clock[0].time < periods.end_times[lane]:
            if statuses[lane] != m.TOO_MANY_STEPS:
                begin_sample(model, state, task, periods, lane)
            periods.counters[lane, 0] = 0
            call_at(
                address, advance_lanes, models, states, settings, recorder, arrays, queue[ticket : ticket + 1],
                periods.counters[lane], steps_left, statuses, periods.sample_ends,
            )  # fmt: skip
            if statuses[lane] != m.DONE:
                break
            periods.samples[lane] += 1
            if task.drive_settles and all_latched(state.joints):
                periods.end_times[lane] = end_of_episode(state, task)
        if statuses[lane] == m.DONE:
            end_period(model, state, task, channels, prices, periods, lane)


@kernel(inlined=False)
def observe_lanes(models, states, tasks, channels, drives, lanes, observations):
    """Write the observation of the present state, `observations` (lanes, measured) float32."""
    for lane in lanes:
        model, state = lane_view(arrays_of(models), lane), lane_view(arrays_of(states), lane)
        observe(model, state, numbers_of(tasks, lane), channels, drives[lane], observations[lane])
