"""Torques that resist the turning of a hinge: viscous damping and dry friction."""

from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import square_roots


@kernel
def damping_torque(joint, rate):
    """Return the torque [N m] of a viscous or eddy-current damper on a joint, and its slope by the rate [N m s/rad]."""
    return -joint.damping * rate, -joint.damping + 0.0 * rate


@kernel
def friction_torque(joint, rate):
    """Return the torque of dry friction on a joint [N m], and its slope by the rate [N m s/rad].

    Coulomb's torque is multiplied by r / sqrt(r^2 + r0^2), with rate r and ramp rate r0, to be smooth at a reversal.
    """
    if joint.friction_torque == 0.0:
        return 0.0 * rate, 0.0 * rate
    square = joint.friction_ramp_rate * joint.friction_ramp_rate
    size = square_roots(rate * rate + square)
    torque = -joint.friction_torque * rate / size
    return torque, -joint.friction_torque * square / (size * size * size)
