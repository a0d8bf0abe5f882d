"""Unknown loads of a step by the three-stage Radau IIA method, and their mobility, the motion caused by unit loads.

An unknown exerts forces and moments on the bodies of its joint or cable loop. It does work on a joint angle, negative
penetration depth, sliding speed or relative velocity. This motion is the sum of the bodies' motions times forces and
moments of a unit load. The mobility is this motion at the three stages, per unit of the same or another unknown.
"""

import math

from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.joints.torques.hinge import may_be_stiff
from solar_env.mechanics.modal.arrays import (
    ACROSS_X,
    ACROSS_Y,
    CABLE_ROW,
    FACES,
    LENGTH,
    LEVER,
    NORMAL_ROW,
    NORMAL_X,
    NORMAL_Y,
    PULL_ROW,
    REACTION_X_ROW,
    REACTION_Y_ROW,
    RIGID_BODY,
    TANGENTIAL_ROW,
    TORQUE_ROW,
)
from solar_env.mechanics.modal.motion import (
    PLACE_BY_LOAD,
    VELOCITY_BY_LOAD,
    cable_attachment,
    face_load,
    force_of,
    outboard_load,
)
from solar_env.mechanics.modal.tables import (
    ACROSS_ACROSS,
    ACROSS_TURNING,
    ALONG_ALONG,
    COLUMNS,
    END_RATE,
    END_VALUE,
    LANES,
    LAST,
    STAGES,
    TURNING_TURNING,
    side,
)
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.vectors import joined, load4, load8, splat8, store8

_SOFT = 0.05  # greatest relative change of a torque by its own motion at which iterations need no Newton matrix
# Velocity error by a load's deviation from its polynomial at the start of a step, divided by the velocity that a
# constant load of that size causes: at the stages the polynomial is exact, and its integral is of higher order.
DEVIATION = 1.0 / 12.0
_LEAST_RATIO = 1e-3  # least torque ratio of a cable loop in the tolerance for the inner wheel
_APART = 5e-4  # s, step below which Newton's matrix leaves out the effect of a joint's loads on other joints


@kernel
def effect_of_torque(model, tables, level, h, j):
    """Return upper bounds of the rotation [rad] and velocity [m/s] that a unit torque on joint `j` causes in a step.

    The torque is constant in the step `h` [s]. It changes the joint angle by the rotation, and moves the joint's points
    on its two bodies apart at the velocity. `tables` hold, at the step size's `level`, panel motion per unit load.
    """
    joint, angle, velocity = model.joints[j], 0.0, 0.0
    for face in range(2):
        attachment = model.attachments[joint.outboard if face == 0 else joint.inboard]
        body = model.bodies[attachment.body]
        angle += 0.5 * h * h * body.inverse_inertia
        velocity += math.hypot(attachment.x, attachment.y) * body.inverse_inertia * h
        if body.panel != RIGID_BODY:
            response, turned, moved = tables.responses[body.design, level].ends[0], 0.0, 0.0
            for k in range(STAGES):
                turned += abs(response[TURNING_TURNING, COLUMNS * k + END_VALUE])
                moved += response[ACROSS_TURNING, COLUMNS * k + END_RATE]
            angle += turned
            velocity += abs(moved)
    return angle, velocity


@kernel
def list_unknown(model, work, r, kind, j, number):
    """Enter load `number` of joint `j` in `work.unknowns` as unknown `r` of type `kind`; return the next index."""
    unknown, joint = work.unknowns[r], model.joints[j]
    unknown.kind, unknown.owner, unknown.number, unknown.faces = kind, j, number, 2
    unknown.attachment[0], unknown.attachment[1] = joint.outboard, joint.inboard
    return r + 1


@kernel
def list_loop(model, work, r, kind, c, number):
    """Enter load `number` of cable loop `c` in `work.unknowns` as unknown `r` of type `kind`; return the next index."""
    unknown = work.unknowns[r]
    unknown.kind, unknown.owner, unknown.number, unknown.faces = kind, c, number, FACES
    for face in range(FACES):
        unknown.attachment[face] = cable_attachment(model, model.cables[c], face)
    return r + 1


@kernel
def list_rows(model, state, work, tables, level, h):
    """List the unknown loads of a step `h` [s] in `work.unknowns`, a record for each, and return their number.

    Forces are unknowns: reactions, contact forces and pulls of cable loops. A torque is an unknown if an engaged stop,
    a damper or dry friction contributes, or if the rotation that it causes in the step changes the torque by over 5 %.
    Every iteration evaluates the other torques from the motion. The tolerances [N m] of all torques are written to
    their records in `work.loads`. `tables` hold, at index `level`, the panel modes' responses to the step.
    """
    n = 0
    for j in range(model.joints.size):
        joint, torque, force = model.joints[j], work.loads[j], force_of(model, j)
        give, moved = effect_of_torque(model, tables, level, h, j)
        work.joints[j].angle_by_torque, torque.tolerance = give, work.step[0].velocity_tolerance / (DEVIATION * moved)
        torque.unknown = may_be_stiff(joint, state.joints[j]) or joint.known_stiffness * give > _SOFT
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
            n = list_loop(model, work, n, CABLE_ROW, c, model.joints.size + c)
        if cable.wheel_radius > 0.0:
            n = list_loop(model, work, n, PULL_ROW, c, model.joints.size + model.cables.size + c)
    mark_blocks(work, n, h)
    return n


@kernel
def mark_blocks(work, n, h):
    """Divide the `n` unknown loads of a step of size `h` [s] into diagonal blocks of Newton's matrix.

    Every unknown's record in `work.unknowns` gets the index `first` of its block's first unknown, and the index `end`
    after the last one. Each joint has its own block if `h` < 0.5 ms and no unknown is a cable loop's load or an ideal
    joint's reaction; otherwise all unknowns share one block.
    """
    apart = h < _APART
    for r in range(n):
        apart = apart and work.unknowns[r].faces < FACES and work.unknowns[r].kind < REACTION_X_ROW
    first = 0
    for r in range(n):
        if apart and work.unknowns[r].owner != work.unknowns[first].owner:
            first = r
        work.unknowns[r].first = first
    end = n
    for up in range(n):
        r = n - 1 - up
        work.unknowns[r].end = end
        if work.unknowns[r].first == r:
            end = r


@kernel
def enter_load(model, work, number, fx, fy, torque, load):
    """Write a force (fx, fy), in inertial axes, and a torque on attachment `number` of a body to `load` (4,).

    Elements 0 and 1 are the force's components along and across the body, with the body's angle at the step's end.
    Element 2 is the torque, element 3 the moment of force and torque about the body's centre of mass.
    """
    turn, local = work.bodies[model.attachments[number].body].turn, work.attachments[number].local
    c, s = turn[0, LAST], turn[1, LAST]
    along, across = c * fx + s * fy, c * fy - s * fx
    load[0], load[1], load[2] = along, across, torque
    load[3] = torque + local[0, LAST] * across - local[1, LAST] * along


@kernel
def fill_unit_loads(model, work, n):
    """Write the loads that a unit of each of the `n` unknowns exerts on bodies, at the step's end, to `work.unknowns`.

    In an unknown's record, `load` (4, 4) has a row for each point at which the unknown acts on a body. Its columns are
    force along and across the body, torque at the point, and the moment of both about the body's centre of mass. The
    array `reading` (4, 4) has weights, by which the bodies' displacements and rotations add up to the motion on which
    the unknown does work. They equal `load` except in cable loops that do not conserve energy.
    """
    for r in range(n):
        unknown = work.unknowns[r]
        if unknown.faces == FACES:
            cable, motion = model.cables[unknown.owner], work.cables[unknown.owner].motion
            x, y, length = motion[ACROSS_X, LAST], motion[ACROSS_Y, LAST], motion[LENGTH, LAST]
            unit, pull = (1.0, 0.0) if unknown.kind == CABLE_ROW else (0.0, 1.0)
            for face in range(FACES):
                fx, fy, torque = face_load(model, cable, x, y, length, face, unit, pull, cable.torque_ratio)
                enter_load(model, work, unknown.attachment[face], fx, fy, torque, unknown.load[face])
                fx, fy, torque = face_load(model, cable, x, y, length, face, unit, pull, cable.wheel_ratio)
                enter_load(model, work, unknown.attachment[face], fx, fy, torque, unknown.reading[face])
        else:
            first = 1.0 if unknown.kind in (NORMAL_ROW, REACTION_X_ROW) else 0.0
            second = 1.0 if unknown.kind in (TANGENTIAL_ROW, REACTION_Y_ROW) else 0.0
            torque = 1.0 if unknown.kind == TORQUE_ROW else 0.0
            joint, motion = model.joints[unknown.owner], work.joints[unknown.owner].motion
            nx, ny, lever = motion[NORMAL_X, LAST], motion[NORMAL_Y, LAST], motion[LEVER, LAST]
            fx, fy, outboard, inboard = outboard_load(joint, nx, ny, lever, first, second, torque)
            for face in range(2):
                sign, torque = (1.0, outboard) if face == 0 else (-1.0, inboard)
                enter_load(model, work, unknown.attachment[face], sign * fx, sign * fy, torque, unknown.load[face])
                copy_into(unknown.reading[face], unknown.load[face])


@kernel
def add_scaled(sums, gain, motion):
    """Return the tuple `sums` of three vectors (8,), plus `gain` times the successive thirds of `motion` (24,).

    The first vector and the first third belong to a unit load at the first of a step's three stages, and so on. Each is
    the motion that this load causes: its values at the three stages, the third one repeated, then its rates alike.
    """
    first, second, third = sums
    first, second = first + gain * load8(motion, 0), second + gain * load8(motion, COLUMNS)
    return first, second, third + gain * load8(motion, 2 * COLUMNS)


@kernel
def add_shared(work, model, tables, level, number, reading, other, opposite, sums):
    """Return `sums` plus the motion of one body that a second unknown load causes and on which a first one does work.

    Args:
        number: index in `model.attachments` of the point at which the first load acts on the body.
        reading: (4,) weights by which the body's displacements (along, across) and rotations (elastic at the point, of
            the whole body) enter the motion on which the first load does work.
        other: record of the second load in `work.unknowns`.
        opposite: index, in `other.attachment`, of a point at which the second load acts on the same body.
        sums: three vectors (8,), for a unit of the second load at the first, second and third stage. Each has the
            motion's values at the three stages, the third one repeated, then the rates alike.
        tables, level: panel modes' responses, and the step size's index in them.
    """
    attachment, loaded = model.attachments[number], model.attachments[other.attachment[opposite]]
    body, load = model.bodies[attachment.body], other.load[opposite]
    along, across = reading[0] * load[0], reading[1] * load[1]
    rigid = (along + across) * body.inverse_mass + reading[3] * load[3] * body.inverse_inertia
    sums = add_scaled(sums, rigid, work.rigid)
    if body.panel != RIGID_BODY:
        apart = int(attachment.end != loaded.end)
        motion = tables.responses[body.design, level].ends[apart]
        turned = reading[1] * load[2] + side(apart) * reading[2] * load[1]
        sums = add_scaled(sums, along, motion[ALONG_ALONG])
        sums = add_scaled(sums, across, motion[ACROSS_ACROSS])
        sums = add_scaled(sums, side(loaded.end) * turned, motion[ACROSS_TURNING])
        sums = add_scaled(sums, reading[2] * load[2], motion[TURNING_TURNING])
    return sums


@kernel
def share_motion(model, work, tables, level, p, q, mutual):
    """Write the motion on which unknown load `p` does work, caused by a unit of load `q`, to `work.mobility[p, q]`.

    Both are indices into `work.unknowns`. `work.mobility[p, q].response` (24,) gets eight numbers for a unit of load
    `q` at the first stage, then for units at the second and third stage. They are the motion's values at the three
    stages, the third one repeated, then its rates alike. If `mutual`, they are also copied to [q, p]. Only bodies on
    which both loads act contribute. `tables` hold, at the step size's index `level`, the panel modes' responses.
    """
    one, other, nothing = work.unknowns[p], work.unknowns[q], splat8(0.0)
    sums = nothing, nothing, nothing
    for face in range(one.faces):
        number, reading = one.attachment[face], one.reading[face]
        for opposite in range(other.faces):
            if model.attachments[other.attachment[opposite]].body == model.attachments[number].body:
                sums = add_shared(work, model, tables, level, number, reading, other, opposite, sums)
    response, reverse = work.mobility[p, q].response, work.mobility[q, p].response
    for k in range(STAGES):
        store8(response, COLUMNS * k, sums[k])
        if mutual:
            store8(reverse, COLUMNS * k, sums[k])


@kernel
def fill_mobility(model, work, tables, level, h, n):
    """Compute the mobility of the `n` unknown loads in a step `h` [s], and write it to `work.mobility`.

    Entry [p, q] is the motion on which load p does work, such as a joint angle, due to a unit of load q. Its `response`
    (24,) has eight numbers for a unit of load q at the first stage only, then for units at the second and third stage:
    the values at the three stages, the third one repeated, then the rates alike. Entries for loads in different blocks
    of Newton's matrix are left as they are. `tables` hold the modes' motion per unit load, at the step size's `level`.
    """
    fill_unit_loads(model, work, n)
    for k in range(STAGES):
        store8(work.rigid, COLUMNS * k, joined(h * h * load4(PLACE_BY_LOAD[k], 0), h * load4(VELOCITY_BY_LOAD[k], 0)))
    for p in range(n):
        for q in range(work.unknowns[p].first, work.unknowns[p].end):
            # The mobility of a cable loop that does not conserve energy is not symmetric.
            mutual = work.unknowns[p].faces < FACES and work.unknowns[q].faces < FACES
            if q <= p or not mutual:
                share_motion(model, work, tables, level, p, q, mutual)
        if work.unknowns[p].kind == NORMAL_ROW:
            for s in range(LANES):
                stage = min(s, LAST)
                work.loads[work.unknowns[p].number].give[s] = abs(work.mobility[p, p].response[COLUMNS * stage + stage])
