"""Equations of the loads at the stages: torques, contact forces and reactions, each a row of Newton's matrix."""

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.joints.cable_loop import cable_torque
from solar_env.mechanics.joints.contact import friction_share, normal_force, sliding_share
from solar_env.mechanics.joints.torques import hinge_torques, torque_of_motion
from solar_env.mechanics.modal.arrays import (
    DEPTH,
    DEPTH_RATE,
    REACTION_X_ROW,
    SLIDING_SPEED,
    START,
    STRETCH,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.numerics.jit import kernel

# Least time [s] over which a gap of an ideal joint is closed; and over the speed that errors may have, the greatest
# speed of that, and by how much it changes in a step: faster, it would be felt as a blow, which no step is short enough
# for.
_RETURN_TIME, _RETURN_SPEED, _RETURN_CHANGE = 1e-3, 3.0, 0.1


@kernel(inlined=True)
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


@kernel(inlined=True)
def enter_row(work, s, n, r, by_value, by_rate, diagonal):
    """Enter a row of Newton's matrix: by what a residual changes with motion, and with the unknown itself."""
    row = work.matrix[s * n + r]
    for c in range(n):
        moved = work.mobility[r, c].response
        for k in range(2):
            row[k * n + c] = by_value * moved[4 * k + 2 * s] + by_rate * moved[4 * k + 2 * s + 1]
    row[s * n + r] += diagonal


@kernel(single_caller=True)
def torque_row(work, s, n, r, renewed):
    """Row of a torque: its residual, and its slopes in Newton's matrix where that is `renewed`."""
    load = work.loads[work.unknowns[r].number]
    work.correction[s * n + r] = load.law - load.stage[s]
    if renewed:
        enter_row(work, s, n, r, -load.by_value, -load.by_rate, 1.0)


@kernel(single_caller=True)
def contact_rows(model, state, work, s, n, r, renewed):
    """Rows of a contact's normal and tangential force, as of a torque."""
    j, first = work.unknowns[r].owner, work.unknowns[r].number
    joint, joint_state, motion = model.joints[j], state.joints[j], work.joints[j].motion[s]
    force, _, by_depth, by_rate = normal_force(joint, motion[DEPTH], motion[DEPTH_RATE], joint_state.impact_speed)
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
    normal_load = work.loads[first].stage[s]
    pressing = max(normal_load, 0.0)
    work.correction[s * n + r] = force - normal_load
    work.correction[s * n + r + 1] = share * pressing - work.loads[first + 1].stage[s]
    if renewed:
        # The motion that a normal force reads off is minus the depth.
        enter_row(work, s, n, r, by_depth, by_rate, 1.0)
        enter_row(work, s, n, r + 1, 0.0, -by_slip * pressing, 1.0)
        work.matrix[s * n + r + 1, s * n + r] -= share


@kernel(single_caller=True)
def reaction_row(work, s, n, r, h, renewed):
    """Row of a component of an ideal joint's reaction, as of a torque: of its relative velocity."""
    j, kind = work.unknowns[r].owner, work.unknowns[r].kind
    response = work.mobility[r, r].response
    scale = 1.0 / (abs(response[3]) + abs(response[7]))
    column = VELOCITY_X if kind == REACTION_X_ROW else VELOCITY_Y
    rate, before = work.joints[j].motion[s, column], -work.joints[j].motion[START, column]
    gap = work.joints[j].motion[START, ECCENTRICITY_X if kind == REACTION_X_ROW else ECCENTRICITY_Y]
    limit, change = _RETURN_SPEED * work.step[0].velocity_tolerance, _RETURN_CHANGE * work.step[0].velocity_tolerance
    back = min(max(gap / max(h, _RETURN_TIME), -limit), limit)
    back = min(max(back, before - change), before + change)
    work.correction[s * n + r] = -scale * (rate + back)
    if renewed:
        enter_row(work, s, n, r, 0.0, scale, 0.0)
