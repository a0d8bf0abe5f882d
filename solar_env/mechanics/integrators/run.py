"""Run loop for all methods: it controls step sizes, ends steps at events, and updates records and joint states.

During a step the contact mode of each joint is frozen, so that a step into a bearing wall sees a smooth vector field.
The wall is then located on the motion inside the step (`events.py`). The step is shortened to end at the wall, and the
contact starts with the exact approach speed. Latchings and stop engagements are treated likewise. Steps in an impact
are bounded by a fraction of the impact's duration, which is predicted from impact speed and stiffness.
"""

import math

import numpy as np

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.lanes import lane_view, take_ticket
from solar_env.mechanics.integrators.events import (
    LATCHING,
    NO_EVENT,
    SMALLEST_PART,
    begin_event,
    begin_passed_events,
    place_of_event,
)
from solar_env.mechanics.integrators.methods.table import (
    NOT_AT_ALL,
    adapt_of,
    attempt_of,
    begin_of,
    choose_of,
    commit_of,
    complete_of,
    contact_arcs_of,
    controller_of,
    evaluate_of,
    landing_of,
    note_peaks_of,
    resume_of,
    sample_of,
)
from solar_env.mechanics.numerics.handles import arrays_of
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import all_finite
from solar_env.mechanics.numerics.step_size import growth, shortened
from solar_env.mechanics.records.history import (
    check_joint,
    end_contact,
    fail,
    has_parted,
    next_release,
    note_force,
    note_latch_torque,
    parting_time,
    release_joints,
    release_stop,
    wear_contact,
)
from solar_env.mechanics.records.recording import pause_due, sample_due

_SMALLEST_STEP = 1e-13  # smallest step divided by max(time, 1 s)
# Most events that may follow each other with no time between them.
_MOST_EVENTS_AT_ONCE = 1000


@kernel
def record_until(model, state, settings, arrays, recorder, h, end):
    """Record all samples that are due up to `end` [s] in the step `h` [s] that the work arrays `arrays` hold."""
    start = state.clock[0].time
    while sample_due(recorder, end):
        share = min(max((recorder.times[recorder.filled[0]] - start) / h, 0.0), 1.0) if h > 0.0 else 0.0
        sample_of(settings)(model, state, settings, arrays, recorder, h, share)


@kernel(inlined=False)
def begin_call(model, state, settings, recorder, arrays):
    """Prepare the arrays for a call of `advance`, and record samples due at its start; return a status code."""
    arrays.trial[0].at_once = 0
    if not begin_of(settings)(model, state, settings, arrays):
        return fail(state, m.SINGULAR_CONSTRAINTS, -1, 0.0)
    if recorder.times.size > 0:
        record_until(model, state, settings, arrays, recorder, 0.0, state.clock[0].time)
    return m.DONE


@kernel
def choose_step(model, state, settings, arrays, end_time):
    """Choose the longest step that accuracy, impacts, settings and `end_time` [s] allow; store it in `arrays.trial`."""
    clock, trial = state.clock[0], arrays.trial[0]
    remaining = end_time - clock.time
    trial.retry, trial.reason, trial.joint = 0.0, m.DONE, -1
    trial.bound = trial.implicit = trial.stiff_contacts = trial.cuts = 0
    trial.wanted = choose_of(settings)(model, state, settings, arrays, remaining)
    trial.last = trial.wanted >= remaining
    trial.step = remaining if trial.last else trial.wanted


@kernel
def reject(model, state, settings, arrays, h, error):
    """Store a shorter next step in `state.clock` after a rejected step `h` [s] with `error`; return a status code."""
    clock, trial, control = state.clock[0], arrays.trial[0], controller_of(settings)
    clock.rejected_steps += 1
    if trial.retry == 0.0:
        clock.step_size = shortened(control, h, error)
    elif trial.retry > 0.0:
        clock.step_size = trial.retry
    if control.memory > 0.0:
        # The next accepted step then does not make its successor grow at once.
        clock.last_error = 1.0
    adapt_of(settings)(model, state, settings, arrays, False)
    if trial.retry < 0.0 or not clock.step_size > _SMALLEST_STEP * max(1.0, abs(clock.time)):
        reason = m.STEP_TOO_SMALL if math.isfinite(error) else m.NOT_FINITE
        return fail(state, reason if trial.reason == m.DONE else trial.reason, trial.joint, error)
    return m.DONE


@kernel
def choose_next(model, state, settings, arrays):
    """Store the next step's size, computed from the error of the accepted step, in `state.clock`."""
    clock, trial, control = state.clock[0], arrays.trial[0], controller_of(settings)
    error = max(trial.error, control.memory * clock.last_error)
    grow = growth(control, error, clock.last_error)
    clock.last_error = max(error, 1e-4)
    # A step that was cut short by the end of the call says little about the next one.
    clock.step_size = max(trial.wanted, trial.step * grow) if trial.last else trial.step * grow
    clock.stability_bound_steps += trial.bound
    adapt_of(settings)(model, state, settings, arrays, True)


@kernel
def settle_joints(model, state, settings, arrays, recorder, start, event_joint):
    """Update the joints after an accepted step from `start` [s]: wear, force maxima, and ends of contacts and stops.

    The stop of `event_joint`, whose event has ended the step, is not released.
    """
    time, latched = state.clock[0].time, state.clock[0].latched_joints > 0
    for j in range(model.joints.size):
        joint, joint_state, motion = model.joints[j], state.joints[j], arrays.motion[j]
        note_latch_torque(joint, joint_state, motion.angle, motion.rate)
        if joint_state.stop_engaged and j != event_joint:
            release_stop(joint, joint_state, motion.angle, motion.rate)
        if joint.kind != m.CLEARANCE:
            note_force(joint_state, motion.force, latched)
        elif joint_state.in_contact:
            note_force(joint_state, motion.force, latched)
            if joint.wear_coefficient > 0.0 and motion.sliding_work > 0.0:
                journal, bearing = contact_arcs_of(settings)(model, state, arrays, j)
                wear_contact(joint, state, j, journal, bearing, motion.depth, motion.sliding_work)
            if has_parted(joint_state, time, motion.depth, motion.depth_rate):
                end_contact(state, j, parting_time(start, time, motion.start_depth, motion.depth), recorder)


@kernel
def accept(model, state, settings, arrays, recorder, h, share, joint, kind):
    """Move `state` to the fraction `share` of a step `h` [s], and record it; return False if constraints are singular.

    Unless `kind` is NO_EVENT, `joint` then starts its contact, latches or engages its stop.
    """
    clock, start = state.clock[0], state.clock[0].time
    end = start + share * h
    complete_of(settings)(model, state, settings, arrays, h)
    if recorder.times.size > 0:
        record_until(model, state, settings, arrays, recorder, h, end)
    note_peaks_of(settings)(model, state, arrays, h, share)
    for j in range(model.joints.size):
        motion, first = arrays.motion[j], m.INTEGRALS_PER_JOINT * j
        motion.start_depth, motion.start_depth_rate = motion.depth, motion.depth_rate
        motion.start_angle = motion.angle
        motion.sliding_work = -state.integrals[first + m.SLIDING_WORK]
    if not commit_of(settings)(model, state, settings, arrays, h, share):
        return False
    clock.time = end
    clock.steps += 1
    for j in range(model.joints.size):
        arrays.motion[j].sliding_work += state.integrals[m.INTEGRALS_PER_JOINT * j + m.SLIDING_WORK]
    if kind != NO_EVENT:
        begin_event(model, state, settings, arrays, joint, kind, end, arrays.motion[joint].depth_rate)
    if not evaluate_of(settings)(model, state, arrays, kind != NO_EVENT):
        return False
    if landing_of(settings) == NOT_AT_ALL:
        begin_passed_events(model, state, settings, arrays, start, h)
    settle_joints(model, state, settings, arrays, recorder, start, joint)
    resume_of(settings)(model, state, arrays)
    return True


@kernel
def begin_at_once(model, state, settings, arrays, joint, kind):
    """Begin event `kind` of `joint` at `state` without taking a step, and update the method's work `arrays`.

    Kinds are CONTACT_START, LATCHING and STOP_ENGAGEMENT. Return the status code DONE, or EVENTS_PILE_UP after 1000
    such events without a step between them, or SINGULAR_CONSTRAINTS.
    """
    trial = arrays.trial[0]
    trial.at_once += 1
    if trial.at_once > _MOST_EVENTS_AT_ONCE:
        return fail(state, m.EVENTS_PILE_UP, joint, float(trial.at_once))
    time, speed = state.clock[0].time, arrays.motion[joint].depth_rate
    begin_event(model, state, settings, arrays, joint, kind, time, speed)
    if kind == LATCHING:
        state.joints[joint].latch_rate = arrays.motion[joint].rate
    if not evaluate_of(settings)(model, state, arrays, True):
        return fail(state, m.SINGULAR_CONSTRAINTS, -1, 0.0)
    resume_of(settings)(model, state, arrays)
    return m.DONE


@kernel
def check_state(model, state, arrays):
    """Check that `state` is finite, and depths and angles in `arrays.motion` are in range; return a status code."""
    if not (all_finite(state.q) and all_finite(state.v)):
        return fail(state, m.NOT_FINITE, -1, math.nan)
    for j in range(model.joints.size):
        motion = arrays.motion[j]
        status = check_joint(model.joints[j], state, j, motion.depth, motion.angle)
        if status != m.DONE:
            return status
    return m.DONE


@kernel
def take_step(model, state, settings, recorder, end_time, arrays):
    """Try a step towards `end_time` [s]; if its error is within the tolerance, accept it up to its first event.

    `arrays` are the method's work arrays. Return the status code DONE, even after a rejection, or an error's code.
    """
    trial = arrays.trial[0]
    choose_step(model, state, settings, arrays, end_time)
    h, share, joint, kind, again = trial.step, 1.0, np.int64(-1), NO_EVENT, True
    while again:
        error = attempt_of(settings)(model, state, settings, arrays, h)
        if error < 0.0:
            return fail(state, m.SINGULAR_CONSTRAINTS, -1, 0.0)
        if not error <= 1.0:
            return reject(model, state, settings, arrays, h, error)
        if trial.cuts == 0:
            trial.error = error
        again = False
        if landing_of(settings) != NOT_AT_ALL:
            share, joint, kind, again = place_of_event(model, state, settings, arrays, h, joint, kind)
        if again:
            h *= share
            trial.cuts += 1
    if kind != NO_EVENT and share * h <= SMALLEST_PART:
        return begin_at_once(model, state, settings, arrays, joint, kind)
    trial.at_once = 0
    if not accept(model, state, settings, arrays, recorder, h, share, joint, kind):
        return fail(state, m.SINGULAR_CONSTRAINTS, -1, 0.0)
    if trial.last and share * h == trial.step:
        state.clock[0].time = end_time
    choose_next(model, state, settings, arrays)
    return check_state(model, state, arrays)


@kernel
def advance(model, state, settings, recorder, end_time, steps_left, arrays):
    """Advance `state` to `end_time` [s], using the method's work `arrays`; return a status code, and the steps left.

    A call that stops at the step limit does not shorten its last step: continuing the run gives bit-identical results.
    """
    clock = state.clock[0]
    status = begin_call(model, state, settings, recorder, arrays)
    while status == m.DONE and clock.time < end_time:
        if pause_due(recorder, clock.time, model.joints.size):
            return m.PAUSED, steps_left
        if steps_left <= 0:
            return m.TOO_MANY_STEPS, steps_left
        if release_joints(model, state, arrays.motion):
            status = begin_call(model, state, settings, recorder, arrays)
            continue
        steps_left -= 1
        status = take_step(model, state, settings, recorder, next_release(state, end_time), arrays)
    return status, steps_left


@kernel(inlined=False)
def advance_lanes(models, states, settings, recorder, arrays, queue, counter, steps_left, statuses, end_times):
    """Advance the lanes of a batch (one mechanism each) from a queue that several threads share.

    Args:
        models, states: handles (addresses) through which compiled code reaches the arrays of all lanes (`lanes.py`).
        settings: the integration method's settings in the kernels' types; their type selects the method.
        recorder: records samples and contacts of every lane.
        arrays: handle of the thread's work arrays.
        queue: (k,) indices of the lanes to advance, in this order.
        counter: (1,) number of queue entries that threads have taken so far.
        steps_left: (lanes,) number of steps that each lane may still try, rejected steps included; updated.
        statuses: (lanes,) status codes; written.
        end_times: (lanes,) times [s] up to which the lanes are advanced.
    """
    while True:
        ticket = take_ticket(counter)
        if ticket >= queue.size:
            break
        lane = queue[ticket]
        model, state = lane_view(arrays_of(models), lane), lane_view(arrays_of(states), lane)
        status, left = advance(model, state, settings, recorder, end_times[lane], steps_left[lane], arrays_of(arrays))
        statuses[lane], steps_left[lane] = status, left
