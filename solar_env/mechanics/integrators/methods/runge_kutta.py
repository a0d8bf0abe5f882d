"""Explicit Runge-Kutta method of order four: stages and error estimate of a step.

Kutta's 3/8 rule of order four with an error estimate of order three that uses the first-same-as-last stage (E. Hairer,
S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, 1993, sections II.1 and II.4,
doi:10.1007/978-3-540-78862-1). In lasting contact the bearing's stiffness bounds the step. Of the common methods, the
methods with four stages and order four then cover the most time per evaluation: their stability interval on the
imaginary axis, 2 sqrt(2), is nearly as long as four stages allow. Lasting contacts between rigid bodies, and the
dampers of stops on beams, are treated linearly implicitly (`stiff_forces.py`).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import TORQUES
from solar_env.mechanics.arrays.model import State
from solar_env.mechanics.equations.system import inlined_accelerations
from solar_env.mechanics.integrators.methods.stiff_forces import begin_step, correct_stage, may_be_stiff, product
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into, greater

STAGES = 5
_NODES = (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0, 1.0)
# Row s has the weights of the stages before s; the last row gives the step's end, which is the next step's first stage.
_COUPLING = (
    (0.0, 0.0, 0.0, 0.0),
    (1.0 / 3.0, 0.0, 0.0, 0.0),
    (-1.0 / 3.0, 1.0, 0.0, 0.0),
    (1.0, -1.0, 1.0, 0.0),
    (0.125, 0.375, 0.375, 0.125),
)
# Weights of the error estimate: the only combination of the five stages, up to a factor, that vanishes to third order.
# The estimate includes the error of integrals, unlike estimates from the last two stages alone.
_ERROR = tuple(weight / 40.0 for weight in (-1.0, 3.0, -3.0, -3.0, 4.0))

# Fraction of a lasting contact's depth by which a step may err. The depth is some nanometres: with a position tolerance
# alone, a step could cause a hundred times the contact's force.
_DEPTH_ERROR = 0.01

# Integrals that enter the energy balance, and therefore the error norm.
BOOKED_ENERGIES = (m.NORMAL_DISSIPATION, m.FRICTION_DISSIPATION, *(law.integral for law in TORQUES if law.book))


class StiffForces(NamedTuple):
    """Stiff forces of the current step (`stiff_forces.py`); the first `active[0]` entries of each array are in use."""

    joint: NDArray[np.int64]  # (joints,) indices
    stiffness: NDArray[np.float64]  # (joints,) along the gradient; 0 for a stop, whose damping alone is stiff
    damping: NDArray[np.float64]  # (joints,)
    shares: NDArray[np.float64]  # (joints, 2) fractions of stop and of damper in the damping; friction has the rest
    resistance: NDArray[np.float64]  # (joints,) damping plus the stiffness's contribution in a stage
    gradient: NDArray[np.float64]  # (joints, n) of angle or depth
    response: NDArray[np.float64]  # (joints, n) accelerations by a unit force
    motion: NDArray[np.float64]  # (joints, n) motions by 1 along one gradient and by 0 along the others
    coupling: NDArray[np.float64]  # (joints, joints) accelerations along the gradients by a unit force
    matrix: NDArray[np.float64]  # (joints, joints) of the stage equations, factored
    force_rate: NDArray[np.float64]  # (stages, joints) force's rate of change by stage
    closing: NDArray[np.float64]  # (stages, joints) acceleration along the gradient by stage
    past: NDArray[np.float64]  # (joints,)
    rest: NDArray[np.float64]  # (n,) rate of change of the accelerations that the stiff forces leave out
    probe_q: NDArray[np.float64]  # (n,)
    probe_v: NDArray[np.float64]  # (n,)
    start: NDArray[np.float64]  # (n,) accelerations at the step's start
    end: NDArray[np.float64]  # (n,) and at its end
    start_power: NDArray[np.float64]  # (integrals,) powers at the step's start
    end_power: NDArray[np.float64]  # (integrals,) and at its end
    active: NDArray[np.int64]  # (1,) number of entries in use


def make_stiff_forces(state: State) -> StiffForces:
    """Return zeroed `StiffForces` for at most one stiff force per joint: of a lasting contact or a hinge's damping."""
    n, k, joints = state.q.size, state.integrals.size, state.joints.size
    return StiffForces(
        joint=np.zeros(joints, dtype=np.int64),
        stiffness=np.zeros(joints),
        damping=np.zeros(joints),
        shares=np.zeros((joints, 2)),
        resistance=np.zeros(joints),
        gradient=np.zeros((joints, n)),
        response=np.zeros((joints, n)),
        motion=np.zeros((joints, n)),
        coupling=np.zeros((joints, joints)),
        matrix=np.zeros((joints, joints)),
        force_rate=np.zeros((STAGES, joints)),
        closing=np.zeros((STAGES, joints)),
        past=np.zeros(joints),
        rest=np.zeros(n),
        probe_q=np.zeros(n),
        probe_v=np.zeros(n),
        start=np.zeros(n),
        end=np.zeros(n),
        start_power=np.zeros(k),
        end_power=np.zeros(k),
        active=np.zeros(1, dtype=np.int64),
    )


@kernel
def restore_ends(v0, stages, stiff):
    """Restore the values in `stages` that corrections for stiff forces have changed at the start and end of a step.

    Start velocities are copied from `v0` (n,). Accelerations and powers at both ends are copied from `stiff`, where
    they were saved before the corrections. The number of stiff forces, `stiff.active[0]`, is set to 0.
    """
    velocity, acceleration, power = stages.velocity, stages.acceleration, stages.power
    copy_into(velocity[0], v0)
    copy_into(acceleration[0], stiff.start)
    copy_into(acceleration[-1], stiff.end)
    copy_into(power[0], stiff.start_power)
    copy_into(power[-1], stiff.end_power)
    stiff.active[0] = 0


@kernel
def take_stages(model, state, arrays, h):
    """Write a step's stages, end (q, v), work, losses, impulses to `arrays.stages`; False for singular constraints."""
    work, stages, stiff = arrays.work, arrays.stages, arrays.stiff
    q0, v0, joint_states, multipliers = state.q, state.v, state.joints, state.multipliers
    q, v, velocity, acceleration = stages.q, stages.v, stages.velocity, stages.acceleration
    power, stage_power, gain = work.power, stages.power, stages.gain
    n = q.size
    time = state.clock[0].time
    if stiff.active[0] > 0:
        restore_ends(v0, stages, stiff)
    if may_be_stiff(model, state):
        stiff.active[0] = begin_step(model, state, work, stiff, acceleration[0], h)
    if stiff.active[0] > 0:
        copy_into(stiff.start, acceleration[0])
        copy_into(stiff.start_power, stage_power[0])
    arrays.trial[0].stiff_contacts = 0 if model.flexible else stiff.active[0]
    for s in range(STAGES):
        c0, c1, c2, c3 = _COUPLING[s]
        if s > 0:
            for i in range(n):
                q[i] = q0[i] + h * (
                    c0 * velocity[0, i] + c1 * velocity[1, i] + c2 * velocity[2, i] + c3 * velocity[3, i]
                )
                v[i] = v0[i] + h * (
                    c0 * acceleration[0, i]
                    + c1 * acceleration[1, i]
                    + c2 * acceleration[2, i]
                    + c3 * acceleration[3, i]
                )
            copy_into(velocity[s], v)
            if not inlined_accelerations(
                model, joint_states, q, v, time + _NODES[s] * h, work, acceleration[s], multipliers
            ):
                return False
            copy_into(stage_power[s], power)
        if stiff.active[0] > 0 and s < STAGES - 1:
            correct_stage(stiff, s, h, velocity, acceleration, stage_power)
    for k in range(gain.size):
        gain[k] = h * (
            c0 * stage_power[0, k] + c1 * stage_power[1, k] + c2 * stage_power[2, k] + c3 * stage_power[3, k]
        )
    state.clock[0].evaluations += STAGES - 1
    return True


@kernel
def contact_error(model, arrays, stiff, h):
    """Return the greatest error of a lasting contact's depth in a step `h` [s], divided by its tolerance.

    `stiff` lists the contacts: their impacts are over, and they are treated linearly implicitly. The error is estimated
    from the stage velocities in `arrays`; the tolerance is 1 % of the greater depth at the step's two ends.
    """
    worst, stages = 0.0, arrays.stages
    for c in range(stiff.active[0]):
        if stiff.stiffness[c] > 0.0:
            j, rate = stiff.joint[c], 0.0
            for s in range(STAGES):
                rate += _ERROR[s] * product(stiff.gradient[c], stages.velocity[s])
            depth, _ = penetration(model.joints[j], model.markers, stages.q, stages.v)
            worst = greater(worst, h * abs(rate) / (_DEPTH_ERROR * max(depth, arrays.motion[j].depth)))
    return worst


@kernel
def error_norm(model, state, arrays, rtol, velocity_scale, h):
    """Return the greatest component of an explicit step's error estimate (`arrays.stages`), divided by its tolerance.

    The tolerance is `rtol` times length scale for q, `velocity_scale` [m/s] + speed for v, initial energy for energies.
    """
    stages, stiff = arrays.stages, arrays.stiff
    v0, v, velocity, acceleration, power = state.v, stages.v, stages.velocity, stages.acceleration, stages.power
    e0, e1, e2, e3, e4 = _ERROR
    if stiff.active[0] > 0:
        copy_into(stiff.end, acceleration[-1])
        copy_into(stiff.end_power, power[-1])
        correct_stage(stiff, STAGES - 1, h, velocity, acceleration, power)
    weights, ratios = model.error_weight, stages.ratios
    position_scale = 1.0 / (rtol * model.length_scale)
    # Without branches, several entries fit into one instruction.
    for i in range(v.size):
        dq = e0 * velocity[0, i] + e1 * velocity[1, i] + e2 * velocity[2, i] + e3 * velocity[3, i] + e4 * velocity[4, i]
        dv = (
            e0 * acceleration[0, i]
            + e1 * acceleration[1, i]
            + e2 * acceleration[2, i]
            + e3 * acceleration[3, i]
            + e4 * acceleration[4, i]
        )
        scale = rtol * (velocity_scale + weights[i] * max(abs(v0[i]), abs(v[i])))
        ratios[i] = h * weights[i] * max(abs(dq) * position_scale, abs(dv) / scale)
    worst = 0.0
    # Not `greatest`: with its branch the whole step of a rigid mechanism takes a sixth longer.
    for i in range(v.size):
        worst = greater(worst, ratios[i])
    energy_tolerance = rtol * state.clock[0].energy_scale
    joint_integrals = power.shape[1] - m.GLOBAL_INTEGRALS
    for j in range(0, joint_integrals, m.INTEGRALS_PER_JOINT):
        for k in BOOKED_ENERGIES:
            i = j + k
            de = e0 * power[0, i] + e1 * power[1, i] + e2 * power[2, i] + e3 * power[3, i] + e4 * power[4, i]
            worst = greater(worst, abs(h * de) / energy_tolerance)
    for i in range(joint_integrals, power.shape[1]):
        de = e0 * power[0, i] + e1 * power[1, i] + e2 * power[2, i] + e3 * power[3, i] + e4 * power[4, i]
        worst = greater(worst, abs(h * de) / energy_tolerance)
    if stiff.active[0] > 0:
        worst = greater(worst, contact_error(model, arrays, stiff, h))
        restore_ends(v0, stages, stiff)
    return worst
