"""Equations of the loads at the stages: torques, contact forces and reactions, each a row of Newton's matrix."""

import numpy as np

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.joints.cable_loop import cable_torque
from solar_env.mechanics.joints.contact import depth_under, friction_share, normal_force, sliding_share
from solar_env.mechanics.joints.torques import hinge_torques, stop_depth, torque_of_motion
from solar_env.mechanics.modal.arrays import (
    DEPTH,
    DEPTH_RATE,
    REACTION_X_ROW,
    SLIDING_SPEED,
    STRETCH,
    TORQUE_ROW,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.tables import COLUMNS, END_RATE, LANES, LAST, STAGES
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import load4, load8, lower_half, splat4, store4, upper_half

# One in the lane of a stage.
_UNIT = np.array([[float(s == k) for s in range(LANES)] for k in range(STAGES)])
# Least time [s] over which a gap of an ideal joint is closed; and over the speed that errors may have, the greatest
# speed of that, and by how much it changes in a step: faster, it would be felt as a blow, which no step is short enough
# for.
_RETURN_TIME, _RETURN_SPEED, _RETURN_CHANGE = 1e-3, 3.0, 0.1


@kernel
def repeat_last(values):
    """Fill the lanes that have no stage with the last one."""
    for s in range(STAGES, LANES):
        values[s] = values[LAST]


@kernel
def fill_torques(model, state, work):
    """Torques of joints and cable loops by their laws at the stages, with their slopes."""
    for j in range(model.joints.size):
        load, motion = work.loads[j], work.joints[j].motion
        for s in range(STAGES):
            torques = hinge_torques(model.joints[j], state.joints[j], motion[ANGLE, s], motion[RATE, s])
            load.law[s] = torque_of_motion(torques)
            load.by_value[s], load.by_rate[s] = torques.by_angle, torques.by_rate
        repeat_last(load.law)
    for c in range(model.cables.size):
        load, motion = work.loads[model.joints.size + c], work.cables[c].motion
        for s in range(STAGES):
            load.law[s], slope, _ = cable_torque(model.cables[c], motion[STRETCH, s])
            # The motion that it works on is minus the mismatch.
            load.by_value[s], load.by_rate[s] = -slope, 0.0
        repeat_last(load.law)


@kernel
def enter_row(work, r, by_value, by_rate, diagonal):
    """Enter a row of Newton's matrix: by what residuals change with motion, and with the unknown itself."""
    for c in range(work.unknowns[r].first, work.unknowns[r].end):
        moved = work.mobility[r, c].response
        for k in range(STAGES):
            response = load8(moved, COLUMNS * k)
            change = by_value * lower_half(response) + by_rate * upper_half(response)
            if c == r:
                change = change + diagonal * load4(_UNIT[k], 0)
            store4(work.matrix[STAGES * c + k, r], 0, change)


@kernel
def torque_row(work, r, renewed):
    """Row of a torque: its residuals, and their slopes in Newton's matrix where that is `renewed`."""
    load = work.loads[work.unknowns[r].number]
    store4(work.residual[r], 0, load4(load.law, 0) - load4(load.stage, 0))
    if renewed:
        enter_row(work, r, -load4(load.by_value, 0), -load4(load.by_rate, 0), 1.0)


@kernel
def contact_law(joint, joint_state, motion, response, normal, tangential, tried):
    """Fill forces and slopes at the stages of a contact's two loads; the `response` is of its motion to the former."""
    for s in range(STAGES):
        depth, rate, speed = motion[DEPTH, s], motion[DEPTH_RATE, s], motion[SLIDING_SPEED, s]
        force, _, by_depth, by_rate = normal_force(joint, depth, rate, joint_state.impact_speed)
        # A contact that is stiffer than its bodies: its law is linearised at the depth that carries the load, for a
        # small change of that depth changes the force by more than itself.
        load = normal.stage[s]
        if load > 0.0:
            give = abs(response[COLUMNS * s + s])
            carrying, slope, elastic_by_rate = depth_under(joint, load, rate, joint_state.impact_speed, give)
            if carrying > 0.0:
                force, by_depth, by_rate = load + slope * (depth - carrying), slope, elastic_by_rate
        normal.law[s], normal.by_value[s], normal.by_rate[s] = force, by_depth, by_rate
        share, by_slip = friction_share(joint, speed)
        side = 0 if speed < 0.0 else 1
        tried[side, s] = speed
        other = tried[1 - side, s]
        if speed * other < 0.0:
            # Sliding has turned: between the two tries it was slower, and its friction changed by more than at either.
            before, _ = friction_share(joint, other)
            by_slip = (share - before) / (speed - other)
        by_slip *= sliding_share(joint, depth)
        pressing = max(normal.stage[s], 0.0)
        tangential.by_normal[s] = -joint.friction_coefficient * share
        tangential.law[s] = tangential.by_normal[s] * pressing
        tangential.by_rate[s] = -joint.friction_coefficient * by_slip * pressing
    repeat_last(normal.law)
    repeat_last(tangential.law)


@kernel
def contact_rows(model, state, work, r, renewed):
    """Rows of a contact's normal and tangential force, as of a torque."""
    j, first = work.unknowns[r].owner, work.unknowns[r].number
    normal, tangential, scratch = work.loads[first], work.loads[first + 1], work.joints[j]
    response = work.mobility[r, r].response
    contact_law(model.joints[j], state.joints[j], scratch.motion, response, normal, tangential, scratch.tried)
    store4(work.residual[r], 0, load4(normal.law, 0) - load4(normal.stage, 0))
    store4(work.residual[r + 1], 0, load4(tangential.law, 0) - load4(tangential.stage, 0))
    if renewed:
        # The motion that a normal force reads off is minus the depth.
        enter_row(work, r, load4(normal.by_value, 0), load4(normal.by_rate, 0), 1.0)
        enter_row(work, r + 1, splat4(0.0), -load4(tangential.by_rate, 0), 1.0)
        by_normal = load4(tangential.by_normal, 0)
        for k in range(STAGES):
            row = work.matrix[STAGES * r + k, r + 1]
            store4(row, 0, load4(row, 0) - by_normal * load4(_UNIT[k], 0))


@kernel
def piece_of_law(joint, joint_state, motion, kind, s):
    """Number, below 31, of the piece of its law in which a torque or a contact is at a stage."""
    if kind == TORQUE_ROW:
        depth, direction = stop_depth(joint, joint_state.latched, motion[ANGLE, s])
        return 0 if depth <= 0.0 else (1 if direction > 0.0 else 2)
    speed = abs(motion[SLIDING_SPEED, s])
    piece = (1 if motion[DEPTH, s] > 0.0 else 0) + (2 if motion[SLIDING_SPEED, s] < 0.0 else 0)
    return piece + (4 if speed > joint.friction_speed_zero else 0) + (8 if speed >= joint.friction_speed_full else 0)


@kernel
def reaction_row(state, work, r, h, renewed):
    """Row of a component of an ideal joint's reaction, as of a torque: of its relative velocity."""
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
    if renewed:
        enter_row(work, r, splat4(0.0), splat4(scale), 0.0)
