"""All torques about a hinge: their sum, slopes, energies and powers; and torques of cable loops between two hinges."""

from typing import NamedTuple

from solar_env.mechanics.arrays import columns as c
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.joints.torques.resistance import damping_torque, friction_torque
from solar_env.mechanics.joints.torques.stop import stop_energy, stop_torque
from solar_env.mechanics.joints.torques.table import table_energy, table_torque
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import sum_lanes


class HingeTorques(NamedTuple):
    """Torques on a joint's angle, without the cable loops'.

    Attributes:
        spring, harness, latch, damping, friction, motor: torques [N m]; `latch` is the torque of all stops.
        latch_elastic: part of the latch's torque that has an energy [N m].
        by_angle, by_rate: slopes of their sum [N m/rad], [N m s/rad].
        latch_by_rate: the latch's part of `by_rate`.
    """

    spring: float
    harness: float
    latch: float
    damping: float
    friction: float
    motor: float
    latch_elastic: float
    by_angle: float
    by_rate: float
    latch_by_rate: float


@kernel
def hinge_torques(joint, joint_state, angle, rate):
    """Return the torques of all laws at a joint's angle [rad] and its rate, which are numbers or vectors of several."""
    spring = joint.spring_stiffness * (joint.spring_preload_angle - angle)
    harness, slope = 0.0 * angle, 0.0 * angle - joint.spring_stiffness
    if joint.spring_points > 0:
        torque, by_angle = table_torque(joint.spring_table, joint.spring_points, angle)
        spring, slope = spring + torque, slope + by_angle
    if joint.harness_points > 0:
        harness, by_angle = table_torque(joint.harness_table, joint.harness_points, angle)
        slope = slope + by_angle
    latch, elastic, stop_slope, latch_by_rate = stop_torque(joint, joint_state, angle, rate)
    damping, damping_slope = damping_torque(joint, rate)
    friction, friction_slope = friction_torque(joint, rate)
    return HingeTorques(
        spring=spring,
        harness=harness,
        latch=latch,
        damping=damping,
        friction=friction,
        motor=joint_state.motor_torque,
        latch_elastic=elastic,
        by_angle=slope + stop_slope,
        by_rate=latch_by_rate + damping_slope + friction_slope,
        latch_by_rate=latch_by_rate,
    )


@kernel
def torque_of_motion(torques):
    """Return the sum of the torques that depend on the motion [N m]: all but the motor's."""
    return torques.spring + torques.harness + torques.latch + torques.damping + torques.friction


@kernel
def may_be_stiff(joint, joint_state):
    """Return whether a torque acts that may be stiff: an engaged stop's, a damper's or dry friction's."""
    return joint_state.stop_engaged != 0 or joint.damping > 0.0 or joint.friction_torque > 0.0


@kernel
def enter_torques(torques, j, loads):
    """Enter the torques of joint `j` in the table of loads, without the cable loops', which `enter_cable` adds."""
    loads[j, c.SPRING_TORQUE] = torques.spring
    loads[j, c.HARNESS_TORQUE] = torques.harness
    loads[j, c.CABLE_TORQUE] = 0.0
    loads[j, c.LATCH_TORQUE] = torques.latch
    loads[j, c.DAMPING_TORQUE] = torques.damping
    loads[j, c.HINGE_FRICTION_TORQUE] = torques.friction
    loads[j, c.MOTOR_TORQUE] = torques.motor


@kernel
def enter_cable(cable, torque, loads):
    """Enter the torque [N m] of a cable loop on its outer joint in the table of loads."""
    loads[cable.joint_a, c.CABLE_TORQUE] -= cable.torque_ratio * torque
    loads[cable.joint_b, c.CABLE_TORQUE] += torque


@kernel
def summed_torque(loads, j):
    """Return the sum of the torques of all laws on joint `j` [N m], from the table of loads."""
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
    add_resistance_powers(torques, rate, weight, j, out)


@kernel
def add_resistance_powers(torques, rate, weight, j, out):
    """Add `weight` times the powers that damper and friction of joint `j` take, as `add_torque_powers` does."""
    first = m.INTEGRALS_PER_JOINT * j
    out[first + m.DAMPER_DISSIPATION] -= sum_lanes(weight * torques.damping * rate)
    out[first + m.HINGE_FRICTION_DISSIPATION] -= sum_lanes(weight * torques.friction * rate)


@kernel
def add_cable_power(cable, torque, rate, weight, out):
    """Add `weight` times a cable loop's power, at the inner wheel's rate [rad/s], to the integrals or their rates.

    The power is zero unless the torque ratio differs from the wheel ratio. Of vectors it adds up the lanes.
    """
    power = torque * (cable.wheel_ratio - cable.torque_ratio) * rate
    out[m.INTEGRALS_PER_JOINT * cable.joint_a + m.CABLE_WORK] += sum_lanes(weight * power)


@kernel
def add_torque_energies(joint, joint_state, angle, energies):
    """Add the energies [J] that the torques of a joint store at its angle [rad]."""
    stretch = joint.spring_preload_angle - angle
    energies[m.SPRING] += 0.5 * joint.spring_stiffness * stretch * stretch
    if joint.spring_points > 0:
        energies[m.SPRING] += table_energy(joint.spring_table, joint.spring_points, angle)
    if joint.harness_points > 0:
        energies[m.HARNESS] += table_energy(joint.harness_table, joint.harness_points, angle)
    energies[m.LATCH] += stop_energy(joint, joint_state, angle)
