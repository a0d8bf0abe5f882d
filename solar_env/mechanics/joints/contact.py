"""Contact laws of a journal in its bearing: penetration depth, its rate and the sliding speed to forces.

Normal force (all laws): F = K depth^1.5 (1 + d rate / impact speed), never attractive. The damping factor d is the
law: see ``laws.damping_factor``.

Friction: Coulomb, ramped linearly between two sliding speeds (Li, Wang and Huang, Mech. Syst. Signal Process. 117
(2019) 188, Eqs 41-42).
"""

from __future__ import annotations

import math

from solar_env.mechanics.numerics.jit import kernel

# Duration of a Hertzian impact in units of (greatest depth / impact speed): 2 sqrt(pi) Gamma(7/5) / Gamma(9/10).
HERTZ_DURATION = 2.0 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)


@kernel(inlined=True)
def normal_force(depth, rate, stiffness, factor, impact_speed):
    """Normal force [N], compressive positive, and its elastic part, at a penetration depth [m] and its rate [m/s]."""
    if depth <= 0.0:
        return 0.0, 0.0
    elastic = stiffness * depth * math.sqrt(depth)
    return max(elastic * (1.0 + factor * rate / impact_speed), 0.0), elastic


@kernel
def normal_force_slopes(depth, rate, stiffness, factor, impact_speed):
    """Derivatives of :func:`normal_force` with respect to depth and rate."""
    if depth <= 0.0:
        return 0.0, 0.0
    bracket = 1.0 + factor * rate / impact_speed
    if bracket <= 0.0:
        return 0.0, 0.0
    root = math.sqrt(depth)
    return 1.5 * stiffness * root * bracket, stiffness * depth * root * factor / impact_speed


@kernel(inlined=True)
def friction_ramp(sliding_speed, speed_zero, speed_full):
    """Share of the Coulomb force that acts at a sliding speed [m/s], with its sign: 0 below, 1 above the two speeds."""
    magnitude = abs(sliding_speed)
    if magnitude <= speed_zero:
        return 0.0
    sign = 1.0 if sliding_speed > 0.0 else -1.0
    if magnitude >= speed_full:
        return sign
    return sign * (magnitude - speed_zero) / (speed_full - speed_zero)


@kernel
def friction_ramp_slope(sliding_speed, speed_zero, speed_full):
    """Derivative of :func:`friction_ramp`."""
    magnitude = abs(sliding_speed)
    if magnitude <= speed_zero or magnitude >= speed_full:
        return 0.0
    return 1.0 / (speed_full - speed_zero)


@kernel
def impact_scales(stiffness, inverse_mass, impact_speed):
    """Greatest depth [m] and duration [s] of a Hertzian impact (Johnson, Contact Mechanics, 1985, section 11.4)."""
    depth = (1.25 * impact_speed * impact_speed / (inverse_mass * stiffness)) ** 0.4
    return depth, HERTZ_DURATION * depth / impact_speed
