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
    LEVER,
    NORMAL_ROW,
    NORMAL_X,
    NORMAL_Y,
    REACTION_X_ROW,
    REACTION_Y_ROW,
    RIGID_BODY,
    SECOND,
    TANGENTIAL_ROW,
    TORQUE_ROW,
)
from solar_env.mechanics.modal.panel.coupling import bend_response
from solar_env.mechanics.modal.panel.oscillators import A, B
from solar_env.mechanics.modal.panel.tables import AXIAL_EVEN, AXIAL_ODD, BENDING_EVEN, BENDING_ODD, side
from solar_env.mechanics.modal.step.cables import face_load, list_cables
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into

# Change of a torque by the motion that it causes, over itself, that converges at once without Newton's matrix.
_SOFT = 0.05


@kernel(inlined=True)
def angle_by_torque(model, tables, level, h, j):
    """Greatest change [rad] of a joint's angle by a unit of its torque over a step."""
    joint, total = model.joints[j], 0.0
    for face in range(2):
        attachment = model.attachments[joint.outboard if face == 0 else joint.inboard]
        body = model.bodies[attachment.body]
        total += 0.5 * h * h * body.inverse_inertia
        if body.panel != RIGID_BODY:
            response = tables.responses[body.design, level].response
            even, odd = response[BENDING_EVEN, 1, 1], response[BENDING_ODD, 1, 1]
            total += abs(even[2] + odd[2]) + abs(even[6] + odd[6])
    return total


@kernel(inlined=True)
def velocity_by_torque(model, work, tables, level, h, j):
    """Velocity [m/s] of the two points that joint `j` joins by a unit of its torque over a step, without signs."""
    joint, total = model.joints[j], 0.0
    for face in range(2):
        number = joint.outboard if face == 0 else joint.inboard
        attachment = model.attachments[number]
        body = model.bodies[attachment.body]
        lever = math.hypot(work.attachments[number].local[SECOND, 0], work.attachments[number].local[SECOND, 1])
        total += lever * body.inverse_inertia * h
        if body.panel != RIGID_BODY:
            response = tables.responses[body.design, level].response
            even, odd = response[BENDING_EVEN, 0, 1], response[BENDING_ODD, 0, 1]
            total += abs(even[3] + odd[3] + even[7] + odd[7])
    return total


@kernel(inlined=True)
def list_unknown(model, work, r, kind, j):
    """Enter unknown `r` of joint `j`."""
    own, joint = work.unknowns[r], model.joints[j]
    own.kind, own.owner, own.faces = kind, j, 2
    own.attachment[0], own.attachment[1] = joint.outboard, joint.inboard


@kernel(inlined=True)
def list_rows(model, state, work, tables, level, h):
    """List the unknowns; returns their number.

    A torque that a step hardly changes is none: it follows the motion from iteration to iteration.
    """
    n = 0
    for j in range(model.joints.size):
        give = angle_by_torque(model, tables, level, h, j)
        work.joints[j].torque_unknown, work.joints[j].angle_by_torque = -1, give
        if may_be_stiff(state.joints[j]) or known_stiffness(model.joints[j]) * give > _SOFT:
            work.joints[j].torque_unknown = n
            list_unknown(model, work, n, TORQUE_ROW, j)
            n += 1
        if model.joints[j].kind == IDEAL:
            list_unknown(model, work, n, REACTION_X_ROW, j)
            list_unknown(model, work, n + 1, REACTION_Y_ROW, j)
            n += 2
        elif state.joints[j].in_contact:
            list_unknown(model, work, n, NORMAL_ROW, j)
            list_unknown(model, work, n + 1, TANGENTIAL_ROW, j)
            n += 2
    return list_cables(model, work, n, _SOFT)


@kernel(inlined=True)
def load_column(kind):
    """Column of an unknown among the loads of its joint."""
    if kind == TORQUE_ROW:
        return 2
    return 0 if kind in (NORMAL_ROW, REACTION_X_ROW) else 1


@kernel(inlined=True)
def unit_load(model, work, kind, j):
    """Load of a unit of an unknown on its outboard body, force and torque, and the torque on the inboard one."""
    joint, motion = model.joints[j], work.joints[j].motion[SECOND]
    if kind == TORQUE_ROW:
        return 0.0, 0.0, float(joint.sign), -float(joint.sign)
    if kind == REACTION_X_ROW:
        return 1.0, 0.0, 0.0, 0.0
    if kind == REACTION_Y_ROW:
        return 0.0, 1.0, 0.0, 0.0
    nx, ny = motion[NORMAL_X], motion[NORMAL_Y]
    if kind == NORMAL_ROW:
        return -nx, -ny, 0.0, 0.0
    return -ny, nx, joint.journal_radius, -motion[LEVER]


@kernel(inlined=True)
def enter_load(model, work, number, fx, fy, torque, load):
    """Enter a load on an attachment as its body's frame has it, in the directions of the second stage."""
    body, local = work.bodies[model.attachments[number].body], work.attachments[number].local
    c, s = body.turn[SECOND, 0], body.turn[SECOND, 1]
    along, across = c * fx + s * fy, c * fy - s * fx
    load[0], load[1], load[2] = along, across, torque
    load[3] = torque + local[SECOND, 0] * across - local[SECOND, 1] * along


@kernel(inlined=True)
def fill_unit_loads(model, work, n):
    """Unit loads of the unknowns in the frames of their bodies, as the second stage has them."""
    for r in range(n):
        own = work.unknowns[r]
        if own.kind == CABLE_ROW:
            cable, motion = model.cables[own.owner], work.cables[own.owner].motion[SECOND]
            for face in range(FACES):
                fx, fy, torque = face_load(model, cable, motion, face, 1.0, cable.torque_ratio)
                enter_load(model, work, own.attachment[face], fx, fy, torque, own.load[face])
                fx, fy, torque = face_load(model, cable, motion, face, 1.0, cable.wheel_ratio)
                enter_load(model, work, own.attachment[face], fx, fy, torque, own.reading[face])
        else:
            fx, fy, outboard, inboard = unit_load(model, work, own.kind, own.owner)
            for face in range(2):
                sign, torque = (1.0, outboard) if face == 0 else (-1.0, inboard)
                enter_load(model, work, own.attachment[face], sign * fx, sign * fy, torque, own.load[face])
                copy_into(own.reading[face], own.load[face])


@kernel(inlined=True)
def move_ends(response, load, odd, motion):
    """Motion of both ends of a panel, along, across and turning, by a load at the end where `odd` is `side`.

    Args:
        response: (GROUPS, VALUES, VALUES, 8) of the groups.
        load: (4,) force along and across, torque.
        motion: (2, 3, 8) is filled.
    """
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


@kernel(inlined=True)
def move_bent_ends(own, load, odd, motion):
    """Add to the motion of both ends of a panel, see `move_ends`, what a bent axis does: see `bend_response`."""
    along, across, torque = load[0], load[1], load[2]
    for c in range(8):
        value = own.bent[0, BENDING_EVEN, 0, c] + odd * own.bent[1, BENDING_EVEN, 0, c]
        other = own.bent[0, BENDING_ODD, 0, c] + odd * own.bent[1, BENDING_ODD, 0, c]
        motion[0, 1, c] += along * (value + other)
        motion[1, 1, c] += along * (value - other)
        value = own.bent[0, BENDING_EVEN, 1, c] + odd * own.bent[1, BENDING_EVEN, 1, c]
        other = own.bent[0, BENDING_ODD, 1, c] + odd * own.bent[1, BENDING_ODD, 1, c]
        motion[0, 2, c] += along * (other + value)
        motion[1, 2, c] += along * (other - value)
        for x in range(2):
            short = across * (own.bent[x, BENDING_EVEN, 0, c] + odd * own.bent[x, BENDING_ODD, 0, c])
            short += torque * (odd * own.bent[x, BENDING_EVEN, 1, c] + own.bent[x, BENDING_ODD, 1, c])
            short += along * (own.shortened[0, x, c] + odd * own.shortened[1, x, c])
            motion[0, 0, c] += short
            motion[1, 0, c] += short if x == 0 else -short


@kernel(inlined=True)
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
    own, other = work.unknowns[p], work.unknowns[q]
    for face in range(own.faces):
        first = model.attachments[own.attachment[face]]
        body = model.bodies[first.body]
        for opposite in range(other.faces):
            if model.attachments[other.attachment[opposite]].body == first.body:
                motion = other.motion[opposite, first.end]
                add_shared(body, own.reading[face], other.load[opposite], motion, work.rigid, shared)


@kernel(inlined=True)
def fill_mobility(model, work, tables, level, h, n, bent):
    """Motion that each unknown works on by a unit of each other, at both stages; with foreshortening where `bent`."""
    fill_unit_loads(model, work, n)
    if bent:
        for b in range(model.bodies.size):
            p, d = model.bodies[b].panel, model.bodies[b].design
            if p != RIGID_BODY:
                bend_response(
                    model.panels, work.panels[p], tables.answers[d, level], tables.responses[d, level].rest, d
                )
    for s in range(2):
        for k in range(2):
            work.rigid[4 * k + 2 * s], work.rigid[4 * k + 2 * s + 1] = h * h * B[s][k], h * A[s][k]
    for q in range(n):
        own = work.unknowns[q]
        for face in range(own.faces):
            attachment = model.attachments[own.attachment[face]]
            body = model.bodies[attachment.body]
            if body.panel != RIGID_BODY:
                response = tables.responses[body.design, level].response
                odd, motion = side(attachment.end), own.motion[face]
                move_ends(response, own.load[face], odd, motion)
                if bent:
                    move_bent_ends(work.panels[body.panel], own.load[face], odd, motion)
    for p in range(n):
        for q in range(p + 1):
            share_motion(model, work, p, q)
            if work.unknowns[p].kind == CABLE_ROW or work.unknowns[q].kind == CABLE_ROW:
                share_motion(model, work, q, p)
            else:
                copy_into(work.mobility[q, p].response, work.mobility[p, q].response)
