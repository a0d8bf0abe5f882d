"""Equations of the loads at the stages: torques, contact forces and reactions, each a row of Newton's matrix."""

from solar_env.mechanics.joints.contact.normal_force import normal_force
from solar_env.mechanics.joints.friction.friction_share import friction_share
from solar_env.mechanics.joints.joint import cable_torque, stop_torque
from solar_env.mechanics.modal.arrays import (
    ANGLE,
    DEPTH,
    DEPTH_RATE,
    ECCENTRICITY_X,
    ECCENTRICITY_Y,
    RATE,
    REACTION_X,
    SLIDING_SPEED,
    START,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.numerics.jit import kernel

# Least time [s] over which a gap of an ideal joint is closed: at once, it would be felt as a blow.
_RETURN_TIME = 1e-3


@kernel(inlined=True)
def cable_stretch(cable, joints, slot):
    """Wheel-angle mismatch [rad] of a cable loop at a slot of the joints' scratch."""
    return cable.wheel_ratio * joints[cable.joint_a].motion[slot, ANGLE] - joints[cable.joint_b].motion[slot, ANGLE]


@kernel(inlined=True)
def fill_torques(model, state, work, s):
    """Torques of the laws at a stage, in place of the corrections' torque rows, with their slopes by angle and rate."""
    joints = model.joints.size
    for j in range(joints):
        motion = work.joints[j].motion[s]
        joint, angle = model.joints[j], motion[ANGLE]
        stop, _, by_angle, by_rate = stop_torque(joint, state.joints[j], angle, motion[RATE])
        torque = joint.spring_stiffness * (joint.spring_preload_angle - angle) + stop
        for i in range(joints):
            work.torque_slope[j, i] = 0.0
        work.torque_slope[j, j] = by_angle - joint.spring_stiffness
        work.joints[j].torque, work.joints[j].torque_by_rate = torque, by_rate
    for c in range(model.cables.size):
        cable = model.cables[c]
        a, b, ratio = cable.joint_a, cable.joint_b, cable.wheel_ratio
        torque, slope, _ = cable_torque(cable, cable_stretch(cable, work.joints, s))
        work.joints[a].torque -= cable.torque_ratio * torque
        work.joints[b].torque += torque
        work.torque_slope[a, a] -= cable.torque_ratio * slope * ratio
        work.torque_slope[a, b] += cable.torque_ratio * slope
        work.torque_slope[b, a] += slope * ratio
        work.torque_slope[b, b] -= slope


@kernel(inlined=True)
def torque_row(model, work, s, n, r, renewed):
    """Row of a joint's torque: its residual, and its slopes in Newton's matrix where that is `renewed`."""
    j = work.unknowns[r].joint
    work.correction[s * n + r] = work.joints[j].torque - work.joints[j].load[s, 2]
    if not renewed:
        return
    row, by_rate = work.matrix[s * n + r], work.joints[j].torque_by_rate
    for c in range(n):
        own = work.mobility[r, c].response
        for k in range(2):
            row[k * n + c] = -by_rate * own[4 * k + 2 * s + 1]
    for i in range(model.joints.size):
        slope, other = work.torque_slope[j, i], work.joints[i].torque_unknown
        if slope != 0.0 and other >= 0:
            for c in range(n):
                own = work.mobility[other, c].response
                for k in range(2):
                    row[k * n + c] -= slope * own[4 * k + 2 * s]
    row[s * n + r] += 1.0


@kernel(inlined=True)
def contact_rows(model, state, work, s, n, r, renewed):
    """Rows of a contact's normal and tangential force, as of a torque."""
    j = work.unknowns[r].joint
    joint, own, motion, load = model.joints[j], state.joints[j], work.joints[j].motion[s], work.joints[j].load[s]
    force, _, by_depth, by_rate = normal_force(joint, motion[DEPTH], motion[DEPTH_RATE], own.impact_speed)
    share, by_slip = friction_share(joint, motion[SLIDING_SPEED])
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
    j, kind = work.unknowns[r].joint, work.unknowns[r].kind
    own = work.mobility[r, r].response
    scale = 1.0 / (abs(own[3]) + abs(own[7]))
    rate = work.joints[j].motion[s, VELOCITY_X if kind == REACTION_X else VELOCITY_Y]
    gap = work.joints[j].motion[START, ECCENTRICITY_X if kind == REACTION_X else ECCENTRICITY_Y]
    work.correction[s * n + r] = -scale * (rate + gap / max(h, _RETURN_TIME))
    if not renewed:
        return
    row = work.matrix[s * n + r]
    for c in range(n):
        own = work.mobility[r, c].response
        for k in range(2):
            row[k * n + c] = scale * own[4 * k + 2 * s + 1]
