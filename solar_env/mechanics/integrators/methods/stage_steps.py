"""Run-loop kernels of Runge-Kutta and Rosenbrock: the motion inside a step, its acceptance, samples and force peaks.

Constraints are enforced on the acceleration level and by projection of every accepted step.
"""

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, NORMAL, RATE
from solar_env.mechanics.arrays.model import APPROXIMATE, CLEARANCE, EXACT
from solar_env.mechanics.bodies.markers import vector_angle
from solar_env.mechanics.equations.constraints import fill_columns, prepare_response, project
from solar_env.mechanics.equations.system import normal_inverse_mass
from solar_env.mechanics.integrators.methods.stages import (
    hermite_depth,
    hermite_integrals,
    hermite_state,
    interpolate_without_accelerations,
    refresh,
    set_impact_speeds,
)
from solar_env.mechanics.integrators.methods.stiff_forces import lasts
from solar_env.mechanics.joints.contact import normal_force
from solar_env.mechanics.joints.joint import joint_motion, penetration, relative
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.records.history import note_force
from solar_env.mechanics.records.recording import record_sample

_FIRST_STEP = 1e-6  # s
_PEAK_SAMPLES = 8


@kernel
def fill_rows(model, work):
    """Write constraint rows to `work.row_value`, and inverse mass matrix times ideal joints' rows to `work.columns`."""
    for r in range(work.row_value.shape[0]):
        copy_into(work.row_value[r], model.constraints.value[r])
    fill_columns(model, work, False)


@kernel
def measure_depths(model, state, motion):
    """Write clearance joints' penetrations [m] and their rates [m/s] at the accepted state to the records `motion`."""
    for j in range(model.joints.size):
        joint = model.joints[j]
        if joint.kind == CLEARANCE:
            motion[j].depth, motion[j].depth_rate = penetration(joint, model.markers, state.q, state.v)


@kernel
def take_loads(loads, motion):
    """Copy joint angles, rates and forces from the joint-load table (joints, LOAD_COLUMNS) to the records `motion`."""
    for j in range(motion.size):
        motion[j].angle, motion[j].rate, motion[j].force = loads[j, ANGLE], loads[j, RATE], loads[j, NORMAL]


@kernel(inlined=False)
def begin_stages(model, state, settings, arrays):
    """Prepare `arrays` and accelerations in `state` for `advance`; return False if the constraints are singular."""
    work, stages, clock = arrays.work, arrays.stages, state.clock[0]
    # Stages that are not computed yet enter with weight zero, but zero times NaN would be NaN.
    for array in (stages.velocity, stages.acceleration, stages.power):
        for s in range(array.shape[0]):
            for i in range(array.shape[1]):
                array[s, i] = 0.0
    fill_rows(model, work)
    fill_rows(model, arrays.scratch)
    arrays.trial[0].stiff_contacts = 0
    set_impact_speeds(state.joints, work.impact_speeds)
    if clock.acceleration_current in (EXACT, APPROXIMATE):
        copy_into(stages.acceleration[0], state.a)
        copy_into(stages.power[0], state.power)
    elif not refresh(model, state, stages, work):
        return False
    copy_into(stages.velocity[0], state.v)
    measure_depths(model, state, arrays.motion)
    copy_into(arrays.scratch.impact_speeds, work.impact_speeds)
    if clock.step_size <= 0.0:
        clock.step_size = _FIRST_STEP
        clock.last_error = 1.0
    return True


@kernel
def depth_in_stages(model, state, arrays, j, h, share):
    """Return joint `j`'s penetration [m] at a fraction `share` of a step `h` [s].

    It is interpolated between `state`, at the step's start, and the step's end in `arrays.stages`.
    """
    if share == 0.0:
        return arrays.motion[j].depth
    return hermite_depth(model.joints[j], model.markers, state, arrays.stages, h, share)


@kernel
def angle_in_stages(model, state, arrays, j, h, share):
    """Return joint `j`'s angle [rad] at a fraction `share` of a step `h` [s], interpolated between its ends."""
    if share == 1.0:
        return arrays.work.loads[j, ANGLE]
    hermite_state(state, arrays.stages, h, share)
    angle, _, _, _ = joint_motion(model.joints[j], model.markers, arrays.stages.scratch_q, arrays.stages.scratch_v)
    return angle


@kernel(inlined=False)
def sample_stages(model, state, settings, arrays, recorder, h, share):
    """Record a sample at the fraction `share` of the step `h` [s], on the step's interpolant."""
    stages, scratch = arrays.stages, arrays.scratch
    hermite_state(state, stages, h, share)
    if arrays.trial[0].stiff_contacts:
        interpolate_without_accelerations(state, stages, h, share)
    hermite_integrals(state, stages, h, share)
    copy_into(scratch.impact_speeds, arrays.work.impact_speeds)
    q, v, a, time = stages.scratch_q, stages.scratch_v, stages.scratch_a, state.clock[0].time + share * h
    integrals, multipliers, energies = stages.integrals, stages.multipliers, stages.energies
    record_sample(recorder, model, state.joints, q, v, time, integrals, scratch, a, multipliers, energies)


@kernel(inlined=False)
def refine_peak(model, state, stages, j, h, share):
    """Raise `state.joints[j]`'s force maxima to the contact force's peak in the first `share` * `h` [s] of a step."""
    joint, joint_state, markers = model.joints[j], state.joints[j], model.markers
    peak, before, here = 0.0, 0.0, 0.0
    for k in range(_PEAK_SAMPLES + 1):
        hermite_state(state, stages, h, share * k / _PEAK_SAMPLES)
        depth, rate = penetration(joint, markers, stages.scratch_q, stages.scratch_v)
        after, _, _, _ = normal_force(joint, depth, rate, joint_state.impact_speed)
        peak = max(peak, after)
        if k >= 2 and here >= before and here > after:
            peak = max(peak, here + (after - before) ** 2 / (8.0 * (2.0 * here - before - after)))
        before, here = here, after
    note_force(joint_state, peak, state.clock[0].latched_joints > 0)


@kernel
def refine_peaks(model, state, arrays, h, share):
    """Raise force maxima in `state.joints` to the force peaks in the accepted fraction `share` of a step `h` [s].

    A contact has a peak if its penetration has turned from growing to falling. Lasting contacts are left out in steps
    that are linearly implicit, or treat contacts implicitly: interpolation gives forces up to 1000 times too large.
    """
    coarse, stages = arrays.trial[0].implicit or arrays.trial[0].stiff_contacts, arrays.stages
    for j in range(model.joints.size):
        joint_state = state.joints[j]
        growing = joint_state.in_contact and arrays.motion[j].depth_rate > 0.0
        if growing and not (coarse and lasts(joint_state, state.clock[0].time)):
            _, rate = penetration(model.joints[j], model.markers, stages.q, stages.v)
            if rate <= 0.0:
                refine_peak(model, state, stages, j, h, share)


@kernel
def complete_nothing(model, state, settings, arrays, h):
    """Do nothing: the attempt has already computed all quantities at the end of the step."""


@kernel
def commit_stages(model, state, settings, arrays, h, share):
    """Move `state` to the fraction `share` of a step `h` [s], and project it; False if constraints are singular."""
    stages, integrals, end = arrays.stages, state.integrals, state.clock[0].time + share * h
    if share < 1.0:
        hermite_state(state, stages, h, share)
        hermite_integrals(state, stages, h, share)
        copy_into(state.q, stages.scratch_q)
        copy_into(state.v, stages.scratch_v)
        copy_into(integrals, stages.integrals)
    else:
        for k in range(integrals.size):
            integrals[k] += stages.gain[k]
        copy_into(state.q, stages.q)
        copy_into(state.v, stages.v)
    if (arrays.trial[0].implicit or share < 1.0) and not prepare_response(model, state.q, end, arrays.work):
        return False
    project(model, state.q, state.v, end, arrays.work)
    measure_depths(model, state, arrays.motion)
    return True


@kernel
def evaluate_stages(model, state, arrays, changed):
    """Copy this step's last stage to the next step's first stage, or evaluate it if an event has `changed` the forces.

    Return False if the constraints are singular.
    """
    stages, clock = arrays.stages, state.clock[0]
    if changed:
        if not refresh(model, state, stages, arrays.work):
            return False
    else:
        copy_into(stages.acceleration[0], stages.acceleration[-1])
        copy_into(stages.power[0], stages.power[-1])
        copy_into(state.a, stages.acceleration[0])
        copy_into(state.power, stages.power[0])
        clock.acceleration_current = APPROXIMATE if arrays.trial[0].implicit else EXACT
    take_loads(arrays.work.loads, arrays.motion)
    return True


@kernel
def resume_stages(model, state, arrays):
    """Copy `state`'s impact speeds to `arrays.work.impact_speeds`, and velocities to `arrays.stages.velocity[0]`."""
    set_impact_speeds(state.joints, arrays.work.impact_speeds)
    copy_into(arrays.stages.velocity[0], state.v)


@kernel
def open_contact(model, state, arrays, j):
    """Return the inverse effective mass [1/kg] of joint `j`'s new contact along its line of centres, at `state`."""
    scratch, joint = arrays.scratch, model.joints[j]
    scratch.loads[j, ECCENTRICITY_X], scratch.loads[j, ECCENTRICITY_Y] = relative(joint, model.markers, state.q)
    return normal_inverse_mass(model, state.q, state.v, j, scratch)


@kernel
def contact_arcs(model, state, arrays, j):
    """Return the arcs (middle, half-width) [rad] along which contact has moved on joint `j`'s journal and bearing.

    Here an arc is only the present point of contact: its middle is the point's angle relative to the body, and its
    half-width is 0. The line of centres is read from the work `arrays`.
    """
    joint, markers, loads = model.joints[j], model.markers, arrays.work.loads
    ex, ey = loads[j, ECCENTRICITY_X], loads[j, ECCENTRICITY_Y]
    journal = vector_angle(markers[joint.outboard], state.q, ex, ey)
    return (journal, 0.0), (vector_angle(markers[joint.inboard], state.q, ex, ey), 0.0)
