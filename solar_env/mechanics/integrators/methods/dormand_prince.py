"""Explicit Runge-Kutta method of order eight, Dormand and Prince's 8(5,3), with an interpolant of order seven.

E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, 1993, sections II.5, II.6 and II.10,
doi:10.1007/978-3-540-78862-1. Worth its twelve evaluations a step where many digits are asked of a smooth motion. The
interpolant takes three more, and only where something happens or is recorded between the ends of a step.
"""

import math

from solar_env.mechanics.arrays.columns import ANGLE
from solar_env.mechanics.arrays.model import CLEARANCE, EXACT, GLOBAL_INTEGRALS, INTEGRALS_PER_JOINT, Model, State
from solar_env.mechanics.equations.system import accelerations, inlined_accelerations, make_workspace
from solar_env.mechanics.integrators.methods.dop853_coefficients import COUPLING, DENSE, ERROR, NODES, ROWS, STAGES
from solar_env.mechanics.integrators.methods.runge_kutta import BOOKED_ENERGIES
from solar_env.mechanics.integrators.step import (
    AdaptiveArrays,
    AdaptiveSettings,
    Interpolant,
    make_adaptive_arrays,
    refresh,
)
from solar_env.mechanics.joints.joint import relative
from solar_env.mechanics.joints.torques import stop_depth
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into, greater
from solar_env.mechanics.records.recording import sample_due

_END = ROWS - 1


class DormandPrinceSettings(AdaptiveSettings):
    """Settings of this method."""


def make_dormand_prince_arrays(model: Model, state: State) -> AdaptiveArrays:
    """Allocate the arrays for a mechanism."""
    return make_adaptive_arrays(model, state, ROWS, make_workspace(model, state), ())


@kernel(inner=True)
def begin_dormand_prince(model, own):
    """Nothing is kept between calls."""


@kernel(inner=True)
def choose_dormand_prince(model, state, stages, wanted):
    """Step to try [s]: the one `wanted`, for the error estimate alone bounds it."""
    return wanted


@kernel(inner=True)
def add_stages(weights, h, start, derivatives, values):
    """Write start (n,) + h * sum_i weights[i] * derivatives[i] (rows, n) to `values` (n,)."""
    copy_into(values, start)
    for s in range(weights.size):
        factor = h * weights[s]
        if factor != 0.0:
            derivative = derivatives[s]
            for i in range(values.size):
                values[i] += factor * derivative[i]


@kernel(inner=True)
def enter_stage(state, stages, row, h, q, v):
    """Coordinates `q` and velocities `v` (n,) at a stage from the derivatives at those before it."""
    add_stages(COUPLING[row], h, state.q, stages.velocity, q)
    add_stages(COUPLING[row], h, state.v, stages.acceleration, v)
    copy_into(stages.velocity[row], v)


@kernel(inner=True)
def combined(weights, derivatives, i):
    """Sum over the stages of weights[s] * derivatives[s, i]."""
    total = 0.0
    for s in range(STAGES):
        total += weights[s] * derivatives[s, i]
    return total


@kernel(inner=True)
def error_of_order_eight(model, state, stages, settings, h):
    """Error of a step in units of the tolerance, e5^2 / sqrt(e5^2 + e3^2 / 100) of the two estimates' greatest parts.

    Hairer, Norsett and Wanner, section II.10, there with root mean squares.
    """
    v0, v, velocity, acceleration, power = state.v, stages.v, stages.velocity, stages.acceleration, stages.power
    rtol, weights = settings.rtol, model.error_weight
    position_scale = 1.0 / (rtol * model.length_scale)
    energy_scale = 1.0 / (rtol * state.clock[0].energy_scale)
    fifth, third = 0.0, 0.0
    for order in range(2):
        worst = 0.0
        estimate = ERROR[order]
        for i in range(v.size):
            scale = rtol * (settings.velocity_scale + weights[i] * max(abs(v0[i]), abs(v[i])))
            dq, dv = combined(estimate, velocity, i), combined(estimate, acceleration, i)
            worst = greater(worst, weights[i] * max(abs(dq) * position_scale, abs(dv) / scale))
        joint_integrals = power.shape[1] - GLOBAL_INTEGRALS
        for j in range(0, joint_integrals, INTEGRALS_PER_JOINT):
            for k in BOOKED_ENERGIES:
                worst = greater(worst, abs(combined(estimate, power, j + k)) * energy_scale)
        for i in range(joint_integrals, power.shape[1]):
            worst = greater(worst, abs(combined(estimate, power, i)) * energy_scale)
        if order == 0:
            fifth = h * worst
        else:
            third = h * worst
    size = math.sqrt(fifth * fifth + 0.01 * third * third)
    return fifth * fifth / size if size != 0.0 else 0.0


@kernel(inner=True)
def attempt_dormand_prince(model, state, settings, arrays, h):
    """Fill a step `h`, its end going to `stages`; its error in units of the tolerance, negative if singular."""
    work, stages, time = arrays.work, arrays.stages, state.clock[0].time
    q, v, acceleration, power, gain = stages.q, stages.v, stages.acceleration, stages.power, stages.gain
    joint_states, multipliers = state.joints, state.multipliers
    if state.clock[0].acceleration_current != EXACT and not refresh(model, state, stages, work):
        return -1.0
    for s in range(1, STAGES):
        enter_stage(state, stages, s, h, q, v)
        now = time + NODES[s] * h
        if not inlined_accelerations(model, joint_states, q, v, now, work, acceleration[s], multipliers):
            return -1.0
        copy_into(power[s], work.power)
    enter_stage(state, stages, _END, h, q, v)
    state.clock[0].evaluations += STAGES - 1
    error = error_of_order_eight(model, state, stages, settings, h)
    if error <= 1.0:
        if not accelerations(model, joint_states, q, v, time + h, work, acceleration[_END], multipliers):
            return -1.0
        copy_into(power[_END], work.power)
        state.clock[0].evaluations += 1
        for k in range(gain.size):
            gain[k] = h * combined(COUPLING[_END], power, k)
    return error


@kernel(single_caller=True)
def is_looked_into(model, state, arrays, recorder, end):
    """Whether something may happen, or is recorded, inside the step in hand, which ends at `end` [s]."""
    stages, joints, loads = arrays.stages, model.joints, arrays.work.loads
    if sample_due(recorder, end):
        return True
    for j in range(joints.size):
        joint, own, angle = joints[j], state.joints[j], loads[j, ANGLE]
        if joint.kind == CLEARANCE and (not own.in_contact or stages.depth_rate[j] > 0.0):
            return True
        if joint.has_latch and not own.latched and angle >= joint.lock_angle:
            return True
        depth, _ = stop_depth(joint, own.latched, angle)
        if depth > 0.0 and not own.stop_engaged:
            return True
    return False


@kernel(inner=True)
def complete_dense(model, state, arrays, recorder, h):
    """Evaluate the interpolant's own stages if the step in hand is looked into; False if constraints are singular."""
    stages, scratch, time = arrays.stages, arrays.scratch, state.clock[0].time
    if not is_looked_into(model, state, arrays, recorder, time + h):
        return True
    copy_into(scratch.impact_speeds, arrays.work.impact_speeds)
    q, v, acceleration = stages.scratch_q, stages.scratch_v, stages.acceleration
    for s in range(STAGES, _END):
        enter_stage(state, stages, s, h, q, v)
        now = time + NODES[s] * h
        if not accelerations(model, state.joints, q, v, now, scratch, acceleration[s], stages.multipliers):
            return False
        copy_into(stages.power[s], scratch.power)
    return True


@kernel(inner=True)
def fill_weights(share, weights):
    """Weights (rows,) of the stages in the interpolant of order seven at `share` of the step."""
    rest = 1.0 - share
    w1 = share * rest
    w2 = share * w1
    w3 = rest * w2
    w4 = share * w3
    w5 = rest * w4
    w6 = share * w5
    for s in range(ROWS):
        own = (share - w1 + 2.0 * w2) * COUPLING[_END, s]
        weights[s] = own + w3 * DENSE[0, s] + w4 * DENSE[1, s] + w5 * DENSE[2, s] + w6 * DENSE[3, s]
    weights[0] += w1 - w2
    weights[_END] -= w2


@kernel(inner=True)
def dense_state(state, stages, h, share):
    """State at `share` of the step, into `stages.scratch_q` and `stages.scratch_v`."""
    fill_weights(share, stages.weights)
    add_stages(stages.weights, h, state.q, stages.velocity, stages.scratch_q)
    add_stages(stages.weights, h, state.v, stages.acceleration, stages.scratch_v)


@kernel(inner=True)
def dense_integrals(state, stages, h, share):
    """Integrals at `share` of the step, into `stages.integrals`."""
    fill_weights(share, stages.weights)
    add_stages(stages.weights, h, state.integrals, stages.power, stages.integrals)


@kernel(inner=True)
def dense_depth(joint, markers, state, stages, h, share):
    """Penetration [m] of a joint at `share` of the step."""
    dense_state(state, stages, h, share)
    ex, ey = relative(joint, markers, stages.scratch_q)
    return math.sqrt(ex * ex + ey * ey) - joint.clearance


INTERPOLANT = Interpolant(complete_dense, dense_state, dense_integrals, dense_depth)
