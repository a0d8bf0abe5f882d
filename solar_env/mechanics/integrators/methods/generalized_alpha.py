"""Generalized-alpha for the index-3 equations M a + Phi_q^T lambda = Q(q, v, t), Phi(q, t) = 0: the run.

One step is in `alpha_step.py`, the control of its length in `alpha_control.py`.
"""

import math
from typing import NamedTuple

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y
from solar_env.mechanics.arrays.model import Model, State
from solar_env.mechanics.equations.constraints import fill_columns
from solar_env.mechanics.equations.newton import fill_mass
from solar_env.mechanics.equations.system import (
    Workspace,
    applied_forces,
    make_workspace,
    store_constraint_loads,
)
from solar_env.mechanics.integrators.methods.alpha_control import judge, next_step
from solar_env.mechanics.integrators.methods.alpha_step import (
    AlphaSettings,
    Iteration,
    make_iteration,
    restart,
    solve_step,
)
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, alpha_coefficients
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.profile import clear
from solar_env.mechanics.records.history import (
    check_state,
    fail,
    latch,
    settle_joints,
    start_contact,
)
from solar_env.mechanics.records.recording import record_sample, sample_due

_SMALLEST_STEP = 1e-12  # s


class AlphaArrays(NamedTuple):
    """Scratch arrays of the method, of one thread; nothing in them outlives a lane's turn."""

    work: Workspace
    scratch: Workspace  # for evaluations that leave the other as it is
    iteration: Iteration


def make_alpha_arrays(model: Model, state: State) -> AlphaArrays:
    """Allocate the arrays for a mechanism."""
    work = make_workspace(model, state)
    return AlphaArrays(work, make_workspace(model, state), make_iteration(model, state, work))


def convert_settings(chosen: GeneralizedAlpha) -> AlphaSettings:
    """The settings as the kernels take them; of other types they would be compiled anew."""
    return AlphaSettings(
        *alpha_coefficients(chosen.rho_inf),
        float(chosen.step),
        float(chosen.rtol or 0.0),
        float(chosen.velocity_scale),
        float(chosen.max_step),
        float(chosen.impact_resolution),
        float(chosen.newton_tolerance),
        int(chosen.max_steps),
    )


@kernel(inner=True)
def prepare(model, state, it, work):
    """Contact modes, depths and powers at the start of a step.

    A journal that flies freely gets its present approach speed as the impact speed, should the step end in contact.
    """
    joints, markers, joint_states = model.joints, model.markers, state.joints
    for j in range(joints.size):
        joint = joints[j]
        work.impact_speeds[j] = 0.0
        # Newton's iteration meets stops wherever they are; nothing is frozen as in the explicit method.
        joint_states[j].stop_engaged = 1
        if joint.kind == m.CLEARANCE:
            it.depth[j], it.depth_rate[j] = penetration(joint, markers, state.q, state.v)
            if joint_states[j].in_contact:
                work.impact_speeds[j] = joint_states[j].impact_speed
            else:
                work.impact_speeds[j] = max(it.depth_rate[j], joint.minimum_impact_speed)
    applied_forces(model, joint_states, state.q, state.v, work)
    store_constraint_loads(model, state.multipliers, state.clock[0].time, state.q, work)
    copy_into(it.power, work.power)
    for j in range(joints.size):
        it.angle[j] = work.loads[j, ANGLE]


@kernel(inner=True)
def record_until(model, state, it, scratch, recorder, work, h):
    """Take the samples inside the solved step: cubic Hermite for positions, its derivative for velocities."""
    n = state.q.size
    start = state.clock[0].time
    end = start + h
    copy_into(scratch.impact_speeds, work.impact_speeds)
    while sample_due(recorder, end):
        s = min(max((recorder.times[recorder.filled[0]] - start) / h, 0.0), 1.0) if h > 0.0 else 0.0
        for i in range(n):
            rise = it.q[i] - state.q[i]
            slope0, slope1 = h * state.v[i], h * it.v[i]
            c2 = 3.0 * rise - 2.0 * slope0 - slope1
            c3 = slope0 + slope1 - 2.0 * rise
            it.scratch_q[i] = state.q[i] + s * (slope0 + s * (c2 + s * c3))
            if h > 0.0:
                it.scratch_v[i] = (slope0 + s * (2.0 * c2 + 3.0 * s * c3)) / h
            else:
                it.scratch_v[i] = state.v[i]
        for k in range(state.integrals.size):
            # Trapezoid over the share: the power is taken as linear in the step.
            it.integrals[k] = state.integrals[k] + s * h * (it.power[k] + 0.5 * s * (work.power[k] - it.power[k]))
        record_sample(
            recorder,
            model,
            state.joints,
            it.scratch_q,
            it.scratch_v,
            start + s * h,
            it.integrals,
            scratch,
            it.scratch_a,
            it.scratch_multipliers,
            it.energies,
        )


@kernel(single_caller=True)
def accept(model, state, it, work, scratch, recorder, h):
    """Move to the end of the solved step and book what happened on the way."""
    joints, joint_states, integrals = model.joints, state.joints, state.integrals
    clock = state.clock[0]
    start = clock.time
    store_constraint_loads(model, it.multipliers, start + h, it.q, work)
    if recorder.times.size > 0:
        record_until(model, state, it, scratch, recorder, work, h)
    for k in range(integrals.size):
        integrals[k] += 0.5 * h * (it.power[k] + work.power[k])
    copy_into(state.q, it.q)
    copy_into(state.v, it.v)
    copy_into(state.a, it.a)
    copy_into(state.algorithmic_a, it.auxiliary)
    copy_into(state.multipliers, it.multipliers)
    clock.time = start + h
    clock.steps += 1
    for j in range(joints.size):
        joint = joints[j]
        if joint.kind == m.CLEARANCE and not joint_states[j].in_contact:
            depth, _ = penetration(joint, model.markers, state.q, state.v)
            if depth > 0.0:
                share = it.depth[j] / (it.depth[j] - depth) if it.depth[j] < 0.0 else 0.0
                scratch.loads[j, ECCENTRICITY_X] = work.loads[j, ECCENTRICITY_X]
                scratch.loads[j, ECCENTRICITY_Y] = work.loads[j, ECCENTRICITY_Y]
                start_contact(model, state, j, state.q, state.v, start + share * h, work.impact_speeds[j], scratch)
        angle = work.loads[j, ANGLE]
        if joint.has_latch and not joint_states[j].latched and angle >= joint.lock_angle:
            rise = angle - it.angle[j]
            latch(state, j, start + h * ((joint.lock_angle - it.angle[j]) / rise if rise > 0.0 else 1.0))
        k = m.INTEGRALS_PER_JOINT * j + m.SLIDING_WORK
        it.sliding_work[j] = 0.5 * h * (it.power[k] + work.power[k])
    settle_joints(model, state, work.loads, it.sliding_work, start, it.depth, recorder)


@kernel(inner=True)
def begin_alpha(model, state, settings, recorder, arrays):
    """Fill what the arrays hold of a model and record the start of a call; a status code."""
    work, scratch, it = arrays
    for evaluation in (work, scratch):
        for r in range(evaluation.row_value.shape[0]):
            copy_into(evaluation.row_value[r], model.constraints.value[r])
        fill_columns(model, evaluation, False)
    clear(model.elimination, it.newton.mass)
    fill_mass(model, it.newton.mass)
    if recorder.times.size > 0 and sample_due(recorder, state.clock[0].time):
        prepare(model, state, it, work)
        copy_into(it.q, state.q)
        copy_into(it.v, state.v)
        record_until(model, state, it, scratch, recorder, work, 0.0)
    return m.DONE


@kernel(single_caller=True)
def solve_until_accepted(model, state, settings, it, work, scratch, h):
    """Solve a step `h` [s], or shorter ones after those that are refused; the step solved and a status code."""
    clock = state.clock[0]
    retry = 1.0
    while retry > 0.0:
        if clock.acceleration_current != m.ALGORITHMIC or abs(h - clock.last_step) > 1e-9 * h:
            if not restart(model, state, it, work, settings, h):
                return h, fail(state, m.SINGULAR_CONSTRAINTS, -1, 0.0)
            clock.acceleration_current = m.ALGORITHMIC
            clock.last_step = h
        convergence = solve_step(model, state, it, work, settings, h)
        if settings.rtol == 0.0:
            if not convergence <= 1.0:
                return h, fail(state, m.NEWTON_FAILED if math.isfinite(convergence) else m.NOT_FINITE, -1, convergence)
            break
        retry = judge(model, state, it, scratch, settings, h, convergence)
        if retry > 0.0:
            clock.rejected_steps += 1
            h = retry
            clock.step_size = h
            if h < _SMALLEST_STEP:
                return h, fail(state, m.STEP_TOO_SMALL, -1, clock.failure_value)
    return h, m.DONE


@kernel(inner=True)
def take_alpha_step(model, state, settings, recorder, end_time, arrays):
    """Take a step towards `end_time` [s], tried again with shorter ones if need be; a status code."""
    work, scratch, it = arrays
    clock = state.clock[0]
    wanted = next_step(state, settings, end_time - clock.time)
    last = wanted >= end_time - clock.time
    prepare(model, state, it, work)
    h, status = solve_until_accepted(model, state, settings, it, work, scratch, wanted)
    if status != m.DONE:
        return status
    accept(model, state, it, work, scratch, recorder, h)
    if last and h == wanted:
        clock.time = end_time
    return check_state(model, state, work.loads)
