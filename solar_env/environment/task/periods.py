"""The control period in the environments of a batch, called lanes; a single environment is a batch of one lane.

In this module `models` and `states` are addresses (handles) of the arrays of all lanes for compiled code, `task` is one
lane's `TaskNumbers`, and `periods` is the `Periods` of all lanes.
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

_SAME = 1e-6  # fraction of a period; smaller differences of time are rounding


class Periods(NamedTuple):
    """Arrays of actions, times and results of the present control period, for all lanes (environments) of a batch."""

    actions: NDArray[np.float64]  # (lanes, motors) see `Task.action`; kernels clip actions to [-1, 1]
    rate_errors: NDArray[np.float64]  # (lanes, samples, motors) errors of the rate loops' measured rates [rad/s]
    drives: NDArray[np.float64]  # (lanes, motors, MEMORY) memories of the drives
    end_times: NDArray[np.float64]  # (lanes,) ends of the control periods [s]
    sample_ends: NDArray[np.float64]  # (lanes,) ends of the drives' present samples [s]
    samples: NDArray[np.int64]  # (lanes,) numbers of completed drive samples
    counters: NDArray[np.int64]  # (lanes, 1) queue counters for `advance_lanes`, called with a single lane
    accounts: NDArray[np.float64]  # (lanes, terms, 2) accounts of `reward.charge`
    terms: NDArray[np.float64]  # (lanes, terms) reward terms
    rewards: NDArray[np.float64]  # (lanes,) rewards, the sums of the terms
    exact: NDArray[np.float32]  # (lanes, measured) exact observations, without sensor effects
    terminated: NDArray[np.bool_]  # (lanes,) whether the episode is over


def error_count(task: TaskNumbers) -> int:
    """Return the greatest number of the drives' sampling intervals in a step of the environment.

    All drives sample together; every measured rate has one random error in each interval. If the drives bring the array
    to rest, the step of the last latching includes the settling window, whose first and last interval may be short.
    """
    period = float(task.sample_period)
    return round(task.control_period / period) + (
        math.ceil(task.settling_window / period) + 1 if task.drive_settles else 0
    )


def make_periods(lanes: int, motors: int, errors: int, terms: int, exact: NDArray[np.float32]) -> Periods:
    """Allocate `Periods` (actions, times and results of a control period) for a batch of `lanes` environments.

    Each has `motors` motors and `terms` reward terms. `errors` is the greatest number of random errors that a motor's
    measured rate has in an environment step (`error_count`). `exact` (lanes, measured) will take exact observations.
    """
    return Periods(
        np.zeros((lanes, motors)),
        np.zeros((lanes, errors, motors)),
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
    """Reset all joints' `recent_peak_force`; write the end of environment `lane`'s next period to `periods.end_times`.

    The end is a multiple of the period, so that rounding errors do not add up, or an earlier end of the episode.
    """
    for j in range(state.joints.size):
        state.joints[j].recent_peak_force = 0.0
    end = (math.floor(state.clock[0].time / task.control_period + _SAME) + 1) * task.control_period
    last = end_of_episode(state, task)
    periods.end_times[lane] = last if last < end + _SAME * task.control_period else end
    periods.samples[lane] = 0


@kernel
def begin_sample(model, state, task, periods, lane):
    """Set motor torques in environment `lane` for the drives' next sampling interval; write `periods.sample_ends`."""
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
    """Write reward, observations without sensor effects, and `terminated` of environment `lane` to `periods`.

    `channels` are records of the observed quantities, `prices` of the reward terms. An episode ends
    `task.settling_window` after the last latching, or at `task.last_chance` if a joint is still open.
    """
    periods.rewards[lane] = charge(model, state, task, prices, periods.accounts[lane], periods.terms[lane])
    observe(model, state, task, channels, periods.drives[lane], periods.exact[lane])
    periods.terminated[lane] = state.clock[0].time >= end_of_episode(state, task)


@kernel(inlined=False)
def hold_lanes(
    models, states, settings, recorder, arrays, queue, counter, steps_left, statuses,
    address, tasks, channels, prices, periods,
):  # fmt: skip
    """Advance lanes (environments) from a queue, which threads share, by a control period with constant actions.

    Args:
        models, states, arrays: handles (addresses) of the lanes' models and states, and of the thread's work arrays.
        settings, recorder: integrator settings in the kernels' types, and recorder of samples and contacts.
        queue, counter: (k,) lanes to advance, and (1,) number of lanes that threads have taken so far.
        steps_left, statuses: (lanes,) number of integration steps left, and status codes; both are written.
        address: address of `advance_lanes` compiled for these arguments.
        tasks: `TaskNumbers` of all lanes.
        channels: (measured,) records of the observed quantities, from `observations.channels`.
        prices: (terms,) records of the reward terms, from `reward.Reward.rows`.
        periods: `Periods` of all lanes: actions are read; rewards and observations are written, unless a lane fails.
    """
    while True:
        ticket = take_ticket(counter)
        if ticket >= queue.size:
            break
        lane = queue[ticket]
        model, state = lane_view(arrays_of(models), lane), lane_view(arrays_of(states), lane)
        task = numbers_of(tasks, lane)
        # A lane whose steps ran out in the last call continues within its sample.
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
    """Write exact quantities, without sensors, to rows `lanes` (k,) of `observations` (environments, measured) float32.

    `channels` (measured,) are records of the quantities, `drives` (environments, motors, MEMORY) the drives' states.
    """
    for lane in lanes:
        model, state = lane_view(arrays_of(models), lane), lane_view(arrays_of(states), lane)
        observe(model, state, numbers_of(tasks, lane), channels, drives[lane], observations[lane])
