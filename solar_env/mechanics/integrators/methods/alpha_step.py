"""One step of generalized-alpha: residual, Newton matrix, iteration, and the restart after a change of step.

J. Chung and G. M. Hulbert, J. Appl. Mech. 60 (1993) 371, doi:10.1115/1.2900803, in the form of M. Arnold and
O. Bruls, Multibody Syst. Dyn. 18 (2007) 185, doi:10.1007/s11044-007-9084-0. Constraint rows and multipliers are
scaled by beta h^2 (C. L. Bottasso, O. A. Bauchau and A. Cardona, SIAM J. Sci. Comput. 29 (2007) 397,
doi:10.1137/050638503). With rho_inf = 1 this is the trapezoidal Newmark scheme, beta = 1/4, gamma = 1/2.

A change of step size leaves the auxiliary accelerations inconsistent; they are then solved for afresh on the
acceleration level, at the instant t + (alpha_m - alpha_f) h which they stand for.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import ENERGIES, Model, State
from solar_env.mechanics.bodies.natural_coordinates import add_length_force
from solar_env.mechanics.equations.constraints import add_row, constraint_drift, prepare_response, project
from solar_env.mechanics.equations.newton import NewtonMatrices, assemble, linearize_forces, make_newton_matrices
from solar_env.mechanics.equations.system import Workspace, accelerations, add_mass_products, applied_forces
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.profile import BLOCK, enter, profile_factor, profile_solve, taken

_MOST_ITERATIONS = 60
# Full corrections at first; where kinks of contact or friction make them cycle for so long, smaller shares of them.
_PATIENCE = 12


class AlphaSettings(NamedTuple):
    """Settings of generalized-alpha as the kernels take them."""

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

    start_q: NDArray[np.float64]  # where it begins: the accepted state, returned to the constraints after a restart
    start_v: NDArray[np.float64]
    q: NDArray[np.float64]
    v: NDArray[np.float64]
    a: NDArray[np.float64]  # accelerations q''
    auxiliary: NDArray[np.float64]  # algorithmic accelerations
    multipliers: NDArray[np.float64]  # unscaled
    newton: NewtonMatrices
    rhs: NDArray[np.float64]  # (n + m + bodies,)
    solution: NDArray[np.float64]  # (blocks, BLOCK) the same in the order of elimination
    power: NDArray[np.float64]  # at the step's start
    scratch_q: NDArray[np.float64]
    scratch_v: NDArray[np.float64]
    scratch_a: NDArray[np.float64]
    scratch_multipliers: NDArray[np.float64]
    integrals: NDArray[np.float64]
    energies: NDArray[np.float64]


def make_iteration(model: Model, state: State, work: Workspace) -> Iteration:
    """Allocate the arrays of a step."""
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
        energies=np.zeros(ENERGIES),
    )


@kernel(single_caller=True)
def fill_residual(model, state, it, work, time, scale):
    """Right-hand side of Newton's equations: minus the scaled residual of dynamics, minus the constraints."""
    bodies, rhs, force = model.bodies, it.rhs, work.force
    q, multipliers = it.q, it.multipliers
    n, m = q.size, work.residual.size
    applied_forces(model, state.joints, q, it.v, work)
    constraint_drift(model, q, time, work)
    for i in range(n):
        it.scratch_a[i] = 0.0
    add_mass_products(model, it.a, it.scratch_a)
    for i in range(n):
        rhs[i] = force[i] - it.scratch_a[i]
    for r in range(m):
        add_row(model, work, r, -multipliers[r], rhs)
    for r in range(m):
        rhs[n + r] = -work.residual[r]
    for b in range(bodies.size):
        body = bodies[b]
        rhs[n + m + b] = 0.0
        if body.constraints:
            rhs[n + m + b] = -add_length_force(body, q, multipliers[m + b], rhs)
    for i in range(n):
        rhs[i] *= scale


@kernel(single_caller=True)
def solve_newton(model, it):
    """Solve Newton's equations for `it.rhs` in place; False if the matrix is singular."""
    position, rhs, solution = model.elimination.position, it.rhs, it.solution
    if not profile_factor(model.elimination, it.newton.matrix):
        return False
    for i in range(rhs.size):
        enter(solution, position[i], rhs[i])
    profile_solve(model.elimination, it.newton.matrix, solution)
    for i in range(rhs.size):
        rhs[i] = taken(solution, position[i])
    return True


@kernel(inner=True)
def solve_step(model, state, it, work, settings, h):
    """Solve one step into `it`; returns the last correction in units of the tolerance (at most 1 if it converged)."""
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
        # A share r of a correction that points the right way leaves 1 - r of it.
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


@kernel(inner=True)
def restart(model, state, it, work, settings, h):
    """Solve accelerations and multipliers afresh at the accepted state, for steps of size `h`. False if singular."""
    q0, v0, time = it.start_q, it.start_v, state.clock[0].time
    # Velocities are O(h^2) off the constraints, which a shorter step would answer with forces of O(h^2 / new step).
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
