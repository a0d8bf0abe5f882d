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
def fill_torques(model, state, work, s):
    """Torques of the laws at a stage, in place of the corrections' torque rows, with their slopes by angle and rate."""
    joints = model.joints.size
    for j in range(joints):
        motion = work.motion[s, j]
        joint, angle = model.joints[j], motion[ANGLE]
        stop, _, by_angle, by_rate = stop_torque(joint, state.joints[j], angle, motion[RATE])
        torque = joint.spring_stiffness * (joint.spring_preload_angle - angle) + stop
        for i in range(joints):
            work.torque_slope[j, i] = 0.0
        work.torque_slope[j, j] = by_angle - joint.spring_stiffness
        work.torque[j, 0], work.torque[j, 1] = torque, by_rate
    for c in range(model.cables.size):
        cable = model.cables[c]
        a, b, ratio = cable.joint_a, cable.joint_b, cable.wheel_ratio
        torque, slope, _ = cable_torque(cable, ratio * work.motion[s, a, ANGLE] - work.motion[s, b, ANGLE])
        work.torque[a, 0] -= cable.torque_ratio * torque
        work.torque[b, 0] += torque
        work.torque_slope[a, a] -= cable.torque_ratio * slope * ratio
        work.torque_slope[a, b] += cable.torque_ratio * slope
        work.torque_slope[b, a] += slope * ratio
        work.torque_slope[b, b] -= slope


@kernel(inlined=True)
def torque_row(model, work, s, n, r, renewed):
    """Row of a joint's torque: its residual, and its slopes in Newton's matrix where that is `renewed`."""
    j = work.joint[r]
    work.correction[s * n + r] = work.torque[j, 0] - work.load[s, j, 2]
    if not renewed:
        return
    row = work.matrix[s * n + r]
    for k in range(2):
        for c in range(n):
            row[k * n + c] = -work.torque[j, 1] * work.mobility[4 * k + 2 * s + 1, r, c]
        for i in range(model.joints.size):
            slope = work.torque_slope[j, i]
            if slope != 0.0 and work.torque_row[i] >= 0:
                for c in range(n):
                    row[k * n + c] -= slope * work.mobility[4 * k + 2 * s, work.torque_row[i], c]
    row[s * n + r] += 1.0


@kernel(inlined=True)
def contact_rows(model, state, work, s, n, r, renewed):
    """Rows of a contact's normal and tangential force, as of a torque."""
    j = work.joint[r]
    joint, own, motion, load = model.joints[j], state.joints[j], work.motion[s, j], work.load[s, j]
    force, _, by_depth, by_rate = normal_force(joint, motion[DEPTH], motion[DEPTH_RATE], own.impact_speed)
    share, by_slip = friction_share(joint, motion[SLIDING_SPEED])
    share, by_slip = -joint.friction_coefficient * share, -joint.friction_coefficient * by_slip
    pressing = max(load[0], 0.0)
    work.correction[s * n + r] = force - load[0]
    work.correction[s * n + r + 1] = share * pressing - load[1]
    if not renewed:
        return
    normal, tangential = work.matrix[s * n + r], work.matrix[s * n + r + 1]
    for k in range(2):
        for c in range(n):
            at = 4 * k + 2 * s
            # The motion that a normal force reads off is minus the depth.
            normal[k * n + c] = by_depth * work.mobility[at, r, c] + by_rate * work.mobility[at + 1, r, c]
            tangential[k * n + c] = -by_slip * pressing * work.mobility[at + 1, r + 1, c]
    normal[s * n + r] += 1.0
    tangential[s * n + r + 1] += 1.0
    tangential[s * n + r] -= share


@kernel(inlined=True)
def reaction_row(work, s, n, r, h, renewed):
    """Row of a component of an ideal joint's reaction, as of a torque: of its relative velocity."""
    j, kind = work.joint[r], work.kind[r]
    scale = 1.0 / (abs(work.mobility[3, r, r]) + abs(work.mobility[7, r, r]))
    rate = work.motion[s, j, VELOCITY_X if kind == REACTION_X else VELOCITY_Y]
    gap = work.motion[START, j, ECCENTRICITY_X if kind == REACTION_X else ECCENTRICITY_Y]
    work.correction[s * n + r] = -scale * (rate + gap / max(h, _RETURN_TIME))
    if not renewed:
        return
    row = work.matrix[s * n + r]
    for k in range(2):
        for c in range(n):
            row[k * n + c] = scale * work.mobility[4 * k + 2 * s + 1, r, c]
