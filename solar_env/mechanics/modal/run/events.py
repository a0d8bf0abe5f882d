"""Events inside a step: contact starts, latchings and stop engagements, on the cubic through the joint's motion."""

import math

import numpy as np

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.arrays.model import CLEARANCE, IMPULSE, INTEGRALS_PER_JOINT, SLIDING_WORK
from solar_env.mechanics.joints.contact.normal_force import impact_scales, normal_force
from solar_env.mechanics.joints.friction.friction_share import friction_share
from solar_env.mechanics.joints.torques import stop_depth
from solar_env.mechanics.modal.arrays import (
    DEPTH,
    DEPTH_RATE,
    NORMAL_X,
    NORMAL_Y,
    RIGID_BODY,
    SECOND,
    SLIDING_SPEED,
    START,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.panel.tables import AXIAL_EVEN, GROUPS
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.records.history import latch

NONE, CONTACT_START, LATCHING, STOP_ENGAGEMENT = (np.int64(kind) for kind in range(4))
_SAMPLES = 4


@kernel(inlined=True)
def cubic(share, x0, r0, x1, r1):
    """Value at a share of the step of the cubic through values and rates (times the step) at both ends."""
    rest = 1.0 - share
    return rest * rest * ((1.0 + 2.0 * share) * x0 + share * r0) + share * share * (
        (3.0 - 2.0 * share) * x1 - rest * r1
    )


@kernel(inlined=True)
def event_function(model, state, work, j, kind, h, share):
    """Depth [m] of joint `j`, or its angle past the lock or in a stop [rad], which rises through zero at an event."""
    joint, start, end = model.joints[j], work.joints[j].motion[START], work.joints[j].motion[SECOND]
    if kind == CONTACT_START:
        ex = cubic(share, start[ECCENTRICITY_X], h * start[VELOCITY_X], end[ECCENTRICITY_X], h * end[VELOCITY_X])
        ey = cubic(share, start[ECCENTRICITY_Y], h * start[VELOCITY_Y], end[ECCENTRICITY_Y], h * end[VELOCITY_Y])
        return math.sqrt(ex * ex + ey * ey) - joint.clearance
    angle = cubic(share, start[ANGLE], h * start[RATE], end[ANGLE], h * end[RATE])
    if kind == LATCHING:
        return angle - joint.lock_angle
    depth, _ = stop_depth(joint, state.joints[j].latched, angle)
    return depth


@kernel(inner=True)
def first_rise(model, state, work, j, kind, h):
    """Share of the step at which the event function first rises through zero; 2 if it does not. Illinois iteration."""
    low, f_low = 0.0, event_function(model, state, work, j, kind, h, 0.0)
    if f_low >= 0.0:
        return 0.0
    for k in range(1, _SAMPLES + 1):
        high = k / _SAMPLES
        f_high = event_function(model, state, work, j, kind, h, high)
        if f_high > 0.0:
            for _ in range(60):
                if high - low < 1e-12:
                    break
                middle = high - f_high * (high - low) / (f_high - f_low)
                if not low < middle < high:
                    middle = 0.5 * (low + high)
                f = event_function(model, state, work, j, kind, h, middle)
                if f >= 0.0:
                    high, f_high = middle, f
                    f_low *= 0.5
                else:
                    low, f_low = middle, f
                    f_high *= 0.5
                if abs(f) < 1e-15:
                    return middle
            return high
        low, f_low = high, f_high
    return 2.0


@kernel(inlined=True)
def first_event(model, state, work, h):
    """Earliest contact start, latching or stop engagement inside the step: (share, joint, kind)."""
    share, which, what = 1.0, np.int64(-1), NONE
    for j in range(model.joints.size):
        joint, own, number, end = model.joints[j], state.joints[j], np.int64(j), work.joints[j].motion[SECOND]
        if joint.kind == CLEARANCE and not own.in_contact:
            start = work.joints[j].motion[START]
            # Pressed from the start of the run, on the very wall and on the way in, or inside the step.
            if start[DEPTH] != 0.0 or start[DEPTH_RATE] > 0.0 or end[DEPTH] > start[DEPTH]:
                root = first_rise(model, state, work, j, CONTACT_START, h)
                if root < share or (root == share and what == NONE):
                    share, which, what = root, number, CONTACT_START
        if joint.has_latch and not own.latched and end[ANGLE] >= joint.lock_angle:
            root = first_rise(model, state, work, j, LATCHING, h)
            if root < share or (root <= share and what == NONE):
                share, which, what = root, number, LATCHING
        if not own.stop_engaged:
            depth, _ = stop_depth(joint, own.latched, end[ANGLE])
            if depth > 0.0:
                root = first_rise(model, state, work, j, STOP_ENGAGEMENT, h)
                if root < share or (root <= share and what == NONE):
                    share, which, what = root, number, STOP_ENGAGEMENT
    return share, which, what


@kernel(inlined=True)
def instantaneous_inverse_mass(model, work, j):
    """Inverse mass [1/kg] that joint `j` feels along its line of centres before the bodies deform."""
    motion, joint = work.joints[j].motion[START], model.joints[j]
    nx, ny, total = motion[NORMAL_X], motion[NORMAL_Y], 0.0
    for side in range(2):
        number = joint.outboard if side == 0 else joint.inboard
        attachment = model.attachments[number]
        b = attachment.body
        body = model.bodies[b]
        lever = work.attachments[number].arm[START, 0] * ny - work.attachments[number].arm[START, 1] * nx
        total += body.inverse_mass + lever * lever * body.inverse_inertia
        if body.panel != RIGID_BODY:
            c, s = work.bodies[b].turn[START, 0], work.bodies[b].turn[START, 1]
            along, across = c * nx + s * ny, c * ny - s * nx
            for group in range(GROUPS):
                share = across if group < AXIAL_EVEN else along
                for k in range(model.panels.first[group], model.panels.first[group + 1]):
                    total += (model.panels.modes[body.design, k].row[0] * share) ** 2
    return total


@kernel(inner=True)
def begin_event(model, state, work, j, kind):
    """Latch joint `j`, engage its stop, or start its contact, at the accepted state."""
    joint, own, time = model.joints[j], state.joints[j], state.clock[0].time
    if kind == LATCHING:
        latch(state, j, time)
        return
    if kind == STOP_ENGAGEMENT:
        own.stop_engaged = 1
        return
    own.in_contact = 1
    own.impact_speed = max(work.joints[j].motion[START, DEPTH_RATE], joint.minimum_impact_speed)
    own.contact_start = time
    own.contact_peak = 0.0
    own.contact_impulse = state.integrals[INTEGRALS_PER_JOINT * j + IMPULSE]
    own.contact_sliding_work = state.integrals[INTEGRALS_PER_JOINT * j + SLIDING_WORK]
    own.contact_starts += 1
    inverse_mass = instantaneous_inverse_mass(model, work, j)
    _, own.contact_duration = impact_scales(joint, inverse_mass, own.impact_speed)
    # Of note where a run starts with a journal that is pressed into its bearing.
    motion = work.joints[j].motion[START]
    normal, _, _, _ = normal_force(joint, motion[DEPTH], motion[DEPTH_RATE], own.impact_speed)
    share, _ = friction_share(joint, motion[SLIDING_SPEED])
    state.loads[j, 0], state.loads[j, 1] = normal, -joint.friction_coefficient * share * normal
    state.load_rates[j, 0] = state.load_rates[j, 1] = 0.0
