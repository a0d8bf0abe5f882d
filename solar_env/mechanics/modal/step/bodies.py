"""Loads of the joints to the bodies, and the frames of the bodies at the stages of a step."""

import math

from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.modal.arrays import LEVER, NORMAL_X, NORMAL_Y, RIGID_BODY, START
from solar_env.mechanics.modal.panel.oscillators import NODES, A, B
from solar_env.mechanics.modal.panel.tables import (
    AXIAL_EVEN,
    AXIAL_ODD,
    BENDING_EVEN,
    BENDING_ODD,
    GROUPS,
    VALUES,
    side,
)
from solar_env.mechanics.numerics.jit import kernel

# Below this angle [rad] three terms of the series of sine and cosine hold all digits.
_SMALL_TURN = 0.02


@kernel(inlined=True)
def add_load(model, work, stage, number, fx, fy, torque):
    """Add a force [N] and a torque [N m] at an attachment to its body's loads at a stage."""
    attachment = model.attachments[number]
    own, arm = work.bodies[attachment.body], work.attachments[number].arm
    own.load[stage, 0] += fx
    own.load[stage, 1] += fy
    own.load[stage, 2] += torque + arm[stage, 0] * fy - arm[stage, 1] * fx
    p = model.bodies[attachment.body].panel
    if p != RIGID_BODY:
        load = work.panels[p].load[stage]
        c, s = own.turn[stage, 0], own.turn[stage, 1]
        along, across, odd = c * fx + s * fy, c * fy - s * fx, side(attachment.end)
        load[BENDING_EVEN, 0] += across
        load[BENDING_EVEN, 1] += odd * torque
        load[BENDING_ODD, 0] += odd * across
        load[BENDING_ODD, 1] += torque
        load[AXIAL_EVEN, 0] += along
        load[AXIAL_ODD, 0] += odd * along


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
def distribute_loads(model, state, work):
    """Fill the loads of bodies and ends at both stages from those of the joints, in the directions there now.

    Those of cable loops are added by `cables.distribute_cables`.
    """
    for b in range(model.bodies.size):
        for s in range(2):
            for i in range(3):
                work.bodies[b].load[s, i] = 0.0
    for p in range(work.panels.size):
        own = work.panels[p]
        for s in range(2):
            for group in range(GROUPS):
                for i in range(VALUES):
                    # What foreshortening does to the rest of the end values is a load of the ends.
                    bending, rest = group < AXIAL_EVEN, model.panels.coupled[group] + i
                    own.load[s, group, i] = own.coupling[s, group, rest] if bending else 0.0
    for j in range(model.joints.size):
        joint, own = model.joints[j], work.joints[j]
        for s in range(2):
            fx, fy, outboard, inboard = outboard_load(joint, state.joints[j], own.load[s], own.motion[s])
            add_load(model, work, s, joint.outboard, fx, fy, outboard)
            add_load(model, work, s, joint.inboard, -fx, -fy, inboard)


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
        body, own = model.bodies[b], work.bodies[b]
        for i in range(3):
            inverse = body.inverse_mass if i < 2 else body.inverse_inertia
            first, second = own.load[0, i] * inverse, own.load[1, i] * inverse
            if i < 2 and inverse > 0.0:
                first += model.gravity[i]
                second += model.gravity[i]
            x, v = state.q[body.offset + i], state.v[body.offset + i]
            for s in range(2):
                own.place[s, i] = x + h * (NODES[s] * v + h * (B[s][0] * first + B[s][1] * second))
                own.speed[s, i] = v + h * (A[s][0] * first + A[s][1] * second)
        for s in range(2):
            angle = own.place[s, 2] - own.place[START, 2]
            own.turn[s, 0], own.turn[s, 1] = turned(own.turn[START, 0], own.turn[START, 1], angle)
