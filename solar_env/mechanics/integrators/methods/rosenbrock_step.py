"""A step of the Rosenbrock method RODAS, linearly implicit and L-stable, of order four with an estimate of order three.

E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 1996, sections IV.7 and VI.4,
doi:10.1007/978-3-642-05221-7. With y' = f(y) and the Jacobian J at the start of the step, stage i solves

(1 / (gamma h) - J) u_i = f(y_0 + sum_j a_ij u_j) + sum_j c_ij u_j / h,      y_1 = y_0 + sum_i m_i u_i.

Here y = (q, v); accelerations and multipliers are algebraic variables of a differential-algebraic equation of index 1.
Eliminating all but the velocities leaves, for every stage, one system of equations with the matrix

[[M + gamma h C + (gamma h)^2 K, Phi_q^T], [Phi_q, 0]],

where K and C are minus the derivatives of the forces by coordinates and velocities. A rigid body's length constraint,
differentiated twice in time, depends on both, too. Its row of the block Phi_q also has its derivatives by coordinates,
times (gamma h)^2, and by velocities, times gamma h. The matrix is factored once per step, in time that grows linearly
with the length of the chain of bodies (`profile.py`). Stiff vibrations of beams do not bound the step.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.model import Model, State
from solar_env.mechanics.equations.newton import NewtonMatrices, assemble, linearize_forces, make_newton_matrices
from solar_env.mechanics.equations.system import Workspace, applied_forces, store_constraint_loads
from solar_env.mechanics.integrators.methods.stages import hermite_state
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into, greatest
from solar_env.mechanics.numerics.profile import (
    BLOCK,
    add_entry,
    add_to,
    enter,
    profile_factor,
    profile_product,
    profile_solve,
    taken,
)

ROSENBROCK_STAGES = 6
NEVER = -1
GAMMA = 0.25
# Coefficients a_ij and c_ij of stage i; the sixth stage adds the fifth's increment, the step's end adds the sixth's.
_A = (
    (0.0, 0.0, 0.0, 0.0, 0.0),
    (1.544, 0.0, 0.0, 0.0, 0.0),
    (0.9466785280815826, 0.2557011698983284, 0.0, 0.0, 0.0),
    (3.314825187068521, 2.896124015972201, 0.9986419139977817, 0.0, 0.0),
    (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 0.0),
    (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0),
)
_C = (
    (0.0, 0.0, 0.0, 0.0, 0.0),
    (-5.6688, 0.0, 0.0, 0.0, 0.0),
    (-2.430093356833875, -0.2063599157091915, 0.0, 0.0, 0.0),
    (-0.1073529058151375, -9.594562251023355, -20.47028614809616, 0.0, 0.0),
    (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160, 0.0),
    (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054),
)


class LinearStep(NamedTuple):
    """Arrays of a linearly implicit step; each (blocks, BLOCK) is a vector in elimination order, BLOCK values a row."""

    newton: NewtonMatrices  # of the stage equations
    coordinate_increments: NDArray[np.float64]  # (stages, n)
    velocity_increments: NDArray[np.float64]  # (stages, n)
    acceleration_increments: NDArray[np.float64]  # (stages, n)
    multiplier_increments: NDArray[np.float64]  # (stages, m + bodies)
    start_force: NDArray[np.float64]  # (n,)
    q: NDArray[np.float64]  # (n,) stage values
    v: NDArray[np.float64]
    a: NDArray[np.float64]
    past_velocity: NDArray[np.float64]  # (n,) sum of c_ij u_j / h
    rate: NDArray[np.float64]  # (n,) rates of the coordinates, without the increment of the present stage
    multipliers: NDArray[np.float64]  # (m + bodies,)
    unknowns: NDArray[np.float64]  # (blocks, BLOCK)
    factor: NDArray[np.float64]  # (blocks, BLOCK) vector to multiply by a matrix
    product: NDArray[np.float64]  # (blocks, BLOCK)
    linearized: NDArray[np.int64]  # (1,) number of accepted steps at which the tangents were computed, or NEVER


def make_linear_step(model: Model, state: State, work: Workspace) -> LinearStep:
    """Return the arrays of a linearly implicit step, filled with zeros except for the mass matrix.

    Its `newton` shares joint loads and impact speeds with `work`; the derivatives of the forces are computed from them.
    """
    n, k = state.q.size, state.multipliers.size
    blocks = model.elimination.first.size
    return LinearStep(
        newton=make_newton_matrices(model, work),
        coordinate_increments=np.zeros((ROSENBROCK_STAGES, n)),
        velocity_increments=np.zeros((ROSENBROCK_STAGES, n)),
        acceleration_increments=np.zeros((ROSENBROCK_STAGES, n)),
        multiplier_increments=np.zeros((ROSENBROCK_STAGES, k)),
        start_force=np.zeros(n),
        q=np.zeros(n),
        v=np.zeros(n),
        a=np.zeros(n),
        past_velocity=np.zeros(n),
        rate=np.zeros(n),
        multipliers=np.zeros(k),
        unknowns=np.zeros((blocks, BLOCK)),
        factor=np.zeros((blocks, BLOCK)),
        product=np.zeros((blocks, BLOCK)),
        linearized=np.zeros(1, dtype=np.int64),
    )


@kernel
def add_length_slopes(model, state, a, newton, diagonal):
    """Add derivatives of length constraints g = d.d'' + d'.d' = 0 with respect to coordinates and velocities.

    The vector d joins the two base points whose coordinates describe a rigid body. The constraints' rows of
    `newton.matrix` get (gamma h)^2 dg/dd + gamma h dg/d(d'), where dg/dd = d'' and dg/d(d') = 2 d'. `a` (n,) are the
    accelerations at the start of the step, and `diagonal` is gamma h.
    """
    q, v, elimination = state.q, state.v, model.elimination
    first = q.size + model.constraints.size.size
    for b in range(model.bodies.size):
        if model.bodies[b].constraints:
            k = model.bodies[b].offset
            for axis in range(2):
                i, j = k + axis, k + 2 + axis
                slope = diagonal * (2.0 * (v[j] - v[i]) + diagonal * (a[j] - a[i]))
                add_entry(elimination, newton.matrix, first + b, i, -slope)
                add_entry(elimination, newton.matrix, first + b, j, slope)


@kernel
def set_stage(state, stages, step, s, h):
    """Write stage `s`'s q, v, a, multipliers and sums c_ij u_j / h to `step`, from `state` and past increments u_j."""
    q, v, a, past, rate, multipliers = step.q, step.v, step.a, step.past_velocity, step.rate, step.multipliers
    copy_into(q, state.q)
    copy_into(v, state.v)
    copy_into(a, stages.acceleration[0])
    copy_into(multipliers, state.multipliers)
    for i in range(q.size):
        past[i] = 0.0
        rate[i] = 0.0
    for j in range(s):
        weight, pull = _A[s][j], _C[s][j] / h
        uq, uv = step.coordinate_increments[j], step.velocity_increments[j]
        ua, ul = step.acceleration_increments[j], step.multiplier_increments[j]
        for i in range(q.size):
            q[i] += weight * uq[i]
            v[i] += weight * uv[i]
            a[i] += weight * ua[i]
            rate[i] += pull * uq[i]
            past[i] += pull * uv[i]
        for k in range(ul.size):
            multipliers[k] += weight * ul[k]
    for i in range(q.size):
        rate[i] += v[i]


@kernel
def solve_stage(model, state, stages, step, s, force, diagonal):
    """Solve stage `s`; write its increments of q, v, a and multipliers to row `s` of the increment arrays in `step`.

    `force` (n,) has the forces at `step.q` and `step.v`, and `diagonal` is gamma h [s]. `stages.acceleration[0]` holds
    the accelerations at the step's start.
    """
    elimination, position = model.elimination, model.elimination.position
    n, rows = state.q.size, model.constraints.size.size
    x, factor, product = step.unknowns, step.factor, step.product
    past, rate = step.past_velocity, step.rate
    for i in range(n):
        enter(factor, position[i], rate[i])
    profile_product(elimination, step.newton.stiffness, factor, product)
    for r in range(x.shape[0]):
        for k in range(BLOCK):
            x[r, k] = -diagonal * diagonal * product[r, k]
    for i in range(n):
        enter(factor, position[i], past[i])
    profile_product(elimination, step.newton.mass, factor, product)
    for r in range(x.shape[0]):
        for k in range(BLOCK):
            x[r, k] += diagonal * product[r, k]
    for i in range(n):
        add_to(x, position[i], diagonal * force[i])
    for r in range(rows):
        enter(x, position[n + r], 0.0)
    for b in range(model.bodies.size):
        if model.bodies[b].constraints:
            border_length(state, stages.acceleration[0], step, model.bodies[b].offset, rows + b, position, diagonal)
    profile_solve(elimination, step.newton.matrix, x)
    uq, uv = step.coordinate_increments[s], step.velocity_increments[s]
    ua, ul = step.acceleration_increments[s], step.multiplier_increments[s]
    inverse = 1.0 / diagonal
    for i in range(n):
        uv[i] = taken(x, position[i])
        uq[i] = diagonal * (uv[i] + rate[i])
        ua[i] = inverse * uv[i] - step.a[i] - past[i]
    for k in range(ul.size):
        if position[n + k] >= 0:
            ul[k] = inverse * taken(x, position[n + k]) - step.multipliers[k]


@kernel
def border_length(state, start_a, step, k, row, position, diagonal):
    """Enter a rigid body's length constraint in `step.unknowns`, the right-hand side of a stage's linear equations.

    The constraint keeps the distance of the body's two base points. The right-hand side of its own equation is written
    to the entry of its multiplier. The equations' matrix takes the constraint force along the gradient at the step's
    start. The force due to the gradient's change since then is added to the entries of the base points' coordinates.
    `start_a` (n,): accelerations at the step's start. `k`: index of the body's first coordinate. `row`: index of the
    constraint's multiplier. `position`: places of the unknowns in the elimination order. `diagonal`: gamma h.
    """
    q, v, a, rate, past, x = step.q, step.v, step.a, step.rate, step.past_velocity, step.unknowns
    multiplier, start = step.multipliers[row], state.multipliers[row]
    square = diagonal * diagonal
    length_row = 0.0
    for axis in range(2):
        i, j = k + axis, k + 2 + axis
        d0, d = state.q[j] - state.q[i], q[j] - q[i]
        relative = start_a[j] - start_a[i]
        pull = diagonal * multiplier * (d - d0) - square * start * (rate[i] - rate[j])
        add_to(x, position[i], pull)
        add_to(x, position[j], -pull)
        u = v[j] - v[i]
        length_row += d0 * (a[j] - a[i] + past[j] - past[i]) - d * (a[j] - a[i]) - u * u
        length_row -= diagonal * relative * (rate[j] - rate[i])
    enter(x, position[state.q.size + row], diagonal * length_row)


@kernel(inlined=False)
def evaluate_forces(model, joint_states, q, v, work):
    """Write forces, joint loads and powers to `work` by `system.applied_forces`, here compiled once for all callers."""
    applied_forces(model, joint_states, q, v, work)


@kernel
def take_contacts_from_ends(joints, power, gain, h):
    """Write contacts' dissipation, sliding work and impulse in a step to `gain` (integrals,), by the trapezoidal rule.

    Row 0 of `power` (stages, integrals) has their rates at the step's start, and the last row at its end. In between,
    the step's interpolant does not resolve a lasting contact's depth of some nanometres.
    """
    for j in range(joints.size):
        if joints[j].kind == m.CLEARANCE:
            for integral in (m.NORMAL_DISSIPATION, m.FRICTION_DISSIPATION, m.SLIDING_WORK, m.IMPULSE):
                k = m.INTEGRALS_PER_JOINT * j + integral
                gain[k] = 0.5 * h * (power[0, k] + power[-1, k])


@kernel
def estimate_error(model, state, stages, step, settings):
    """Return the greatest component of the error estimate (the last stage's increment), divided by the tolerance."""
    last = ROSENBROCK_STAGES - 1
    uq, uv = step.coordinate_increments[last], step.velocity_increments[last]
    v0, v, weights, ratios = state.v, stages.v, model.error_weight, stages.ratios
    rtol, velocity_scale = settings.rtol, settings.velocity_scale
    position_scale = 1.0 / (rtol * model.length_scale)
    for i in range(v.size):
        scale = rtol * (velocity_scale + weights[i] * max(abs(v0[i]), abs(v[i])))
        ratios[i] = weights[i] * max(abs(uq[i]) * position_scale, abs(uv[i]) / scale)
    return greatest(ratios)


@kernel(inlined=False)
def attempt_implicit(model, state, stages, step, work, settings, h):
    """Try a linearly implicit step `h` [s] from `state`; return error / tolerance, negative for singular constraints.

    `stages.q`, `stages.v` and `stages.multipliers` get the values at the step's end. The accelerations there are
    written to the last row of `stages.acceleration`, and the rates of works, losses and impulses to the last row of
    `stages.power`. `stages.gain` gets the integrals of these rates over the step. `step` and `work` are work arrays.
    """
    time = state.clock[0].time
    diagonal = GAMMA * h
    if step.linearized[0] != state.clock[0].steps:
        step.linearized[0] = state.clock[0].steps
        evaluate_forces(model, state.joints, state.q, state.v, work)
        copy_into(step.start_force, work.force)
        linearize_forces(model, state.joints, state.q, state.v, step.newton)
        state.clock[0].evaluations += 1
    weights = (1.0, diagonal, diagonal * diagonal)
    assemble(model, state.q, state.multipliers, work.row_value, step.newton, weights)
    add_length_slopes(model, state, stages.acceleration[0], step.newton, diagonal)
    state.clock[0].factorizations += 1
    if not profile_factor(model.elimination, step.newton.matrix):
        return -1.0
    for s in range(ROSENBROCK_STAGES):
        set_stage(state, stages, step, s, h)
        if s == 0:
            solve_stage(model, state, stages, step, s, step.start_force, diagonal)
        else:
            evaluate_forces(model, state.joints, step.q, step.v, work)
            solve_stage(model, state, stages, step, s, work.force, diagonal)
    last = ROSENBROCK_STAGES - 1
    end = stages.acceleration[-1]
    for i in range(step.q.size):
        stages.q[i] = step.q[i] + step.coordinate_increments[last, i]
        stages.v[i] = step.v[i] + step.velocity_increments[last, i]
        end[i] = step.a[i] + step.acceleration_increments[last, i]
    # Simpson's rule gives the integrals, with the interpolated state in the middle of the step.
    power, middle, gain = stages.power, stages.power[1], stages.gain
    hermite_state(state, stages, h, 0.5)
    evaluate_forces(model, state.joints, stages.scratch_q, stages.scratch_v, work)
    multipliers, halfway = stages.multipliers, step.multipliers
    for k in range(multipliers.size):
        multipliers[k] = step.multipliers[k] + step.multiplier_increments[last, k]
        halfway[k] = 0.5 * (state.multipliers[k] + multipliers[k])
    store_constraint_loads(model, halfway, time + 0.5 * h, stages.scratch_q, work)
    copy_into(middle, work.power)
    evaluate_forces(model, state.joints, stages.q, stages.v, work)
    store_constraint_loads(model, multipliers, time + h, stages.q, work)
    copy_into(power[-1], work.power)
    for k in range(gain.size):
        gain[k] = h / 6.0 * (power[0, k] + 4.0 * middle[k] + power[-1, k])
    take_contacts_from_ends(model.joints, power, gain, h)
    state.clock[0].evaluations += ROSENBROCK_STAGES + 1
    return estimate_error(model, state, stages, step, settings)
