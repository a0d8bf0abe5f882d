"""From bodies to joints: where attachments are and how they move, and what a joint sees of it."""

import math

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, INBOARD_SPIN, OUTBOARD_SPIN, RATE
from solar_env.mechanics.arrays.model import CLEARANCE
from solar_env.mechanics.joints.contact import contact_motion
from solar_env.mechanics.modal.arrays import (
    DEPTH,
    DEPTH_RATE,
    LEVER,
    NORMAL_X,
    NORMAL_Y,
    RIGID_BODY,
    SLIDING_SPEED,
    SLIP,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.panel.coupling import foreshorten_pose, shorten_ends
from solar_env.mechanics.modal.panel.tables import AXIAL_EVEN, AXIAL_ODD, BENDING_EVEN, BENDING_ODD, GROUPS, side
from solar_env.mechanics.modal.step.cables import move_cables
from solar_env.mechanics.numerics.jit import kernel


@kernel(inlined=True)
def move_attachments(model, work, slot):
    """Place the attachments at a slot, from the bodies' frames and the motion of the panels' ends there.

    The motion of the ends is that of the stage; other slots keep theirs where the first stage has its own.
    """
    column = 2 * (slot if slot < 2 else 0)
    for number in range(model.attachments.size):
        attachment, own = model.attachments[number], work.attachments[number]
        body = work.bodies[attachment.body]
        panel = model.bodies[attachment.body].panel
        place, speed = body.place[slot], body.speed[slot]
        x, y, turn = attachment.x, attachment.y, place[2]
        x_rate, y_rate, spin = 0.0, 0.0, speed[2]
        if panel != RIGID_BODY:
            odd, ends = side(attachment.end), work.panels[panel].ends
            x += ends[AXIAL_EVEN, 0, column] + odd * ends[AXIAL_ODD, 0, column]
            y += ends[BENDING_EVEN, 0, column] + odd * ends[BENDING_ODD, 0, column]
            turn += odd * ends[BENDING_EVEN, 1, column] + ends[BENDING_ODD, 1, column]
            column += 1
            x_rate = ends[AXIAL_EVEN, 0, column] + odd * ends[AXIAL_ODD, 0, column]
            y_rate = ends[BENDING_EVEN, 0, column] + odd * ends[BENDING_ODD, 0, column]
            spin += odd * ends[BENDING_EVEN, 1, column] + ends[BENDING_ODD, 1, column]
            column -= 1
        c, s = body.turn[slot, 0], body.turn[slot, 1]
        ax, ay = c * x - s * y, s * x + c * y
        own.local[slot, 0], own.local[slot, 1] = x, y
        own.arm[slot, 0], own.arm[slot, 1] = ax, ay
        own.point[slot, 0], own.point[slot, 1] = place[0] + ax, place[1] + ay
        own.point_rate[slot, 0] = speed[0] - speed[2] * ay + c * x_rate - s * y_rate
        own.point_rate[slot, 1] = speed[1] + speed[2] * ax + s * x_rate + c * y_rate
        own.direction[slot, 0], own.direction[slot, 1] = turn, spin


@kernel(inlined=True)
def move_joints(model, work, slot):
    """Fill the motion of every joint at a slot from that of its attachments."""
    for j in range(model.joints.size):
        joint, motion = model.joints[j], work.joints[j].motion[slot]
        outboard, inboard = work.attachments[joint.outboard], work.attachments[joint.inboard]
        ex = outboard.point[slot, 0] - inboard.point[slot, 0]
        ey = outboard.point[slot, 1] - inboard.point[slot, 1]
        ux = outboard.point_rate[slot, 0] - inboard.point_rate[slot, 0]
        uy = outboard.point_rate[slot, 1] - inboard.point_rate[slot, 1]
        motion[ECCENTRICITY_X], motion[ECCENTRICITY_Y] = ex, ey
        motion[VELOCITY_X], motion[VELOCITY_Y] = ux, uy
        turn = outboard.direction[slot, 0] - inboard.direction[slot, 0]
        motion[ANGLE] = joint.sign * (turn - model.folded_angle[j])
        motion[OUTBOARD_SPIN], motion[INBOARD_SPIN] = outboard.direction[slot, 1], inboard.direction[slot, 1]
        motion[RATE] = joint.sign * (motion[OUTBOARD_SPIN] - motion[INBOARD_SPIN])
        if joint.kind == CLEARANCE:
            contact = contact_motion(joint, ex, ey, ux, uy, motion[OUTBOARD_SPIN], motion[INBOARD_SPIN])
            motion[LEVER], motion[NORMAL_X], motion[NORMAL_Y] = contact.lever, contact.normal_x, contact.normal_y
            motion[DEPTH], motion[DEPTH_RATE] = contact.depth, contact.rate
            motion[SLIP], motion[SLIDING_SPEED] = contact.slip, contact.sliding_speed


@kernel(inner=True)
def sum_ends(modes, q, v, ends):
    """Values and rates of the ends of one group, columns 0 and 1, from the amplitudes."""
    w, w_rate, s, s_rate = 0.0, 0.0, 0.0, 0.0
    for k in range(q.size):
        first, second = modes[k].row[0], modes[k].row[1]
        w += first * q[k]
        w_rate += first * v[k]
        s += second * q[k]
        s_rate += second * v[k]
    ends[0, 0], ends[0, 1], ends[1, 0], ends[1, 1] = w, w_rate, s, s_rate


@kernel(inlined=True)
def place_bodies(model, q, v, work, slot):
    """Fill frames, attachments and joints at a slot, from coordinates and the motion of the ends at the first stage."""
    for b in range(model.bodies.size):
        body, own, first = model.bodies[b], work.bodies[b], model.bodies[b].offset
        for i in range(3):
            own.place[slot, i], own.speed[slot, i] = q[first + i], v[first + i]
        own.turn[slot, 0], own.turn[slot, 1] = math.cos(q[first + 2]), math.sin(q[first + 2])
        if body.panel != RIGID_BODY:
            panel = work.panels[body.panel]
            foreshorten_pose(model.panels, panel, body.design, q[first + 3 :], v[first + 3 :])
            shorten_ends(panel)
    move_attachments(model, work, slot)
    move_joints(model, work, slot)
    move_cables(model, work, slot)


@kernel
def look_at(model, q, v, work, slot):
    """Fill frames, attachments and joints at a slot for given coordinates and velocities."""
    panels = model.panels
    for b in range(model.bodies.size):
        body = model.bodies[b]
        if body.panel != RIGID_BODY:
            for group in range(GROUPS):
                begin, end = panels.first[group], panels.first[group + 1]
                first, last = body.offset + 3 + begin, body.offset + 3 + end
                ends = work.panels[body.panel].ends[group]
                sum_ends(panels.modes[body.design, begin:end], q[first:last], v[first:last], ends)
    place_bodies(model, q, v, work, slot)
