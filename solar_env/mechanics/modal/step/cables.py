"""Closed cable loops at the stages of a step: their motion, their loads on the bodies, and their equations.

A loop's wheels turn against the chord of the body between its joints (`joints/cable_loop.py`). Its unknown is the
torque on the outer wheel; the motion that it works on, where it conserves energy, is minus the mismatch of the wheels.
"""

import math

from solar_env.mechanics.arrays.columns import ANGLE, RATE
from solar_env.mechanics.joints.cable_loop import cable_torque
from solar_env.mechanics.modal.arrays import (
    ACROSS_X,
    ACROSS_Y,
    CABLE_COLUMNS,
    CABLE_ROW,
    FACES,
    START,
    STRETCH,
    WHEEL_RATE,
)
from solar_env.mechanics.modal.panel.oscillators import NODES
from solar_env.mechanics.modal.step.bodies import add_load
from solar_env.mechanics.numerics.jit import kernel

# Least torque ratio that tells of errors at the inner wheel.
_LEAST_RATIO = 1e-3


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
def cable_attachment(model, cable, face):
    """Number of an attachment that a loop loads: with the outer wheel, the inner one, then the carrier's two ends."""
    if face == 0:
        return model.joints[cable.joint_b].outboard
    if face == 1:
        return model.joints[cable.joint_a].inboard
    return model.joints[cable.joint_a].outboard if face == 2 else model.joints[cable.joint_b].inboard


@kernel(inlined=True)
def face_load(model, cable, motion, face, torque, ratio):
    """Force (x, y) [N] and torque [N m] of a loop on an attachment.

    Args:
        model: of the mechanism.
        cable: row of the loop.
        motion: its motion at a slot.
        face: see `cable_attachment`.
        torque: on the outer wheel [N m].
        ratio: minus the torque on the inner wheel over that on the outer one.
    """
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
def distribute_cables(model, work):
    """Add the loads of the loops at both stages to those of bodies and ends, in the directions there now."""
    for c in range(model.cables.size):
        cable, own = model.cables[c], work.cables[c]
        for s in range(2):
            for face in range(FACES):
                fx, fy, torque = face_load(model, cable, own.motion[s], face, own.load[s], cable.torque_ratio)
                add_load(model, work, s, cable_attachment(model, cable, face), fx, fy, torque)


@kernel(inlined=True)
def start_cables(state, work, h):
    """First guess of the loops' motion and torques at the stages."""
    for c in range(work.cables.size):
        own = work.cables[c]
        for s in range(2):
            for k in range(CABLE_COLUMNS):
                own.motion[s, k] = own.motion[START, k]
            own.load[s] = state.cable_loads[c, 0] + NODES[s] * h * state.cable_loads[c, 1]


@kernel(inlined=True)
def list_cables(model, work, n, soft):
    """List the loops whose torque is an unknown from `n` on; returns the number of all unknowns.

    A torque that a step changes by less than the share `soft` of itself follows from iteration to iteration.
    """
    for c in range(model.cables.size):
        cable, own = model.cables[c], work.cables[c]
        own.unknown = -1
        gain = work.joints[cable.joint_b].angle_by_torque
        gain += max(cable.wheel_ratio, 1.0) * max(cable.torque_ratio, 1.0) * work.joints[cable.joint_a].angle_by_torque
        if cable.stiffness * gain > soft:
            own.unknown = n
            unknown = work.unknowns[n]
            unknown.kind, unknown.owner, unknown.faces = CABLE_ROW, c, FACES
            for face in range(FACES):
                unknown.attachment[face] = cable_attachment(model, cable, face)
            n += 1
    return n


@kernel(inlined=True)
def fill_cable_torques(model, work, s):
    """Torques of the loops by their law at a slot, and their slopes."""
    for c in range(model.cables.size):
        own = work.cables[c]
        own.torque, own.slope, _ = cable_torque(model.cables[c], own.motion[s, STRETCH])


@kernel(inlined=True)
def set_cable_tolerances(model, work):
    """Torques whose errors come to the tolerances of the torques about a loop's joints."""
    for c in range(model.cables.size):
        cable = model.cables[c]
        inner = work.joints[cable.joint_a].torque_tolerance / max(cable.torque_ratio, _LEAST_RATIO)
        work.cables[c].tolerance = min(work.joints[cable.joint_b].torque_tolerance, inner)


@kernel(inlined=True)
def cable_row(work, s, n, r, renewed):
    """Row of a loop's torque, as of a joint's."""
    own = work.cables[work.unknowns[r].owner]
    work.correction[s * n + r] = own.torque - own.load[s]
    if not renewed:
        return
    row = work.matrix[s * n + r]
    for c in range(n):
        # The motion that it reads off is minus the mismatch.
        minus_stretch = work.mobility[r, c].response
        for k in range(2):
            row[k * n + c] = own.slope * minus_stretch[4 * k + 2 * s]
    row[s * n + r] += 1.0
