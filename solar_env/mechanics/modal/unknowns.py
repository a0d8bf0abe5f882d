"""Unknown loads of a step, and how the joints' motion at both stages answers them.

A unit of an unknown loads the two bodies of its joint. By reciprocity, the same row of loads reads off the motion that
the unknown works on: a joint angle, minus a depth, a sliding speed, a component of the relative velocity.
"""

import math

from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.joints.torques import known_stiffness, may_be_stiff
from solar_env.mechanics.modal.arrays import (
    CABLE_ROW,
    FACES,
    NORMAL_ROW,
    REACTION_X_ROW,
    REACTION_Y_ROW,
    RIGID_BODY,
    SECOND,
    TANGENTIAL_ROW,
    TORQUE_ROW,
)
from solar_env.mechanics.modal.motion import cable_attachment, face_load, force_of, outboard_load
from solar_env.mechanics.modal.tables import AXIAL_EVEN, AXIAL_ODD, BENDING_EVEN, BENDING_ODD, A, B, side
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into

# Change of a torque by the motion that it causes, over itself, that converges at once without Newton's matrix.
_SOFT = 0.05
# A load that is off by the deviation of its course from the collocation polynomial moves its body by a twelfth of what
# the same load would if it were constant: the second integral of (1 - 3 t)(1 - t), over one half.
DEVIATION = 1.0 / 12.0
# Least torque ratio of a cable loop that tells of errors at the inner wheel.
_LEAST_RATIO = 1e-3


@kernel(inlined=True)
def effect_of_torque(model, tables, level, h, j):
    """Greatest changes over a step by a unit of a joint's torque: of its angle [rad], of its points' velocity [m/s]."""
    joint, angle, velocity = model.joints[j], 0.0, 0.0
    for face in range(2):
        attachment = model.attachments[joint.outboard if face == 0 else joint.inboard]
        body = model.bodies[attachment.body]
        angle += 0.5 * h * h * body.inverse_inertia
        velocity += math.hypot(attachment.x, attachment.y) * body.inverse_inertia * h
        if body.panel != RIGID_BODY:
            response = tables.responses[body.design, level].response
            even, odd = response[BENDING_EVEN, 1, 1], response[BENDING_ODD, 1, 1]
            angle += abs(even[2] + odd[2]) + abs(even[6] + odd[6])
            even, odd = response[BENDING_EVEN, 0, 1], response[BENDING_ODD, 0, 1]
            velocity += abs(even[3] + odd[3] + even[7] + odd[7])
    return angle, velocity


@kernel(inlined=True)
def list_unknown(model, work, r, kind, j, number):
    """Enter unknown `r` of joint `j`, the load `number`; returns how many unknowns there are then."""
    unknown, joint = work.unknowns[r], model.joints[j]
    unknown.kind, unknown.owner, unknown.number, unknown.faces = kind, j, number, 2
    unknown.attachment[0], unknown.attachment[1] = joint.outboard, joint.inboard
    return r + 1


@kernel(single_caller=True)
def list_rows(model, state, work, tables, level, h):
    """List the unknowns, and set the tolerances of torques; returns the number of unknowns.

    A torque that a step hardly changes is none: it follows the motion from iteration to iteration.
    """
    n = 0
    for j in range(model.joints.size):
        joint, torque, force = model.joints[j], work.loads[j], force_of(model, j)
        give, moved = effect_of_torque(model, tables, level, h, j)
        work.joints[j].angle_by_torque, torque.tolerance = give, work.step[0].velocity_tolerance / (DEVIATION * moved)
        torque.unknown = may_be_stiff(state.joints[j]) or known_stiffness(joint) * give > _SOFT
        if torque.unknown:
            n = list_unknown(model, work, n, TORQUE_ROW, j, j)
        if joint.kind == IDEAL:
            n = list_unknown(model, work, n, REACTION_X_ROW, j, force)
            n = list_unknown(model, work, n, REACTION_Y_ROW, j, force + 1)
        elif state.joints[j].in_contact:
            n = list_unknown(model, work, n, NORMAL_ROW, j, force)
            n = list_unknown(model, work, n, TANGENTIAL_ROW, j, force + 1)
    for c in range(model.cables.size):
        cable, torque = model.cables[c], work.loads[model.joints.size + c]
        inner, outer = work.loads[cable.joint_a].tolerance, work.loads[cable.joint_b].tolerance
        torque.tolerance = min(outer, inner / max(cable.torque_ratio, _LEAST_RATIO))
        give = work.joints[cable.joint_b].angle_by_torque
        give += max(cable.wheel_ratio, 1.0) * max(cable.torque_ratio, 1.0) * work.joints[cable.joint_a].angle_by_torque
        torque.unknown = cable.stiffness * give > _SOFT
        if torque.unknown:
            unknown = work.unknowns[n]
            unknown.kind, unknown.owner, unknown.number, unknown.faces = CABLE_ROW, c, model.joints.size + c, FACES
            for face in range(FACES):
                unknown.attachment[face] = cable_attachment(model, cable, face)
            n += 1
    return n


@kernel(inlined=True)
def enter_load(model, work, number, fx, fy, torque, load):
    """Enter a load on an attachment as its body's frame has it, in the directions of the second stage."""
    body, local = work.bodies[model.attachments[number].body], work.attachments[number].local
    c, s = body.turn[SECOND, 0], body.turn[SECOND, 1]
    along, across = c * fx + s * fy, c * fy - s * fx
    load[0], load[1], load[2] = along, across, torque
    load[3] = torque + local[SECOND, 0] * across - local[SECOND, 1] * along


@kernel(single_caller=True)
def fill_unit_loads(model, work, n):
    """Unit loads of the unknowns in the frames of their bodies, as the second stage has them."""
    for r in range(n):
        unknown = work.unknowns[r]
        if unknown.kind == CABLE_ROW:
            cable, motion = model.cables[unknown.owner], work.cables[unknown.owner].motion[SECOND]
            for face in range(FACES):
                fx, fy, torque = face_load(model, cable, motion, face, 1.0, cable.torque_ratio)
                enter_load(model, work, unknown.attachment[face], fx, fy, torque, unknown.load[face])
                fx, fy, torque = face_load(model, cable, motion, face, 1.0, cable.wheel_ratio)
                enter_load(model, work, unknown.attachment[face], fx, fy, torque, unknown.reading[face])
        else:
            first = 1.0 if unknown.kind in (NORMAL_ROW, REACTION_X_ROW) else 0.0
            second = 1.0 if unknown.kind in (TANGENTIAL_ROW, REACTION_Y_ROW) else 0.0
            torque = 1.0 if unknown.kind == TORQUE_ROW else 0.0
            joint, motion = model.joints[unknown.owner], work.joints[unknown.owner].motion[SECOND]
            fx, fy, outboard, inboard = outboard_load(joint, motion, first, second, torque)
            for face in range(2):
                sign, torque = (1.0, outboard) if face == 0 else (-1.0, inboard)
                enter_load(model, work, unknown.attachment[face], sign * fx, sign * fy, torque, unknown.load[face])
                copy_into(unknown.reading[face], unknown.load[face])


@kernel(single_caller=True)
def move_ends(response, load, odd, motion):
    """Motion of both ends of a panel, along, across and turning, by a load at the end where `odd` is `side`."""
    along, across, torque = load[0], load[1], load[2]
    for c in range(8):
        even = response[BENDING_EVEN, 0, 0, c] * across + response[BENDING_EVEN, 0, 1, c] * odd * torque
        other = response[BENDING_ODD, 0, 0, c] * odd * across + response[BENDING_ODD, 0, 1, c] * torque
        motion[0, 1, c], motion[1, 1, c] = even + other, even - other
        even = response[BENDING_EVEN, 1, 0, c] * across + response[BENDING_EVEN, 1, 1, c] * odd * torque
        other = response[BENDING_ODD, 1, 0, c] * odd * across + response[BENDING_ODD, 1, 1, c] * torque
        motion[0, 2, c], motion[1, 2, c] = other + even, other - even
        even, other = response[AXIAL_EVEN, 0, 0, c] * along, response[AXIAL_ODD, 0, 0, c] * odd * along
        motion[0, 0, c], motion[1, 0, c] = even + other, even - other


@kernel(single_caller=True)
def add_shared(body, first, second, motion, rigid, shared):
    """Add what unit load `second` on a body does to the motion that unit load `first` works on.

    `motion` is that of the end at which the first one acts, by the second one.
    """
    share = (first[0] * second[0] + first[1] * second[1]) * body.inverse_mass
    share += first[3] * second[3] * body.inverse_inertia
    for c in range(8):
        shared[c] += share * rigid[c]
    if body.panel != RIGID_BODY:
        along, across, torque = first[0], first[1], first[2]
        for c in range(8):
            shared[c] += along * motion[0, c] + across * motion[1, c] + torque * motion[2, c]


@kernel(inner=True)
def share_motion(model, work, p, q):
    """Fill the motion that unknown `p` reads off by a unit of unknown `q`."""
    shared = work.mobility[p, q].response
    for c in range(8):
        shared[c] = 0.0
    unknown, other = work.unknowns[p], work.unknowns[q]
    for face in range(unknown.faces):
        first = model.attachments[unknown.attachment[face]]
        body = model.bodies[first.body]
        for opposite in range(other.faces):
            if model.attachments[other.attachment[opposite]].body == first.body:
                motion = other.motion[opposite, first.end]
                add_shared(body, unknown.reading[face], other.load[opposite], motion, work.rigid, shared)


@kernel(single_caller=True)
def fill_mobility(model, work, tables, level, h, n):
    """Motion that each unknown works on by a unit of each other, at both stages."""
    fill_unit_loads(model, work, n)
    for s in range(2):
        for k in range(2):
            work.rigid[4 * k + 2 * s], work.rigid[4 * k + 2 * s + 1] = h * h * B[s][k], h * A[s][k]
    for q in range(n):
        unknown = work.unknowns[q]
        for face in range(unknown.faces):
            attachment = model.attachments[unknown.attachment[face]]
            body = model.bodies[attachment.body]
            if body.panel != RIGID_BODY:
                response = tables.responses[body.design, level].response
                move_ends(response, unknown.load[face], side(attachment.end), unknown.motion[face])
    for p in range(n):
        for q in range(p + 1):
            share_motion(model, work, p, q)
            if work.unknowns[p].kind == CABLE_ROW or work.unknowns[q].kind == CABLE_ROW:
                share_motion(model, work, q, p)
            else:
                copy_into(work.mobility[q, p].response, work.mobility[p, q].response)
