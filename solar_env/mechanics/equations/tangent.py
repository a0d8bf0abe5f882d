"""Analytic tangents of the generalized forces, for implicit integration.

A joint's forces p depend on its local coordinates x = (eccentricity x, y, outboard angle, inboard angle). The
generalized force is B^T p(x, x') with B = dx/dq, so that

dQ/dq = B^T (dp/dx B + dp/dx' dx'/dq) + p times the Hessians of x,   dQ/dv = B^T dp/dx' B.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.columns import ANGLE, INBOARD_SPIN, OUTBOARD_SPIN, RATE
from solar_env.mechanics.arrays.model import CLEARANCE
from solar_env.mechanics.bodies.cable_element.tangent import ElementSlopes, add_elastic_tangents, make_element_slopes
from solar_env.mechanics.bodies.markers import fill_slopes, subtract_hessian
from solar_env.mechanics.equations.cable_tangent import add_cable_slopes
from solar_env.mechanics.equations.system import Workspace
from solar_env.mechanics.joints.contact import contact_motion, friction_share, normal_force, sliding_share
from solar_env.mechanics.joints.joint import relative
from solar_env.mechanics.joints.laws import MATERIAL, PLACES
from solar_env.mechanics.joints.torques.hinge import hinge_torques, summed_torque
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry, clear


class TangentScratch(NamedTuple):
    """Work arrays of `fill_tangents`; loads and impact speeds are shared with the workspace."""

    loads: NDArray[np.float64]
    impact_speeds: NDArray[np.float64]
    coordinates: NDArray[np.int64]  # (joints, 8) coordinates that a joint depends on
    b: NDArray[np.float64]  # (4, 8)
    rate_slope: NDArray[np.float64]  # (4, 8)
    stiffness: NDArray[np.float64]  # (4, 4)
    damping: NDArray[np.float64]  # (4, 4)
    stiffness_product: NDArray[np.float64]  # (4, 8)
    damping_product: NDArray[np.float64]  # (4, 8)
    angle_gradient: NDArray[np.float64]  # (joints, 8)
    # Coordinates of a cable loop's two joints, and gradients of the loop's wheel angles, chord angle and chord length.
    cable_coordinates: NDArray[np.int64]  # (16,)
    cable_gradient: NDArray[np.float64]  # (4, 16)
    elements: ElementSlopes


def make_tangent_scratch(work: Workspace) -> TangentScratch:
    """Allocate the work arrays of `fill_tangents`, which share loads and impact speeds with `work`."""
    joints = work.impact_speeds.size
    return TangentScratch(
        loads=work.loads,
        impact_speeds=work.impact_speeds,
        coordinates=np.zeros((joints, 8), dtype=np.int64),
        b=np.zeros((4, 8)),
        rate_slope=np.zeros((4, 8)),
        stiffness=np.zeros((4, 4)),
        damping=np.zeros((4, 4)),
        stiffness_product=np.zeros((4, 8)),
        damping_product=np.zeros((4, 8)),
        angle_gradient=np.zeros((joints, 8)),
        cable_coordinates=np.zeros(16, dtype=np.int64),
        cable_gradient=np.zeros((4, 16)),
        elements=make_element_slopes(),
    )


@kernel
def local_map(joint, markers, q, v, index, b, rate_slope):
    """Write derivatives dx/dq to `b` and dx'/dq to `rate_slope`, both (4, 8), for a joint's local coordinates x.

    The joint's two markers are points with a direction, on its outboard and on its inboard body. x has the difference
    of their positions [m], outboard minus inboard, then the outboard and the inboard marker's direction angle [rad].
    `markers` are the records of all markers. `index` (8,) gets the indices in q of the two markers' coordinates.
    """
    b[:] = 0.0
    rate_slope[:] = 0.0
    fill_slopes(markers[joint.outboard], q, v, 0, index, b, rate_slope)
    fill_slopes(markers[joint.inboard], q, v, 1, index, b, rate_slope)
    # The eccentricity is the outboard marker's position minus the inboard marker's.
    for axis in range(2):
        for c in range(4, 8):
            b[axis, c] *= -1.0
            rate_slope[axis, c] *= -1.0


@kernel
def contact_tangent(joint, markers, q, v, outboard_spin, inboard_spin, impact_speed, stiffness, damping):
    """Add derivatives of contact loads p(x, x') to the (4, 4) matrices `stiffness`, dp/dx, and `damping`, dp/dx'.

    p: force x, force y, outboard torque, inboard torque. x: eccentricity x and y, outboard angle, inboard angle.
    Return the tangential force [N] and its lever [m] about the bearing's centre. Spins are angular velocities [rad/s].
    """
    ex, ey = relative(joint, markers, q)
    ux, uy = relative(joint, markers, v)
    motion = contact_motion(joint, ex, ey, ux, uy, outboard_spin, inboard_spin)
    rate, radius, lever = motion.rate, motion.radius, motion.lever
    if motion.depth <= 0.0:
        return 0.0, lever
    nx, ny = motion.normal_x, motion.normal_y
    tx, ty = -ny, nx
    material = joint.sliding == MATERIAL
    normal, _, by_depth, by_rate = normal_force(joint, motion.depth, rate, impact_speed)
    share, slope = friction_share(joint, motion.sliding_speed)
    per_normal = -joint.friction_coefficient * share
    per_slip = -joint.friction_coefficient * slope * normal
    tangential = per_normal * normal
    turn = motion.centre_speed / radius
    share_of_centres = sliding_share(joint, motion.depth)
    share_by_radius = joint.clearance / (radius * radius) if joint.sliding == PLACES else 0.0
    for k in range(2):
        n_k = nx if k == 0 else ny
        t_k = tx if k == 0 else ty
        normal_by_e = by_depth * n_k + by_rate * turn * t_k
        slip_by_e = -share_of_centres * rate / radius * t_k + share_by_radius * motion.centre_speed * n_k
        slip_by_e -= inboard_spin * n_k if material else 0.0
        tangential_by_e = per_normal * normal_by_e + per_slip * slip_by_e
        normal_by_u = by_rate * n_k
        tangential_by_u = per_normal * normal_by_u + per_slip * share_of_centres * t_k
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


@kernel(inlined=False)
def fill_tangents(model, joint_states, q, v, tangent, by_q, by_v):
    """Compute the stiffness -dQ/dq and damping -dQ/dv of generalized forces Q in profile matrices `by_q` and `by_v`.

    `tangent.loads` and `tangent.impact_speeds` must be current; the other arrays of `tangent` are work arrays.
    """
    joints, markers, cables = model.joints, model.markers, model.cables
    loads, index = tangent.loads, tangent.coordinates
    b, rate_slope = tangent.b, tangent.rate_slope
    stiffness, damping = tangent.stiffness, tangent.damping
    stiffness_product, damping_product = tangent.stiffness_product, tangent.damping_product
    elimination = model.elimination
    clear(elimination, by_q)
    clear(elimination, by_v)
    for j in range(joints.size):
        joint = joints[j]
        local_map(joint, markers, q, v, index[j], b, rate_slope)
        stiffness[:] = 0.0
        damping[:] = 0.0
        torques = hinge_torques(joint, joint_states[j], loads[j, ANGLE], loads[j, RATE])
        for row in range(2):
            for column in range(2):
                sign = 1.0 if row == column else -1.0
                stiffness[2 + row, 2 + column] += sign * torques.by_angle
                damping[2 + row, 2 + column] += sign * torques.by_rate
        torque = summed_torque(loads, j)
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
                # The rates depend on q too.
                by_x += damping[r, 2] * rate_slope[2, c] + damping[r, 3] * rate_slope[3, c]
                by_x += damping[r, 0] * rate_slope[0, c] + damping[r, 1] * rate_slope[1, c]
                stiffness_product[r, c], damping_product[r, c] = by_x, by_rate
        for r in range(8):
            for c in range(8):
                by_x, by_rate = 0.0, 0.0
                for k in range(4):
                    by_x += b[k, r] * stiffness_product[k, c]
                    by_rate += b[k, r] * damping_product[k, c]
                # Most entries vanish: angles do not depend on a beam's nodal positions, and most dampers are idle.
                if by_x != 0.0:
                    add_entry(elimination, by_q, index[j, r], index[j, c], -by_x)
                if by_rate != 0.0:
                    add_entry(elimination, by_v, index[j, r], index[j, c], -by_rate)
        for c in range(8):
            tangent.angle_gradient[j, c] = joint.sign * (b[2, c] - b[3, c])
        outboard, inboard = markers[joint.outboard], markers[joint.inboard]
        subtract_hessian(outboard, q, outboard_torque, elimination, by_q)
        subtract_hessian(inboard, q, inboard_torque, elimination, by_q)
    for k in range(cables.size):
        add_cable_slopes(model, cables[k], q, v, tangent, by_q)
    for k in range(model.loads.size):
        load = model.loads[k]
        subtract_hessian(markers[load.marker], q, load.torque, elimination, by_q)
    add_elastic_tangents(model.cable_elements, q, v, tangent.elements, elimination, by_q, by_v)
