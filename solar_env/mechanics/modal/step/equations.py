"""Equations of the loads at the stages: torques, contact forces and reactions, each a row of Newton's matrix."""

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.joints.contact import friction_share, normal_force, sliding_share
from solar_env.mechanics.joints.torques import hinge_torques, torque_of_motion
from solar_env.mechanics.modal.arrays import (
    DEPTH,
    DEPTH_RATE,
    REACTION_X_ROW,
    SLIDING_SPEED,
    START,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.step.cables import fill_cable_torques
from solar_env.mechanics.numerics.jit import kernel

# Least time [s] over which a gap of an ideal joint is closed; and over the speed that errors may have, the greatest
# speed of that, and by how much it changes in a step: faster, it would be felt as a blow, which no step is short enough
# for.
_RETURN_TIME, _RETURN_SPEED, _RETURN_CHANGE = 1e-3, 3.0, 0.1


@kernel(inlined=True)
def fill_torques(model, state, work, s):
    """Torques of the laws at a stage, in place of the corrections' torque rows, with their slopes."""
    for j in range(model.joints.size):
        own, joint = work.joints[j], model.joints[j]
        torques = hinge_torques(joint, state.joints[j], own.motion[s, ANGLE], own.motion[s, RATE])
        own.torque = torque_of_motion(torques)
        own.torque_by_angle, own.torque_by_rate = torques.by_angle, torques.by_rate
    fill_cable_torques(model, work, s)


@kernel(inlined=True)
def torque_row(work, s, n, r, renewed):
    """Row of a joint's torque: its residual, and its slopes in Newton's matrix where that is `renewed`."""
    own = work.joints[work.unknowns[r].owner]
    work.correction[s * n + r] = own.torque - own.load[s, 2]
    if not renewed:
        return
    row = work.matrix[s * n + r]
    for c in range(n):
        moved = work.mobility[r, c].response
        for k in range(2):
            row[k * n + c] = -own.torque_by_angle * moved[4 * k + 2 * s] - own.torque_by_rate * moved[4 * k + 2 * s + 1]
    row[s * n + r] += 1.0


@kernel(inlined=True)
def contact_rows(model, state, work, s, n, r, renewed):
    """Rows of a contact's normal and tangential force, as of a torque."""
    j = work.unknowns[r].owner
    joint, own, motion, load = model.joints[j], state.joints[j], work.joints[j].motion[s], work.joints[j].load[s]
    force, _, by_depth, by_rate = normal_force(joint, motion[DEPTH], motion[DEPTH_RATE], own.impact_speed)
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
    pressing = max(load[0], 0.0)
    work.correction[s * n + r] = force - load[0]
    work.correction[s * n + r + 1] = share * pressing - load[1]
    if not renewed:
        return
    normal, tangential = work.matrix[s * n + r], work.matrix[s * n + r + 1]
    for c in range(n):
        # The motion that a normal force reads off is minus the depth.
        minus_depth, slip = work.mobility[r, c].response, work.mobility[r + 1, c].response
        for k in range(2):
            at = 4 * k + 2 * s
            normal[k * n + c] = by_depth * minus_depth[at] + by_rate * minus_depth[at + 1]
            tangential[k * n + c] = -by_slip * pressing * slip[at + 1]
    normal[s * n + r] += 1.0
    tangential[s * n + r + 1] += 1.0
    tangential[s * n + r] -= share


@kernel(inlined=True)
def reaction_row(work, s, n, r, h, renewed):
    """Row of a component of an ideal joint's reaction, as of a torque: of its relative velocity."""
    j, kind = work.unknowns[r].owner, work.unknowns[r].kind
    own = work.mobility[r, r].response
    scale = 1.0 / (abs(own[3]) + abs(own[7]))
    column = VELOCITY_X if kind == REACTION_X_ROW else VELOCITY_Y
    rate, before = work.joints[j].motion[s, column], -work.joints[j].motion[START, column]
    gap = work.joints[j].motion[START, ECCENTRICITY_X if kind == REACTION_X_ROW else ECCENTRICITY_Y]
    limit, change = _RETURN_SPEED * work.velocity_tolerance[0], _RETURN_CHANGE * work.velocity_tolerance[0]
    back = min(max(gap / max(h, _RETURN_TIME), -limit), limit)
    back = min(max(back, before - change), before + change)
    work.correction[s * n + r] = -scale * (rate + back)
    if not renewed:
        return
    row = work.matrix[s * n + r]
    for c in range(n):
        own = work.mobility[r, c].response
        for k in range(2):
            row[k * n + c] = scale * own[4 * k + 2 * s + 1]
