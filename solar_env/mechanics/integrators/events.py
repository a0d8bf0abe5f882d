"""Events inside a step of an adaptive method: contact starts, latchings and stop engagements.

Each is a root of the step's interpolant, found without further evaluations of the equations of motion.
"""

import numpy as np

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y
from solar_env.mechanics.arrays.model import CLEARANCE
from solar_env.mechanics.integrators.methods.table import depth_of, interpolate_of
from solar_env.mechanics.joints.joint import joint_motion, penetration, relative
from solar_env.mechanics.joints.torques import stop_depth
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.records.history import latch, start_contact

# Kinds of event inside a step.
# Typed: Numba would compile the functions that take a literal for each one anew.
NO_EVENT, CONTACT_START, LATCHING, STOP_ENGAGEMENT = (np.int64(kind) for kind in range(4))


@kernel(inner=True)
def event_function(model, state, settings, stages, j, kind, h, share):
    """Depth [m], or angle past the lock or into the stop [rad], that rises through zero at an event of joint `j`."""
    joint, markers = model.joints[j], model.markers
    if kind != CONTACT_START:
        interpolate_of(settings)(state, stages, h, share)
        angle, _, _, _ = joint_motion(joint, markers, stages.scratch_q, stages.scratch_v)
        if kind == LATCHING:
            return angle - joint.lock_angle
        depth, _ = stop_depth(joint, state.joints[j].latched, angle)
        return depth
    return depth_of(settings)(joint, markers, state, stages, h, share)


@kernel(inner=True)
def locate(model, state, settings, stages, j, kind, h, low, f_low, high, f_high):
    """Share of the step at which the event function rises through zero: Illinois iteration, ending on its far side."""
    for _ in range(60):
        if high - low < 1e-12 or f_high == 0.0:
            break
        middle = high - f_high * (high - low) / (f_high - f_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        f = event_function(model, state, settings, stages, j, kind, h, middle)
        if f >= 0.0:
            # The end that stays put has its value halved, which keeps the iteration superlinear.
            high, f_high = middle, f
            f_low *= 0.5
        else:
            low, f_low = middle, f
            f_high *= 0.5
        if abs(f) < 1e-18:
            high = middle
            break
    return high


@kernel(inner=True)
def locate_at_end(model, state, settings, stages, j, kind, h, f_high):
    """Share of the step at which an event function that is positive at its end has risen through zero."""
    f_low = event_function(model, state, settings, stages, j, kind, h, 0.0)
    if f_low >= 0.0:
        return 0.0
    return locate(model, state, settings, stages, j, kind, h, 0.0, f_low, 1.0, f_high)


@kernel(inner=True)
def first_touch(model, state, settings, stages, j, h, depth):
    """Share of the step at which the free journal of joint `j` meets its bearing; 2 if it does not.

    A curved path can graze the wall inside the step: the interpolant is looked at between the ends too.
    """
    low, f_low = 0.0, depth
    for k in range(1, 5):
        high = 0.25 * k
        f_high = event_function(model, state, settings, stages, j, CONTACT_START, h, high)
        if f_high > 0.0:
            if f_low >= 0.0:
                return low
            return locate(model, state, settings, stages, j, CONTACT_START, h, low, f_low, high, f_high)
        low, f_low = high, f_high
    return 2.0


@kernel(single_caller=True)
def first_event(model, state, settings, stages, work, h):
    """Earliest contact start, latching or stop engagement inside the step: (share, joint, kind)."""
    joints, joint_states, loads, depths = model.joints, state.joints, work.loads, stages.depth
    share, which, what = 1.0, np.int64(-1), NO_EVENT
    for j in range(joints.size):
        joint, own, number = joints[j], joint_states[j], np.int64(j)
        root, kind = 2.0, NO_EVENT
        if joint.kind == CLEARANCE and not own.in_contact:
            root, kind = first_touch(model, state, settings, stages, j, h, depths[j]), CONTACT_START
            if root < share or (root == share and what == NO_EVENT):
                share, which, what = root, number, kind
        angle = loads[j, ANGLE]
        if joint.has_latch and not own.latched and angle >= joint.lock_angle:
            root, kind = (
                locate_at_end(model, state, settings, stages, j, LATCHING, h, angle - joint.lock_angle),
                LATCHING,
            )
            if root < share or what == NO_EVENT:
                share, which, what = root, number, kind
        if not own.stop_engaged:
            depth, _ = stop_depth(joint, own.latched, angle)
            if depth > 0.0:
                root, kind = (
                    locate_at_end(model, state, settings, stages, j, STOP_ENGAGEMENT, h, depth),
                    STOP_ENGAGEMENT,
                )
                if root < share or what == NO_EVENT:
                    share, which, what = root, number, kind
    return share, which, what


@kernel(inner=True)
def begin_event(model, state, j, kind, scratch):
    """Latch joint `j`, engage its stop, or start its contact, at the accepted state."""
    time = state.clock[0].time
    if kind == LATCHING:
        latch(state, j, time)
        return
    if kind == STOP_ENGAGEMENT:
        state.joints[j].stop_engaged = 1
        return
    joint = model.joints[j]
    _, rate = penetration(joint, model.markers, state.q, state.v)
    scratch.loads[j, ECCENTRICITY_X], scratch.loads[j, ECCENTRICITY_Y] = relative(joint, model.markers, state.q)
    start_contact(model, state, j, state.q, state.v, time, rate, scratch)
