"""Sum, slopes, energies and powers of all torques about a hinge, and torques of cable loops between two hinges."""

from typing import NamedTuple

from solar_env.mechanics.arrays import columns as c
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.joints.torques.resistance import damping_torque, friction_torque
from solar_env.mechanics.joints.torques.stop import stop_energy, stop_torque
from solar_env.mechanics.joints.torques.table import table_energy, table_torque
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import sum_lanes


class HingeTorques(NamedTuple):
    """Torques [N m] on a joint's angle, without the torques of cable loops, and slopes of the torques."""

    spring: float
    harness: float
    latch: float  # of all stops
    damping: float
    friction: float
    motor: float
    latch_elastic: float  # elastic part of `latch`, which stores energy
    by_angle: float  # slope of the summed torques by angle [N m/rad]
    by_rate: float  # slope of the summed torques by rate [N m s/rad]
    latch_by_rate: float  # part of `by_rate` that belongs to `latch`


@kernel
def hinge_torques(joint, joint_state, angle, rate):
    """Return the `HingeTorques` at a joint's angle [rad] and rate [rad/s], which are numbers or vectors."""
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
    """Return the sum [N m] of the torques that depend on the motion: all except the motor's torque."""
    return torques.spring + torques.harness + torques.latch + torques.damping + torques.friction


@kernel
def may_be_stiff(joint, joint_state):
    """Return whether the joint has a torque that may be stiff: from an engaged stop, a damper or dry friction."""
    return joint_state.stop_engaged != 0 or joint.damping > 0.0 or joint.friction_torque > 0.0


@kernel
def enter_torques(torques, j, loads):
    """Write joint `j`'s `HingeTorques` [N m] to their columns in row `j` of `loads`; set the cable torque to 0."""
    loads[j, c.SPRING_TORQUE] = torques.spring
    loads[j, c.HARNESS_TORQUE] = torques.harness
    loads[j, c.CABLE_TORQUE] = 0.0
    loads[j, c.LATCH_TORQUE] = torques.latch
    loads[j, c.DAMPING_TORQUE] = torques.damping
    loads[j, c.HINGE_FRICTION_TORQUE] = torques.friction
    loads[j, c.MOTOR_TORQUE] = torques.motor


@kernel
def enter_cable(cable, torque, loads):
    """Add a cable loop's torques on its two joints to `loads`; `torque` is its torque on the outer joint [N m]."""
    loads[cable.joint_a, c.CABLE_TORQUE] -= cable.torque_ratio * torque
    loads[cable.joint_b, c.CABLE_TORQUE] += torque


@kernel
def summed_torque(loads, j):
    """Return the sum of all torques on joint `j` [N m] in row `j` of the table `loads`."""
    total = loads[j, c.FIRST_TORQUE]
    for column in range(c.FIRST_TORQUE + 1, c.END_OF_TORQUES):
        total += loads[j, column]
    return total


@kernel
def add_torque_powers(torques, rate, weight, j, out):
    """Add to `out`, times `weight`, the power of joint `j`'s motor and the dissipation of latch, damper and friction.

    Each of the four has its own entry of `out` (integrals,). Entries are powers [W] if `weight` is 1, and works [J] if
    it is a duration [s]. `rate` is the joint's [rad/s]. If torques, `rate` and `weight` are vectors over the stages of
    a step, their products are summed over the stages.
    """
    first = m.INTEGRALS_PER_JOINT * j
    out[first + m.MOTOR_WORK] += sum_lanes(weight * torques.motor * rate)
    out[first + m.LATCH_DISSIPATION] += sum_lanes(weight * (torques.latch_elastic - torques.latch) * rate)
    add_resistance_powers(torques, rate, weight, j, out)


@kernel
def add_resistance_powers(torques, rate, weight, j, out):
    """Add `weight` times the losses in joint `j`'s damper and friction at `rate` [rad/s] to their entries of `out`."""
    first = m.INTEGRALS_PER_JOINT * j
    out[first + m.DAMPER_DISSIPATION] -= sum_lanes(weight * torques.damping * rate)
    out[first + m.HINGE_FRICTION_DISSIPATION] -= sum_lanes(weight * torques.friction * rate)


@kernel
def add_cable_power(cable, torque, rate, weight, out):
    """Add the power that a cable loop supplies, times `weight`, to the cable work of its inner joint in `out`.

    The loop exerts `torque` [N m] on the outer joint, and -(torque ratio) * `torque` on the inner joint. It stores
    energy in the mismatch of the wheels' angles: wheel ratio * inner angle, minus outer angle. The supplied power is
    the power of both torques plus the rate of this energy: (wheel ratio - torque ratio) * `torque` * `rate`; `rate`
    [rad/s] is the inner wheel's. `weight` is 1, or a duration [s] for a work. If `torque`, `rate` and `weight` are
    vectors over the stages of a step, the products are summed over the stages.
    """
    power = torque * (cable.wheel_ratio - cable.torque_ratio) * rate
    out[m.INTEGRALS_PER_JOINT * cable.joint_a + m.CABLE_WORK] += sum_lanes(weight * power)


@kernel
def add_torque_energies(joint, joint_state, angle, energies):
    """Add a joint's energies [J] at `angle` [rad] to entries SPRING, HARNESS and LATCH (all stops) of `energies`."""
    stretch = joint.spring_preload_angle - angle
    energies[m.SPRING] += 0.5 * joint.spring_stiffness * stretch * stretch
    if joint.spring_points > 0:
        energies[m.SPRING] += table_energy(joint.spring_table, joint.spring_points, angle)
    if joint.harness_points > 0:
        energies[m.HARNESS] += table_energy(joint.harness_table, joint.harness_points, angle)
    energies[m.LATCH] += stop_energy(joint, joint_state, angle)
