"""Analytic tangents of the generalized forces, for implicit integration.

A joint sees its motion through four local coordinates x = (eccentricity x, y, outboard angle, inboard angle); its
generalized force is B^T p(x, x') with B = dx/dq. Only the angles are nonlinear in q, so that

dQ/dq = B^T (dp/dx B + dp/dx' dx'/dq) + torques times the Hessians of the angles,   dQ/dv = B^T dp/dx' B.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import CLEARANCE, MATERIAL_POINTS
from solar_env.mechanics.bodies.cable_element_tangent import ElementSlopes, add_elastic_tangents, make_element_slopes
from solar_env.mechanics.equations.system import Workspace
from solar_env.mechanics.joints.contact import friction_ramp, friction_ramp_slope, normal_force, normal_force_slopes
from solar_env.mechanics.joints.joint import (
    ANGLE,
    CABLE_TORQUE,
    INBOARD_SPIN,
    MOTOR_TORQUE,
    OUTBOARD_SPIN,
    RATE,
    SPRING_TORQUE,
    STOP_TORQUE,
    cable_torque,
    direction,
    relative,
    stop_torque,
)
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry, clear


class TangentScratch(NamedTuple):
    """Arrays of :func:`fill_tangents`; loads and impact speeds are the workspace's own."""

    loads: NDArray[np.float64]
    impact_speeds: NDArray[np.float64]
    coordinates: NDArray[np.int64]  # (joints, 8) those that a joint depends on
    b: NDArray[np.float64]  # (4, 8)
    spin_slope: NDArray[np.float64]  # (2, 8)
    stiffness: NDArray[np.float64]  # (4, 4)
    damping: NDArray[np.float64]  # (4, 4)
    stiffness_product: NDArray[np.float64]  # (4, 8)
    damping_product: NDArray[np.float64]  # (4, 8)
    angle_gradient: NDArray[np.float64]  # (joints, 8)
    elements: ElementSlopes


def make_tangent_scratch(work: Workspace) -> TangentScratch:
    """Allocate the arrays of a tangent."""
    joints = work.impact_speeds.size
    return TangentScratch(
        loads=work.loads,
        impact_speeds=work.impact_speeds,
        coordinates=np.zeros((joints, 8), dtype=np.int64),
        b=np.zeros((4, 8)),
        spin_slope=np.zeros((2, 8)),
        stiffness=np.zeros((4, 4)),
        damping=np.zeros((4, 4)),
        stiffness_product=np.zeros((4, 8)),
        damping_product=np.zeros((4, 8)),
        angle_gradient=np.zeros((joints, 8)),
        elements=make_element_slopes(),
    )


@kernel(inner=True)
def local_map(joint, markers, q, v, index, b, spin_slope):
    """Fill the joint's 8 coordinate indices, B (4, 8) and d(angular rates)/dq (2, 8)."""
    b[:] = 0.0
    spin_slope[:] = 0.0
    for side in range(2):
        marker = markers[joint.outboard] if side == 0 else markers[joint.inboard]
        sign = 1.0 if side == 0 else -1.0
        k = 4 * side
        index[k], index[k + 1] = marker.i1, marker.i1 + 1
        index[k + 2], index[k + 3] = marker.i2, marker.i2 + 1
        b[0, k], b[0, k + 1], b[0, k + 2], b[0, k + 3] = marker.a1, -marker.b1, marker.a2, -marker.b2
        b[1, k], b[1, k + 1], b[1, k + 2], b[1, k + 3] = marker.b1, marker.a1, marker.b2, marker.a2
        for c in range(k, k + 4):
            b[0, c] *= sign
            b[1, c] *= sign
        dx, dy = direction(marker, q)
        ux, uy = direction(marker, v)
        hxx, hxy = angle_hessian(dx, dy)
        squared = dx * dx + dy * dy
        gx, gy = -dy / squared, dx / squared
        sx, sy = hxx * ux + hxy * uy, hxy * ux - hxx * uy
        row = 2 + side
        b[row, k], b[row, k + 1], b[row, k + 2], b[row, k + 3] = marker.c1 * gx, marker.c1 * gy, gx, gy
        spin_slope[side, k], spin_slope[side, k + 1] = marker.c1 * sx, marker.c1 * sy
        spin_slope[side, k + 2], spin_slope[side, k + 3] = sx, sy


@kernel
def angle_hessian(dx, dy):
    """Entries (xx, xy) of the Hessian of atan2(dy, dx); yy = -xx."""
    fourth = (dx * dx + dy * dy) ** 2
    return 2.0 * dx * dy / fourth, (dy * dy - dx * dx) / fourth


@kernel
def subtract_angle_hessian(marker, q, torque, elimination, matrix):
    """Subtract torque * Hessian of the marker's angle from ``matrix``."""
    dx, dy = direction(marker, q)
    hxx, hxy = angle_hessian(dx, dy)
    for row in range(2):
        first = marker.i1 if row == 0 else marker.i2
        c = marker.c1 if row == 0 else 1.0
        for column in range(2):
            second = marker.i1 if column == 0 else marker.i2
            d = -torque * c * (marker.c1 if column == 0 else 1.0)
            add_entry(elimination, matrix, first, second, d * hxx)
            add_entry(elimination, matrix, first, second + 1, d * hxy)
            add_entry(elimination, matrix, first + 1, second, d * hxy)
            add_entry(elimination, matrix, first + 1, second + 1, -d * hxx)


@kernel(inner=True)
def contact_tangent(joint, markers, q, v, outboard_spin, inboard_spin, impact_speed, stiffness, damping):
    """Add the slopes of (force x, force y, outboard torque, inboard torque); returns the tangential force and lever.

    Args:
        stiffness: (4, 4) slopes by the local coordinates, changed in place.
        damping: (4, 4) slopes by their rates, changed in place.
    """
    ex, ey = relative(joint, markers, q)
    radius = math.sqrt(ex * ex + ey * ey)
    depth = radius - joint.clearance
    lever = joint.journal_radius + radius
    if depth <= 0.0:
        return 0.0, lever
    ux, uy = relative(joint, markers, v)
    nx, ny = ex / radius, ey / radius
    tx, ty = -ny, nx
    rate = ux * nx + uy * ny
    slide = ux * tx + uy * ty
    material = joint.sliding_speed == MATERIAL_POINTS
    slip = slide + joint.journal_radius * outboard_spin - lever * inboard_spin if material else slide
    normal, _ = normal_force(depth, rate, joint.contact_stiffness, joint.damping_factor, impact_speed)
    by_depth, by_rate = normal_force_slopes(depth, rate, joint.contact_stiffness, joint.damping_factor, impact_speed)
    ramp = friction_ramp(slip, joint.friction_speed_zero, joint.friction_speed_full)
    ramp_slope = friction_ramp_slope(slip, joint.friction_speed_zero, joint.friction_speed_full)
    per_normal = -joint.friction_coefficient * ramp
    per_slip = -joint.friction_coefficient * ramp_slope * normal
    tangential = per_normal * normal
    turn = slide / radius
    for k in range(2):
        n_k = nx if k == 0 else ny
        t_k = tx if k == 0 else ty
        normal_by_e = by_depth * n_k + by_rate * turn * t_k
        slip_by_e = -rate / radius * t_k - (inboard_spin * n_k if material else 0.0)
        tangential_by_e = per_normal * normal_by_e + per_slip * slip_by_e
        normal_by_u = by_rate * n_k
        tangential_by_u = per_normal * normal_by_u + per_slip * t_k
        stiffness[0, k] += -nx * normal_by_e - normal * tx * t_k / radius
        stiffness[0, k] += tx * tangential_by_e - tangential * nx * t_k / radius
        stiffness[1, k] += -ny * normal_by_e - normal * ty * t_k / radius
        stiffness[1, k] += ty * tangential_by_e - tangential * ny * t_k / radius
        stiffness[2, k] += joint.journal_radius * tangential_by_e
        stiffness[3, k] += -lever * tangential_by_e - tangential * n_k
        damping[0, k] += -nx * normal_by_u + tx * tangential_by_u
        damping[1, k] += -ny * normal_by_u + ty * tangential_by_u
        damping[2, k] += joint.journal_radius * tangential_by_u
        damping[3, k] -= lever * tangential_by_u
    if material:
        for k in range(2):
            by_spin = per_slip * (joint.journal_radius if k == 0 else -lever)
            damping[0, 2 + k] += tx * by_spin
            damping[1, 2 + k] += ty * by_spin
            damping[2, 2 + k] += joint.journal_radius * by_spin
            damping[3, 2 + k] -= lever * by_spin
    return tangential, lever


@kernel
def fill_tangents(model, joint_states, q, v, tangent, by_q, by_v):
    """Fill the matrices (``profile.py``) -dQ/dq, the stiffness, and -dQ/dv, the damping.

    ``tangent.loads`` and ``tangent.impact_speeds`` must be current; the other arrays of ``tangent`` are scratch.
    """
    joints, markers, cables = model.joints, model.markers, model.cables
    loads, index = tangent.loads, tangent.coordinates
    b, spin_slope = tangent.b, tangent.spin_slope
    stiffness, damping = tangent.stiffness, tangent.damping
    stiffness_product, damping_product = tangent.stiffness_product, tangent.damping_product
    elimination = model.elimination
    clear(elimination, by_q)
    clear(elimination, by_v)
    for j in range(joints.size):
        joint = joints[j]
        local_map(joint, markers, q, v, index[j], b, spin_slope)
        stiffness[:] = 0.0
        damping[:] = 0.0
        _, _, by_angle, by_rate = stop_torque(joint, joint_states[j], loads[j, ANGLE], loads[j, RATE])
        by_angle -= joint.spring_stiffness
        for row in range(2):
            for column in range(2):
                sign = 1.0 if row == column else -1.0
                stiffness[2 + row, 2 + column] += sign * by_angle
                damping[2 + row, 2 + column] += sign * by_rate
        torque = loads[j, SPRING_TORQUE] + loads[j, CABLE_TORQUE] + loads[j, STOP_TORQUE] + loads[j, MOTOR_TORQUE]
        outboard_torque, inboard_torque = joint.sign * torque, -joint.sign * torque
        if joint.kind == CLEARANCE and tangent.impact_speeds[j] > 0.0:
            tangential, lever = contact_tangent(
                joint,
                markers,
                q,
                v,
                loads[j, OUTBOARD_SPIN],
                loads[j, INBOARD_SPIN],
                tangent.impact_speeds[j],
                stiffness,
                damping,
            )
            outboard_torque += joint.journal_radius * tangential
            inboard_torque -= lever * tangential
        for r in range(4):
            for c in range(8):
                by_x, by_rate = 0.0, 0.0
                for k in range(4):
                    by_x += stiffness[r, k] * b[k, c]
                    by_rate += damping[r, k] * b[k, c]
                # The angles' rates depend on q too.
                by_x += damping[r, 2] * spin_slope[0, c] + damping[r, 3] * spin_slope[1, c]
                stiffness_product[r, c], damping_product[r, c] = by_x, by_rate
        for r in range(8):
            for c in range(8):
                by_x, by_rate = 0.0, 0.0
                for k in range(4):
                    by_x += b[k, r] * stiffness_product[k, c]
                    by_rate += b[k, r] * damping_product[k, c]
                # Most vanish: angles do not depend on the positions of a beam's nodes, most dampers are idle.
                if by_x != 0.0:
                    add_entry(elimination, by_q, index[j, r], index[j, c], -by_x)
                if by_rate != 0.0:
                    add_entry(elimination, by_v, index[j, r], index[j, c], -by_rate)
        for c in range(8):
            tangent.angle_gradient[j, c] = joint.sign * (b[2, c] - b[3, c])
        outboard, inboard = markers[joint.outboard], markers[joint.inboard]
        subtract_angle_hessian(outboard, q, outboard_torque, elimination, by_q)
        subtract_angle_hessian(inboard, q, inboard_torque, elimination, by_q)
    for k in range(cables.size):
        cable = cables[k]
        a, o = cable.joint_a, cable.joint_b
        _, slope, _ = cable_torque(cable, cable.wheel_ratio * loads[a, ANGLE] - loads[o, ANGLE])
        for r in range(8):
            for c in range(8):
                ga, gb = tangent.angle_gradient[a, c], tangent.angle_gradient[o, c]
                weight_a = -cable.torque_ratio * slope * tangent.angle_gradient[a, r]
                weight_b = slope * tangent.angle_gradient[o, r]
                add_entry(elimination, by_q, index[a, r], index[a, c], -weight_a * cable.wheel_ratio * ga)
                add_entry(elimination, by_q, index[a, r], index[o, c], weight_a * gb)
                add_entry(elimination, by_q, index[o, r], index[a, c], -weight_b * cable.wheel_ratio * ga)
                add_entry(elimination, by_q, index[o, r], index[o, c], weight_b * gb)
    for k in range(model.load_torques.size):
        load = model.load_torques[k]
        subtract_angle_hessian(markers[load.marker], q, load.torque, elimination, by_q)
    # Internal forces resist: their slopes enter as they are.
    add_elastic_tangents(model.elements, q, v, tangent.elements, elimination, by_q, by_v)
