"""Generalized-alpha for the index-3 equations M a + Phi_q^T lambda = Q(q, v, t), Phi(q, t) = 0.

J. Chung and G. M. Hulbert, J. Appl. Mech. 60 (1993) 371, doi:10.1115/1.2900803, in the form of M. Arnold and
O. Bruls, Multibody Syst. Dyn. 18 (2007) 185, doi:10.1007/s11044-007-9084-0. Constraint rows and multipliers are
scaled by beta h^2 (C. L. Bottasso, O. A. Bauchau and A. Cardona, SIAM J. Sci. Comput. 29 (2007) 397,
doi:10.1137/050638503). With rho_inf = 1 the method is the trapezoidal Newmark scheme, beta = 1/4, gamma = 1/2.

Fixed steps divide a call of `advance` evenly and do not end at events: contacts, latches and stops act inside Newton's
iteration. A change of step size makes the auxiliary accelerations inconsistent. They are then solved anew on the
acceleration level, at the time t + (alpha_m - alpha_f) h for which they are valid.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.model import Model, State
from solar_env.mechanics.arrays.trial import joint_motion_type, trial_type
from solar_env.mechanics.bodies.natural_coordinates import add_length_force
from solar_env.mechanics.equations.constraints import add_row, constraint_drift, prepare_response, project
from solar_env.mechanics.equations.newton import (
    NewtonMatrices,
    assemble,
    fill_mass,
    linearize_forces,
    make_newton_matrices,
)
from solar_env.mechanics.equations.system import (
    Workspace,
    accelerations,
    add_mass_products,
    applied_forces,
    make_workspace,
    store_constraint_loads,
)
from solar_env.mechanics.integrators.methods.stage_steps import fill_rows, measure_depths, take_loads
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, alpha_coefficients
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.profile import BLOCK, clear, enter, profile_factor, profile_solve, taken
from solar_env.mechanics.records.recording import record_sample

_MOST_ITERATIONS = 60
# Iterations without progress, as at kinks of contact or friction, after which corrections are scaled down.
_PATIENCE = 12


class AlphaSettings(NamedTuple):
    """Settings of generalized-alpha in the types that the kernels take."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    step: float  # [s]
    newton_tolerance: float


class Iteration(NamedTuple):
    """Arrays of the current step of generalized-alpha."""

    start_q: NDArray[np.float64]  # start of the step: the accepted state, which a restart projects on the constraints
    start_v: NDArray[np.float64]
    q: NDArray[np.float64]
    v: NDArray[np.float64]
    a: NDArray[np.float64]  # accelerations q''
    auxiliary: NDArray[np.float64]  # algorithmic accelerations
    multipliers: NDArray[np.float64]  # unscaled
    newton: NewtonMatrices
    rhs: NDArray[np.float64]  # (n + m + bodies,)
    solution: NDArray[np.float64]  # (blocks, BLOCK) `rhs` in the order of elimination
    power: NDArray[np.float64]  # powers at the step's start
    scratch_q: NDArray[np.float64]
    scratch_v: NDArray[np.float64]
    scratch_a: NDArray[np.float64]
    scratch_multipliers: NDArray[np.float64]
    integrals: NDArray[np.float64]
    energies: NDArray[np.float64]


def make_iteration(model: Model, state: State, work: Workspace) -> Iteration:
    """Return newly allocated arrays of a generalized-alpha step, in which only the mass matrix is computed already."""
    n = state.q.size
    size = n + state.multipliers.size
    return Iteration(
        start_q=np.zeros(n),
        start_v=np.zeros(n),
        q=np.zeros(n),
        v=np.zeros(n),
        a=np.zeros(n),
        auxiliary=np.zeros(n),
        multipliers=np.zeros(state.multipliers.size),
        newton=make_newton_matrices(model, work),
        rhs=np.zeros(size),
        solution=np.zeros((model.elimination.first.size, BLOCK)),
        power=np.zeros(state.power.size),
        scratch_q=np.zeros(n),
        scratch_v=np.zeros(n),
        scratch_a=np.zeros(n),
        scratch_multipliers=np.zeros(state.multipliers.size),
        integrals=np.zeros(state.integrals.size),
        energies=np.zeros(m.ENERGIES),
    )


@kernel
def fill_residual(model, state, it, work, time, scale):
    """Write Newton's right-hand side to `it.rhs`: negative residuals of dynamics, times `scale`, and of constraints."""
    bodies, rhs, force = model.bodies, it.rhs, work.force
    q, multipliers = it.q, it.multipliers
    n, rows = q.size, work.residual.size
    applied_forces(model, state.joints, q, it.v, work)
    constraint_drift(model, q, time, work)
    for i in range(n):
        it.scratch_a[i] = 0.0
    add_mass_products(model, it.a, it.scratch_a)
    for i in range(n):
        rhs[i] = force[i] - it.scratch_a[i]
    for r in range(rows):
        add_row(model, work, r, -multipliers[r], rhs)
    for r in range(rows):
        rhs[n + r] = -work.residual[r]
    for b in range(bodies.size):
        body = bodies[b]
        rhs[n + rows + b] = 0.0
        if body.constraints:
            rhs[n + rows + b] = -add_length_force(body, q, multipliers[rows + b], rhs)
    for i in range(n):
        rhs[i] *= scale


@kernel
def solve_newton(model, it):
    """Replace `it.rhs` by the solution of the Newton iteration's linear system in arrays `it`; False if singular."""
    position, rhs, solution = model.elimination.position, it.rhs, it.solution
    if not profile_factor(model.elimination, it.newton.matrix):
        return False
    for i in range(rhs.size):
        enter(solution, position[i], rhs[i])
    profile_solve(model.elimination, it.newton.matrix, solution)
    for i in range(rhs.size):
        rhs[i] = taken(solution, position[i])
    return True


@kernel
def solve_step(model, state, it, work, settings, h):
    """Solve a step `h` [s] in the arrays `it`; return the last Newton correction / tolerance, <= 1 if converged."""
    n = state.q.size
    alpha_m, alpha_f, beta, gamma = settings.alpha_m, settings.alpha_f, settings.beta, settings.gamma
    q0, v0, a0, x0 = it.start_q, it.start_v, state.a, state.algorithmic_a
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
    correction, best, relaxation, stalled = math.inf, math.inf, 1.0, 0
    for _ in range(_MOST_ITERATIONS):
        fill_residual(model, state, it, work, time, scale)
        linearize_forces(model, state.joints, q, v, it.newton)
        weights = (scale * mass_weight, scale * damping_weight, scale)
        assemble(model, q, multipliers, work.row_value, it.newton, weights)
        state.clock[0].evaluations += 1
        state.clock[0].factorizations += 1
        if not solve_newton(model, it):
            return math.inf
        correction = 0.0
        for i in range(n):
            if not abs(rhs[i]) <= correction:
                correction = abs(rhs[i])
        # A correction that is right but scaled by r leaves the fraction 1 - r of the error.
        if correction <= (1.0 - 0.5 * relaxation) * best:
            best, stalled, relaxation = correction, 0, min(1.0, 2.0 * relaxation)
        else:
            stalled += 1
            if stalled == _PATIENCE:
                relaxation, stalled = 0.5 * relaxation, 0
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


@kernel
def restart(model, state, it, work, settings, h):
    """Restart with a step `h` [s]: project its start onto the constraints, and recompute accelerations in `state`.

    `it.start_q` and `it.start_v` are projected in place. `state` gets the accelerations and multipliers there, and as
    auxiliary accelerations those at (alpha_m - alpha_f) `h` after the start. Return False for singular constraints.
    """
    q0, v0, time = it.start_q, it.start_v, state.clock[0].time
    # Velocities violate the constraints by O(h^2), which would cause forces of O(h^2 / new step) in a shorter step.
    if not prepare_response(model, q0, time, work):
        return False
    project(model, q0, v0, time, work)
    if not accelerations(model, state.joints, q0, v0, time, work, state.a, state.multipliers):
        return False
    shift = (settings.alpha_m - settings.alpha_f) * h
    for i in range(q0.size):
        it.scratch_q[i] = q0[i] + shift * v0[i] + 0.5 * shift * shift * state.a[i]
        it.scratch_v[i] = v0[i] + shift * state.a[i]
    regular = accelerations(
        model,
        state.joints,
        it.scratch_q,
        it.scratch_v,
        time + shift,
        work,
        state.algorithmic_a,
        it.scratch_multipliers,
    )
    state.clock[0].evaluations += 2
    return regular


class AlphaArrays(NamedTuple):
    """Work arrays of generalized-alpha for one thread, which reuses them for all mechanisms of a batch."""

    trial: NDArray[np.void]  # (1,) rows of `trial.trial_type`
    motion: NDArray[np.void]  # (joints,) rows of `trial.joint_motion_type`
    work: Workspace
    scratch: Workspace  # for evaluations that must not change `work`
    iteration: Iteration


def make_alpha_arrays(model: Model, state: State) -> AlphaArrays:
    """Allocate a thread's work arrays of generalized-alpha for a mechanism."""
    work, motion = make_workspace(model, state), np.zeros(state.joints.size, joint_motion_type)
    return AlphaArrays(
        np.zeros(1, trial_type), motion, work, make_workspace(model, state), make_iteration(model, state, work)
    )


def convert_settings(chosen: GeneralizedAlpha) -> AlphaSettings:
    """Convert a user's settings to the kernels' types; other types would compile the kernels anew."""
    return AlphaSettings(
        *alpha_coefficients(chosen.rho_inf),
        float(chosen.step),
        float(chosen.newton_tolerance),
    )


@kernel
def prepare(model, state, arrays):
    """Compute impact speeds in `arrays.work`, and powers in `arrays.iteration.power`, at a step's start.

    Powers are the time derivatives of `state.integrals`: of work and dissipation [W], and of impulses [N]. A journal
    out of contact in its clearance gets its approach speed as the impact speed, in case the step ends in contact.
    """
    work, joint_states = arrays.work, state.joints
    for j in range(model.joints.size):
        joint = model.joints[j]
        work.impact_speeds[j] = 0.0
        if joint.kind == m.CLEARANCE:
            if joint_states[j].in_contact:
                work.impact_speeds[j] = joint_states[j].impact_speed
            else:
                work.impact_speeds[j] = max(arrays.motion[j].depth_rate, joint.minimum_impact_speed)
    applied_forces(model, joint_states, state.q, state.v, work)
    store_constraint_loads(model, state.multipliers, state.clock[0].time, state.q, work)
    copy_into(arrays.iteration.power, work.power)


@kernel
def engage_stops(model, state, arrays):
    """Mark all stops as engaged in `state`: otherwise they exert no torque, even when reached. `arrays` is unused."""
    for j in range(model.joints.size):
        state.joints[j].stop_engaged = 1


@kernel
def begin_alpha(model, state, settings, arrays):
    """Prepare the work arrays for a call of `advance`, from the model and its present state; return True."""
    it = arrays.iteration
    engage_stops(model, state, arrays)
    fill_rows(model, arrays.work)
    fill_rows(model, arrays.scratch)
    clear(model.elimination, it.newton.mass)
    fill_mass(model, it.newton.mass)
    measure_depths(model, state, arrays.motion)
    prepare(model, state, arrays)
    take_loads(arrays.work.loads, arrays.motion)
    for q, v in ((it.start_q, it.start_v), (it.q, it.v)):
        copy_into(q, state.q)
        copy_into(v, state.v)
    return True


@kernel
def choose_alpha(model, state, settings, arrays, remaining):
    """Return `settings.step` [s], shortened so that equal steps fill the `remaining` time [s]; all else is unused."""
    return remaining / math.ceil(remaining / settings.step - 1e-9)


@kernel
def attempt_alpha(model, state, settings, arrays, h):
    """Solve a step `h` [s]; return 0 if Newton's iteration converges, or -1 if the constraints are singular.

    If the iteration fails, return its last correction divided by the tolerance, which is above 1, infinite or NaN.
    """
    clock, trial, it, work = state.clock[0], arrays.trial[0], arrays.iteration, arrays.work
    prepare(model, state, arrays)
    copy_into(it.start_q, state.q)
    copy_into(it.start_v, state.v)
    if clock.acceleration_current != m.ALGORITHMIC or abs(h - clock.last_step) > 1e-9 * h:
        if not restart(model, state, it, work, settings, h):
            return -1.0
        clock.acceleration_current = m.ALGORITHMIC
        clock.last_step = h
    convergence = solve_step(model, state, it, work, settings, h)
    if not convergence <= 1.0:
        trial.retry = -1.0
        if math.isfinite(convergence):
            trial.reason = m.NEWTON_FAILED
        return convergence
    return 0.0


@kernel
def complete_alpha(model, state, settings, arrays, h):
    """Write ideal joints' forces and the drives' power at the end of the solved step `h` [s] to `arrays.work`."""
    it = arrays.iteration
    store_constraint_loads(model, it.multipliers, state.clock[0].time + h, it.q, arrays.work)


@kernel
def sample_alpha(model, state, settings, arrays, recorder, h, share):
    """Record a sample at fraction `share` of the step: cubic Hermite positions, and their derivative as velocities."""
    it, work, scratch = arrays.iteration, arrays.work, arrays.scratch
    for i in range(state.q.size):
        rise = it.q[i] - it.start_q[i]
        slope0, slope1 = h * it.start_v[i], h * it.v[i]
        c2 = 3.0 * rise - 2.0 * slope0 - slope1
        c3 = slope0 + slope1 - 2.0 * rise
        it.scratch_q[i] = it.start_q[i] + share * (slope0 + share * (c2 + share * c3))
        it.scratch_v[i] = (slope0 + share * (2.0 * c2 + 3.0 * share * c3)) / h if h > 0.0 else it.start_v[i]
    for k in range(state.integrals.size):
        # Trapezoidal rule up to the sample: the power is taken as linear in the step.
        mean = it.power[k] + 0.5 * share * (work.power[k] - it.power[k])
        it.integrals[k] = state.integrals[k] + share * h * mean
    copy_into(scratch.impact_speeds, work.impact_speeds)
    q, v, a, time = it.scratch_q, it.scratch_v, it.scratch_a, state.clock[0].time + share * h
    integrals, multipliers, energies = it.integrals, it.scratch_multipliers, it.energies
    record_sample(recorder, model, state.joints, q, v, time, integrals, scratch, a, multipliers, energies)


@kernel
def commit_alpha(model, state, settings, arrays, h, share):
    """Move `state` to the end of the solved step `h` [s]; return True. Its accepted fraction, `share`, is always 1."""
    it = arrays.iteration
    for k in range(state.integrals.size):
        state.integrals[k] += 0.5 * h * (it.power[k] + arrays.work.power[k])
    copy_into(state.q, it.q)
    copy_into(state.v, it.v)
    copy_into(state.a, it.a)
    copy_into(state.algorithmic_a, it.auxiliary)
    copy_into(state.multipliers, it.multipliers)
    measure_depths(model, state, arrays.motion)
    return True


@kernel
def evaluate_alpha(model, state, arrays, changed):
    """Copy joint angles, rates, forces from `arrays.work` to `.motion`; return True (success). `changed` is unused."""
    take_loads(arrays.work.loads, arrays.motion)
    return True


@kernel
def depth_at_start(model, state, arrays, j, h, share):
    """Return joint `j`'s penetration [m] at the step's start; `share`, the fraction to evaluate at, is unused."""
    return arrays.motion[j].depth


@kernel
def angle_at_start(model, state, arrays, j, h, share):
    """Return joint `j`'s angle [rad] at the step's start; `share`, the fraction to evaluate at, is unused."""
    return arrays.motion[j].angle
