"""Generalized-alpha for the index-3 equations M a + Phi_q^T lambda = Q(q, v, t), Phi(q, t) = 0.

One step is in `alpha_step.py`, what the run loop asks for here. Fixed steps divide a call evenly and land on no events:
Newton's iteration meets contacts, latches and stops wherever they are. Adaptive steps follow the change of the
accelerations, and are shortened to end near a bearing wall when a contact begins that they would not resolve.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ECCENTRICITY_X, ECCENTRICITY_Y
from solar_env.mechanics.arrays.model import Model, State
from solar_env.mechanics.arrays.trial import joint_motion_type, trial_type
from solar_env.mechanics.equations.newton import fill_mass
from solar_env.mechanics.equations.system import (
    Workspace,
    applied_forces,
    make_workspace,
    normal_inverse_mass,
    store_constraint_loads,
)
from solar_env.mechanics.integrators.methods.alpha_step import (
    AlphaSettings,
    Iteration,
    make_iteration,
    restart,
    solve_step,
)
from solar_env.mechanics.integrators.methods.stage_steps import fill_rows, measure_depths, take_loads
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, alpha_coefficients
from solar_env.mechanics.joints.contact import impact_scales
from solar_env.mechanics.joints.joint import penetration, relative
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into, greater
from solar_env.mechanics.numerics.profile import clear
from solar_env.mechanics.numerics.step_size import UNSOLVED, StepController
from solar_env.mechanics.records.recording import record_sample

# A change of step costs a restart: a step is kept unless much is gained.
CONTROL = StepController(2.0, least_share=0.2, most_growth=2.0, least_growth=1.5)


class AlphaArrays(NamedTuple):
    """Scratch arrays of the method, of one thread; nothing in them outlives a lane's turn."""

    trial: NDArray[np.void]  # (1,) rows of `trial.trial_type`
    motion: NDArray[np.void]  # (joints,) rows of `trial.joint_motion_type`
    work: Workspace
    scratch: Workspace  # for evaluations that leave the other as it is
    iteration: Iteration


def make_alpha_arrays(model: Model, state: State) -> AlphaArrays:
    """Allocate the arrays for a mechanism."""
    work, motion = make_workspace(model, state), np.zeros(state.joints.size, joint_motion_type)
    return AlphaArrays(
        np.zeros(1, trial_type), motion, work, make_workspace(model, state), make_iteration(model, state, work)
    )


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
def prepare(model, state, arrays):
    """Contact modes and powers at the start of a step.

    A journal that flies freely gets its present approach speed as the impact speed, should the step end in contact.
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


@kernel(inner=True)
def engage_stops(model, state, arrays):
    """Engage all stops: Newton's iteration meets them wherever they are, and nothing is frozen in a step."""
    for j in range(model.joints.size):
        state.joints[j].stop_engaged = 1


@kernel(inner=True)
def begin_alpha(model, state, settings, arrays):
    """Fill what the arrays hold of a model and its present state."""
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
    if state.clock[0].step_size <= 0.0:
        state.clock[0].step_size = settings.step
        state.clock[0].last_error = 1.0
    return True


@kernel(inner=True)
def choose_alpha(model, state, settings, arrays, wanted, remaining):
    """Step to try [s]: the fixed one, divided so that a whole number of them ends the call, or the one `wanted`."""
    if settings.rtol == 0.0:
        return remaining / math.ceil(remaining / settings.step - 1e-9)
    # Two even steps rather than one followed by a sliver.
    return 0.5 * remaining if wanted < remaining < 2.0 * wanted else wanted


@kernel(single_caller=True)
def error_norm(state, it, settings, h):
    """Local error in units of the tolerance, from the change of the accelerations (Zienkiewicz and Xie 1991).

    O. C. Zienkiewicz and Y. M. Xie, Earthq. Eng. Struct. Dyn. 20 (1991) 871, doi:10.1002/eqe.4290200907.
    Multipliers are left out.
    """
    worst = 0.0
    factor = abs(settings.beta - 1.0 / 6.0) * h
    for i in range(state.q.size):
        estimate = factor * abs(it.auxiliary[i] - state.algorithmic_a[i])
        scale = settings.rtol * (settings.velocity_scale + max(abs(state.v[i]), abs(it.v[i])))
        worst = greater(worst, estimate / scale)
    return worst


@kernel(single_caller=True)
def landing_step(model, state, arrays, settings, h):
    """A step that ends near the wall if a contact begins inside this one and `h` does not resolve it, else `h`."""
    it, scratch, shorter = arrays.iteration, arrays.scratch, h
    for j in range(model.joints.size):
        joint, motion = model.joints[j], arrays.motion[j]
        if joint.kind != m.CLEARANCE or state.joints[j].in_contact:
            continue
        depth, _ = penetration(joint, model.markers, it.q, it.v)
        if depth <= 0.0:
            continue
        scratch.loads[j, ECCENTRICITY_X], scratch.loads[j, ECCENTRICITY_Y] = relative(joint, model.markers, it.q)
        speed = max(motion.depth_rate, joint.minimum_impact_speed)
        _, duration = impact_scales(joint, normal_inverse_mass(model, it.q, it.v, j, scratch), speed)
        wanted = max(min(-motion.depth / speed, 0.5 * h), duration / settings.impact_resolution)
        shorter = min(shorter, wanted)
    return shorter


@kernel(inner=True)
def attempt_alpha(model, state, settings, arrays, h):
    """Fill a step `h` [s]; its error in units of the tolerance, negative if constraints are singular."""
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
        fixed = settings.rtol == 0.0
        trial.retry = -1.0 if fixed else UNSOLVED * h
        if fixed and math.isfinite(convergence):
            trial.reason = m.NEWTON_FAILED
        return convergence
    if settings.rtol == 0.0:
        return 0.0
    shorter = landing_step(model, state, arrays, settings, h)
    if shorter < h:
        trial.retry = shorter
        return math.inf
    return error_norm(state, it, settings, h)


@kernel(inner=True)
def complete_alpha(model, state, settings, arrays, h):
    """Fill the loads of the constraints at the end of the step."""
    it = arrays.iteration
    store_constraint_loads(model, it.multipliers, state.clock[0].time + h, it.q, arrays.work)


@kernel(inner=True)
def sample_alpha(model, state, settings, arrays, recorder, h, share):
    """Store one row inside the solved step: cubic Hermite for positions, its derivative for velocities."""
    it, work, scratch = arrays.iteration, arrays.work, arrays.scratch
    for i in range(state.q.size):
        rise = it.q[i] - it.start_q[i]
        slope0, slope1 = h * it.start_v[i], h * it.v[i]
        c2 = 3.0 * rise - 2.0 * slope0 - slope1
        c3 = slope0 + slope1 - 2.0 * rise
        it.scratch_q[i] = it.start_q[i] + share * (slope0 + share * (c2 + share * c3))
        it.scratch_v[i] = (slope0 + share * (2.0 * c2 + 3.0 * share * c3)) / h if h > 0.0 else it.start_v[i]
    for k in range(state.integrals.size):
        # Trapezoid over the share: the power is taken as linear in the step.
        mean = it.power[k] + 0.5 * share * (work.power[k] - it.power[k])
        it.integrals[k] = state.integrals[k] + share * h * mean
    copy_into(scratch.impact_speeds, work.impact_speeds)
    q, v, a, time = it.scratch_q, it.scratch_v, it.scratch_a, state.clock[0].time + share * h
    integrals, multipliers, energies = it.integrals, it.scratch_multipliers, it.energies
    record_sample(recorder, model, state.joints, q, v, time, integrals, scratch, a, multipliers, energies)


@kernel(inner=True)
def commit_alpha(model, state, settings, arrays, h, share):
    """Take over the end of the step, with the integrals."""
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


@kernel(inner=True)
def evaluate_alpha(model, state, arrays, changed):
    """Fill what the joints' motion takes from the loads at the accepted state."""
    take_loads(arrays.work.loads, arrays.motion)
    return True


@kernel(inner=True)
def depth_at_start(model, state, arrays, j, h, share):
    """Penetration [m] of joint `j`, at the start of the step alone: events inside it are not looked for."""
    return arrays.motion[j].depth


@kernel(inner=True)
def angle_at_start(model, state, arrays, j, h, share):
    """Angle [rad] of joint `j`, likewise."""
    return arrays.motion[j].angle
