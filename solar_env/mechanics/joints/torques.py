"""Torques about a hinge: spring, latch and stow stop, motor; and cable loops, which act between two hinges.

Every law is a row of `columns.TORQUES`. All equations of motion ask here for torques, their slopes, energies and
powers: to add a law, write it here, enter it in `hinge_torques` and in the functions below it, and give it a row.
"""

import math
from typing import NamedTuple

from solar_env.mechanics.arrays import columns as c
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.numerics.jit import kernel


@kernel
def one_sided_stop(joint, depth, closing_rate):
    """Resisting torque of one stop face, its elastic part, and its slopes by depth and by closing rate.

    k depth^e plus damping that a cubic STEP ramps in over `stop_ramp_depth`; never pulls (BISTOP, paper Eqs 5-7).
    """
    if depth <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    exponent = joint.stop_exponent
    elastic = joint.stop_stiffness * depth**exponent
    s = min(depth / joint.stop_ramp_depth, 1.0)
    damping = joint.stop_damping * s * s * (3.0 - 2.0 * s)
    torque = elastic + damping * closing_rate
    if torque <= 0.0:
        return 0.0, elastic, 0.0, 0.0
    slope = exponent * elastic / depth + joint.stop_damping * 6.0 * s * (1.0 - s) / joint.stop_ramp_depth * closing_rate
    return torque, elastic, slope, damping


@kernel
def stop_depth(joint, latched, angle):
    """Depth [rad] in latch or stow stop, negative outside, and the sign of the torque that resists it."""
    below_stow = joint.stow_angle - joint.stop_gap - angle if joint.has_stow_stop else -math.inf
    if latched:
        beyond = angle - joint.lock_angle
        depth = abs(beyond) - joint.stop_gap
        if depth >= below_stow:
            return depth, -1.0 if beyond > 0.0 else 1.0
    return below_stow, 1.0


@kernel
def stop_torque(joint, joint_state, angle, rate):
    """Torque of latch and stow stop on the joint angle, its elastic part, and its slopes by angle and rate.

    A stop that is not engaged exerts none: within a step of the explicit method this keeps the torque smooth.
    """
    if not joint_state.stop_engaged:
        return 0.0, 0.0, 0.0, 0.0
    depth, sign = stop_depth(joint, joint_state.latched, angle)
    torque, elastic, slope, damping = one_sided_stop(joint, depth, -sign * rate)
    return sign * torque, sign * elastic, -slope, -damping


@kernel
def stop_energy(joint, joint_state, angle):
    """Elastic energy [J] of latch and stow stop."""
    depth, _ = stop_depth(joint, joint_state.latched, angle)
    if depth <= 0.0 or not joint_state.stop_engaged:
        return 0.0
    return joint.stop_stiffness * depth ** (joint.stop_exponent + 1.0) / (joint.stop_exponent + 1.0)


class HingeTorques(NamedTuple):
    """Torques on a joint's angle, but for the cable loops'.

    Attributes:
        spring, latch, motor: [N m]; the latch's with the stow stop's.
        latch_elastic: the part of the latch's that has an energy [N m].
        by_angle, by_rate: slopes of their sum [N m/rad], [N m s/rad].
    """

    spring: float
    latch: float
    motor: float
    latch_elastic: float
    by_angle: float
    by_rate: float


@kernel
def hinge_torques(joint, joint_state, angle, rate):
    """Torques of all laws at a joint's angle [rad] and its rate."""
    latch, elastic, by_angle, by_rate = stop_torque(joint, joint_state, angle, rate)
    return HingeTorques(
        spring=joint.spring_stiffness * (joint.spring_preload_angle - angle),
        latch=latch,
        motor=joint_state.motor_torque,
        latch_elastic=elastic,
        by_angle=by_angle - joint.spring_stiffness,
        by_rate=by_rate,
    )


@kernel
def torque_of_motion(torques):
    """Sum of the torques that depend on the motion [N m]: of all but the motor's."""
    return torques.spring + torques.latch


@kernel
def may_be_stiff(joint_state):
    """Whether a torque acts whose slopes have no bound that is known beforehand."""
    return joint_state.stop_engaged != 0


@kernel
def known_stiffness(joint):
    """Greatest slope by the angle [N m/rad] of the torques that always act."""
    return joint.spring_stiffness


@kernel
def enter_torques(torques, j, loads):
    """Enter the torques of joint `j` in the table of loads, without those of cable loops, which `enter_cable` adds."""
    loads[j, c.SPRING_TORQUE] = torques.spring
    loads[j, c.CABLE_TORQUE] = 0.0
    loads[j, c.LATCH_TORQUE] = torques.latch
    loads[j, c.MOTOR_TORQUE] = torques.motor


@kernel
def enter_cable(cable, torque, loads):
    """Enter the torque [N m] of a cable loop on its outer joint in the table of loads."""
    loads[cable.joint_a, c.CABLE_TORQUE] -= cable.torque_ratio * torque
    loads[cable.joint_b, c.CABLE_TORQUE] += torque


@kernel
def summed_torque(loads, j):
    """Sum of the torques of all laws on joint `j` [N m], from the table of loads."""
    total = loads[j, c.FIRST_TORQUE]
    for column in range(c.FIRST_TORQUE + 1, c.END_OF_TORQUES):
        total += loads[j, column]
    return total


@kernel
def add_torque_powers(torques, rate, weight, j, out):
    """Add `weight` times the powers of the torques of joint `j`, at a rate [rad/s], to its integrals or their rates."""
    first = m.INTEGRALS_PER_JOINT * j
    out[first + m.MOTOR_WORK] += weight * torques.motor * rate
    out[first + m.LATCH_DISSIPATION] += weight * (torques.latch_elastic - torques.latch) * rate


@kernel
def add_cable_power(cable, torque, rate, weight, out):
    """Add `weight` times a cable loop's power, at the inner wheel's rate [rad/s], to the integrals or their rates.

    It has none unless the ratio of torques differs from the wheels'.
    """
    power = torque * (cable.wheel_ratio - cable.torque_ratio) * rate
    out[m.INTEGRALS_PER_JOINT * cable.joint_a + m.CABLE_WORK] += weight * power


@kernel
def add_torque_energies(joint, joint_state, angle, energies):
    """Add the energies [J] that the torques of a joint store at its angle [rad]."""
    stretch = joint.spring_preload_angle - angle
    energies[m.SPRING] += 0.5 * joint.spring_stiffness * stretch * stretch
    energies[m.LATCH] += stop_energy(joint, joint_state, angle)
