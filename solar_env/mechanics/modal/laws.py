"""The laws of joints as the step takes them: forces with their slopes. The only place that calls them."""

from __future__ import annotations

from solar_env.mechanics.arrays.model import MATERIAL_POINTS
from solar_env.mechanics.joints.contact import (
    friction_ramp,
    friction_ramp_slope,
    impact_scales,
    normal_force,
    normal_force_slopes,
)
from solar_env.mechanics.joints.joint import cable_torque, stop_energy, stop_torque
from solar_env.mechanics.numerics.jit import kernel


@kernel(inlined=True)
def contact_force(joint, own, depth, rate):
    """Normal force [N] of the contact of a joint, and its elastic part."""
    return normal_force(depth, rate, joint.contact_stiffness, joint.damping_factor, own.impact_speed)


@kernel(inlined=True)
def contact_slopes(joint, own, depth, rate):
    """Derivatives of the normal force by depth and by its rate."""
    return normal_force_slopes(depth, rate, joint.contact_stiffness, joint.damping_factor, own.impact_speed)


@kernel(inlined=True)
def contact_energy(joint, depth):
    """Elastic energy [J] of a contact."""
    if depth <= 0.0:
        return 0.0
    _, elastic = normal_force(depth, 0.0, joint.contact_stiffness, 0.0, 1.0)
    return 0.4 * elastic * depth


@kernel(inlined=True)
def impact_duration(joint, inverse_mass, impact_speed):
    """Predicted greatest depth [m] and duration [s] of an impact."""
    return impact_scales(joint.contact_stiffness, inverse_mass, impact_speed)


@kernel(inlined=True)
def friction_share(joint, slip):
    """Tangential over normal force at a sliding speed [m/s], opposing it, and its slope."""
    zero, full = joint.friction_speed_zero, joint.friction_speed_full
    share = -joint.friction_coefficient * friction_ramp(slip, zero, full)
    return share, -joint.friction_coefficient * friction_ramp_slope(slip, zero, full)


@kernel(inlined=True)
def law_slip(joint, slip, centre_slip):
    """The sliding speed that the friction law takes [m/s]."""
    return slip if joint.sliding_speed == MATERIAL_POINTS else centre_slip


@kernel(inlined=True)
def own_torque(joint, own, angle, rate):
    """Torque of spring and stops on a joint angle [N m], and its slopes by angle and rate."""
    stop, _, by_angle, by_rate = stop_torque(joint, own, angle, rate)
    spring = joint.spring_stiffness * (joint.spring_preload_angle - angle)
    return spring + stop, by_angle - joint.spring_stiffness, by_rate


@kernel(inlined=True)
def stop_parts(joint, own, angle, rate):
    """Torque of the stops on a joint angle [N m], and its elastic part."""
    torque, elastic, _, _ = stop_torque(joint, own, angle, rate)
    return torque, elastic


@kernel(inlined=True)
def stored_in_stop(joint, own, angle):
    """Elastic energy [J] of the stops."""
    return stop_energy(joint, own, angle)


@kernel(inlined=True)
def loop_torque(cable, stretch):
    """Torque of a cable loop on its outer joint [N m], its slope, and its energy [J]."""
    return cable_torque(cable, stretch)
