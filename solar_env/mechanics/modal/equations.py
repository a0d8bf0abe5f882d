"""Equations of joint and cable loads at a step's three stages: torques, contact forces, reactions; Newton's matrix.

A branch of a load's law is a range of motion with one smooth formula, such as contact or no contact.
"""

import numpy as np

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.joints.cable_loop import belt_loads, cable_torque
from solar_env.mechanics.joints.contact import depth_under, friction_share, normal_force, sliding_share
from solar_env.mechanics.joints.torques.hinge import hinge_torques, torque_of_motion
from solar_env.mechanics.modal.arrays import (
    DEPTH,
    DEPTH_RATE,
    LENGTH,
    NORMAL_ROW,
    REACTION_X_ROW,
    SLIDING_SPEED,
    STRETCH,
    TANGENTIAL_ROW,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.tables import COLUMNS, END_RATE, LANES, STAGES
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import load4, load8, lower_half, splat4, store4, upper_half, where_less

# Unit vectors: one in the lane of a stage.
_UNIT = np.array([[float(s == k) for s in range(LANES)] for k in range(STAGES)])
# Closing of a gap in an ideal joint: least time [s]; greatest speed, and greatest speed change in a step, both divided
# by the velocity tolerance. A faster closing would be an impact, too short for any step.
_RETURN_TIME, _RETURN_SPEED, _RETURN_CHANGE = 1e-3, 3.0, 0.1


@kernel
def enter_piece(load, piece):
    """Write `piece`, the branch of a load's law at each stage of a step, to `load.piece`.

    Branches are numbers of smooth parts, such as contact. Return a vector: 1 at stages with a change, else 0.
    """
    before = load4(load.piece, 0)
    store4(load.piece, 0, piece)
    return where_less(piece, before, 1.0, where_less(before, piece, 1.0, 0.0))


@kernel
def torque_laws(model, state, work):
    """Evaluate the laws of joint torques, and of torques and pulls of cable loops, at a step's stages.

    A pull is a loop's force between its wheels' centres. A load's record in `work.loads` gets its law's value (`law`),
    and derivatives by the motion on which the load does work, such as the joint angle, and by this motion's rate.
    Return a vector: for each stage, the number of joint torques that have moved to another smooth part of their law
    since the last call. Only torques that Newton's method solves for are counted.
    """
    changed = splat4(0.0)
    for j in range(model.joints.size):
        load, motion = work.loads[j], work.joints[j].motion
        torques = hinge_torques(model.joints[j], state.joints[j], load4(motion[ANGLE], 0), load4(motion[RATE], 0))
        store4(load.law, 0, torque_of_motion(torques))
        store4(load.by_value, 0, torques.by_angle)
        store4(load.by_rate, 0, torques.by_rate)
        if load.unknown:
            piece = where_less(0.0, torques.latch, 1.0, where_less(torques.latch, 0.0, 2.0, 0.0))
            changed = changed + enter_piece(load, piece)
    for c in range(model.cables.size):
        cable, load, motion = model.cables[c], work.loads[model.joints.size + c], work.cables[c].motion
        # The torque does work on minus the mismatch, a pull on minus the length.
        if cable.wheel_radius == 0.0:
            torque, slope, _ = cable_torque(cable, load4(motion[STRETCH], 0))
            store4(load.law, 0, torque)
            store4(load.by_value, 0, -slope)
        else:
            pull = work.loads[model.joints.size + model.cables.size + c]
            for s in range(LANES):
                torque, drawn, _, by_stretch, _, by_length = belt_loads(cable, motion[STRETCH, s], motion[LENGTH, s])
                load.law[s], load.by_value[s], pull.law[s], pull.by_value[s] = torque, -by_stretch, drawn, -by_length
    return changed


@kernel
def enter_row(work, r, load, diagonal):
    """Write row `r` of Newton's matrix to `work.matrix`: derivatives of (unknown load `r`) - (value of its law).

    Derivatives are taken with respect to the unknown loads that are solved together with load `r`. `load` is load `r`'s
    record, which has its law's slopes. `diagonal` is 1, or 0 for a reaction, whose equation is a constraint.
    """
    tangential = work.unknowns[r].kind == TANGENTIAL_ROW
    for c in range(work.unknowns[r].first, work.unknowns[r].end):
        moved, own = work.mobility[r, c].response, diagonal if c == r else 0.0
        by_load = -load4(load.by_normal, 0) if tangential and c == r - 1 else splat4(own)
        for k in range(STAGES):
            response = load8(moved, COLUMNS * k)
            change = load4(load.by_value, 0) * lower_half(response) + load4(load.by_rate, 0) * upper_half(response)
            store4(work.matrix[STAGES * c + k, r], 0, by_load * load4(_UNIT[k], 0) - change)


@kernel
def contact_law(joint, joint_state, scratch, normal, tangential):
    """Write a contact's normal force and friction at a step's stages to the load records `normal` and `tangential`.

    Also write derivatives there: of the normal force by depth and its rate, of friction by sliding velocity and normal
    force. `scratch` has the joint's motion and, to detect reversals, earlier sliding speeds. Return a vector: 1 at
    stages where the law is on another branch (smooth part) than at the last call, else 0.
    """
    motion, tried, speed_zero = scratch.motion, scratch.tried, joint_state.impact_speed
    depth, rate, speed = load4(motion[DEPTH], 0), load4(motion[DEPTH_RATE], 0), load4(motion[SLIDING_SPEED], 0)
    force, _, by_depth, by_rate = normal_force(joint, depth, rate, speed_zero)
    # A contact stiffer than its bodies has its law linearised at the depth that carries the load: a small change of
    # depth changes the force so much that the bodies yield by more than the change.
    stage, nothing = load4(normal.stage, 0), splat4(0.0)
    carrying, slope, carried_by_rate = depth_under(joint, stage, rate, speed_zero, load4(normal.give, 0))
    store4(normal.law, 0, where_less(nothing, carrying, stage + slope * (depth - carrying), force))
    # The normal force does work on minus the depth.
    store4(normal.by_value, 0, -where_less(nothing, carrying, slope, by_depth))
    store4(normal.by_rate, 0, -where_less(nothing, carrying, carried_by_rate, by_rate))
    share, by_slip = friction_share(joint, speed)
    backward = where_less(speed, nothing, speed, load4(tried[0], 0))
    forward = where_less(speed, nothing, load4(tried[1], 0), speed)
    store4(tried[0], 0, backward)
    store4(tried[1], 0, forward)
    other = where_less(speed, nothing, forward, backward)
    before, _ = friction_share(joint, other)
    # Where sliding has reversed between two iterations, friction's slope is the secant: it differs from both slopes.
    by_slip = where_less(speed * other, nothing, (share - before) / (speed - other), by_slip)
    pressing, by_normal = where_less(nothing, stage, stage, nothing), -joint.friction_coefficient * share
    store4(tangential.by_normal, 0, by_normal)
    store4(tangential.law, 0, by_normal * pressing)
    by_rate = -joint.friction_coefficient * by_slip * sliding_share(joint, depth) * pressing
    store4(tangential.by_rate, 0, by_rate)
    piece = where_less(nothing, depth, 1.0, nothing) + where_less(speed, nothing, 2.0, nothing)
    piece = piece + where_less(joint.friction_speed_zero, abs(speed), 4.0, nothing)
    return enter_piece(normal, piece + where_less(abs(speed), joint.friction_speed_full, nothing, 8.0))


@kernel
def contact_laws(model, state, work, n):
    """Write the forces of all contacts whose forces are among a step's `n` unknowns, with derivatives, to `work.loads`.

    Return a vector: for each stage, the number of contacts in another case (gap, sliding, ...) than at the last call.
    """
    changed = splat4(0.0)
    for r in range(n):
        if work.unknowns[r].kind == NORMAL_ROW:
            j, first = work.unknowns[r].owner, work.unknowns[r].number
            scratch, normal, tangential = work.joints[j], work.loads[first], work.loads[first + 1]
            changed = changed + contact_law(model.joints[j], state.joints[j], scratch, normal, tangential)
    return changed


@kernel
def reaction_law(state, work, r, h):
    """Write the equation of unknown `r`, a component of an ideal joint's reaction: its residual and derivatives.

    `work.residual[r]` is -(relative velocity + velocity that closes the initial gap) / (velocity that a unit reaction
    causes in the step `h` [s]). Derivatives by position and velocity go to the load's record in `work.loads`.
    """
    j, kind, response, gain = work.unknowns[r].owner, work.unknowns[r].kind, work.mobility[r, r].response, 0.0
    for k in range(STAGES):
        gain += abs(response[COLUMNS * k + END_RATE])
    scale, start = 1.0 / gain, state.motion[j]
    column = VELOCITY_X if kind == REACTION_X_ROW else VELOCITY_Y
    before, gap = -start[column], start[ECCENTRICITY_X if kind == REACTION_X_ROW else ECCENTRICITY_Y]
    limit, change = _RETURN_SPEED * work.step[0].velocity_tolerance, _RETURN_CHANGE * work.step[0].velocity_tolerance
    back = min(max(gap / max(h, _RETURN_TIME), -limit), limit)
    back = min(max(back, before - change), before + change)
    store4(work.residual[r], 0, -scale * (load4(work.joints[j].motion[column], 0) + back))
    load = work.loads[work.unknowns[r].number]
    store4(load.by_value, 0, splat4(0.0))
    store4(load.by_rate, 0, splat4(-scale))
