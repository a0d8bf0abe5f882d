"""Torques about a hinge: spring, latch and stow stop, motor; and cable loops, which act between two hinges.

Every law is a row of `columns.TORQUES`. All equations of motion ask here for torques, their slopes, energies and
powers: to add a law, write it here, enter it in `hinge_torques` and in the functions below it, and give it a row.
"""

import math
from typing import NamedTuple

from solar_env.mechanics.arrays import columns as c
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import sum_lanes, where_less


@kernel
def one_sided_stop(joint, depth, closing_rate):
    """Resisting torque of one stop face, its elastic part, and its slopes by depth and by closing rate.

    k depth^e plus damping that a cubic STEP ramps in over `stop_ramp_depth`; never pulls (BISTOP, paper Eqs 5-7).
    """
    inside, exponent = where_less(0.0, depth, depth, 0.0), joint.stop_exponent
    growth = joint.stop_stiffness * (1.0 + 0.0 * inside if exponent == 1.0 else inside ** (exponent - 1.0))
    # Outside a stop that a joint does not have, powers are infinite.
    elastic, share = where_less(0.0, depth, growth * inside, 0.0), inside / joint.stop_ramp_depth
    ramp = where_less(share, 1.0, share, 1.0)
    damping = joint.stop_damping * ramp * ramp * (3.0 - 2.0 * ramp)
    torque = elastic + damping * closing_rate
    slope = exponent * growth + joint.stop_damping * 6.0 * ramp * (1.0 - ramp) / joint.stop_ramp_depth * closing_rate
    pushing = where_less(0.0, torque, torque, 0.0)
    return pushing, elastic, where_less(0.0, torque, slope, 0.0), where_less(0.0, torque, damping, 0.0)


@kernel
def stop_depth(joint, latched, angle):
    """Depth [rad] in latch or stow stop, negative outside, and the sign of the torque that resists it."""
    below_stow = (joint.stow_angle - joint.stop_gap if joint.has_stow_stop else -math.inf) - angle
    if latched:
        beyond = angle - joint.lock_angle
        depth = abs(beyond) - joint.stop_gap
        sign = where_less(depth, below_stow, 1.0, where_less(0.0, beyond, -1.0, 1.0))
        return where_less(depth, below_stow, below_stow, depth), sign
    return below_stow, 1.0 + 0.0 * angle


@kernel
def stop_torque(joint, joint_state, angle, rate):
    """Torque of latch and stow stop on the joint angle, its elastic part, and its slopes by angle and rate.

    A stop that is not engaged exerts none: within a step of the explicit method this keeps the torque smooth.
    """
    if not joint_state.stop_engaged:
        nothing = 0.0 * angle
        return nothing, nothing, nothing, nothing
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
    """Torques of all laws at a joint's angle [rad] and its rate, which are numbers or vectors of several."""
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
    """Add `weight` times the powers of the torques of joint `j`, at a rate [rad/s], to its integrals or their rates.

    Of vectors it adds up the lanes.
    """
    first = m.INTEGRALS_PER_JOINT * j
    out[first + m.MOTOR_WORK] += sum_lanes(weight * torques.motor * rate)
    out[first + m.LATCH_DISSIPATION] += sum_lanes(weight * (torques.latch_elastic - torques.latch) * rate)


@kernel
def add_cable_power(cable, torque, rate, weight, out):
    """Add `weight` times a cable loop's power, at the inner wheel's rate [rad/s], to the integrals or their rates.

    It has none unless the ratio of torques differs from the wheels'. Of vectors it adds up the lanes.
    """
    power = torque * (cable.wheel_ratio - cable.torque_ratio) * rate
    out[m.INTEGRALS_PER_JOINT * cable.joint_a + m.CABLE_WORK] += sum_lanes(weight * power)


@kernel
def add_torque_energies(joint, joint_state, angle, energies):
    """Add the energies [J] that the torques of a joint store at its angle [rad]."""
    stretch = joint.spring_preload_angle - angle
    energies[m.SPRING] += 0.5 * joint.spring_stiffness * stretch * stretch
    energies[m.LATCH] += stop_energy(joint, joint_state, angle)
