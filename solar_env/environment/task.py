"""The control task on a deploying array: what is observed, what is charged, when an episode ends.

The kernels work on lanes (``mechanics/lanes.py``): a single environment is a batch of one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.environment.hardware import Hardware
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.lanes import lane_model, lane_state
from solar_env.mechanics.joints.joint import joint_motion, relative
from solar_env.mechanics.numerics.jit import kernel

OBSERVATIONS = ("drive", "history", "privileged")
# Control periods that the observation "history" looks back.
HISTORY = 3
# What the reward is the sum of.
REWARD_TERMS = ("peak_impact", "wear", "missed_deadline")


@dataclass(frozen=True)
class Task:
    """Limits, durations and prices of the task.

    Attributes:
        torque_limit: greatest motor torque on the root hinge [N m].
        control_period: time between two actions [s].
        deadline: time by which every joint must have latched [s].
        postlock_window: time after the last latching during which the episode goes on [s].
        force_scale: peak post-lock force, summed over the joints, that costs 1 [N].
        work_scale: post-lock sliding work, summed over the joints, that costs 1 [J]; wear is proportional to it.
        largest_charge: bound on what peak force and on what wear may cost in one episode.
        missed_deadline_cost: cost of a missed deadline; above twice the largest charge, so that no deployment is
            worse than none.
    """

    torque_limit: float = 0.5
    control_period: float = 0.1
    deadline: float = 20.0
    postlock_window: float = 10.0
    force_scale: float = 500.0
    work_scale: float = 0.05
    largest_charge: float = 12.0
    missed_deadline_cost: float = 25.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < value < math.inf:
                raise ValueError(f"{name} = {value!r} must be a positive finite number")
        if self.postlock_window < self.control_period:
            raise ValueError(
                f"postlock_window = {self.postlock_window!r} s is below control_period = {self.control_period!r} s"
            )
        if self.deadline < self.control_period:
            raise ValueError(f"deadline = {self.deadline!r} s is below control_period = {self.control_period!r} s")
        if self.missed_deadline_cost <= 2.0 * self.largest_charge:
            raise ValueError(
                f"missed_deadline_cost = {self.missed_deadline_cost!r} must exceed twice largest_charge = "
                f"{self.largest_charge!r}, or not deploying would pay"
            )

    def numbers(self, hardware: Hardware) -> TaskNumbers:
        """The task, with the motor that it is done with, as the kernels take it."""
        values = {
            **vars(self),
            "motor_response": hardware.motor_response(self.control_period),
            "largest_torque_change": hardware.torque_rate_limit * self.control_period,
        }
        return TaskNumbers(**{name: float(value) for name, value in values.items()})


class TaskNumbers(NamedTuple):
    """A :class:`Task` for kernels, with what the motor can do in a period: share of the way, and greatest change."""

    torque_limit: float
    control_period: float
    deadline: float
    postlock_window: float
    force_scale: float
    work_scale: float
    largest_charge: float
    missed_deadline_cost: float
    motor_response: float
    largest_torque_change: float


class Entry(NamedTuple):
    """One entry of an observation: its name, its unit as observed, and its bounds."""

    name: str
    unit: str
    low: float
    high: float


def observation_entries(joints: int, observation: str) -> tuple[Entry, ...]:
    """Entries of an observation, in order; values outside the bounds are clipped to them.

    Raises:
        ValueError: if the kind of observation is unknown.
    """
    if observation not in OBSERVATIONS:
        raise ValueError(f"observation {observation!r} is unknown; choose from {', '.join(OBSERVATIONS)}")
    numbers = range(1, joints + 1)
    entries = [Entry(f"theta_{k}", "lock angle", -2.0, 2.0) for k in numbers]
    entries += [Entry(f"rate_{k}", "rad/s", -5.0, 5.0) for k in numbers]
    entries += [Entry(f"latched_{k}", "0 or 1", 0.0, 1.0) for k in numbers]
    entries += [
        Entry("motor_torque", "torque limit", -1.0, 1.0),
        Entry("time_to_deadline", "deadline", 0.0, 1.0),
        Entry("time_since_latch", "post-lock window", 0.0, 1.0),
    ]
    if observation == "privileged":
        for k in numbers:
            entries += [
                Entry(f"eccentricity_x_{k}", "clearance", -2.0, 2.0),
                Entry(f"eccentricity_y_{k}", "clearance", -2.0, 2.0),
                Entry(f"in_contact_{k}", "0 or 1", 0.0, 1.0),
            ]
        entries.append(Entry("main_body_spin", "rad/s", -1.0, 1.0))
    if observation == "history":
        remembered = [*entries[: 2 * joints], entries[3 * joints]]
        for back in range(1, HISTORY + 1):
            entries += [entry._replace(name=f"{entry.name}_{back}_ago") for entry in remembered]
    return tuple(entries)


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
def observe(model, state, task, privileged, low, high, out):
    """Write the observation of the present state to ``out``, within its bounds, as :func:`observation_entries` lists.

    Args:
        model, state: of the array.
        task: TaskNumbers.
        privileged: whether what only a simulator knows is observed too.
        low, high: (entries,) bounds.
        out: (entries,) float32.
    """
    joints, joint_states, markers = model.joints, state.joints, model.markers
    count = joints.size
    time = state.clock[0].time
    spin = 0.0
    for j in range(count):
        joint, own = joints[j], joint_states[j]
        angle, rate, _, inboard_spin = joint_motion(joint, markers, state.q, state.v)
        if j == 0:
            spin = inboard_spin
        out[j] = angle / joint.lock_angle
        out[count + j] = rate
        out[2 * count + j] = own.latched
        if privileged:
            k = 3 * count + 3 + 3 * j
            ex, ey = relative(joint, markers, state.q)
            scale = 1.0 / joint.clearance if joint.kind == m.CLEARANCE else 0.0
            out[k], out[k + 1], out[k + 2] = ex * scale, ey * scale, own.in_contact
    out[3 * count] = joint_states[0].motor_torque / task.torque_limit
    out[3 * count + 1] = (task.deadline - time) / task.deadline
    latched_at = last_latch(joint_states)
    out[3 * count + 2] = (time - latched_at) / task.postlock_window if latched_at == latched_at else 0.0
    if privileged:
        out[6 * count + 3] = spin
    for k in range(out.size):
        out[k] = min(max(out[k], low[k]), high[k])


@kernel(single_caller=True)
def charge(state, task, charged, terms):
    """Write to ``terms`` what peak force and wear since the first latching cost beyond ``charged``, and raise that."""
    peak, work = 0.0, 0.0
    if state.clock[0].latched_joints > 0:
        for j in range(state.joints.size):
            own = state.joints[j]
            peak += own.postlock_peak_force
            work += state.integrals[m.INTEGRALS_PER_JOINT * j + m.SLIDING_WORK] - own.lock_sliding_work
    peak = min(peak / task.force_scale, task.largest_charge)
    work = min(work / task.work_scale, task.largest_charge)
    terms[0], terms[1] = charged[0] - peak, charged[1] - work
    charged[0], charged[1] = peak, work


@kernel(single_caller=True)
def begin_period(state, task, action):
    """Set the motor torque for an action, and return when its period ends [s].

    The torque is the one that the motor, with its lag and its rate limit, reaches in the period. The period ends after
    a whole number of control periods, which are counted so that rounding does not build up, or with the episode if that
    ends before.
    """
    own, clock = state.joints[0], state.clock[0]
    torque = task.torque_limit * min(max(action, -1.0), 1.0)
    if task.motor_response < 1.0:
        torque = own.motor_torque + task.motor_response * (torque - own.motor_torque)
    change = task.largest_torque_change
    torque = min(max(torque, own.motor_torque - change), own.motor_torque + change)
    if own.motor_torque != torque:
        own.motor_torque = torque
        clock.acceleration_current = 0
    for j in range(state.joints.size):
        state.joints[j].recent_peak_force = 0.0
    end = (round(clock.time / task.control_period) + 1) * task.control_period
    latched_at = last_latch(state.joints)
    return min(end, latched_at + task.postlock_window if latched_at == latched_at else task.deadline)


@kernel(single_caller=True)
def end_period(model, state, task, privileged, low, high, charged, terms, observation):
    """Write reward terms and observation of a period that has ended; returns whether the episode has, too.

    Args:
        model, state: of the array.
        task: TaskNumbers.
        privileged, low, high: of :func:`observe`.
        charged: (2,) what peak force and wear have cost so far; raised.
        terms: (3,) the terms of the reward, in the order of REWARD_TERMS.
        observation: (entries,) float32.
    """
    charge(state, task, charged, terms)
    time, latched_at = state.clock[0].time, last_latch(state.joints)
    if latched_at == latched_at:
        missed, terminated = False, time >= latched_at + task.postlock_window
    else:
        missed = terminated = time >= task.deadline
    terms[2] = -task.missed_deadline_cost if missed else 0.0
    observe(model, state, task, privileged, low, high, observation)
    return terminated


@kernel
def begin_periods(states, task, lanes, actions, end_times):
    """:func:`begin_period` for the lanes (k,) named; actions and ends of the periods are by lane."""
    for lane in lanes:
        end_times[lane] = begin_period(lane_state(states, lane), task, actions[lane])


@kernel
def end_periods(models, states, task, privileged, low, high, lanes, charged, terms, observations, terminated):
    """:func:`end_period` for the lanes (k,) named; what it writes is by lane."""
    for lane in lanes:
        model, state = lane_model(models, lane), lane_state(states, lane)
        terminated[lane] = end_period(
            model, state, task, privileged, low, high, charged[lane], terms[lane], observations[lane]
        )


@kernel
def observe_lanes(models, states, task, privileged, low, high, lanes, observations):
    """:func:`observe` for the lanes (k,) named; observations are by lane."""
    for lane in lanes:
        model, state = lane_model(models, lane), lane_state(states, lane)
        observe(model, state, task, privileged, low, high, observations[lane])


def wear_depths(state: m.State) -> NDArray[np.float64]:
    """(joints,) deepest wear of either surface [m]."""
    return np.maximum(state.wear_journal.max(axis=1), state.wear_bearing.max(axis=1))
