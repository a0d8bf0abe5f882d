"""Kernels of the method `ModalRadau`: a call's start, and a step with its size, events, acceptance and samples.

A step is a pure function of the accepted state and its size. Where the run finds an event inside a step, it solves the
step again, cut there.
"""

import math
from typing import Any

import numpy as np

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.arrays.model import (
    DONE,
    EVENTS_PILE_UP,
    EXACT,
    NEWTON_STALLED,
    NOT_FINITE,
    SINGULAR_CONSTRAINTS,
    STEP_TOO_SMALL,
)
from solar_env.mechanics.modal.arrays import DEPTH, DEPTH_RATE, EVENTS, ITERATIONS, START, STUCK
from solar_env.mechanics.modal.panel.tables import LEVELS, fill_level, level_below, level_size
from solar_env.mechanics.modal.run.books import add_integrals, note_peaks
from solar_env.mechanics.modal.run.events import CONTACT_START, NONE, begin_event, event_function, first_event
from solar_env.mechanics.modal.run.sampling import record_modal_sample
from solar_env.mechanics.modal.step.acceptance import commit_step, keep_loads, step_error
from solar_env.mechanics.modal.step.equations import fill_torques
from solar_env.mechanics.modal.step.motion import look_at
from solar_env.mechanics.modal.step.solve import ModalSettings, solve_step
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.step_size import UNSOLVED, StepController, growth, shortened
from solar_env.mechanics.records.history import (
    check_joint,
    end_contact,
    fail,
    has_parted,
    impact_step_limit,
    parting_time,
    release_stop,
    wear_contact,
)
from solar_env.mechanics.records.recording import sample_due

_FIRST_STEP = 1e-4  # s
_MOST_EVENTS_AT_ONCE = 1000
_SMALLEST_PART = 1e-13  # s, before an event; in less time nothing moves
_CONTROL = StepController(4.0, most_growth=4.0)
# Of clearances, and angles [rad], by which an event may be missed.
_EVENT_TOLERANCE = 1e-6
# Level of tables for one step size, of the type of other levels: of another one kernels would be compiled anew.
_CUT = np.int64(0)
# Depth errors of a step over rtol, relative to the depth.
_DEPTH_TOLERANCE = 0.1


def convert_settings(chosen: Any) -> ModalSettings:
    """The settings `ModalRadau` as the kernels take them."""
    return ModalSettings(
        float(chosen.rtol),
        float(chosen.velocity_scale),
        float(chosen.rtol * _DEPTH_TOLERANCE),
        float(chosen.max_step),
        float(chosen.impact_resolution),
        int(chosen.max_steps),
    )


@kernel
def start_loads(model, state, work):
    """Torques of the laws at the start of a run."""
    look_at(model, state.q, state.v, work, START)
    fill_torques(model, state, work, START)
    for j in range(model.joints.size):
        state.loads[j, 2] = work.joints[j].torque
    for c in range(model.cables.size):
        state.cable_loads[c, 0] = work.cables[c].torque


@kernel(inner=True)
def settle_joints(model, state, work, start, recorder):
    """Book an accepted step that began at `start` [s]: wear, and the ends of contacts and stops that have opened."""
    time = state.clock[0].time
    for j in range(model.joints.size):
        joint, own, motion = model.joints[j], state.joints[j], work.joints[j].motion[START]
        if own.stop_engaged:
            release_stop(joint, own, motion[ANGLE], motion[RATE])
        if own.in_contact:
            if joint.wear_coefficient > 0.0 and work.joints[j].sliding_work > 0.0:
                angle = math.atan2(motion[ECCENTRICITY_Y], motion[ECCENTRICITY_X])
                journal = angle - work.attachments[joint.outboard].direction[START, 0]
                bearing = angle - work.attachments[joint.inboard].direction[START, 0]
                wear_contact(joint, state, j, journal, bearing, motion[DEPTH], work.joints[j].sliding_work)
            if has_parted(own, time, motion[DEPTH], motion[DEPTH_RATE]):
                end_contact(state, j, parting_time(start, time, work.joints[j].depth, motion[DEPTH]), recorder)
                for c in range(2):
                    state.loads[j, c] = 0.0
                    state.load_rates[j, c] = 0.0


@kernel(inlined=True)
def check_state(model, state, work):
    """Status of an accepted state: finite, contact depths and joint angles within what the model describes."""
    for i in range(state.q.size):
        if not math.isfinite(state.q[i] + state.v[i]):
            return fail(state, NOT_FINITE, -1, state.q[i])
    for j in range(model.joints.size):
        motion = work.joints[j].motion[START]
        status = check_joint(model.joints[j], state, j, motion[DEPTH], motion[ANGLE])
        if status != DONE:
            return status
    return DONE


@kernel(inner=True)
def record_until(model, state, work, recorder, start, h):
    """Take the samples that fall inside the step that has just been committed."""
    while sample_due(recorder, start + h):
        share = min(max((recorder.times[recorder.filled[0]] - start) / h, 0.0), 1.0) if h > 0.0 else 0.0
        record_modal_sample(model, state, work, recorder, h, share)


@kernel(inlined=True)
def accept_step(model, state, work, recorder, tables, level, h):
    """Move to the end of the solved step and book what has happened on the way."""
    clock = state.clock[0]
    start = clock.time
    if recorder.times.size > 0:
        copy_into(work.q, state.q)
        copy_into(work.v, state.v)
        copy_into(work.integrals, state.integrals)
    for j in range(model.joints.size):
        work.joints[j].depth = work.joints[j].motion[START, DEPTH]
    commit_step(model, state, work, tables, level, h)
    add_integrals(model, state, work, h)
    note_peaks(model, state, work)
    clock.time = start + h
    clock.steps += 1
    clock.last_step = h
    clock.acceleration_current = EXACT
    if recorder.times.size > 0:
        record_until(model, state, work, recorder, start, h)
    keep_loads(state, work, h)
    settle_joints(model, state, work, start, recorder)


@kernel(inlined=True)
def reject_step(clock, work, h, solved, error):
    """Shrink the step after a rejected one of size `h` [s]."""
    clock.rejected_steps += 1
    clock.failure_joint, clock.failure_value = -1 if solved else work.counts[STUCK], error
    # The step that is taken then does not grow at once.
    clock.last_error = 1.0
    clock.step_size = shortened(_CONTROL, h, error) if solved else UNSOLVED * h


@kernel(inlined=True)
def next_step_size(clock, h, error, cut):
    """Set the size that the next step is to have, from the error of one of size `h` [s].

    A vibration may pass through zero in the error of a step: that of the one before counts for a quarter.
    """
    error = max(error, 0.25 * clock.last_error)
    clock.last_error = max(error, _CONTROL.least_error)
    size = h * growth(_CONTROL, error, 1.0)
    clock.step_size = max(clock.step_size, size) if cut else size


@kernel(inner=True)
def begin_modal(model, state, settings, recorder, work):
    """Look at the present state and record the start of a call; a status code."""
    clock = state.clock[0]
    if recorder.times.size > 0:
        copy_into(work.q, state.q)
        copy_into(work.v, state.v)
        copy_into(work.integrals, state.integrals)
        for j in range(model.joints.size):
            for c in range(3):
                work.joints[j].load[0, c] = work.joints[j].load[1, c] = state.loads[j, c]
        record_until(model, state, work, recorder, clock.time, 0.0)
    look_at(model, state.q, state.v, work, START)
    if clock.step_size <= 0.0:
        clock.step_size = _FIRST_STEP
        clock.last_error = 1.0
    work.counts[:] = 0
    return DONE


@kernel(inlined=True)
def cut_tables(model, work, h):
    """Tables for a step size `h` [s] that is not tabled."""
    fill_level(model.panels, work.tables, _CUT, h, work.coefficients)
    return work.tables


@kernel(inlined=True)
def cut_at_event(model, state, work, settings, h, share, joint, kind):
    """Solve a step of size `h` [s] again up to an event at a share of it: size, joint and kind of event at its end.

    Vibrations within a long step pass by the cubic that has placed the event: it is placed again in the cut one. The
    size is negative if Newton's iteration does not converge; the kind is NONE if the event is not reached.
    """
    while True:
        h *= share
        if not solve_step(model, state, work, settings, cut_tables(model, work, h), _CUT, h):
            return -h, joint, kind
        past = event_function(model, state, work, joint, kind, h, 1.0)
        tolerance = _EVENT_TOLERANCE * (model.joints[joint].clearance if kind == CONTACT_START else 1.0)
        if past < -tolerance:
            return h, joint, NONE
        if past <= tolerance:
            return h, joint, kind
        share, joint, kind = first_event(model, state, work, h)
        if kind == NONE or share >= 1.0 or share * h <= _SMALLEST_PART:
            return h, joint, kind


@kernel(inner=True)
def take_modal_step(model, state, settings, recorder, end_time, work):
    """Try a step towards `end_time` [s], and take it if its error allows, up to its first event; a status code."""
    clock = state.clock[0]
    wanted = min(clock.step_size, settings.max_step)
    wanted = min(wanted, impact_step_limit(state, clock.time, settings.impact_resolution))
    tables, level = model.tables, level_below(wanted)
    if level == LEVELS:
        # Joint and value are those of the latest step that was refused.
        if math.isfinite(clock.failure_value):
            return STEP_TOO_SMALL
        return NEWTON_STALLED if clock.failure_joint >= 0 else SINGULAR_CONSTRAINTS
    h = level_size(level)
    # No sliver of a step is left before the end.
    last = end_time - clock.time <= max(wanted, 1.05 * h)
    if last:
        h = end_time - clock.time
        tables, level = cut_tables(model, work, h), _CUT
    size = h
    solved = solve_step(model, state, work, settings, tables, level, h)
    error = step_error(model, state, work, settings, tables, level, h) if solved else math.inf
    clock.evaluations += work.counts[ITERATIONS]
    work.counts[ITERATIONS] = 0
    if not error <= 1.0:
        reject_step(clock, work, h, solved, error)
        return DONE
    share, joint, kind = first_event(model, state, work, h)
    work.counts[EVENTS] = 0 if share * h > _SMALLEST_PART else work.counts[EVENTS] + 1
    if work.counts[EVENTS] > _MOST_EVENTS_AT_ONCE:
        return fail(state, EVENTS_PILE_UP, joint, float(work.counts[EVENTS]))
    if kind != NONE and work.counts[EVENTS] > 0:
        begin_event(model, state, work, joint, kind)
        return DONE
    if kind != NONE and share < 1.0:
        last = False
        h, joint, kind = cut_at_event(model, state, work, settings, h, share, joint, kind)
        clock.evaluations += work.counts[ITERATIONS]
        work.counts[ITERATIONS] = 0
        tables, level = work.tables, _CUT
        if h < 0.0:
            reject_step(clock, work, -h, False, math.inf)
            return DONE
    accept_step(model, state, work, recorder, tables, level, h)
    if last:
        clock.time = end_time
    next_step_size(clock, size, error, last)
    if kind != NONE:
        begin_event(model, state, work, joint, kind)
    return check_state(model, state, work)
