"""Unknown loads of a step, and how the joints' motion at both stages answers them.

A unit of an unknown loads the two bodies of its joint. By reciprocity, the same row of loads reads off the motion that
the unknown works on: a joint angle, minus a depth, a sliding speed, a component of the relative velocity.
"""

from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.modal.arrays import (
    LEVER,
    LOAD_HALVES,
    NORMAL,
    NORMAL_X,
    NORMAL_Y,
    REACTION_X,
    REACTION_Y,
    RIGID_BODY,
    SECOND,
    TANGENTIAL,
    TORQUE,
)
from solar_env.mechanics.modal.oscillators import A, B
from solar_env.mechanics.modal.tables import side
from solar_env.mechanics.numerics.jit import kernel

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
            even, odd = tables.response[body.design, level, 0, 1, 1], tables.response[body.design, level, 1, 1, 1]
            total += abs(even[2] + odd[2]) + abs(even[6] + odd[6])
    return total


@kernel(inlined=True)
def torque_stiffness(model, j):
    """Stiffness [N m/rad] of spring and cable loops about a joint's angle, those of its neighbours included."""
    stiffness = model.joints[j].spring_stiffness
    for c in range(model.cables.size):
        cable = model.cables[c]
        if cable.joint_a == j or cable.joint_b == j:
            ratio = max(cable.wheel_ratio, 1.0)
            stiffness += cable.stiffness * ratio * max(cable.torque_ratio, 1.0)
    return stiffness


@kernel(inlined=True)
def list_rows(model, state, work, tables, level, h):
    """List the unknowns; returns their number.

    A torque that a step hardly changes is none: it follows the motion from iteration to iteration.
    """
    n = 0
    for j in range(model.joints.size):
        work.torque_row[j] = -1
        if (
            state.joints[j].stop_engaged
            or torque_stiffness(model, j) * angle_by_torque(model, tables, level, h, j) > _SOFT
        ):
            work.torque_row[j] = n
            work.kind[n], work.joint[n] = TORQUE, j
            n += 1
        if model.joints[j].kind == IDEAL:
            work.kind[n], work.joint[n], work.kind[n + 1], work.joint[n + 1] = REACTION_X, j, REACTION_Y, j
            n += 2
        elif state.joints[j].in_contact:
            work.kind[n], work.joint[n], work.kind[n + 1], work.joint[n + 1] = NORMAL, j, TANGENTIAL, j
            n += 2
    return n


@kernel(inlined=True)
def load_column(kind):
    """Column of an unknown among the loads of its joint."""
    if kind == TORQUE:
        return 2
    return 0 if kind in (NORMAL, REACTION_X) else 1


@kernel(inlined=True)
def unit_load(model, work, kind, j):
    """Load of a unit of an unknown on its outboard body, force and torque, and the torque on the inboard one."""
    joint, motion = model.joints[j], work.motion[SECOND, j]
    if kind == TORQUE:
        return 0.0, 0.0, float(joint.sign), -float(joint.sign)
    if kind == REACTION_X:
        return 1.0, 0.0, 0.0, 0.0
    if kind == REACTION_Y:
        return 0.0, 1.0, 0.0, 0.0
    nx, ny = motion[NORMAL_X], motion[NORMAL_Y]
    if kind == NORMAL:
        return -nx, -ny, 0.0, 0.0
    return -ny, nx, joint.journal_radius, -motion[LEVER]


@kernel(inlined=True)
def fill_row_loads(model, work, n):
    """Unit loads of the unknowns in the frames of their bodies, as the second stage has them."""
    for r in range(n):
        j = work.joint[r]
        fx, fy, outboard, inboard = unit_load(model, work, work.kind[r], j)
        for face in range(2):
            number = model.joints[j].outboard if face == 0 else model.joints[j].inboard
            attachment = model.attachments[number]
            c, s = work.turn[SECOND, attachment.body, 0], work.turn[SECOND, attachment.body, 1]
            sign, odd = 1.0 if face == 0 else -1.0, side(attachment.end)
            along, across = sign * (c * fx + s * fy), sign * (c * fy - s * fx)
            torque = outboard if face == 0 else inboard
            row = work.row_load[r, face]
            row[0], row[1] = along, across
            row[2] = torque + work.local[SECOND, number, 0] * across - work.local[SECOND, number, 1] * along
            row[3], row[4], row[5], row[6], row[7], row[8] = (
                across,
                odd * torque,
                odd * across,
                torque,
                along,
                odd * along,
            )


@kernel(inlined=True)
def move_by_row(model, work, tables, level, r, face):
    """Motion of a body by the unit load of unknown `r` on it."""
    j = work.joint[r]
    body = model.bodies[model.attachments[model.joints[j].outboard if face == 0 else model.joints[j].inboard].body]
    load, motion = work.row_load[r, face], work.row_motion[r, face]
    for c in range(8):
        motion[0, c] = load[0] * body.inverse_mass * work.rigid[c]
        motion[1, c] = load[1] * body.inverse_mass * work.rigid[c]
        motion[2, c] = load[2] * body.inverse_inertia * work.rigid[c]
    if body.panel != RIGID_BODY:
        for group in range(2):
            by_load = tables.response[body.design, level, group]
            first, second = load[3 + 2 * group], load[4 + 2 * group]
            for c in range(8):
                motion[3 + 2 * group, c] = by_load[0, 0, c] * first + by_load[0, 1, c] * second
                motion[4 + 2 * group, c] = by_load[1, 0, c] * first + by_load[1, 1, c] * second
        for c in range(8):
            motion[7, c] = tables.response[body.design, level, 2, 0, 0, c] * load[7]
            motion[8, c] = tables.response[body.design, level, 3, 0, 0, c] * load[8]


@kernel(inlined=True)
def add_shared(work, p, face, q, opposite, halves):
    """Add to the mobility what the unit load of unknown `q` does to the motion that unknown `p` works on."""
    load, motion = work.row_load[p, face], work.row_motion[q, opposite]
    for i in range(halves):
        for c in range(8):
            work.shared[c] += load[i] * motion[i, c]


@kernel(inlined=True)
def fill_mobility(model, work, tables, level, h, n):
    """Motion that each unknown works on by a unit of each other, at both stages."""
    fill_row_loads(model, work, n)
    for s in range(2):
        for k in range(2):
            work.rigid[4 * k + 2 * s], work.rigid[4 * k + 2 * s + 1] = h * h * B[s][k], h * A[s][k]
    for r in range(n):
        move_by_row(model, work, tables, level, r, 0)
        move_by_row(model, work, tables, level, r, 1)
    for p in range(n):
        for q in range(p + 1):
            for c in range(8):
                work.shared[c] = 0.0
            one, other = model.joints[work.joint[p]], model.joints[work.joint[q]]
            for face in range(2):
                b = model.attachments[one.outboard if face == 0 else one.inboard].body
                halves = 3 if model.bodies[b].panel == RIGID_BODY else LOAD_HALVES
                for opposite in range(2):
                    if model.attachments[other.outboard if opposite == 0 else other.inboard].body == b:
                        add_shared(work, p, face, q, opposite, halves)
            for c in range(8):
                work.mobility[c, p, q] = work.mobility[c, q, p] = work.shared[c]
