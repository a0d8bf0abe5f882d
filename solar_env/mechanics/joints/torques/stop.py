"""Stops of a hinge: stow stop, latch, end stop without a latch, and hold-down, all with the same torque law.

The law is ADAMS' BISTOP, with damping ramped by its function STEP (Y. Li, C. Wang and W. Huang, Mech. Syst. Signal
Process. 117 (2019) 188, Eqs 5-7). Latch and hold-down have two faces, other stops one. The free play is the distance of
a face from the stop's angle; it is 0 for a hold-down.
"""

import math

from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import where_less


@kernel
def one_sided_stop(joint, depth, closing_rate):
    """Return a stop face's resisting torque [N m], its elastic part, and its slopes by depth and closing rate.

    The torque is k depth^e, plus damping that grows as a cubic STEP up to the depth `stop_ramp_depth`. It never pulls.
    """
    inside, exponent = where_less(0.0, depth, depth, 0.0), joint.stop_exponent
    growth = joint.stop_stiffness * (1.0 + 0.0 * inside if exponent == 1.0 else inside ** (exponent - 1.0))
    # A joint without stops has exponent 0, whose power is infinite: the elastic torque is zero outside.
    elastic, share = where_less(0.0, depth, growth * inside, 0.0), inside / joint.stop_ramp_depth
    ramp = where_less(share, 1.0, share, 1.0)
    damping = joint.stop_damping * ramp * ramp * (3.0 - 2.0 * ramp)
    torque = elastic + damping * closing_rate
    slope = exponent * growth + joint.stop_damping * 6.0 * ramp * (1.0 - ramp) / joint.stop_ramp_depth * closing_rate
    pushing = where_less(0.0, torque, torque, 0.0)
    return pushing, elastic, where_less(0.0, torque, slope, 0.0), where_less(0.0, torque, damping, 0.0)


@kernel
def stop_depth(joint, joint_state, angle):
    """Return the depth [rad] of a joint's `angle` in its stop, negative outside, and the sign of the stop's torque."""
    if joint_state.held:
        off = angle - joint.stow_angle
        return abs(off), where_less(0.0, off, -1.0, 1.0)
    below_stow = (joint.stow_angle - joint.stop_gap if joint.has_stow_stop else -math.inf) - angle
    if joint_state.latched:
        beyond = angle - joint.lock_angle
        depth = (beyond if joint.one_sided else abs(beyond)) - joint.stop_gap
        sign = where_less(depth, below_stow, 1.0, where_less(0.0, beyond, -1.0, 1.0))
        return where_less(depth, below_stow, below_stow, depth), sign
    return below_stow, 1.0 + 0.0 * angle


@kernel
def stop_torque(joint, joint_state, angle, rate):
    """Return the stops' torque on the joint angle [N m], its elastic part, and its slopes by angle and rate.

    A stop exerts no torque unless `joint_state` says that it is engaged, which changes only between steps: within a
    step of an explicit method, the torque is smooth.
    """
    if not joint_state.stop_engaged:
        nothing = 0.0 * angle
        return nothing, nothing, nothing, nothing
    depth, sign = stop_depth(joint, joint_state, angle)
    torque, elastic, slope, damping = one_sided_stop(joint, depth, -sign * rate)
    return sign * torque, sign * elastic, -slope, -damping


@kernel
def stop_energy(joint, joint_state, angle):
    """Return the elastic energy [J] of a joint's engaged stop at an angle [rad]."""
    depth, _ = stop_depth(joint, joint_state, angle)
    if depth <= 0.0 or not joint_state.stop_engaged:
        return 0.0
    return joint.stop_stiffness * depth ** (joint.stop_exponent + 1.0) / (joint.stop_exponent + 1.0)
