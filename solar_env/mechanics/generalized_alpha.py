"""Generalized-alpha for the index-3 equations M a + Phi_q^T lambda = Q(q, v, t), Phi(q, t) = 0.

J. Chung and G. M. Hulbert, J. Appl. Mech. 60 (1993) 371, doi:10.1115/1.2900803, in the form of M. Arnold and
O. Bruls, Multibody Syst. Dyn. 18 (2007) 185, doi:10.1007/s11044-007-9084-0. Constraint rows and multipliers are
scaled by beta h^2 (C. L. Bottasso, O. A. Bauchau and A. Cardona, SIAM J. Sci. Comput. 29 (2007) 397,
doi:10.1137/050638503). With rho_inf = 1 this is the trapezoidal Newmark scheme, beta = 1/4, gamma = 1/2.

A change of step size leaves the auxiliary accelerations inconsistent; they are then solved for afresh on the
acceleration level, at the instant t + (alpha_m - alpha_f) h which they stand for.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import njit, njit_allocating
from .contact import impact_scales
from .history import (
    angle_out_of_range,
    impact_step_limit,
    latch,
    settle_joints,
    start_contact,
)
from .joint import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, joint_forces, penetration, relative
from .linear import copy_into, lu_factor, lu_solve
from .model import (
    CLEARANCE,
    CONTACT_BUFFER_FULL,
    CONTACT_TOO_DEEP,
    DONE,
    FIXED,
    INTEGRALS_PER_JOINT,
    JOINT_ANGLE_RANGE,
    NEWTON_FAILED,
    NOT_FINITE,
    SINGULAR_CONSTRAINTS,
    SLIDING_WORK,
    STEP_TOO_SMALL,
    TOO_MANY_STEPS,
)
from .recording import contacts_full, record_sample, sample_due
from .rigid import add_mass_product
from .system import (
    accelerations,
    constraint_drift,
    make_workspace,
    normal_inverse_mass,
    project,
    store_constraint_loads,
)
from .tangent import subtract_force_tangents

_MOST_ITERATIONS = 60
# Full corrections at first; where kinks of contact or friction make them cycle, ever smaller shares of them.
_ITERATIONS_PER_RELAXATION = 12
_SMALLEST_STEP = 1e-12  # s


class AlphaSettings(NamedTuple):
    """Settings of :func:`advance_alpha`."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    step: float  # [s]
    rtol: float  # 0 keeps the step fixed
    velocity_scale: float  # [m/s]
    max_step: float  # [s]
    impact_resolution: float
    newton_tolerance: float
    max_steps: int


class Iteration(NamedTuple):
    """Arrays of the step in hand."""

    q: NDArray[np.float64]
    v: NDArray[np.float64]
    a: NDArray[np.float64]  # accelerations q''
    auxiliary: NDArray[np.float64]  # algorithmic accelerations
    multipliers: NDArray[np.float64]  # unscaled
    matrix: NDArray[np.float64]  # (n + m + bodies, same)
    rhs: NDArray[np.float64]
    pivots: NDArray[np.int64]
    power: NDArray[np.float64]  # at the step's start
    depth: NDArray[np.float64]  # (joints,) at the step's start
    depth_rate: NDArray[np.float64]
    angle: NDArray[np.float64]  # (joints,) at the step's start
    sliding_work: NDArray[np.float64]  # (joints,) of the step
    scratch_q: NDArray[np.float64]
    scratch_v: NDArray[np.float64]
    scratch_a: NDArray[np.float64]
    scratch_multipliers: NDArray[np.float64]
    integrals: NDArray[np.float64]
    energies: NDArray[np.float64]


class TangentScratch(NamedTuple):
    """Arrays of :func:`tangent.subtract_force_tangents`; loads and impact speeds are the workspace's own."""

    loads: NDArray[np.float64]
    impact_speeds: NDArray[np.float64]
    coordinates: NDArray[np.int64]  # (joints, 8) those that a joint depends on
    b: NDArray[np.float64]  # (4, 8)
    spin_slope: NDArray[np.float64]  # (2, 8)
    stiffness: NDArray[np.float64]  # (4, 4)
    damping: NDArray[np.float64]  # (4, 4)
    product: NDArray[np.float64]  # (4, 8)
    angle_gradient: NDArray[np.float64]  # (joints, 8)


@njit_allocating
def make_iteration(model, state):
    """Allocate the arrays of a step."""
    n, joints = state.q.size, state.joints.size
    size = n + state.multipliers.size
    return Iteration(
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(state.multipliers.size),
        np.zeros((size, size)),
        np.zeros(size),
        np.zeros(size, dtype=np.int64),
        np.zeros(state.power.size),
        np.zeros(joints),
        np.zeros(joints),
        np.zeros(joints),
        np.zeros(joints),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(state.multipliers.size),
        np.zeros(state.integrals.size),
        np.zeros(6),
    )


@njit_allocating
def make_tangent_scratch(work):
    """Allocate the arrays of a tangent."""
    joints = work.impact_speeds.size
    return TangentScratch(
        work.loads,
        work.impact_speeds,
        np.zeros((joints, 8), dtype=np.int64),
        np.zeros((4, 8)),
        np.zeros((2, 8)),
        np.zeros((4, 4)),
        np.zeros((4, 4)),
        np.zeros((4, 8)),
        np.zeros((joints, 8)),
    )


@njit
def fill_residual(model, state, it, work, time, scale):
    """Right-hand side of Newton's equations: minus the scaled residual of dynamics, minus the constraints."""
    bodies, rows, rhs, force = model.bodies, work.rows, it.rhs, work.force
    q, multipliers = it.q, it.multipliers
    m, n = rows.shape
    copy_into(force, model.gravity_force)
    joint_forces(model, state.joints, work.impact_speeds, q, it.v, work.loads, force, work.power)
    constraint_drift(model, q, time, work)
    for i in range(n):
        it.scratch_a[i] = 0.0
    add_mass_product(bodies, it.a, it.scratch_a)
    for i in range(n):
        total = force[i] - it.scratch_a[i]
        for r in range(m):
            total -= rows[r, i] * multipliers[r]
        rhs[i] = total
    for r in range(m):
        rhs[n + r] = -work.residual[r]
    for b in range(bodies.size):
        body = bodies[b]
        k = body.offset
        if body.kind == FIXED:
            for i in range(k, k + 4):
                rhs[i] = 0.0
            rhs[n + m + b] = 0.0
            continue
        dx, dy = q[k + 2] - q[k], q[k + 3] - q[k + 1]
        multiplier = multipliers[m + b]
        rhs[k] += dx * multiplier
        rhs[k + 1] += dy * multiplier
        rhs[k + 2] -= dx * multiplier
        rhs[k + 3] -= dy * multiplier
        rhs[n + m + b] = -0.5 * (dx * dx + dy * dy - body.length * body.length)
    for i in range(n):
        rhs[i] *= scale


@njit
def fill_matrix(model, state, it, work, tangent, mass_weight, damping_weight, scale):
    """Newton matrix [[scale (mass_weight M + damping_weight C + K), Phi_q^T], [Phi_q, 0]]."""
    bodies, rows, matrix = model.bodies, work.rows, it.matrix
    m, n = rows.shape
    q, multipliers = it.q, it.multipliers
    matrix[:] = 0.0
    subtract_force_tangents(model, state.joints, q, it.v, tangent, scale, scale * damping_weight, matrix)
    for r in range(m):
        for i in range(n):
            matrix[n + r, i] = rows[r, i]
            matrix[i, n + r] = rows[r, i]
    weight = scale * mass_weight
    for b in range(bodies.size):
        body = bodies[b]
        k = body.offset
        row = n + m + b
        if body.kind == FIXED:
            for i in range(k, k + 4):
                for c in range(matrix.shape[1]):
                    matrix[i, c] = 0.0
                matrix[i, i] = 1.0
            matrix[row, row] = 1.0
            continue
        spring = scale * multipliers[m + b]
        dx, dy = q[k + 2] - q[k], q[k + 3] - q[k + 1]
        for axis in range(2):
            d = dx if axis == 0 else dy
            turn = -1.0 if axis == 0 else 1.0
            i, j = k + axis, k + 2 + axis
            matrix[i, i] += weight * body.m11 + spring
            matrix[j, j] += weight * body.m22 + spring
            matrix[i, j] += weight * body.m12 - spring
            matrix[j, i] += weight * body.m12 - spring
            matrix[i, k + 3 - axis] += weight * turn * body.n12
            matrix[j, k + 1 - axis] -= weight * turn * body.n12
            matrix[row, i], matrix[row, j] = -d, d
            matrix[i, row], matrix[j, row] = -d, d


@njit
def attempt_step(model, state, it, work, tangent, settings, h):
    """Solve one step into ``it``; returns the last correction in units of the tolerance (at most 1 if it converged)."""
    n = state.q.size
    alpha_m, alpha_f, beta, gamma = settings.alpha_m, settings.alpha_f, settings.beta, settings.gamma
    q0, v0, a0, x0 = state.q, state.v, state.a, state.algorithmic_a
    q, v, a, x = it.q, it.v, it.a, it.auxiliary
    rhs, multipliers = it.rhs, it.multipliers
    for i in range(n):
        a[i] = a0[i]
        x[i] = (a0[i] - alpha_m * x0[i]) / (1.0 - alpha_m)
        q[i] = q0[i] + h * v0[i] + h * h * ((0.5 - beta) * x0[i] + beta * x[i])
        v[i] = v0[i] + h * ((1.0 - gamma) * x0[i] + gamma * x[i])
    copy_into(multipliers, state.multipliers)
    scale = beta * h * h
    mass_weight = (1.0 - alpha_m) / (h * h * beta * (1.0 - alpha_f))
    damping_weight = gamma / (h * beta)
    time = state.clock[0].time + h
    size = rhs.size
    tolerance = settings.newton_tolerance * model.length_scale
    correction = math.inf
    for iteration in range(_MOST_ITERATIONS):
        fill_residual(model, state, it, work, time, scale)
        fill_matrix(model, state, it, work, tangent, mass_weight, damping_weight, scale)
        state.clock[0].evaluations += 1
        state.clock[0].factorizations += 1
        if not lu_factor(it.matrix, size, it.pivots):
            return math.inf
        lu_solve(it.matrix, size, it.pivots, rhs)
        correction = 0.0
        for i in range(n):
            if not abs(rhs[i]) <= correction:
                correction = abs(rhs[i])
        relaxation = 0.5 ** (iteration // _ITERATIONS_PER_RELAXATION)
        for i in range(size):
            rhs[i] *= relaxation
        for i in range(n):
            q[i] += rhs[i]
            v[i] += damping_weight * rhs[i]
            a[i] += mass_weight * rhs[i]
            x[i] += rhs[i] / scale
        for r in range(size - n):
            multipliers[r] += rhs[n + r] / scale
        if correction <= tolerance:
            break
        if not math.isfinite(correction):
            break
    return correction / tolerance


@njit
def restart(model, state, it, work, settings, h):
    """Solve accelerations and multipliers afresh at the accepted state, for steps of size ``h``. False if singular."""
    n = state.q.size
    # Velocities are O(h^2) off the constraints, which a shorter step would answer with forces of O(h^2 / new step).
    if not project(model, state.q, state.v, state.clock[0].time, work):
        return False
    if not accelerations(model, state.joints, state.q, state.v, state.clock[0].time, work, state.a, state.multipliers):
        return False
    shift = (settings.alpha_m - settings.alpha_f) * h
    for i in range(n):
        it.scratch_q[i] = state.q[i] + shift * state.v[i] + 0.5 * shift * shift * state.a[i]
        it.scratch_v[i] = state.v[i] + shift * state.a[i]
    regular = accelerations(
        model,
        state.joints,
        it.scratch_q,
        it.scratch_v,
        state.clock[0].time + shift,
        work,
        state.algorithmic_a,
        it.scratch_multipliers,
    )
    state.clock[0].evaluations += 2
    return regular


@njit
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
        if joint.kind == CLEARANCE:
            it.depth[j], it.depth_rate[j] = penetration(joint, markers, state.q, state.v)
            if joint_states[j].in_contact:
                work.impact_speeds[j] = joint_states[j].impact_speed
            else:
                work.impact_speeds[j] = max(it.depth_rate[j], joint.minimum_impact_speed)
    copy_into(work.force, model.gravity_force)
    joint_forces(model, joint_states, work.impact_speeds, state.q, state.v, work.loads, work.force, work.power)
    store_constraint_loads(model, state.multipliers, state.clock[0].time, state.q, work)
    copy_into(it.power, work.power)
    for j in range(joints.size):
        it.angle[j] = work.loads[j, ANGLE]


@njit
def error_norm(model, state, it, settings, h):
    """Local error in units of the tolerance, from the change of the accelerations (Zienkiewicz and Xie 1991).

    O. C. Zienkiewicz and Y. M. Xie, Earthq. Eng. Struct. Dyn. 20 (1991) 871, doi:10.1002/eqe.4290200907.
    Multipliers are left out.
    """
    worst = 0.0
    factor = abs(settings.beta - 1.0 / 6.0) * h
    for i in range(state.q.size):
        estimate = factor * abs(it.auxiliary[i] - state.algorithmic_a[i])
        scale = settings.rtol * (settings.velocity_scale + max(abs(state.v[i]), abs(it.v[i])))
        ratio = estimate / scale
        if not ratio <= worst:
            worst = ratio
    return worst


@njit
def landing_step(model, state, it, scratch, settings, h):
    """A step that ends near the wall if a contact begins inside this one and ``h`` does not resolve it, else ``h``."""
    joints, joint_states, markers = model.joints, state.joints, model.markers
    shorter = h
    for j in range(joints.size):
        joint = joints[j]
        if joint.kind != CLEARANCE or joint_states[j].in_contact:
            continue
        depth, _ = penetration(joint, markers, it.q, it.v)
        if depth <= 0.0:
            continue
        scratch.loads[j, ECCENTRICITY_X], scratch.loads[j, ECCENTRICITY_Y] = relative(joint, markers, it.q)
        inverse_mass = normal_inverse_mass(model, it.q, it.v, j, scratch)
        speed = max(it.depth_rate[j], joint.minimum_impact_speed)
        _, duration = impact_scales(joint.contact_stiffness, inverse_mass, speed)
        flight = -it.depth[j] / speed
        wanted = max(min(flight, 0.5 * h), duration / settings.impact_resolution)
        shorter = min(shorter, wanted)
    return shorter


@njit
def record_until(model, state, it, scratch, recorder, work, h):
    """Take the samples inside the solved step: cubic Hermite for positions, its derivative for velocities."""
    n = state.q.size
    start = state.clock[0].time
    end = start + h
    for j in range(state.joints.size):
        scratch.impact_speeds[j] = work.impact_speeds[j]
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


@njit
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
        if joint.kind == CLEARANCE and not joint_states[j].in_contact:
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
        k = INTEGRALS_PER_JOINT * j + SLIDING_WORK
        it.sliding_work[j] = 0.5 * h * (it.power[k] + work.power[k])
    settle_joints(model, state, work.loads, it.sliding_work, start, it.depth, recorder)


@njit
def fail(state, status, joint, value):
    """Note where and why a call stops."""
    state.clock[0].failure_joint = joint
    state.clock[0].failure_value = value
    return status


@njit
def check_state(model, state, work):
    """Status of an accepted state: contact depths and joint angles within what the model describes."""
    for j in range(model.joints.size):
        joint = model.joints[j]
        if joint.kind == CLEARANCE:
            depth, _ = penetration(joint, model.markers, state.q, state.v)
            if depth > joint.journal_radius:
                return fail(state, CONTACT_TOO_DEEP, j, depth)
    wrapped = angle_out_of_range(model.joints, work.loads)
    if wrapped >= 0:
        return fail(state, JOINT_ANGLE_RANGE, wrapped, work.loads[wrapped, ANGLE])
    return DONE


@njit
def next_step(state, settings, remaining):
    """Step to try: the fixed one, divided so that a whole number of them ends the call, or the controller's."""
    if settings.rtol == 0.0:
        return remaining / math.ceil(remaining / settings.step - 1e-9)
    clock = state.clock[0]
    wanted = clock.step_size if clock.step_size > 0.0 else settings.step
    wanted = min(wanted, settings.max_step, impact_step_limit(state, clock.time, settings.impact_resolution))
    if wanted >= remaining:
        return remaining
    # Two even steps rather than one followed by a sliver.
    return 0.5 * remaining if 2.0 * wanted > remaining else wanted


@njit
def judge(model, state, it, scratch, settings, h, convergence):
    """Step to retry with, or 0 to accept. Sets the controller's next step."""
    clock = state.clock[0]
    clock.failure_value = convergence
    if not convergence <= 1.0:
        return 0.25 * h
    shorter = landing_step(model, state, it, scratch, settings, h)
    if shorter < h:
        return shorter
    error = error_norm(model, state, it, settings, h)
    clock.failure_value = error
    if not error <= 1.0:
        return h * max(0.9 * error**-0.5, 0.2)
    grow = min(0.9 * max(error, 1e-6) ** -0.5, 2.0)
    # A change of step costs a restart: keep the step unless much is gained.
    clock.step_size = max(clock.step_size, h * grow) if grow > 1.5 else h
    return 0.0


@njit_allocating
def advance_alpha(model, state, settings, recorder, end_time):
    """Advance ``state`` in place to ``end_time`` [s]; returns a status code."""
    work = make_workspace(model, state)
    scratch = make_workspace(model, state)
    it = make_iteration(model, state)
    tangent = make_tangent_scratch(work)
    clock = state.clock[0]
    status = DONE
    taken = 0
    if recorder.times.size > 0 and sample_due(recorder, clock.time):
        prepare(model, state, it, work)
        copy_into(it.q, state.q)
        copy_into(it.v, state.v)
        record_until(model, state, it, scratch, recorder, work, 0.0)
    while clock.time < end_time:
        if contacts_full(recorder, model.joints.size):
            status = CONTACT_BUFFER_FULL
            break
        if taken >= settings.max_steps:
            status = fail(state, TOO_MANY_STEPS, -1, float(taken))
            break
        taken += 1
        h = next_step(state, settings, end_time - clock.time)
        last = h >= end_time - clock.time
        prepare(model, state, it, work)
        retry = 1.0
        while retry > 0.0:
            if not clock.acceleration_current or abs(h - clock.last_step) > 1e-9 * h:
                if not restart(model, state, it, work, settings, h):
                    return fail(state, SINGULAR_CONSTRAINTS, -1, 0.0)
                clock.acceleration_current = 1
                clock.last_step = h
            convergence = attempt_step(model, state, it, work, tangent, settings, h)
            if settings.rtol == 0.0:
                if not convergence <= 1.0:
                    finite = math.isfinite(convergence)
                    return fail(state, NEWTON_FAILED if finite else NOT_FINITE, -1, convergence)
                break
            retry = judge(model, state, it, scratch, settings, h, convergence)
            if retry > 0.0:
                clock.rejected_steps += 1
                last = False
                h = retry
                clock.step_size = h
                if h < _SMALLEST_STEP:
                    return fail(state, STEP_TOO_SMALL, -1, clock.failure_value)
        accept(model, state, it, work, scratch, recorder, h)
        if last:
            clock.time = end_time
        status = check_state(model, state, work)
        if status != DONE:
            break
    return status
