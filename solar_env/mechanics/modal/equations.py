"""Equations of the loads at the stages: torques, contact forces and reactions, each a row of Newton's matrix."""

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.joints.cable_loop import cable_torque
from solar_env.mechanics.joints.contact import depth_under, friction_share, normal_force, sliding_share
from solar_env.mechanics.joints.torques import hinge_torques, stop_depth, torque_of_motion
from solar_env.mechanics.modal.arrays import (
    DEPTH,
    DEPTH_RATE,
    REACTION_X_ROW,
    SLIDING_SPEED,
    START,
    STRETCH,
    TORQUE_ROW,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.tables import COLUMNS, END_RATE, LANES, STAGES
from solar_env.mechanics.numerics.jit import kernel

# Least time [s] over which a gap of an ideal joint is closed; and over the speed that errors may have, the greatest
# speed of that, and by how much it changes in a step: faster, it would be felt as a blow, which no step is short enough
# for.
_RETURN_TIME, _RETURN_SPEED, _RETURN_CHANGE = 1e-3, 3.0, 0.1


@kernel
def fill_torques(model, state, work, s):
    """Torques of joints and cable loops by their laws at a slot, with their slopes."""
    for j in range(model.joints.size):
        load, motion = work.loads[j], work.joints[j].motion[s]
        torques = hinge_torques(model.joints[j], state.joints[j], motion[ANGLE], motion[RATE])
        load.law = torque_of_motion(torques)
        load.by_value, load.by_rate = torques.by_angle, torques.by_rate
    for c in range(model.cables.size):
        load = work.loads[model.joints.size + c]
        load.law, slope, _ = cable_torque(model.cables[c], work.cables[c].motion[s, STRETCH])
        # The motion that it works on is minus the mismatch.
        load.by_value, load.by_rate = -slope, 0.0


@kernel
def enter_row(work, s, n, r, by_value, by_rate, diagonal):
    """Enter a row of Newton's matrix: by what a residual changes with motion, and with the unknown itself."""
    row = work.matrix[s * n + r]
    for c in range(n):
        moved = work.mobility[r, c].response
        for k in range(STAGES):
            row[k * n + c] = by_value * moved[COLUMNS * k + s] + by_rate * moved[COLUMNS * k + LANES + s]
    row[s * n + r] += diagonal


@kernel
def torque_row(work, s, n, r, renewed):
    """Row of a torque: its residual, and its slopes in Newton's matrix where that is `renewed`."""
    load = work.loads[work.unknowns[r].number]
    work.correction[s * n + r] = load.law - load.stage[s]
    if renewed:
        enter_row(work, s, n, r, -load.by_value, -load.by_rate, 1.0)


@kernel
def contact_rows(model, state, work, s, n, r, renewed):
    """Rows of a contact's normal and tangential force, as of a torque."""
    j, first = work.unknowns[r].owner, work.unknowns[r].number
    joint, own, motion = model.joints[j], state.joints[j], work.joints[j].motion[s]
    normal_load = work.loads[first].stage[s]
    force, _, by_depth, by_rate = normal_force(joint, motion[DEPTH], motion[DEPTH_RATE], own.impact_speed)
    # A stiff contact's depth answers its load by more than the law asks for: the law is then linearised at the depth
    # that carries the load, not at the one that it has brought about.
    if normal_load > 0.0:
        depth, slope, elastic_by_rate = depth_under(joint, normal_load, motion[DEPTH_RATE], own.impact_speed)
        if slope * abs(work.mobility[r, r].response[COLUMNS * s + s]) > 1.0:
            force, by_depth, by_rate = normal_load + slope * (motion[DEPTH] - depth), slope, elastic_by_rate
    share, by_slip = friction_share(joint, motion[SLIDING_SPEED])
    speed, tried = motion[SLIDING_SPEED], work.joints[j].tried[s]
    tried[0 if speed < 0.0 else 1] = speed
    if tried[0] * tried[1] < 0.0:
        # Sliding has turned: between the two tries it was slower, and its friction changed by more than at either.
        other = tried[1 if speed < 0.0 else 0]
        before, _ = friction_share(joint, other)
        by_slip = (share - before) / (speed - other)
    by_slip *= sliding_share(joint, motion[DEPTH])
    share, by_slip = -joint.friction_coefficient * share, -joint.friction_coefficient * by_slip
    pressing = max(normal_load, 0.0)
    work.correction[s * n + r] = force - normal_load
    work.correction[s * n + r + 1] = share * pressing - work.loads[first + 1].stage[s]
    if renewed:
        # The motion that a normal force reads off is minus the depth.
        enter_row(work, s, n, r, by_depth, by_rate, 1.0)
        enter_row(work, s, n, r + 1, 0.0, -by_slip * pressing, 1.0)
        work.matrix[s * n + r + 1, s * n + r] -= share


@kernel
def piece_of_law(joint, joint_state, motion, kind):
    """Number, below 31, of the piece of its law in which a torque or a contact is."""
    if kind == TORQUE_ROW:
        depth, direction = stop_depth(joint, joint_state.latched, motion[ANGLE])
        return 0 if depth <= 0.0 else (1 if direction > 0.0 else 2)
    speed = abs(motion[SLIDING_SPEED])
    piece = (1 if motion[DEPTH] > 0.0 else 0) + (2 if motion[SLIDING_SPEED] < 0.0 else 0)
    return piece + (4 if speed > joint.friction_speed_zero else 0) + (8 if speed >= joint.friction_speed_full else 0)


@kernel
def reaction_row(work, s, n, r, h, renewed):
    """Row of a component of an ideal joint's reaction, as of a torque: of its relative velocity."""
    j, kind = work.unknowns[r].owner, work.unknowns[r].kind
    own = work.mobility[r, r].response
    gain = 0.0
    for k in range(STAGES):
        gain += abs(own[COLUMNS * k + END_RATE])
    scale = 1.0 / gain
    column = VELOCITY_X if kind == REACTION_X_ROW else VELOCITY_Y
    rate, before = work.joints[j].motion[s, column], -work.joints[j].motion[START, column]
    gap = work.joints[j].motion[START, ECCENTRICITY_X if kind == REACTION_X_ROW else ECCENTRICITY_Y]
    limit, change = _RETURN_SPEED * work.step[0].velocity_tolerance, _RETURN_CHANGE * work.step[0].velocity_tolerance
    back = min(max(gap / max(h, _RETURN_TIME), -limit), limit)
    back = min(max(back, before - change), before + change)
    work.correction[s * n + r] = -scale * (rate + back)
    if renewed:
        enter_row(work, s, n, r, 0.0, scale, 0.0)
