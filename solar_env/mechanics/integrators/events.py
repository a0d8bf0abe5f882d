"""Events inside a step: contact starts, latchings and stop engagements, located on the step's interpolated motion."""

import numpy as np

from solar_env.mechanics.arrays.model import CLEARANCE, IMPULSE, INTEGRALS_PER_JOINT, SLIDING_WORK
from solar_env.mechanics.integrators.methods.table import (
    BY_SOLVING_AGAIN,
    angle_of,
    depth_of,
    landing_of,
    open_contact_of,
)
from solar_env.mechanics.joints.contact import impact_scales
from solar_env.mechanics.joints.torques.stop import stop_depth
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.records.history import latch

# Typed integers: for literals Numba would compile functions with such an argument anew for each value.
NO_EVENT, CONTACT_START, LATCHING, STOP_ENGAGEMENT = (np.int64(kind) for kind in range(4))
# Number of samples of an event function per step: a curved path can touch a wall between the step's ends.
_LOOKS = 4
SMALLEST_PART = 1e-13  # s, least time from a step's start to an event: in less time the motion does not change
# Fraction of a clearance, or angle [rad], by which the end of a shortened step may miss its event.
_TOLERANCE = 1e-6
_MOST_CUTS = 20


@kernel
def event_function(model, state, settings, arrays, j, kind, h, share):
    """Return, at fraction `share` of a step `h` [s], the value whose rise through zero is event `kind` of joint `j`.

    It is the penetration [m], or the angle [rad] past the lock angle or into a stop. `arrays` hold the step's motion.
    """
    if kind == CONTACT_START:
        return depth_of(settings)(model, state, arrays, j, h, share)
    angle = angle_of(settings)(model, state, arrays, j, h, share)
    if kind == LATCHING:
        return angle - model.joints[j].lock_angle
    depth, _ = stop_depth(model.joints[j], state.joints[j], angle)
    return depth


@kernel
def locate(model, state, settings, arrays, j, kind, h, low, f_low, high, f_high):
    """Return the fraction of a step `h` [s] just after contact start, latching or stop (`kind`) of joint `j`.

    Illinois iteration finds the root of `event_function`, which is `f_low` and `f_high` at the fractions `low`, `high`.
    """
    for _ in range(60):
        if high - low < 1e-12 or f_high == 0.0:
            break
        middle = high - f_high * (high - low) / (f_high - f_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        f = event_function(model, state, settings, arrays, j, kind, h, middle)
        if f >= 0.0:
            # The value at the end that stays is halved, which keeps the iteration superlinear.
            high, f_high = middle, f
            f_low *= 0.5
        else:
            low, f_low = middle, f
            f_high *= 0.5
        if abs(f) < 1e-18:
            return middle
    return high


@kernel
def first_rise(model, state, settings, arrays, j, kind, h):
    """Return the step fraction of joint `j`'s first event `kind` (contact start, latching or stop); 2 without event."""
    low, f_low = 0.0, event_function(model, state, settings, arrays, j, kind, h, 0.0)
    for k in range(1, _LOOKS + 1):
        high = k / _LOOKS
        f_high = event_function(model, state, settings, arrays, j, kind, h, high)
        if f_high > 0.0 or (f_high == 0.0 and kind == LATCHING):
            if f_low >= 0.0:
                return low
            return locate(model, state, settings, arrays, j, kind, h, low, f_low, high, f_high)
        low, f_low = high, f_high
    return 2.0


@kernel
def first_event(model, state, settings, arrays, h):
    """Return (step fraction, joint, kind) of a step's first event, or (1, -1, NO_EVENT); `arrays` hold the motion."""
    share, which, what = 1.0, np.int64(-1), NO_EVENT
    for j in range(model.joints.size):
        joint, joint_state, number = model.joints[j], state.joints[j], np.int64(j)
        if joint.kind == CLEARANCE and not joint_state.in_contact:
            # Not in the loop below: with a constant kind, the compiler omits the interpolation of angles.
            root = first_rise(model, state, settings, arrays, j, CONTACT_START, h)
            if root < share or (root == share and what == NO_EVENT):
                share, which, what = root, number, CONTACT_START
        angle = angle_of(settings)(model, state, arrays, j, h, 1.0)
        depth, _ = stop_depth(joint, joint_state, angle)
        latches = joint.has_latch and not joint_state.latched and angle >= joint.lock_angle
        for kind in (LATCHING, STOP_ENGAGEMENT):
            if latches if kind == LATCHING else depth > 0.0 and not joint_state.stop_engaged:
                root = first_rise(model, state, settings, arrays, j, kind, h)
                if root < share or (root == share and what == NO_EVENT):
                    share, which, what = root, number, kind
    return share, which, what


@kernel
def is_passed(model, state, settings, arrays, j, kind, h, sign):
    """Return whether a step `h` [s] ends beyond (`sign` 1) or before (-1) the contact, latching or stop of joint `j`.

    `kind` selects the event; `arrays` hold the motion. An end within 1e-6 rad, or a millionth of the clearance, of the
    event is neither beyond nor before it.
    """
    tolerance = _TOLERANCE * (model.joints[j].clearance if kind == CONTACT_START else 1.0)
    return sign * event_function(model, state, settings, arrays, j, kind, h, 1.0) > tolerance


@kernel
def place_of_event(model, state, settings, arrays, h, joint, kind):
    """Return where a solved step `h` [s] must end: (fraction of the step, joint, event kind, whether to solve again).

    Joint and kind name the event at which the step ends; without an event, the fraction is 1 and the kind NO_EVENT. If
    the last member is True, the caller must solve a step of the size fraction * h, and call again, because the shorter
    step's motion differs slightly; the arguments `joint` and `kind` are then this event. In the first call they are
    unused. `arrays` hold the step's motion. Fraction * h is at most SMALLEST_PART [s] for an event at the step's start.
    """
    cuts = arrays.trial[0].cuts
    share, other, found = first_event(model, state, settings, arrays, h)
    again = landing_of(settings) == BY_SOLVING_AGAIN and found != NO_EVENT and SMALLEST_PART / h < share < 1.0
    if cuts == 0:
        return share, other, found, again
    missed = is_passed(model, state, settings, arrays, joint, kind, h, -1.0)
    beyond = is_passed(model, state, settings, arrays, joint, kind, h, 1.0)
    if found == NO_EVENT:
        return 1.0, joint, NO_EVENT if missed else kind, False
    if not is_passed(model, state, settings, arrays, other, found, h, 1.0):
        return (1.0, other, found, False) if missed or beyond else (1.0, joint, kind, False)
    return (share, other, found, again) if cuts < _MOST_CUTS or not again else (1.0, other, found, False)


@kernel(inlined=False)
def begin_event(model, state, settings, arrays, j, kind, time, speed):
    """Begin a contact, a latching or the engagement of a stop (`kind`) of joint `j` at `time` [s], in `state`.

    A contact stores its approach speed `speed` [m/s] and its duration, estimated from the mass that `arrays` give.
    """
    joint, joint_state = model.joints[j], state.joints[j]
    if kind == LATCHING:
        latch(model.joints, state, j, time)
    elif kind == STOP_ENGAGEMENT:
        joint_state.stop_engaged = 1
    else:
        joint_state.in_contact = 1
        joint_state.impact_speed = max(speed, joint.minimum_impact_speed)
        joint_state.contact_start = time
        joint_state.contact_peak = 0.0
        joint_state.contact_impulse = state.integrals[INTEGRALS_PER_JOINT * j + IMPULSE]
        joint_state.contact_sliding_work = state.integrals[INTEGRALS_PER_JOINT * j + SLIDING_WORK]
        joint_state.contact_starts += 1
        inverse_mass = open_contact_of(settings)(model, state, arrays, j)
        _, joint_state.contact_duration = impact_scales(joint, inverse_mass, joint_state.impact_speed)


@kernel
def begin_passed_events(model, state, settings, arrays, start, h):
    """Start contacts and latch joints that an accepted step `h` from `start` [s] reached, at interpolated times."""
    for j in range(model.joints.size):
        joint, motion = model.joints[j], arrays.motion[j]
        if joint.kind == CLEARANCE and not state.joints[j].in_contact and motion.depth > 0.0:
            before = motion.start_depth
            share = before / (before - motion.depth) if before < 0.0 else 0.0
            begin_event(model, state, settings, arrays, j, CONTACT_START, start + share * h, motion.start_depth_rate)
        if joint.has_latch and not state.joints[j].latched and motion.angle >= joint.lock_angle:
            rise = motion.angle - motion.start_angle
            share = (joint.lock_angle - motion.start_angle) / rise if rise > 0.0 else 1.0
            begin_event(model, state, settings, arrays, j, LATCHING, start + share * h, 0.0)
