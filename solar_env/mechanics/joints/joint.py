"""Forces in a joint: the torques about its angle (`torques`), and the contact in its bearing.

Every joint connects an outboard marker (the journal) to an inboard marker (the bearing). A torque's generalized force
is the torque times the gradient of the marker's direction angle, so that it does no work on a body's stretch. A contact
force acts at the same point on both bodies, so that linear and angular momentum are conserved exactly.
"""

import math

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import (
    ANGLE,
    ECCENTRICITY_X,
    ECCENTRICITY_Y,
    FORCE_X,
    FORCE_Y,
    INBOARD_SPIN,
    NORMAL,
    OUTBOARD_SPIN,
    RATE,
    TANGENTIAL,
)
from solar_env.mechanics.bodies.markers import add_point_force, add_torque, direction, place
from solar_env.mechanics.joints.cable_loop import belt_loads, inner_wheel_rate, move_to_chord, wheel_motion
from solar_env.mechanics.joints.contact import contact_motion, friction_share, normal_force
from solar_env.mechanics.joints.torques.hinge import (
    add_cable_power,
    add_torque_powers,
    enter_cable,
    enter_torques,
    hinge_torques,
    summed_torque,
)
from solar_env.mechanics.numerics.jit import kernel


@kernel
def relative(joint, markers, q):
    """Return journal centre minus bearing centre (x, y) [m], or its rate [m/s] if `q` holds velocities."""
    ox, oy = place(markers[joint.outboard], q)
    ix, iy = place(markers[joint.inboard], q)
    return ox - ix, oy - iy


@kernel
def penetration(joint, markers, q, v):
    """Return the journal's penetration depth in its bearing [m], negative for a gap, and the depth's rate [m/s]."""
    ex, ey = relative(joint, markers, q)
    ux, uy = relative(joint, markers, v)
    radius = math.sqrt(ex * ex + ey * ey)
    if radius == 0.0:
        return -joint.clearance, math.sqrt(ux * ux + uy * uy)
    return radius - joint.clearance, (ex * ux + ey * uy) / radius


@kernel
def joint_motion(joint, markers, q, v):
    """Return the joint angle [rad], its rate [rad/s], and the spins of the outboard and inboard bodies [rad/s]."""
    outboard, inboard = markers[joint.outboard], markers[joint.inboard]
    ox, oy = direction(outboard, q)
    ix, iy = direction(inboard, q)
    px, py = direction(outboard, v)
    jx, jy = direction(inboard, v)
    outboard_spin = (ox * py - oy * px) / (ox * ox + oy * oy)
    inboard_spin = (ix * jy - iy * jx) / (ix * ix + iy * iy)
    tx = joint.turn_cos * ix - joint.turn_sin * iy
    ty = joint.turn_sin * ix + joint.turn_cos * iy
    angle = joint.middle + joint.sign * math.atan2(tx * oy - ty * ox, tx * ox + ty * oy)
    return angle, joint.sign * (outboard_spin - inboard_spin), outboard_spin, inboard_spin


@kernel
def joint_torques(model, joint_states, q, v, loads, force, power):
    """Write each joint's angle, rate, both bodies' spins and torques to `loads`, and the torques' powers to `power`.

    `joint_forces` later adds the torques in `loads` to the generalized `force` (n,). For some cable loops this is not
    right: if the loop pulls on the bearings, or the panel between its joints bends, the loop loads this panel by forces
    at the joints. These forces are added to `force` here, and the torques on the panel are subtracted in advance.
    """
    joints, markers, cables = model.joints, model.markers, model.cables
    for j in range(joints.size):
        joint = joints[j]
        angle, rate, outboard_spin, inboard_spin = joint_motion(joint, markers, q, v)
        loads[j, ANGLE] = angle
        loads[j, RATE] = rate
        loads[j, OUTBOARD_SPIN] = outboard_spin
        loads[j, INBOARD_SPIN] = inboard_spin
        torques = hinge_torques(joint, joint_states[j], angle, rate)
        enter_torques(torques, j, loads)
        for k in range(m.INTEGRALS_PER_JOINT * j, m.INTEGRALS_PER_JOINT * (j + 1)):
            power[k] = 0.0
        add_torque_powers(torques, rate, 1.0, j, power)
    for c in range(cables.size):
        cable = cables[c]
        a, b = cable.joint_a, cable.joint_b
        stretch, length = wheel_motion(cable, joints, markers, q, loads[a, ANGLE], loads[b, ANGLE])
        torque, pull, _, _, _, _ = belt_loads(cable, stretch, length)
        enter_cable(cable, torque, loads)
        rate = inner_wheel_rate(cable, joints, markers, q, v, loads[a, RATE])
        add_cable_power(cable, torque, rate, 1.0, power)
        if cable.chord_sense != 0:
            move_to_chord(cable, joints, markers, q, torque, pull, force)


@kernel
def joint_forces(model, joint_states, impact_speeds, q, v, loads, force, power):
    """Write the motion, forces and torques of all joints to `loads`, and their powers and impulse rates to `power`.

    Add the generalized forces to `force`. `power` has the rates of all works, dissipations and impulses. Where a
    joint's impact speed is zero, the journal flies freely and no contact force acts in this step.
    """
    joint_torques(model, joint_states, q, v, loads, force, power)
    joints, markers = model.joints, model.markers
    for j in range(joints.size):
        joint = joints[j]
        outboard, inboard = markers[joint.outboard], markers[joint.inboard]
        torque = joint.sign * summed_torque(loads, j)
        outboard_torque, inboard_torque = torque, -torque
        normal, tangential, fx, fy = 0.0, 0.0, 0.0, 0.0
        ex, ey = 0.0, 0.0
        first = m.INTEGRALS_PER_JOINT * j
        if joint.kind == m.CLEARANCE:
            ex, ey = relative(joint, markers, q)
            if impact_speeds[j] > 0.0:
                ux, uy = relative(joint, markers, v)
                motion = contact_motion(joint, ex, ey, ux, uy, loads[j, OUTBOARD_SPIN], loads[j, INBOARD_SPIN])
                if motion.depth > 0.0:
                    normal, elastic, _, _ = normal_force(joint, motion.depth, motion.rate, impact_speeds[j])
                    share, _ = friction_share(joint, motion.sliding_speed)
                    tangential = -joint.friction_coefficient * share * normal
                    fx = -normal * motion.normal_x - tangential * motion.normal_y
                    fy = -normal * motion.normal_y + tangential * motion.normal_x
                    outboard_torque += joint.journal_radius * tangential
                    inboard_torque -= motion.lever * tangential
                    add_point_force(outboard, fx, fy, force)
                    add_point_force(inboard, -fx, -fy, force)
                    power[first + m.NORMAL_DISSIPATION] = (normal - elastic) * motion.rate
                    power[first + m.FRICTION_DISSIPATION] = -tangential * motion.slip
                    power[first + m.SLIDING_WORK] = normal * abs(motion.sliding_speed)
                    power[first + m.IMPULSE] = normal
        loads[j, ECCENTRICITY_X] = ex
        loads[j, ECCENTRICITY_Y] = ey
        loads[j, NORMAL] = normal
        loads[j, TANGENTIAL] = tangential
        loads[j, FORCE_X] = fx
        loads[j, FORCE_Y] = fy
        add_torque(outboard, q, outboard_torque, force)
        add_torque(inboard, q, inboard_torque, force)
