"""From loads to motion: loads of joints and cable loops to the bodies, their frames at the stages, what a joint sees.

A loop's wheels turn against the chord of the body between its joints (`joints/cable_loop.py`). Its load is the torque
on the outer wheel; the motion that it works on, where it conserves energy, is minus the mismatch of the wheels.
"""

import math

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, INBOARD_SPIN, OUTBOARD_SPIN, RATE
from solar_env.mechanics.arrays.model import CLEARANCE, IDEAL
from solar_env.mechanics.joints.contact import contact_motion
from solar_env.mechanics.modal.arrays import (
    ACROSS_X,
    ACROSS_Y,
    DEPTH,
    DEPTH_RATE,
    FACES,
    LEVER,
    NORMAL_X,
    NORMAL_Y,
    RIGID_BODY,
    SLIDING_SPEED,
    SLIP,
    START,
    STRETCH,
    VELOCITY_X,
    VELOCITY_Y,
    WHEEL_RATE,
)
from solar_env.mechanics.modal.ends import shorten_pose, sum_ends
from solar_env.mechanics.modal.tables import (
    AXIAL_EVEN,
    AXIAL_ODD,
    BENDING_EVEN,
    BENDING_ODD,
    GROUPS,
    NODES,
    VALUES,
    A,
    B,
    side,
)
from solar_env.mechanics.numerics.jit import kernel

# Below this angle [rad] three terms of the series of sine and cosine hold all digits.
_SMALL_TURN = 0.02


@kernel(inlined=True)
def add_load(model, work, stage, number, fx, fy, torque):
    """Add a force [N] and a torque [N m] at an attachment to its body's loads at a stage."""
    attachment = model.attachments[number]
    frame, arm = work.bodies[attachment.body], work.attachments[number].arm
    frame.load[stage, 0] += fx
    frame.load[stage, 1] += fy
    frame.load[stage, 2] += torque + arm[stage, 0] * fy - arm[stage, 1] * fx
    p = model.bodies[attachment.body].panel
    if p != RIGID_BODY:
        load = work.panels[p].load[stage]
        c, s = frame.turn[stage, 0], frame.turn[stage, 1]
        along, across, odd = c * fx + s * fy, c * fy - s * fx, side(attachment.end)
        load[BENDING_EVEN, 0] += across
        load[BENDING_EVEN, 1] += odd * torque
        load[BENDING_ODD, 0] += odd * across
        load[BENDING_ODD, 1] += torque
        load[AXIAL_EVEN, 0] += along
        load[AXIAL_ODD, 0] += odd * along


@kernel(inlined=True)
def outboard_load(joint, motion, first, second, torque):
    """Load on a joint's outboard body by its force and torque: force, torque; and the torque on the inboard one.

    The force has the two components of an ideal joint's reaction, or the normal and tangential ones of a contact.
    """
    torque = joint.sign * torque
    if joint.kind == IDEAL:
        return first, second, torque, -torque
    nx, ny = motion[NORMAL_X], motion[NORMAL_Y]
    return (
        -first * nx - second * ny,
        -first * ny + second * nx,
        torque + joint.journal_radius * second,
        -torque - motion[LEVER] * second,
    )


@kernel(inlined=True)
def force_of(model, j):
    """Number of the first component of a joint's force among the loads; the second one follows."""
    return model.joints.size + model.cables.size + 2 * j


@kernel(inlined=True)
def cable_attachment(model, cable, face):
    """Number of an attachment that a loop loads: with the outer wheel, the inner one, then the carrier's two ends."""
    if face == 0:
        return model.joints[cable.joint_b].outboard
    if face == 1:
        return model.joints[cable.joint_a].inboard
    return model.joints[cable.joint_a].outboard if face == 2 else model.joints[cable.joint_b].inboard


@kernel(inlined=True)
def face_load(model, cable, motion, face, torque, ratio):
    """Force [N] and torque [N m] of a loop on an attachment; `ratio` is of minus the inner torque to the outer one."""
    inner, outer = -ratio * torque * model.joints[cable.joint_a].sign, torque * model.joints[cable.joint_b].sign
    if face == 0:
        return 0.0, 0.0, outer
    if face == 1:
        return 0.0, 0.0, -inner
    moment = inner - outer
    if cable.chord_sense == 0:
        return 0.0, 0.0, moment if face == 2 else 0.0
    force = moment if face == 3 else -moment
    return force * motion[ACROSS_X], force * motion[ACROSS_Y], 0.0


@kernel(inlined=True)
def distribute_loads(model, state, work):
    """Fill the loads of bodies and ends at both stages from those of joints and loops, in the directions there now."""
    for b in range(model.bodies.size):
        for s in range(2):
            for i in range(3):
                work.bodies[b].load[s, i] = 0.0
    for p in range(work.panels.size):
        panel = work.panels[p]
        for s in range(2):
            for group in range(GROUPS):
                for i in range(VALUES):
                    # What foreshortening does to the rest of the end values is a load of the ends.
                    bending, rest = group < AXIAL_EVEN, model.panels.coupled[group] + i
                    panel.load[s, group, i] = panel.coupling[s, group, rest] if bending else 0.0
    for j in range(model.joints.size):
        joint, first = model.joints[j], force_of(model, j)
        for s in range(2):
            torque = work.loads[j].stage[s] + state.joints[j].motor_torque
            force, motion = (work.loads[first].stage[s], work.loads[first + 1].stage[s]), work.joints[j].motion[s]
            fx, fy, outboard, inboard = outboard_load(joint, motion, force[0], force[1], torque)
            add_load(model, work, s, joint.outboard, fx, fy, outboard)
            add_load(model, work, s, joint.inboard, -fx, -fy, inboard)
    for c in range(model.cables.size):
        cable, load = model.cables[c], work.loads[model.joints.size + c].stage
        for s in range(2):
            for face in range(FACES):
                motion = work.cables[c].motion[s]
                fx, fy, torque = face_load(model, cable, motion, face, load[s], cable.torque_ratio)
                add_load(model, work, s, cable_attachment(model, cable, face), fx, fy, torque)


@kernel(inlined=True)
def turned(cosine, sine, angle):
    """Cosine and sine after a further turn by `angle` [rad]."""
    square = angle * angle
    if square < _SMALL_TURN * _SMALL_TURN:
        c = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0 - square / 40320.0)))
        s = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square / 5040.0)))
    else:
        c, s = math.cos(angle), math.sin(angle)
    return cosine * c - sine * s, sine * c + cosine * s


@kernel(inlined=True)
def stage_frames(model, state, work, h):
    """Centres of mass and angles of the bodies at both stages, with their rates."""
    for b in range(model.bodies.size):
        body, frame = model.bodies[b], work.bodies[b]
        for i in range(3):
            inverse = body.inverse_mass if i < 2 else body.inverse_inertia
            first, second = frame.load[0, i] * inverse, frame.load[1, i] * inverse
            if i < 2 and inverse > 0.0:
                first += model.gravity[i]
                second += model.gravity[i]
            x, v = state.q[body.offset + i], state.v[body.offset + i]
            for s in range(2):
                frame.place[s, i] = x + h * (NODES[s] * v + h * (B[s][0] * first + B[s][1] * second))
                frame.speed[s, i] = v + h * (A[s][0] * first + A[s][1] * second)
        for s in range(2):
            angle = frame.place[s, 2] - frame.place[START, 2]
            frame.turn[s, 0], frame.turn[s, 1] = turned(frame.turn[START, 0], frame.turn[START, 1], angle)


@kernel(inlined=True)
def move_attachments(model, work, slot):
    """Place the attachments at a slot, from the bodies' frames and the motion of the panels' ends there.

    The motion of the ends is that of the stage; other slots keep theirs where the first stage has its own.
    """
    column = 2 * (slot if slot < 2 else 0)
    for number in range(model.attachments.size):
        attachment, moved = model.attachments[number], work.attachments[number]
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
        moved.local[slot, 0], moved.local[slot, 1] = x, y
        moved.arm[slot, 0], moved.arm[slot, 1] = ax, ay
        moved.point[slot, 0], moved.point[slot, 1] = place[0] + ax, place[1] + ay
        moved.point_rate[slot, 0] = speed[0] - speed[2] * ay + c * x_rate - s * y_rate
        moved.point_rate[slot, 1] = speed[1] + speed[2] * ax + s * x_rate + c * y_rate
        moved.direction[slot, 0], moved.direction[slot, 1] = turn, spin


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


@kernel(inlined=True)
def move_cables(model, work, slot):
    """Fill the motion of every loop at a slot from that of joints and attachments."""
    for c in range(model.cables.size):
        cable, motion = model.cables[c], work.cables[c].motion[slot]
        inner, outer = work.joints[cable.joint_a].motion[slot], work.joints[cable.joint_b].motion[slot]
        inner_angle, outer_angle, rate, across_x, across_y = inner[ANGLE], outer[ANGLE], inner[RATE], 0.0, 0.0
        if cable.chord_sense != 0:
            a, b = model.joints[cable.joint_a], model.joints[cable.joint_b]
            first, last = work.attachments[a.outboard], work.attachments[b.inboard]
            x, y = last.local[slot, 0] - first.local[slot, 0], last.local[slot, 1] - first.local[slot, 1]
            turn = work.bodies[model.attachments[a.outboard].body].place[slot, 2]
            turn += math.atan2(cable.chord_sense * y, cable.chord_sense * x)
            inner_angle += a.sign * (turn - first.direction[slot, 0])
            outer_angle -= b.sign * (turn - last.direction[slot, 0])
            x, y = last.point[slot, 0] - first.point[slot, 0], last.point[slot, 1] - first.point[slot, 1]
            square = x * x + y * y
            across_x, across_y = -y / square, x / square
            spin = across_x * (last.point_rate[slot, 0] - first.point_rate[slot, 0])
            spin += across_y * (last.point_rate[slot, 1] - first.point_rate[slot, 1])
            rate += a.sign * (spin - first.direction[slot, 1])
        motion[STRETCH], motion[WHEEL_RATE] = cable.wheel_ratio * inner_angle - outer_angle, rate
        motion[ACROSS_X], motion[ACROSS_Y] = across_x, across_y


@kernel(inlined=True)
def place_bodies(model, q, v, work, slot):
    """Fill frames, attachments and joints at a slot, from coordinates and the ends' motion without foreshortening."""
    for b in range(model.bodies.size):
        body, frame, first = model.bodies[b], work.bodies[b], model.bodies[b].offset
        for i in range(3):
            frame.place[slot, i], frame.speed[slot, i] = q[first + i], v[first + i]
        frame.turn[slot, 0], frame.turn[slot, 1] = math.cos(q[first + 2]), math.sin(q[first + 2])
        if body.panel != RIGID_BODY:
            shorten_pose(model.panels, work.panels[body.panel], body.design, q[first + 3 :], v[first + 3 :])
    move_attachments(model, work, slot)
    move_joints(model, work, slot)
    move_cables(model, work, slot)


@kernel
def look_at(model, q, v, work, slot):
    """Fill frames, attachments and joints at a slot for given coordinates and velocities."""
    for b in range(model.bodies.size):
        body, first = model.bodies[b], model.bodies[b].offset + 3
        if body.panel != RIGID_BODY:
            sum_ends(model.panels, work.panels[body.panel], body.design, q[first:], v[first:])
    place_bodies(model, q, v, work, slot)
