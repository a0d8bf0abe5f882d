"""One step of Rosenbrock's method RODAS, linearly implicit, of order four with an estimate of order three, L-stable.

E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 1996, sections IV.7 and VI.4,
doi:10.1007/978-3-642-05221-7. With y' = f(y) and the Jacobian J at the start of the step, stage i solves

(1 / (gamma h) - J) u_i = f(y_0 + sum_j a_ij u_j) + sum_j c_ij u_j / h,      y_1 = y_0 + sum_i m_i u_i.

Here y = (q, v), and accelerations and multipliers are algebraic variables, as in a differential-algebraic equation of
index 1. Eliminating all but the velocities leaves, for every stage, one system of equations with the matrix

[[M + gamma h C + (gamma h)^2 K, Phi_q^T], [Phi_q, 0]],

K and C being the tangents of the forces by coordinates and velocities; the rows of the lengths have further terms,
their own slopes. It is factored once a step, in time that grows linearly with the length of the chain (`profile.py`).
The stiff vibrations of beams then do not bound the step.
"""

from solar_env.mechanics.arrays.model import (
    CLEARANCE,
    FRICTION_DISSIPATION,
    IMPULSE,
    INTEGRALS_PER_JOINT,
    NORMAL_DISSIPATION,
    SLIDING_WORK,
)
from solar_env.mechanics.equations.newton import assemble, linearize_forces
from solar_env.mechanics.equations.system import applied_forces, store_constraint_loads
from solar_env.mechanics.integrators.methods.rosenbrock_stages import (
    GAMMA,
    ROSENBROCK_STAGES,
    add_length_slopes,
    set_stage,
    solve_stage,
)
from solar_env.mechanics.integrators.methods.stages import hermite_state
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into, greatest
from solar_env.mechanics.numerics.profile import profile_factor


@kernel(inner=True)
def evaluate_forces(model, joint_states, q, v, work):
    """`system.applied_forces` as a call: inlined at every place it would take long to compile."""
    applied_forces(model, joint_states, q, v, work)


@kernel(single_caller=True)
def take_contacts_from_ends(joints, power, gain, h):
    """Put the trapezoidal rule in place of Simpson's for the integrals of contacts.

    The depth of a lasting contact, some nanometres, is a difference of positions that move by millimetres in a step:
    the solution has it at its ends, but not its interpolant in between.
    """
    for j in range(joints.size):
        if joints[j].kind == CLEARANCE:
            for integral in (NORMAL_DISSIPATION, FRICTION_DISSIPATION, SLIDING_WORK, IMPULSE):
                k = INTEGRALS_PER_JOINT * j + integral
                gain[k] = 0.5 * h * (power[0, k] + power[-1, k])


@kernel(single_caller=True)
def estimate_error(model, state, stages, step, settings):
    """Greatest component of the error estimate, which is the last increment, in units of the tolerance."""
    last = ROSENBROCK_STAGES - 1
    uq, uv = step.coordinate_increments[last], step.velocity_increments[last]
    v0, v, weights, ratios = state.v, stages.v, model.error_weight, stages.ratios
    rtol, velocity_scale = settings.rtol, settings.velocity_scale
    position_scale = 1.0 / (rtol * model.length_scale)
    for i in range(v.size):
        scale = rtol * (velocity_scale + weights[i] * max(abs(v0[i]), abs(v[i])))
        ratios[i] = weights[i] * max(abs(uq[i]) * position_scale, abs(uv[i]) / scale)
    return greatest(ratios)


@kernel(inner=True)
def attempt_implicit(model, state, stages, step, work, settings, h):
    """Fill a linearly implicit step `h`, its end going to `stages` as in `runge_kutta.take_stages`.

    Returns:
        The error in units of the tolerance; negative if the constraints are singular.
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
    # Simpson's rule for the integrals, with the interpolated state in the middle.
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
