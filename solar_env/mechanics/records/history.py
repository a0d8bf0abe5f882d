"""Contacts, latches, wear and peak forces of a mechanism, updated on accepted steps only."""

import math

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.joints.torques.stop import stop_depth, stop_energy, stop_torque
from solar_env.mechanics.joints.wear import add_wear, pressed_half_angle
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.records.recording import record_contact

IMPACT_DURATIONS = 2.0  # number of predicted durations for which a contact counts as an impact, with shorter steps


@kernel
def end_contact(state, j, time, recorder):
    """End joint `j`'s contact at `time` [s]; add its times, speed, peak force, impulse, work to `recorder.contacts`."""
    joint_state = state.joints[j]
    record_contact(recorder, j, joint_state, state.integrals, time)
    joint_state.in_contact = 0
    joint_state.impact_speed = 0.0


@kernel
def note_force(joint_state, force, postlock):
    """Update the force maxima in `joint_state` by a `force` [N]; the post-lock maximum only if `postlock` is true."""
    joint_state.contact_peak = max(joint_state.contact_peak, force)
    joint_state.peak_force = max(joint_state.peak_force, force)
    joint_state.recent_peak_force = max(joint_state.recent_peak_force, force)
    if postlock:
        joint_state.postlock_peak_force = max(joint_state.postlock_peak_force, force)


@kernel(inlined=False)
def latch(joints, state, j, time):
    """Latch joint `j` for good at a `time` [s], and set the release times of joints that wait for this latching.

    The first latching starts the post-lock record of every joint.
    """
    for k in range(joints.size):
        if joints[k].released_by == j:
            state.joints[k].release_time = time + joints[k].release_time
    state.joints[j].latched = 1
    state.joints[j].latch_time, state.joints[j].latch_rate = time, math.nan
    if state.clock[0].latched_joints == 0:
        for k in range(state.joints.size):
            state.joints[k].lock_impulse = state.integrals[m.INTEGRALS_PER_JOINT * k + m.IMPULSE]
            state.joints[k].lock_sliding_work = state.integrals[m.INTEGRALS_PER_JOINT * k + m.SLIDING_WORK]
            state.joints[k].lock_peak_force = state.joints[k].peak_force
    state.clock[0].latched_joints += 1


@kernel
def wear_contact(joint, state, j, journal, bearing, depth, sliding_work):
    """Add the wear of joint `j` by the sliding work [J] of an accepted step to `state.wear_journal` and `wear_bearing`.

    The line of centres moved along the arcs `journal` and `bearing` (middle, half angle) [rad] in the bodies' frames.
    The penetration `depth` [m] sets the width of the contact, over which the wear is spread.
    """
    half = pressed_half_angle(max(depth, 0.0), joint.clearance)
    worn_section = joint.wear_coefficient * sliding_work / joint.bearing_width
    radius = joint.journal_radius
    add_wear(state.wear_journal[j], journal[0], half, journal[1], worn_section, radius)
    add_wear(state.wear_bearing[j], bearing[0], half, bearing[1], worn_section, radius + joint.clearance)


@kernel
def note_latch_torque(joint, joint_state, angle, rate):
    """Update a latched joint's peak latch torque; the first call after the latching also stores its `rate` [rad/s]."""
    if joint_state.latched:
        if math.isnan(joint_state.latch_rate):
            joint_state.latch_rate = rate
        torque, _, _, _ = stop_torque(joint, joint_state, angle, rate)
        joint_state.peak_latch_torque = max(joint_state.peak_latch_torque, abs(torque))


@kernel
def release_stop(joint, joint_state, angle, rate):
    """Disengage a joint's stop once the joint has moved off the stop's face."""
    if joint_state.held or (joint_state.latched and joint.stop_gap == 0.0 and not joint.one_sided):
        return  # the stop's two faces coincide, and the joint stays on them
    depth, sign = stop_depth(joint, joint_state, angle)
    # Exactly on its face a stop stays engaged unless it opens; otherwise the same engagement would be found for ever.
    joint_state.stop_engaged = depth > 0.0 or (depth > -1e-9 and sign * rate <= 0.0)


@kernel
def next_release(state, end):
    """Return the time [s] at which the next hold-down releases its joint, or `end` if that is earlier."""
    for j in range(state.joints.size):
        if state.joints[j].held:
            end = min(end, state.joints[j].release_time)
    return end


@kernel(inlined=False)
def release_joints(model, state, motion):
    """Release held joints whose release time has come, and return whether any was released.

    The elastic energy of their hold-downs, at the joint angles `motion[j].angle` [rad], is booked as lost.
    """
    released = False
    for j in range(state.joints.size):
        joint_state = state.joints[j]
        if joint_state.held and joint_state.release_time <= state.clock[0].time:
            stored = stop_energy(model.joints[j], joint_state, motion[j].angle)
            state.integrals[m.INTEGRALS_PER_JOINT * j + m.LATCH_DISSIPATION] += stored
            joint_state.held, joint_state.stop_engaged, state.clock[0].acceleration_current = 0, 0, 0
            released = True
    return released


@kernel
def has_parted(joint_state, time, depth, rate):
    """Return whether a contact begun before `time` [s] has ended: penetration `depth` [m] <= 0, `rate` [m/s] < 0."""
    # A contact that has begun just now, exactly on the wall, may not end at once: time would stand still.
    return depth <= 0.0 and rate < 0.0 and joint_state.contact_start < time


@kernel
def parting_time(start, end, start_depth, depth):
    """Return the time [s] at which surfaces parted in the step from `start` to `end` [s], by linear interpolation."""
    share = start_depth / (start_depth - depth) if start_depth > 0.0 else 1.0
    return start + share * (end - start)


@kernel
def step_limit(state, settings):
    """Return the greatest step [s] that the error of the last step, the settings and present impacts allow."""
    joint_states, time = state.joints, state.clock[0].time
    limit = min(state.clock[0].step_size, settings.max_step)
    for j in range(joint_states.size):
        joint_state = joint_states[j]
        if (
            joint_state.in_contact
            and time - joint_state.contact_start < IMPACT_DURATIONS * joint_state.contact_duration
        ):
            limit = min(limit, joint_state.contact_duration / settings.impact_resolution)
    return limit


@kernel
def fail(state, status, joint, value):
    """Record in `state.clock` a joint and a value, such as its angle, for the error's message; return the `status`."""
    state.clock[0].failure_joint = joint
    state.clock[0].failure_value = value
    return status


@kernel
def check_joint(joint, state, j, depth, angle):
    """Check that contact depth [m] and angle [rad] of joint `j` are in their ranges; return DONE or an error status."""
    if joint.kind == m.CLEARANCE and state.joints[j].in_contact and depth > joint.journal_radius:
        return fail(state, m.CONTACT_TOO_DEEP, j, depth)
    if joint.angle_limited and abs(angle - joint.middle) > 0.95 * math.pi:
        # The angle nears the branch cut of the arctangent that measures it.
        return fail(state, m.JOINT_ANGLE_RANGE, j, angle)
    return m.DONE
