"""Acceptance of an adaptive step: samples, force peaks, the move to its end or event, and what is booked there."""

from solar_env.mechanics.arrays.model import APPROXIMATE, CLEARANCE, EXACT, INTEGRALS_PER_JOINT, SLIDING_WORK
from solar_env.mechanics.equations.constraints import prepare_response, project
from solar_env.mechanics.integrators.events import NO_EVENT, begin_event
from solar_env.mechanics.integrators.methods.stiff_forces import lasts
from solar_env.mechanics.integrators.methods.table import integrals_of, interpolate_of
from solar_env.mechanics.integrators.step import interpolate_without_accelerations, refresh, set_impact_speeds
from solar_env.mechanics.joints.contact.normal_force import normal_force
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.records.history import note_force, settle_joints
from solar_env.mechanics.records.recording import record_sample, sample_due

_PEAK_SAMPLES = 8


@kernel(inner=True)
def refine_peak(model, state, settings, stages, j, h, share):
    """Raise the force maxima of joint `j` to the peak inside the step: sampled, then a parabola through the top."""
    joint, own, markers = model.joints[j], state.joints[j], model.markers
    peak, before, here = 0.0, 0.0, 0.0
    for k in range(_PEAK_SAMPLES + 1):
        interpolate_of(settings)(state, stages, h, share * k / _PEAK_SAMPLES)
        depth, rate = penetration(joint, markers, stages.scratch_q, stages.scratch_v)
        after, _, _, _ = normal_force(joint, depth, rate, own.impact_speed)
        peak = max(peak, after)
        if k >= 2 and here >= before and here > after:
            peak = max(peak, here + (after - before) ** 2 / (8.0 * (2.0 * here - before - after)))
        before, here = here, after
    note_force(own, peak, state.clock[0].latched_joints > 0)


@kernel(single_caller=True)
def refine_peaks(model, state, settings, stages, h, share):
    """Find the force peaks that lie inside the step: where a penetration has turned from growing to falling.

    Not those of lasting contacts in steps that are linearly implicit or corrected for stiff contacts: their interpolant
    has depths that never were, see `rosenbrock.take_contacts_from_ends` and
    `step.interpolate_without_accelerations`, and forces up to a thousand times the real ones.
    """
    coarse = stages.trial[0].implicit or stages.trial[0].stiff_contacts
    joints, markers, joint_states, time = model.joints, model.markers, state.joints, state.clock[0].time
    depth_rate, q, v = stages.depth_rate, stages.q, stages.v
    for j in range(joints.size):
        own = joint_states[j]
        if own.in_contact and depth_rate[j] > 0.0 and not (coarse and lasts(own, time)):
            _, rate = penetration(joints[j], markers, q, v)
            if rate <= 0.0:
                refine_peak(model, state, settings, stages, j, h, share)


@kernel(inner=True)
def record_until(model, state, settings, stages, scratch, recorder, h, end):
    """Take the samples that fall inside the accepted part of the step."""
    start = state.clock[0].time
    while sample_due(recorder, end):
        share = min(max((recorder.times[recorder.filled[0]] - start) / h, 0.0), 1.0) if h > 0.0 else 0.0
        interpolate_of(settings)(state, stages, h, share)
        if stages.trial[0].stiff_contacts:
            interpolate_without_accelerations(state, stages, h, share)
        integrals_of(settings)(state, stages, h, share)
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
def move_to(state, settings, stages, h, share):
    """Take over the state at `share` of the step, with the integrals up to there."""
    integrals, gain, sliding_work = state.integrals, stages.gain, stages.sliding_work
    for j in range(sliding_work.size):
        sliding_work[j] = -integrals[INTEGRALS_PER_JOINT * j + SLIDING_WORK]
    if share < 1.0:
        interpolate_of(settings)(state, stages, h, share)
        integrals_of(settings)(state, stages, h, share)
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
def accept(model, state, settings, arrays, recorder, share, end, event_joint, kind):
    """Move to `share` of the step in hand, at the time `end` [s], and book what happened on the way.

    Returns:
        False if the constraints are singular.
    """
    work, scratch, stages = arrays.work, arrays.scratch, arrays.stages
    clock, h, implicit = state.clock[0], stages.trial[0].step, stages.trial[0].implicit
    start = clock.time
    if recorder.times.size > 0:
        copy_into(scratch.impact_speeds, work.impact_speeds)
        record_until(model, state, settings, stages, scratch, recorder, h, end)
    refine_peaks(model, state, settings, stages, h, share)
    move_to(state, settings, stages, h, share)
    clock.time = end
    clock.steps += 1
    if (implicit or share < 1.0) and not prepare_response(model, state.q, end, work):
        return False
    project(model, state.q, state.v, end, work)
    if kind != NO_EVENT:
        begin_event(model, state, event_joint, kind, scratch)
        if not refresh(model, state, stages, work):
            return False
    else:
        copy_into(stages.acceleration[0], stages.acceleration[-1])
        copy_into(stages.power[0], stages.power[-1])
        copy_into(state.a, stages.acceleration[0])
        copy_into(state.power, stages.power[0])
        clock.acceleration_current = APPROXIMATE if implicit else EXACT
    settle_joints(model, state, work.loads, stages.sliding_work, start, stages.depth, recorder)
    set_impact_speeds(state.joints, work.impact_speeds)
    copy_into(stages.velocity[0], state.v)
    measure_depths(model, state, stages)
    return True
