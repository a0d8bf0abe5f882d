"""Adaptive explicit Runge-Kutta with event location on its own interpolant.

Kutta's 3/8 rule of order four with an error estimate of order three that uses the first-same-as-last stage (E. Hairer,
S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, 1993, sections II.1 and II.4,
doi:10.1007/978-3-540-78862-1). In lasting contact the stiffness of the bearing bounds the step; of the common methods
those with four stages and order four cover the most time per evaluation: their stability interval on the imaginary
axis, 2 sqrt(2), is nearly as long as four stages allow. Between the ends of a step positions follow the quintic and
velocities the cubic Hermite polynomial through the derivatives that are known there.

Constraints are enforced on the acceleration level and by projection of every accepted step.

During a step the contact mode of each joint is frozen, so that a step that runs into a bearing wall sees a smooth
vector field. The wall is then found as a root of the interpolant, the step is cut there at no further cost, and the
contact starts with its exact approach speed. Latchings are found in the same way. The steps of an impact are bounded
by a share of its duration, which impact speed and stiffness give beforehand.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import njit, njit_allocating, njit_inlined
from .contact import normal_force
from .history import (
    angle_out_of_range,
    impact_step_limit,
    latch,
    note_force,
    settle_joints,
    start_contact,
)
from .joint import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, joint_motion, penetration, relative, stop_depth
from .linear import copy_into
from .model import (
    CABLE_WORK,
    CLEARANCE,
    CONTACT_BUFFER_FULL,
    CONTACT_TOO_DEEP,
    DONE,
    FRICTION_DISSIPATION,
    INTEGRALS_PER_JOINT,
    JOINT_ANGLE_RANGE,
    MOTOR_WORK,
    NORMAL_DISSIPATION,
    NOT_FINITE,
    SINGULAR_CONSTRAINTS,
    SLIDING_WORK,
    STEP_TOO_SMALL,
    STOP_DISSIPATION,
    TOO_MANY_STEPS,
)
from .recording import contacts_full, record_sample, sample_due
from .system import accelerations, inlined_accelerations, make_workspace, project

STAGES = 5
_NODES = (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0, 1.0)
# Row s: weights of the stages before s; the last row is the method's own, whose end is the next step's first stage.
_COUPLING = (
    (0.0, 0.0, 0.0, 0.0),
    (1.0 / 3.0, 0.0, 0.0, 0.0),
    (-1.0 / 3.0, 1.0, 0.0, 0.0),
    (1.0, -1.0, 1.0, 0.0),
    (0.125, 0.375, 0.375, 0.125),
)
# The one combination of the five stages, up to its scale, that vanishes to third order. It also measures the error of
# integrals, to which estimates from the last two stages alone are blind.
_ERROR = tuple(weight / 40.0 for weight in (-1.0, 3.0, -3.0, -3.0, 4.0))

# Integrals that enter the energy book, and with it the error norm.
_ENERGIES = (NORMAL_DISSIPATION, FRICTION_DISSIPATION, MOTOR_WORK, STOP_DISSIPATION, CABLE_WORK)

_PEAK_SAMPLES = 8
_SMALLEST_STEP = 1e-13  # s, relative to max(time, 1 s)

# Kinds of event inside a step.
_NONE, _CONTACT, _LATCH, _STOP = range(4)


class ExplicitSettings(NamedTuple):
    """Settings of :func:`advance_explicit`."""

    rtol: float  # local error of velocities relative to (velocity_scale + |velocity|), of positions to the length scale
    velocity_scale: float  # [m/s]
    max_step: float  # [s]
    impact_resolution: float  # steps per predicted impact duration
    max_steps: int  # per call


class Stages(NamedTuple):
    """Stage derivatives of the step in hand."""

    velocity: NDArray[np.float64]  # (5, n)
    acceleration: NDArray[np.float64]  # (5, n)
    power: NDArray[np.float64]  # (5, integrals)
    q: NDArray[np.float64]  # (n,) stage or end coordinates
    v: NDArray[np.float64]  # (n,)
    gain: NDArray[np.float64]  # integrals over the whole step
    scratch_q: NDArray[np.float64]  # (n,) interpolated coordinates
    scratch_v: NDArray[np.float64]  # (n,)
    scratch_a: NDArray[np.float64]  # (n,)
    integrals: NDArray[np.float64]  # interpolated integrals
    energies: NDArray[np.float64]  # (6,)
    depth: NDArray[np.float64]  # (joints,) penetration at the step's start
    depth_rate: NDArray[np.float64]  # (joints,)
    sliding_work: NDArray[np.float64]  # (joints,) of the step


@njit_allocating
def make_stages(state):
    """Allocate the arrays of a step."""
    n, k, joints = state.q.size, state.integrals.size, state.joints.size
    return Stages(
        np.zeros((STAGES, n)),
        np.zeros((STAGES, n)),
        np.zeros((STAGES, k)),
        np.zeros(n),
        np.zeros(n),
        np.zeros(k),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(k),
        np.zeros(6),
        np.zeros(joints),
        np.zeros(joints),
        np.zeros(joints),
    )


@njit_inlined
def attempt_step(model, state, stages, work, h):
    """Fill the stages of a step ``h``, its end going to ``stages.q``, ``.v`` and ``.gain``. False if singular."""
    q0, v0, joint_states, multipliers = state.q, state.v, state.joints, state.multipliers
    q, v, velocity, acceleration = stages.q, stages.v, stages.velocity, stages.acceleration
    power, stage_power, gain = work.power, stages.power, stages.gain
    n = q.size
    time = state.clock[0].time
    for s in range(1, STAGES):
        c0, c1, c2, c3 = _COUPLING[s]
        for i in range(n):
            q[i] = q0[i] + h * (c0 * velocity[0, i] + c1 * velocity[1, i] + c2 * velocity[2, i] + c3 * velocity[3, i])
            v[i] = v0[i] + h * (
                c0 * acceleration[0, i] + c1 * acceleration[1, i] + c2 * acceleration[2, i] + c3 * acceleration[3, i]
            )
        copy_into(velocity[s], v)
        if not inlined_accelerations(
            model, joint_states, q, v, time + _NODES[s] * h, work, acceleration[s], multipliers
        ):
            return False
        copy_into(stage_power[s], power)
    for k in range(gain.size):
        gain[k] = h * (
            c0 * stage_power[0, k] + c1 * stage_power[1, k] + c2 * stage_power[2, k] + c3 * stage_power[3, k]
        )
    state.clock[0].evaluations += STAGES - 1
    return True


@njit_inlined
def error_norm(model, state, stages, settings, h):
    """Greatest component of the error estimate in units of the tolerance."""
    v0, v, velocity, acceleration, power = state.v, stages.v, stages.velocity, stages.acceleration, stages.power
    rtol, velocity_scale = settings.rtol, settings.velocity_scale
    e0, e1, e2, e3, e4 = _ERROR
    worst = 0.0
    position_tolerance = rtol * model.length_scale
    for i in range(v.size):
        dq = e0 * velocity[0, i] + e1 * velocity[1, i] + e2 * velocity[2, i] + e3 * velocity[3, i] + e4 * velocity[4, i]
        dv = (
            e0 * acceleration[0, i]
            + e1 * acceleration[1, i]
            + e2 * acceleration[2, i]
            + e3 * acceleration[3, i]
            + e4 * acceleration[4, i]
        )
        scale = rtol * (velocity_scale + max(abs(v0[i]), abs(v[i])))
        ratio = max(abs(h * dq) / position_tolerance, abs(h * dv) / scale)
        if not ratio <= worst:  # also true for NaN
            worst = ratio
    energy_tolerance = rtol * state.clock[0].energy_scale
    for j in range(0, power.shape[1] - 1, INTEGRALS_PER_JOINT):
        for k in _ENERGIES:
            i = j + k
            de = e0 * power[0, i] + e1 * power[1, i] + e2 * power[2, i] + e3 * power[3, i] + e4 * power[4, i]
            worst = max(worst, abs(h * de) / energy_tolerance)
    return worst


@njit_inlined
def quintic_weights(s):
    """Weights of position, velocity * h and acceleration * h^2 at the start, then at the end, at the share ``s``."""
    s3 = s * s * s
    end = s3 * (10.0 - s * (15.0 - 6.0 * s))
    return (
        1.0 - end,
        s - s3 * (6.0 - s * (8.0 - 3.0 * s)),
        0.5 * s * s * (1.0 - s * (3.0 - s * (3.0 - s))),
        end,
        -s3 * (4.0 - s * (7.0 - 3.0 * s)),
        0.5 * s3 * (1.0 - s * (2.0 - s)),
    )


@njit_inlined
def cubic_weights(s):
    """Weights of value and slope * h at the start, then at the end, at the share ``s``."""
    end = s * s * (3.0 - 2.0 * s)
    return 1.0 - end, s * (1.0 - s) * (1.0 - s), end, s * s * (s - 1.0)


@njit
def interpolate(state, stages, h, share):
    """State at ``share`` of the step, into ``stages.scratch_q`` and ``stages.scratch_v``."""
    q0, v0, q1, v1 = state.q, state.v, stages.q, stages.v
    acceleration, q, v = stages.acceleration, stages.scratch_q, stages.scratch_v
    p0, p1, p2, r0, r1, r2 = quintic_weights(share)
    c0, c1, d0, d1 = cubic_weights(share)
    for i in range(q.size):
        a0, a1 = h * acceleration[0, i], h * acceleration[STAGES - 1, i]
        q[i] = p0 * q0[i] + r0 * q1[i] + h * (p1 * v0[i] + r1 * v1[i] + p2 * a0 + r2 * a1)
        v[i] = c0 * v0[i] + c1 * a0 + d0 * v1[i] + d1 * a1


@njit
def interpolate_integrals(state, stages, h, share):
    """Integrals at ``share`` of the step, into ``stages.integrals``."""
    integrals, gain, power, base = stages.integrals, stages.gain, stages.power, state.integrals
    _, start, whole, end = cubic_weights(share)
    for k in range(integrals.size):
        integrals[k] = base[k] + whole * gain[k] + h * (start * power[0, k] + end * power[STAGES - 1, k])


@njit_inlined
def event_function(model, state, stages, j, kind, h, share):
    """What rises through zero at an event of joint ``j``: a depth, or the angle past the lock."""
    joint, markers = model.joints[j], model.markers
    if kind != _CONTACT:
        interpolate(state, stages, h, share)
        angle, _, _, _ = joint_motion(joint, markers, stages.scratch_q, stages.scratch_v)
        if kind == _LATCH:
            return angle - joint.lock_angle
        depth, _ = stop_depth(joint, state.joints[j].latched, angle)
        return depth
    # Eccentricity is linear in q: interpolating it alone is cheap.
    acceleration = stages.acceleration
    p0, p1, p2, r0, r1, r2 = quintic_weights(share)
    ex0, ey0 = relative(joint, markers, state.q)
    ex1, ey1 = relative(joint, markers, stages.q)
    ux0, uy0 = relative(joint, markers, state.v)
    ux1, uy1 = relative(joint, markers, stages.v)
    ax0, ay0 = relative(joint, markers, acceleration[0])
    ax1, ay1 = relative(joint, markers, acceleration[STAGES - 1])
    ex = p0 * ex0 + r0 * ex1 + h * (p1 * ux0 + r1 * ux1 + h * (p2 * ax0 + r2 * ax1))
    ey = p0 * ey0 + r0 * ey1 + h * (p1 * uy0 + r1 * uy1 + h * (p2 * ay0 + r2 * ay1))
    return math.sqrt(ex * ex + ey * ey) - joint.clearance


@njit
def locate(model, state, stages, j, kind, h, low, f_low, high, f_high):
    """Share of the step at which the event function rises through zero: Illinois iteration, ending on its far side."""
    for _ in range(60):
        if high - low < 1e-12 or f_high == 0.0:
            break
        middle = high - f_high * (high - low) / (f_high - f_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        f = event_function(model, state, stages, j, kind, h, middle)
        if f >= 0.0:
            # The end that stays put has its value halved, which keeps the iteration superlinear.
            high, f_high = middle, f
            f_low *= 0.5
        else:
            low, f_low = middle, f
            f_high *= 0.5
        if abs(f) < 1e-18:
            high = middle
            break
    return high


@njit_inlined
def first_event(model, state, stages, work, h):
    """Earliest contact start, latching or stop engagement inside the step: (share, joint, kind)."""
    joints, joint_states, loads, depths = model.joints, state.joints, work.loads, stages.depth
    share, which, what = 1.0, -1, _NONE
    for j in range(joints.size):
        joint = joints[j]
        own = joint_states[j]
        root, kind = 2.0, _NONE
        if joint.kind == CLEARANCE and not own.in_contact:
            root, kind = first_touch(model, state, stages, j, h, depths[j]), _CONTACT
            if root < share or (root == share and what == _NONE):
                share, which, what = root, j, kind
        angle = loads[j, ANGLE]
        if joint.has_latch and not own.latched and angle >= joint.lock_angle:
            root, kind = locate_at_end(model, state, stages, j, _LATCH, h, angle - joint.lock_angle), _LATCH
            if root < share or what == _NONE:
                share, which, what = root, j, kind
        if not own.stop_engaged:
            depth, _ = stop_depth(joint, own.latched, angle)
            if depth > 0.0:
                root, kind = locate_at_end(model, state, stages, j, _STOP, h, depth), _STOP
                if root < share or what == _NONE:
                    share, which, what = root, j, kind
    return share, which, what


@njit
def locate_at_end(model, state, stages, j, kind, h, f_high):
    """Share of the step at which an event function that is positive at its end has risen through zero."""
    f_low = event_function(model, state, stages, j, kind, h, 0.0)
    if f_low >= 0.0:
        return 0.0
    return locate(model, state, stages, j, kind, h, 0.0, f_low, 1.0, f_high)


@njit
def first_touch(model, state, stages, j, h, depth):
    """Share of the step at which the free journal of joint ``j`` meets its bearing; 2 if it does not.

    A curved path can graze the wall inside the step: the interpolant is looked at between the ends too.
    """
    low, f_low = 0.0, depth
    for k in range(1, 5):
        high = 0.25 * k
        f_high = event_function(model, state, stages, j, _CONTACT, h, high)
        if f_high > 0.0:
            if f_low >= 0.0:
                return low
            return locate(model, state, stages, j, _CONTACT, h, low, f_low, high, f_high)
        low, f_low = high, f_high
    return 2.0


@njit
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


@njit
def record_until(model, state, stages, scratch, recorder, h, end):
    """Take the samples that fall inside the accepted part of the step."""
    start = state.clock[0].time
    while sample_due(recorder, end):
        share = min(max((recorder.times[recorder.filled[0]] - start) / h, 0.0), 1.0) if h > 0.0 else 0.0
        interpolate(state, stages, h, share)
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
            state.multipliers,
            stages.energies,
        )


@njit
def refresh(model, state, stages, work):
    """Evaluate the first stage at the accepted state, with its contact modes. False if constraints are singular."""
    for j in range(state.joints.size):
        work.impact_speeds[j] = state.joints[j].impact_speed if state.joints[j].in_contact else 0.0
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


@njit_inlined
def measure_depths(model, state, stages):
    """Penetration and its rate at the accepted state, for every clearance joint."""
    joints, markers, q, v = model.joints, model.markers, state.q, state.v
    depth, depth_rate = stages.depth, stages.depth_rate
    for j in range(joints.size):
        joint = joints[j]
        if joint.kind == CLEARANCE:
            depth[j], depth_rate[j] = penetration(joint, markers, q, v)


@njit_inlined
def refine_peaks(model, state, stages, h, share):
    """Find the force peaks that lie inside the step: where a penetration has turned from growing to falling."""
    joints, markers, joint_states = model.joints, model.markers, state.joints
    depth_rate, q, v = stages.depth_rate, stages.q, stages.v
    for j in range(joints.size):
        if joint_states[j].in_contact and depth_rate[j] > 0.0:
            _, rate = penetration(joints[j], markers, q, v)
            if rate <= 0.0:
                refine_peak(model, state, stages, j, h, share)


@njit_inlined
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


@njit
def begin_event(model, state, j, kind, scratch):
    """Latch joint ``j``, engage its stop, or start its contact, at the accepted state."""
    time = state.clock[0].time
    if kind == _LATCH:
        latch(state, j, time)
        return
    if kind == _STOP:
        state.joints[j].stop_engaged = 1
        return
    joint = model.joints[j]
    _, rate = penetration(joint, model.markers, state.q, state.v)
    scratch.loads[j, ECCENTRICITY_X], scratch.loads[j, ECCENTRICITY_Y] = relative(joint, model.markers, state.q)
    start_contact(model, state, j, state.q, state.v, time, rate, scratch)


@njit_inlined
def accept(model, state, stages, work, scratch, recorder, h, share, event_joint, kind):
    """Move to ``share`` of the step and book what happened on the way. False if constraints are singular."""
    joint_states, impact_speeds = state.joints, work.impact_speeds
    clock = state.clock[0]
    start = clock.time
    end = start + share * h
    if recorder.times.size > 0:
        copy_into(scratch.impact_speeds, impact_speeds)
        record_until(model, state, stages, scratch, recorder, h, end)
    refine_peaks(model, state, stages, h, share)
    move_to(state, stages, h, share)
    clock.time = end
    clock.steps += 1
    if not project(model, state.q, state.v, end, scratch):
        return False
    if kind != _NONE:
        begin_event(model, state, event_joint, kind, scratch)
        if not refresh(model, state, stages, work):
            return False
    else:
        copy_into(stages.acceleration[0], stages.acceleration[STAGES - 1])
        copy_into(stages.power[0], stages.power[STAGES - 1])
    settle_joints(model, state, work.loads, stages.sliding_work, start, stages.depth, recorder)
    for j in range(joint_states.size):
        impact_speeds[j] = joint_states[j].impact_speed if joint_states[j].in_contact else 0.0
    copy_into(stages.velocity[0], state.v)
    measure_depths(model, state, stages)
    return True


@njit
def fail(state, status, joint, value):
    """Note where and why a call stops."""
    state.clock[0].failure_joint = joint
    state.clock[0].failure_value = value
    return status


@njit_inlined
def check_state(model, state, stages, work):
    """Status of an accepted state: contact depths and joint angles within what the model describes."""
    joints, depth = model.joints, stages.depth
    for j in range(joints.size):
        if joints[j].kind == CLEARANCE and depth[j] > joints[j].journal_radius:
            return fail(state, CONTACT_TOO_DEEP, j, depth[j])
    wrapped = angle_out_of_range(joints, work.loads)
    if wrapped >= 0:
        return fail(state, JOINT_ANGLE_RANGE, wrapped, work.loads[wrapped, ANGLE])
    return DONE


@njit_allocating
def advance_explicit(model, state, settings, recorder, end_time):
    """Advance ``state`` in place to ``end_time`` [s]; returns a status code."""
    work = make_workspace(model, state)
    scratch = make_workspace(model, state)
    stages = make_stages(state)
    clock = state.clock[0]
    for j in range(state.joints.size):
        work.impact_speeds[j] = state.joints[j].impact_speed if state.joints[j].in_contact else 0.0
    if clock.acceleration_current:
        copy_into(stages.acceleration[0], state.a)
        copy_into(stages.power[0], state.power)
    elif not refresh(model, state, stages, work):
        return fail(state, SINGULAR_CONSTRAINTS, -1, 0.0)
    copy_into(stages.velocity[0], state.v)
    measure_depths(model, state, stages)
    if recorder.times.size > 0:
        for j in range(state.joints.size):
            scratch.impact_speeds[j] = work.impact_speeds[j]
        record_until(model, state, stages, scratch, recorder, 0.0, clock.time)
    if clock.step_size <= 0.0:
        clock.step_size = 1e-6
        clock.last_error = 1.0
    status = DONE
    taken = 0
    while clock.time < end_time:
        if contacts_full(recorder, model.joints.size):
            status = CONTACT_BUFFER_FULL
            break
        if taken >= settings.max_steps:
            status = fail(state, TOO_MANY_STEPS, -1, float(taken))
            break
        limit = min(settings.max_step, impact_step_limit(state, clock.time, settings.impact_resolution))
        wanted = min(clock.step_size, limit)
        h = wanted
        last = clock.time + h >= end_time
        if last:
            h = end_time - clock.time
        taken += 1
        if not attempt_step(model, state, stages, work, h):
            status = fail(state, SINGULAR_CONSTRAINTS, -1, 0.0)
            break
        error = error_norm(model, state, stages, settings, h)
        if not error <= 1.0:
            clock.rejected_steps += 1
            shrink = 0.9 * error**-0.25 if error < math.inf else 0.1
            clock.step_size = h * max(shrink, 0.1)
            if not clock.step_size > _SMALLEST_STEP * max(1.0, abs(clock.time)):
                finite = math.isfinite(error)
                status = fail(state, STEP_TOO_SMALL if finite else NOT_FINITE, -1, error)
                break
            continue
        share, event_joint, kind = first_event(model, state, stages, work, h)
        if not accept(model, state, stages, work, scratch, recorder, h, share, event_joint, kind):
            status = fail(state, SINGULAR_CONSTRAINTS, -1, 0.0)
            break
        if last and share == 1.0:
            clock.time = end_time
        error = max(error, 1e-10)
        grow = min(0.9 * error**-0.18 * clock.last_error**0.1, 10.0)
        clock.last_error = max(error, 1e-4)
        # A step that was cut short by the end of the call or by an event says little about the next one.
        if not last:
            clock.step_size = wanted * max(grow, 0.2)
        else:
            clock.step_size = max(wanted, h * grow)
        status = check_state(model, state, stages, work)
        if status != DONE:
            break
    copy_into(state.a, stages.acceleration[0])
    copy_into(state.power, stages.power[0])
    clock.acceleration_current = 1
    return status
