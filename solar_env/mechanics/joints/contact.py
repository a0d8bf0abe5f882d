"""Compiled contact of a journal (the pin of a joint) in its bearing: relative motion, normal force and friction."""

from typing import NamedTuple

from solar_env.mechanics.joints.laws import MATERIAL, PLACES, PowerLaw
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import cube_roots, square_roots, where_less

_HERTZ = 1.5  # exponent of the contact of spheres, for which square and cube roots replace powers
_LEAST_BRACKET = 0.05  # least bracket 1 + d rate / v of the contact law; below it no depth follows from a load
_power_energy = kernel(PowerLaw.energy, inlined=False)
_power_scales = kernel(PowerLaw.impact_scales, inlined=False)


class ContactMotion(NamedTuple):
    """Line of centres of a contact, and the velocities along and across this line."""

    depth: float  # penetration depth [m], negative for a gap
    normal_x: float  # unit vector from bearing centre to journal centre; (-normal_y, normal_x) points across it
    normal_y: float
    radius: float  # distance between the centres [m]
    lever: float  # distance from the bearing's centre to the contact point [m]
    rate: float  # rate of the depth [m/s]
    centre_speed: float  # of the journal's centre relative to the bearing's, across the line of centres [m/s]
    slip: float  # speed of the journal's material point relative to the bearing's material point [m/s]
    sliding_speed: float  # speed that friction and wear use [m/s]: slip, centre speed, or speed of the contact point


@kernel
def sliding_share(joint, depth):
    """Return the partial derivative of the sliding speed with respect to the centres' relative speed at `depth` [m].

    `joint.sliding` defines the sliding speed. If it is PLACES, the sliding speed in contact is the depth times the
    turning rate of the line of centres (Li et al. 2019, Eq 35), and the derivative is depth / (clearance + depth).
    Out of contact, and for the definitions MATERIAL and CENTRES, the derivative is 1.
    """
    if joint.sliding == PLACES:
        return where_less(0.0, depth, depth / (joint.clearance + depth), 1.0)
    return 1.0 + 0.0 * depth


@kernel
def contact_motion(joint, ex, ey, ux, uy, outboard_spin, inboard_spin):
    """Return the `ContactMotion` of a journal at (ex, ey) [m] with velocity (ux, uy) [m/s] relative to its bearing.

    `outboard_spin` and `inboard_spin` are the angular velocities [rad/s] of the bodies with the journal and the
    bearing. Arguments are numbers, or vectors with several configurations.
    """
    radius = square_roots(ex * ex + ey * ey)
    # A centred journal has no line of centres, and no contact either.
    size = where_less(0.0, radius, radius, 1.0)
    nx, ny = ex / size, ey / size
    lever = joint.journal_radius + radius
    across = uy * nx - ux * ny
    slip = across + joint.journal_radius * outboard_spin - lever * inboard_spin
    return ContactMotion(
        depth=radius - joint.clearance,
        normal_x=nx,
        normal_y=ny,
        radius=radius,
        lever=lever,
        rate=ux * nx + uy * ny,
        centre_speed=across,
        slip=slip,
        sliding_speed=slip if joint.sliding == MATERIAL else across * sliding_share(joint, radius - joint.clearance),
    )


@kernel
def normal_force(joint, depth, rate, impact_speed):
    """Return the compressive normal force [N], its elastic part [N], and its slopes by depth [N/m] and rate [N s/m].

    The force is K depth^n (1 + d rate / v) (`PowerLaw`), not below zero, and zero where the depth is not positive.
    `impact_speed` is v, the speed at which the contact began [m/s]. Depth and rate may be vectors.
    """
    stiffness, exponent, damping = joint.contact[0], joint.contact[1], joint.contact[2] / impact_speed
    inside = where_less(0.0, depth, depth, 0.0)
    growth = stiffness * (square_roots(inside) if exponent == _HERTZ else inside ** (exponent - 1.0))
    elastic, bracket = growth * inside, 1.0 + damping * rate
    pressing = where_less(0.0, depth, where_less(0.0, bracket, bracket, 0.0), 0.0)
    return elastic * pressing, elastic, exponent * growth * pressing, where_less(0.0, bracket, damping * elastic, 0.0)


@kernel
def depth_under(joint, load, rate, impact_speed, give):
    """Return the depth [m] at which a contact carries a `load` [N], and the force's slopes by depth and rate there.

    `rate` is the depth's rate [m/s], and `give` is how far both bodies yield per unit force [m/N]. `load`, `rate` and
    `give` are vectors with an element per stage of a step. All three results are zero where the surfaces part fast or
    carry no load, or where the slope by depth is at most 1 / `give`. The caller then uses the present depth.
    """
    stiffness, exponent, damping = joint.contact[0], joint.contact[1], joint.contact[2] / impact_speed
    bracket = 1.0 + damping * rate
    elastic = where_less(_LEAST_BRACKET, bracket, load / bracket, 0.0)
    root = cube_roots(elastic / stiffness)
    depth = root * root if exponent == _HERTZ else (elastic / stiffness) ** (1.0 / exponent)
    stiff = where_less(depth, exponent * elastic * bracket * give, depth, 0.0)
    slope = where_less(0.0, stiff, exponent * load / depth, 0.0)
    return stiff, slope, where_less(0.0, stiff, damping * elastic, 0.0)


@kernel(inlined=False)
def contact_energy(joint, depth):
    """Return the elastic energy [J] that a contact stores at a penetration depth [m]."""
    return _power_energy(joint.contact, depth) if depth > 0.0 else 0.0


@kernel(inlined=False)
def impact_scales(joint, inverse_mass, impact_speed):
    """Return the greatest depth [m] and duration [s] of an undamped impact, given its inverse effective mass [1/kg]."""
    return _power_scales(joint.contact, inverse_mass, impact_speed)


@kernel
def friction_share(joint, sliding_speed):
    """Return the signed ratio of friction to Coulomb friction at a sliding speed [m/s], and the ratio's slope [s/m].

    The ratio rises linearly from 0 to 1 between the joint's two friction speeds (Y. Li, C. Wang and W. Huang, Mech.
    Syst. Signal Process. 117 (2019) 188, Eqs 41-42). `sliding_speed` may be a vector of several speeds.
    """
    zero = joint.friction_speed_zero
    steepness = 1.0 / (joint.friction_speed_full - zero)
    ramp = steepness * (abs(sliding_speed) - zero)
    share = where_less(ramp, 1.0, where_less(0.0, ramp, ramp, 0.0), 1.0)
    slope = where_less(0.0, ramp, where_less(ramp, 1.0, steepness, 0.0), 0.0)
    return where_less(sliding_speed, 0.0, -share, share), slope
