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
from solar_env.mechanics.modal.panel.coupling import foreshorten, shorten_ends
from solar_env.mechanics.modal.panel.tables import AXIAL_EVEN, AXIAL_ODD, BENDING_EVEN, BENDING_ODD, GROUPS, side
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
            odd, c = side(end), 2 * stage
            x += work.ends[panel, AXIAL_EVEN, 0, c] + odd * work.ends[panel, AXIAL_ODD, 0, c]
            x_rate = work.ends[panel, AXIAL_EVEN, 0, c + 1] + odd * work.ends[panel, AXIAL_ODD, 0, c + 1]
            y += work.ends[panel, BENDING_EVEN, 0, c] + odd * work.ends[panel, BENDING_ODD, 0, c]
            y_rate = work.ends[panel, BENDING_EVEN, 0, c + 1] + odd * work.ends[panel, BENDING_ODD, 0, c + 1]
            turn += odd * work.ends[panel, BENDING_EVEN, 1, c] + work.ends[panel, BENDING_ODD, 1, c]
            spin += odd * work.ends[panel, BENDING_EVEN, 1, c + 1] + work.ends[panel, BENDING_ODD, 1, c + 1]
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
    """Values and rates of the ends of one group, columns 0 and 1, from the amplitudes."""
    w, w_rate, s, s_rate = 0.0, 0.0, 0.0, 0.0
    for k in range(q.size):
        w += rows[k, 0] * q[k]
        w_rate += rows[k, 0] * v[k]
        s += rows[k, 1] * q[k]
        s_rate += rows[k, 1] * v[k]
    ends[0, 0], ends[0, 1], ends[1, 0], ends[1, 1] = w, w_rate, s, s_rate


@kernel(inlined=True)
def pose_panel(panels, q, v, work, p, d, offset):
    """Ends of panel `p`, columns of the first stage, from amplitudes that begin at `offset`."""
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        sum_ends(
            panels.rows[d, begin:end],
            q[offset + begin : offset + end],
            v[offset + begin : offset + end],
            work.ends[p, group],
        )
        for r in range(panels.coupled[group]):
            work.low[group, r, 0], work.low[group, r, 1] = q[offset + begin + r], v[offset + begin + r]
    foreshorten(panels.forms[d], work.low, 0, work.gradient[0], work.shortening[p, 0])
    shorten_ends(work, p)


@kernel
def look_at(model, q, v, work, slot):
    """Fill frames, attachments and joints at a slot for given coordinates and velocities."""
    for b in range(model.bodies.size):
        body = model.bodies[b]
        first = body.offset
        for i in range(3):
            work.place[slot, b, i], work.speed[slot, b, i] = q[first + i], v[first + i]
        work.turn[slot, b, 0], work.turn[slot, b, 1] = math.cos(q[first + 2]), math.sin(q[first + 2])
        if body.panel != RIGID_BODY:
            pose_panel(model.panels, q, v, work, body.panel, body.design, first + 3)
    move_attachments(model, work, slot)
    move_joints(model, work, slot)
