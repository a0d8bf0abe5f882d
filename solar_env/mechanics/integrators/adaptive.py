"""Adaptive steps that land on events: explicit Runge-Kutta ones, and linearly implicit ones where those are worth it.

Events are roots of a step's own interpolant (``events.py``). Constraints are enforced on the acceleration level and by
projection of every accepted step.

During a step the contact mode of each joint is frozen, so that a step that runs into a bearing wall sees a smooth
vector field. The wall is then found as a root of the interpolant, the step is cut there at no further cost, and the
contact starts with its exact approach speed. Latchings are found in the same way. The steps of an impact are bounded
by a share of its duration, which impact speed and stiffness give beforehand.

With flexible bodies the explicit method (``runge_kutta.py``) is unstable beyond a known step. Where accuracy would
allow several times as long a one, a linearly implicit step is tried (``rosenbrock.py``).
"""

import math
from typing import NamedTuple

from solar_env.mechanics.arrays.lanes import lane_model, lane_state, take_ticket
from solar_env.mechanics.arrays.model import (
    APPROXIMATE,
    CLEARANCE,
    DONE,
    EVENTS_PILE_UP,
    EXACT,
    INTEGRALS_PER_JOINT,
    NOT_FINITE,
    PAUSED,
    SINGULAR_CONSTRAINTS,
    SLIDING_WORK,
    STEP_TOO_SMALL,
    TOO_MANY_STEPS,
    Model,
    State,
)
from solar_env.mechanics.equations.newton import fill_mass
from solar_env.mechanics.equations.system import (
    Workspace,
    accelerations,
    fill_columns,
    make_workspace,
    prepare_response,
    project,
)
from solar_env.mechanics.integrators.events import NONE, begin_event, first_event
from solar_env.mechanics.integrators.history import check_state, fail, impact_step_limit, note_force, settle_joints
from solar_env.mechanics.integrators.recording import pause_due, record_sample, sample_due
from solar_env.mechanics.integrators.rosenbrock import NEVER, Rosenbrock, attempt_rosenbrock, make_rosenbrock
from solar_env.mechanics.integrators.runge_kutta import (
    STAGES,
    Stages,
    StiffForces,
    attempt_step,
    error_norm,
    interpolate,
    interpolate_integrals,
    interpolate_without_accelerations,
    make_stages,
    make_stiff_forces,
)
from solar_env.mechanics.integrators.stiff_forces import lasts
from solar_env.mechanics.joints.contact import normal_force
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.profile import clear

_PEAK_SAMPLES = 8
_SMALLEST_STEP = 1e-13  # s, relative to max(time, 1 s)
# Share of the flexible bodies' stable step that is used: on its very limit their highest mode would not decay.
_STABILITY_MARGIN = 0.95
# A linearly implicit step is taken if it is so many times as long as the stable explicit one. It costs five times as
# much, but the explicit method's estimate sees the stiff vibrations too and promises less than can be had.
_WORTH = 2.5
# Its error is dissipation of vibrations that it does not resolve, which the energy book lacks: hence a stricter
# tolerance.
_STRICTER = 2.0
# After a try that has failed the next one waits for twice as many explicit steps, up to so many.
_LONGEST_WAIT = 256
# Events may follow each other without time between them, but not for ever.
_MOST_EVENTS_AT_ONCE = 1000


class AdaptiveArrays(NamedTuple):
    """Scratch arrays of :func:`advance_lanes`, of one thread; nothing in them outlives a lane's turn."""

    work: Workspace
    scratch: Workspace  # for evaluations that leave the other as it is
    stages: Stages
    stiff: StiffForces
    step: Rosenbrock


def make_adaptive_arrays(model: Model, state: State) -> AdaptiveArrays:
    """Allocate the arrays for a mechanism."""
    work = make_workspace(model, state)
    return AdaptiveArrays(
        work=work,
        scratch=make_workspace(model, state),
        stages=make_stages(state),
        stiff=make_stiff_forces(state),
        step=make_rosenbrock(model, state, work),
    )


@kernel(inner=True)
def refine_peak(model, state, stages, j, h, share):
    """Raise the force maxima of joint ``j`` to the peak inside the step: sampled, then a parabola through the top."""
    joint, own, markers = model.joints[j], state.joints[j], model.markers
    peak, before, here = 0.0, 0.0, 0.0
    for k in range(_PEAK_SAMPLES + 1):
        interpolate(state, stages, h, share * k / _PEAK_SAMPLES)
        depth, rate = penetration(joint, markers, stages.scratch_q, stages.scratch_v)
        after, _ = normal_force(depth, rate, joint.contact_stiffness, joint.damping_factor, own.impact_speed)
        peak = max(peak, after)
        if k >= 2 and here >= before and here > after:
            peak = max(peak, here + (after - before) ** 2 / (8.0 * (2.0 * here - before - after)))
        before, here = here, after
    note_force(own, peak, state.clock[0].latched_joints > 0)


@kernel(single_caller=True)
def refine_peaks(model, state, stages, h, share, coarse):
    """Find the force peaks that lie inside the step: where a penetration has turned from growing to falling.

    Not those of lasting contacts in ``coarse`` steps, linearly implicit or corrected for stiff contacts: their
    interpolant has depths that never were, see ``rosenbrock.take_contacts_from_ends`` and
    ``runge_kutta.interpolate_without_accelerations``, and forces up to a thousand times the real ones.
    """
    joints, markers, joint_states, time = model.joints, model.markers, state.joints, state.clock[0].time
    depth_rate, q, v = stages.depth_rate, stages.q, stages.v
    for j in range(joints.size):
        own = joint_states[j]
        if own.in_contact and depth_rate[j] > 0.0 and not (coarse and lasts(own, time)):
            _, rate = penetration(joints[j], markers, q, v)
            if rate <= 0.0:
                refine_peak(model, state, stages, j, h, share)


@kernel(inner=True)
def record_until(model, state, stages, stiff, scratch, recorder, h, end):
    """Take the samples that fall inside the accepted part of the step."""
    start = state.clock[0].time
    while sample_due(recorder, end):
        share = min(max((recorder.times[recorder.filled[0]] - start) / h, 0.0), 1.0) if h > 0.0 else 0.0
        interpolate(state, stages, h, share)
        if stiff.active[1] > 0:
            interpolate_without_accelerations(state, stages, h, share)
        interpolate_integrals(state, stages, h, share)
        record_sample(
            recorder,
            model,
            state.joints,
            stages.scratch_q,
            stages.scratch_v,
            start + share * h,
            stages.integrals,
            scratch,
            stages.scratch_a,
            stages.multipliers,
            stages.energies,
        )


@kernel(inner=True, inlined=True)
def set_impact_speeds(joint_states, impact_speeds):
    """Fill (joints,) with the impact speeds of the contacts under way, and zeros for free journals."""
    for j in range(joint_states.size):
        impact_speeds[j] = joint_states[j].impact_speed if joint_states[j].in_contact else 0.0


@kernel
def refresh(model, state, stages, work):
    """Evaluate the first stage at the accepted state, with its contact modes. False if constraints are singular."""
    set_impact_speeds(state.joints, work.impact_speeds)
    regular = accelerations(
        model,
        state.joints,
        state.q,
        state.v,
        state.clock[0].time,
        work,
        stages.acceleration[0],
        state.multipliers,
    )
    state.clock[0].evaluations += 1
    copy_into(stages.power[0], work.power)
    return regular


@kernel(single_caller=True)
def measure_depths(model, state, stages):
    """Penetration and its rate at the accepted state, for every clearance joint."""
    joints, markers, q, v = model.joints, model.markers, state.q, state.v
    depth, depth_rate = stages.depth, stages.depth_rate
    for j in range(joints.size):
        joint = joints[j]
        if joint.kind == CLEARANCE:
            depth[j], depth_rate[j] = penetration(joint, markers, q, v)


@kernel(single_caller=True)
def move_to(state, stages, h, share):
    """Take over the state at ``share`` of the step, with the integrals up to there."""
    integrals, gain, sliding_work = state.integrals, stages.gain, stages.sliding_work
    for j in range(sliding_work.size):
        sliding_work[j] = -integrals[INTEGRALS_PER_JOINT * j + SLIDING_WORK]
    if share < 1.0:
        interpolate(state, stages, h, share)
        interpolate_integrals(state, stages, h, share)
        copy_into(stages.q, stages.scratch_q)
        copy_into(stages.v, stages.scratch_v)
        copy_into(integrals, stages.integrals)
    else:
        for k in range(integrals.size):
            integrals[k] += gain[k]
    for j in range(sliding_work.size):
        sliding_work[j] += integrals[INTEGRALS_PER_JOINT * j + SLIDING_WORK]
    copy_into(state.q, stages.q)
    copy_into(state.v, stages.v)


@kernel(single_caller=True)
def accept(model, state, stages, stiff, work, scratch, recorder, h, share, event_joint, kind, implicit):
    """Move to ``share`` of the step and book what happened on the way.

    Args:
        implicit: whether the step was linearly implicit; ``work`` is then not that of the accelerations at its end.

    Returns:
        False if the constraints are singular.
    """
    impact_speeds = work.impact_speeds
    clock = state.clock[0]
    start = clock.time
    end = start + share * h
    if recorder.times.size > 0:
        copy_into(scratch.impact_speeds, impact_speeds)
        record_until(model, state, stages, stiff, scratch, recorder, h, end)
    refine_peaks(model, state, stages, h, share, implicit or stiff.active[1] > 0)
    move_to(state, stages, h, share)
    clock.time = end
    clock.steps += 1
    if (implicit or share < 1.0) and not prepare_response(model, state.q, end, work):
        return False
    project(model, state.q, state.v, end, work)
    if kind != NONE:
        begin_event(model, state, event_joint, kind, scratch)
        if not refresh(model, state, stages, work):
            return False
    else:
        copy_into(stages.acceleration[0], stages.acceleration[STAGES - 1])
        copy_into(stages.power[0], stages.power[STAGES - 1])
    settle_joints(model, state, work.loads, stages.sliding_work, start, stages.depth, recorder)
    set_impact_speeds(state.joints, impact_speeds)
    copy_into(stages.velocity[0], state.v)
    measure_depths(model, state, stages)
    return True


@kernel(single_caller=True)
def prepare_arrays(model, settings, arrays):
    """Fill what the scratch arrays hold of a model.

    Stages are cleared too: those that a step has not come to yet enter with the weight zero, which does not take away
    what is not finite.
    """
    for stage in range(STAGES):
        for array in (arrays.stages.velocity, arrays.stages.acceleration, arrays.stages.power):
            for i in range(array.shape[1]):
                array[stage, i] = 0.0
    for work in (arrays.work, arrays.scratch):
        for r in range(work.row_value.shape[0]):
            copy_into(work.row_value[r], model.constraints.value[r])
        fill_columns(model, work, False)
    if settings.linearly_implicit:
        clear(model.elimination, arrays.step.newton.mass)
        fill_mass(model, arrays.step.newton.mass)


@kernel(single_caller=True)
def advance_adaptive(model, state, settings, recorder, end_time, arrays):
    """Advance ``state`` in place to ``end_time`` [s]; returns a status code."""
    work, scratch, stages, stiff, step = arrays
    clock = state.clock[0]
    stiff.active[:] = 0
    step.linearized[0] = NEVER
    # Whether the accelerations solve the equations, not only to a step's tolerance.
    exact = True
    set_impact_speeds(state.joints, work.impact_speeds)
    if clock.acceleration_current == EXACT or clock.acceleration_current == APPROXIMATE:
        copy_into(stages.acceleration[0], state.a)
        copy_into(stages.power[0], state.power)
        exact = clock.acceleration_current == EXACT
    elif not refresh(model, state, stages, work):
        return fail(state, SINGULAR_CONSTRAINTS, -1, 0.0)
    copy_into(stages.velocity[0], state.v)
    measure_depths(model, state, stages)
    if recorder.times.size > 0:
        copy_into(scratch.impact_speeds, work.impact_speeds)
        record_until(model, state, stages, stiff, scratch, recorder, 0.0, clock.time)
    if clock.step_size <= 0.0:
        clock.step_size = 1e-6
        clock.last_error = 1.0
    status = DONE
    taken = 0
    at_once = 0
    while clock.time < end_time:
        if pause_due(recorder, clock.time, model.joints.size):
            status = PAUSED
            break
        if taken >= settings.max_steps:
            status = fail(state, TOO_MANY_STEPS, -1, float(taken))
            break
        limit = min(settings.max_step, impact_step_limit(state, clock.time, settings.impact_resolution))
        stable = _STABILITY_MARGIN * model.stable_step
        wanted = min(clock.step_size, limit)
        implicit = settings.linearly_implicit and clock.explicit_wait <= 0 and wanted > _WORTH * stable
        bound = stable < wanted and not implicit
        if bound:
            wanted = stable
        h = wanted
        last = clock.time + h >= end_time
        if last:
            h = end_time - clock.time
        taken += 1
        stiff.active[1] = 0
        if implicit:
            error = _STRICTER * attempt_rosenbrock(model, state, stages, step, work, settings, h)
        else:
            if not exact:
                exact = refresh(model, state, stages, work)
            error = -1.0
            if exact and attempt_step(model, state, stages, stiff, work, h):
                # With flexible bodies only stops are treated so.
                stiff.active[1] = stiff.active[0] if model.stable_step == math.inf else 0
                error = error_norm(model, state, stages, stiff, settings, h)
        if error < 0.0:
            status = fail(state, SINGULAR_CONSTRAINTS, -1, 0.0)
            break
        if not error <= 1.0:
            clock.rejected_steps += 1
            shrink = 0.9 * error**-0.25 if error < math.inf else 0.1
            clock.step_size = h * max(shrink, 0.1)
            if implicit and clock.step_size <= _WORTH * stable:
                clock.explicit_patience = min(max(2 * clock.explicit_patience, 4), _LONGEST_WAIT)
                clock.explicit_wait = clock.explicit_patience
            if not clock.step_size > _SMALLEST_STEP * max(1.0, abs(clock.time)):
                finite = math.isfinite(error)
                status = fail(state, STEP_TOO_SMALL if finite else NOT_FINITE, -1, error)
                break
            continue
        clock.stability_bound_steps += bound
        clock.explicit_wait -= not implicit
        if implicit:
            clock.explicit_patience = 0
            copy_into(state.multipliers, stages.multipliers)
        share, event_joint, kind = first_event(model, state, stages, work, h)
        at_once = 0 if clock.time + share * h > clock.time else at_once + 1
        if at_once > _MOST_EVENTS_AT_ONCE:
            status = fail(state, EVENTS_PILE_UP, event_joint, float(at_once))
            break
        if not accept(model, state, stages, stiff, work, scratch, recorder, h, share, event_joint, kind, implicit):
            status = fail(state, SINGULAR_CONSTRAINTS, -1, 0.0)
            break
        if last and share == 1.0:
            clock.time = end_time
        exact = not implicit or kind != NONE
        error = max(error, 1e-10)
        grow = min(0.9 * error**-0.18 * clock.last_error**0.1, 10.0)
        clock.last_error = max(error, 1e-4)
        # A step that was cut short by the end of the call or by an event says little about the next one.
        if not last:
            clock.step_size = wanted * max(grow, 0.2)
            if bound and settings.linearly_implicit:
                # What accuracy alone would allow.
                clock.step_size = max(clock.step_size, wanted * min(0.9 * error**-0.25, 10.0))
        else:
            clock.step_size = max(wanted, h * grow)
        status = check_state(model, state, work.loads)
        if status != DONE:
            break
    copy_into(state.a, stages.acceleration[0])
    copy_into(state.power, stages.power[0])
    clock.acceleration_current = EXACT if exact else APPROXIMATE
    return status


@kernel
def advance_lanes(models, states, settings, recorder, queue, counter, end_times, statuses, arrays):
    """Advance lanes one after the other, next to other threads that do the same.

    Args:
        models, states: of all lanes (``lanes.py``).
        settings: of the integrator.
        recorder: takes samples and contacts of every lane.
        queue: (k,) indices of the lanes to advance, in this order.
        counter: (1,) number of lanes in the queue that some thread has begun with.
        end_times: (lanes,) [s].
        statuses: (lanes,) status codes; written.
        arrays: the thread's own.
    """
    while True:
        ticket = take_ticket(counter)
        if ticket >= queue.size:
            break
        lane = queue[ticket]
        model, state = lane_model(models, lane), lane_state(states, lane)
        prepare_arrays(model, settings, arrays)
        statuses[lane] = advance_adaptive(model, state, settings, recorder, end_times[lane], arrays)
