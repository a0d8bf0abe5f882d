"""From bodies to joints: where attachments are and how they move, and what a joint sees of it."""

import math

from solar_env.mechanics.arrays.model import CLEARANCE
from solar_env.mechanics.joints.sliding import contact_motion
from solar_env.mechanics.modal.arrays import (
    ANGLE,
    DEPTH,
    DEPTH_RATE,
    ECCENTRICITY_X,
    ECCENTRICITY_Y,
    INBOARD_SPIN,
    LEVER,
    NORMAL_X,
    NORMAL_Y,
    OUTBOARD_SPIN,
    RATE,
    RIGID_BODY,
    SLIDING_SPEED,
    SLIP,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.bodies import foreshorten
from solar_env.mechanics.modal.tables import FORMS
from solar_env.mechanics.numerics.jit import kernel


@kernel(inlined=True)
def move_attachments(model, work, slot):
    """Place the attachments at a slot, from the bodies' frames and the motion of the panels' ends there.

    The motion of the ends is that of the stage; other slots keep theirs where the first stage has its own.
    """
    stage = slot if slot < 2 else 0
    for number in range(model.attachments.size):
        attachment = model.attachments[number]
        b, end = attachment.body, attachment.end
        panel = model.bodies[b].panel
        x, y, turn = attachment.x, attachment.y, work.place[slot, b, 2]
        x_rate, y_rate, spin = 0.0, 0.0, work.speed[slot, b, 2]
        rigid_spin = spin
        if panel != RIGID_BODY:
            bending, axial, c = work.bending_ends[panel], work.axial_ends[panel], 2 * stage
            x += axial[end, c]
            x_rate = axial[end, c + 1]
            y += bending[2 * end, c]
            y_rate = bending[2 * end, c + 1]
            turn += bending[2 * end + 1, c]
            spin += bending[2 * end + 1, c + 1]
        c, s = work.turn[slot, b, 0], work.turn[slot, b, 1]
        ax, ay = c * x - s * y, s * x + c * y
        work.local[slot, number, 0], work.local[slot, number, 1] = x, y
        work.arm[slot, number, 0], work.arm[slot, number, 1] = ax, ay
        work.point[slot, number, 0] = work.place[slot, b, 0] + ax
        work.point[slot, number, 1] = work.place[slot, b, 1] + ay
        work.point_rate[slot, number, 0] = work.speed[slot, b, 0] - rigid_spin * ay + c * x_rate - s * y_rate
        work.point_rate[slot, number, 1] = work.speed[slot, b, 1] + rigid_spin * ax + s * x_rate + c * y_rate
        work.direction[slot, number, 0], work.direction[slot, number, 1] = turn, spin


@kernel(inlined=True)
def move_joints(model, work, slot):
    """Fill the motion of every joint at a slot from that of its attachments."""
    point, rate, direction = work.point[slot], work.point_rate[slot], work.direction[slot]
    for j in range(model.joints.size):
        joint, motion = model.joints[j], work.motion[slot, j]
        o, i = joint.outboard, joint.inboard
        ex, ey = point[o, 0] - point[i, 0], point[o, 1] - point[i, 1]
        ux, uy = rate[o, 0] - rate[i, 0], rate[o, 1] - rate[i, 1]
        motion[ECCENTRICITY_X], motion[ECCENTRICITY_Y] = ex, ey
        motion[VELOCITY_X], motion[VELOCITY_Y] = ux, uy
        motion[ANGLE] = joint.sign * (direction[o, 0] - direction[i, 0] - model.folded_angle[j])
        motion[RATE] = joint.sign * (direction[o, 1] - direction[i, 1])
        motion[OUTBOARD_SPIN], motion[INBOARD_SPIN] = direction[o, 1], direction[i, 1]
        if joint.kind == CLEARANCE:
            contact = contact_motion(joint, ex, ey, ux, uy, motion[OUTBOARD_SPIN], motion[INBOARD_SPIN])
            motion[LEVER], motion[NORMAL_X], motion[NORMAL_Y] = contact.lever, contact.normal_x, contact.normal_y
            motion[DEPTH], motion[DEPTH_RATE] = contact.depth, contact.rate
            motion[SLIP], motion[SLIDING_SPEED] = contact.slip, contact.sliding_speed


@kernel(inner=True)
def sum_ends(rows, q, v, ends):
    """Values and rates of the ends, columns 0 and 1, from the amplitudes."""
    for i in range(ends.shape[0]):
        row = rows[i]
        value, rate = 0.0, 0.0
        for k in range(q.size):
            value += row[k] * q[k]
            rate += row[k] * v[k]
        ends[i, 0], ends[i, 1] = value, rate


@kernel
def look_at(model, q, v, work, slot):
    """Fill frames, attachments and joints at a slot for given coordinates and velocities."""
    panels = model.panels
    modes, axial = panels.bending_frequency.shape[1], panels.axial_frequency.shape[1]
    coupled = work.low.shape[1]
    for b in range(model.bodies.size):
        body = model.bodies[b]
        first = body.offset
        for i in range(3):
            work.place[slot, b, i], work.speed[slot, b, i] = q[first + i], v[first + i]
        work.turn[slot, b, 0], work.turn[slot, b, 1] = math.cos(q[first + 2]), math.sin(q[first + 2])
        if body.panel == RIGID_BODY:
            continue
        d, middle = body.design, first + 3 + axial
        sum_ends(panels.axial_rows[d], q[first + 3 : middle], v[first + 3 : middle], work.axial_ends[body.panel])
        bending, rates = q[middle : middle + modes], v[middle : middle + modes]
        sum_ends(panels.bending_rows[d], bending, rates, work.bending_ends[body.panel])
        shortening = work.shortening[0]
        foreshorten(panels.forms[d], bending[:coupled], rates[:coupled], work.gradient[0], shortening)
        ends = work.axial_ends[body.panel]
        for c in range(2):
            ends[0, c] += shortening[c, FORMS - 2]
            ends[1, c] += shortening[c, FORMS - 1]
    move_attachments(model, work, slot)
    move_joints(model, work, slot)
