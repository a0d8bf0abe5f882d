"""Loads of the joints to the bodies, and the frames of the bodies at the stages of a step."""

import math

from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.modal.arrays import LEVER, NORMAL_X, NORMAL_Y, RIGID_BODY, START
from solar_env.mechanics.modal.panel.oscillators import NODES, A, B
from solar_env.mechanics.modal.panel.tables import AXIAL_EVEN, AXIAL_ODD, BENDING_EVEN, BENDING_ODD, GROUPS, side
from solar_env.mechanics.numerics.jit import kernel

# Below this angle [rad] three terms of the series of sine and cosine hold all digits.
_SMALL_TURN = 0.02


@kernel(inlined=True)
def add_load(model, work, stage, number, fx, fy, torque):
    """Add a force [N] and a torque [N m] at an attachment to its body's loads at a stage."""
    attachment = model.attachments[number]
    b = attachment.body
    x, y = work.arm[stage, number, 0], work.arm[stage, number, 1]
    work.body_load[stage, b, 0] += fx
    work.body_load[stage, b, 1] += fy
    work.body_load[stage, b, 2] += torque + x * fy - y * fx
    p = model.bodies[b].panel
    if p != RIGID_BODY:
        c, s = work.turn[stage, b, 0], work.turn[stage, b, 1]
        along, across, odd = c * fx + s * fy, c * fy - s * fx, side(attachment.end)
        work.group_load[p, stage, BENDING_EVEN, 0] += across
        work.group_load[p, stage, BENDING_EVEN, 1] += odd * torque
        work.group_load[p, stage, BENDING_ODD, 0] += odd * across
        work.group_load[p, stage, BENDING_ODD, 1] += torque
        work.group_load[p, stage, AXIAL_EVEN, 0] += along
        work.group_load[p, stage, AXIAL_ODD, 0] += odd * along


@kernel(inlined=True)
def outboard_load(joint, own, load, motion):
    """Load of a joint on its outboard body: force, torque; and the torque on the inboard one."""
    torque = joint.sign * (load[2] + own.motor_torque)
    if joint.kind == IDEAL:
        return load[0], load[1], torque, -torque
    normal, tangential = load[0], load[1]
    nx, ny = motion[NORMAL_X], motion[NORMAL_Y]
    return (
        -normal * nx - tangential * ny,
        -normal * ny + tangential * nx,
        torque + joint.journal_radius * tangential,
        -torque - motion[LEVER] * tangential,
    )


@kernel(inlined=True)
def distribute_loads(model, state, work, stage):
    """Fill the loads of bodies and ends from those of the joints, in the directions that the stage has now."""
    for b in range(model.bodies.size):
        for i in range(3):
            work.body_load[stage, b, i] = 0.0
    for p in range(work.group_load.shape[0]):
        for group in range(GROUPS):
            work.group_load[p, stage, group, 0] = work.group_load[p, stage, group, 1] = 0.0
    for j in range(model.joints.size):
        joint = model.joints[j]
        fx, fy, outboard, inboard = outboard_load(joint, state.joints[j], work.load[stage, j], work.motion[stage, j])
        add_load(model, work, stage, joint.outboard, fx, fy, outboard)
        add_load(model, work, stage, joint.inboard, -fx, -fy, inboard)


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
        body = model.bodies[b]
        for i in range(3):
            inverse = body.inverse_mass if i < 2 else body.inverse_inertia
            first, second = work.body_load[0, b, i] * inverse, work.body_load[1, b, i] * inverse
            if i < 2 and inverse > 0.0:
                first += model.gravity[i]
                second += model.gravity[i]
            x, v = state.q[body.offset + i], state.v[body.offset + i]
            for s in range(2):
                work.place[s, b, i] = x + h * (NODES[s] * v + h * (B[s][0] * first + B[s][1] * second))
                work.speed[s, b, i] = v + h * (A[s][0] * first + A[s][1] * second)
        for s in range(2):
            angle = work.place[s, b, 2] - work.place[START, b, 2]
            work.turn[s, b, 0], work.turn[s, b, 1] = turned(work.turn[START, b, 0], work.turn[START, b, 1], angle)
