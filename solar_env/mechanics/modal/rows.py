"""Unknown loads of a step, and how the joints' motion at both stages answers them.

A unit of an unknown loads the two bodies of its joint. By reciprocity, the same row of loads reads off the motion that
the unknown works on: a joint angle, minus a depth, a sliding speed, a component of the relative velocity.
"""

from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.modal.arrays import (
    LEVER,
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
from solar_env.mechanics.numerics.jit import kernel

# Change of a torque by the motion that it causes, over itself, that converges at once without Newton's matrix.
_SOFT = 0.05


@kernel(inlined=True)
def angle_by_torque(model, tables, level, h, j):
    """Greatest change [rad] of a joint's angle by a unit of its torque over a step."""
    joint, total = model.joints[j], 0.0
    for side in range(2):
        attachment = model.attachments[joint.outboard if side == 0 else joint.inboard]
        body, i = model.bodies[attachment.body], 2 * attachment.end + 1
        total += 0.5 * h * h * body.inverse_inertia
        if body.panel != RIGID_BODY:
            response = tables.bending_response[body.design, level, i, i]
            total += abs(response[2]) + abs(response[6])
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
        for side in range(2):
            number = model.joints[j].outboard if side == 0 else model.joints[j].inboard
            b = model.attachments[number].body
            c, s = work.turn[SECOND, b, 0], work.turn[SECOND, b, 1]
            sign = 1.0 if side == 0 else -1.0
            along, across = sign * (c * fx + s * fy), sign * (c * fy - s * fx)
            torque = outboard if side == 0 else inboard
            row = work.row_load[r, side]
            row[0], row[1], row[2] = along, across, torque
            row[3] = torque + work.local[SECOND, number, 0] * across - work.local[SECOND, number, 1] * along


@kernel(inlined=True)
def add_shared(body, first_end, second_end, first, second, rigid, bending, axial, out):
    """Add what unit loads `second` at one attachment of a body do to the motion read off by `first` at another."""
    share = (first[0] * second[0] + first[1] * second[1]) * body.inverse_mass
    share += first[3] * second[3] * body.inverse_inertia
    for c in range(8):
        out[c] += share * rigid[c]
    if body.panel != RIGID_BODY:
        i, j = 2 * first_end, 2 * second_end
        ww, wt, tw, tt = bending[i, j], bending[i, j + 1], bending[i + 1, j], bending[i + 1, j + 1]
        uu = axial[first_end, second_end]
        for c in range(8):
            out[c] += (
                first[1] * (ww[c] * second[1] + wt[c] * second[2])
                + first[2] * (tw[c] * second[1] + tt[c] * second[2])
                + first[0] * uu[c] * second[0]
            )


@kernel(inlined=True)
def fill_mobility(model, work, tables, level, h, n):
    """Motion that each unknown works on by a unit of each other, at both stages."""
    fill_row_loads(model, work, n)
    for s in range(2):
        for k in range(2):
            work.rigid[4 * k + 2 * s], work.rigid[4 * k + 2 * s + 1] = h * h * B[s][k], h * A[s][k]
    for p in range(n):
        for q in range(p + 1):
            out = work.mobility[p, q]
            for c in range(8):
                out[c] = 0.0
            one, other = model.joints[work.joint[p]], model.joints[work.joint[q]]
            for side in range(2):
                first = model.attachments[one.outboard if side == 0 else one.inboard]
                for opposite in range(2):
                    second = model.attachments[other.outboard if opposite == 0 else other.inboard]
                    if first.body == second.body:
                        body = model.bodies[first.body]
                        d = max(body.design, 0)
                        add_shared(
                            body,
                            first.end,
                            second.end,
                            work.row_load[p, side],
                            work.row_load[q, opposite],
                            work.rigid,
                            tables.bending_response[d, level],
                            tables.axial_response[d, level],
                            out,
                        )
            if p != q:
                for c in range(8):
                    work.mobility[q, p, c] = out[c]
