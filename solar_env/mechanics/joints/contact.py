"""Contact of a journal in its bearing, compiled: its motion, its normal force, and its friction."""

from typing import NamedTuple

from solar_env.mechanics.joints.laws import MATERIAL, PLACES, PowerLaw
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import cube_roots, square_roots, where_less

_HERTZ = 1.5  # the exponent of a contact of spheres, whose powers are roots
_LEAST_BRACKET = 0.05  # of 1 + d rate / v: below it a contact parts, and its depth under a load says nothing
_power_energy = kernel(PowerLaw.energy, inlined=False)
_power_scales = kernel(PowerLaw.impact_scales, inlined=False)


class ContactMotion(NamedTuple):
    """Line of centres of a contact and the velocities along and across it.

    Attributes:
        depth: of penetration [m].
        normal_x, normal_y: unit vector from the bearing's centre to the journal's; (-normal_y, normal_x) is across.
        radius: distance of the centres [m].
        lever: distance of the place of contact from the bearing's centre [m].
        rate: of the depth [m/s].
        centre_speed: of the journal's centre across the line of centres, relative to the bearing's [m/s].
        slip: speed of the journal's material point relative to the bearing's [m/s].
        sliding_speed: speed that the joint's friction and wear take [m/s]: the slip, the centres' speed, or the speed
            of the places of contact.
    """

    depth: float
    normal_x: float
    normal_y: float
    radius: float
    lever: float
    rate: float
    centre_speed: float
    slip: float
    sliding_speed: float


@kernel
def sliding_share(joint, depth):
    """Return the sliding speed divided by the slip or, without the bodies' rotation, by the centres' speed."""
    if joint.sliding == PLACES:
        return where_less(0.0, depth, depth / (joint.clearance + depth), 1.0)
    return 1.0 + 0.0 * depth


@kernel
def contact_motion(joint, ex, ey, ux, uy, outboard_spin, inboard_spin):
    """Return the motion of a journal whose centre lies (ex, ey) [m] off its bearing's and moves at (ux, uy) [m/s].

    It takes numbers, or vectors of several configurations.
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
    """Return the compressive normal force [N], its elastic part, and its slopes by depth [N/m] and rate [N s/m].

    Nothing acts where the depth is not positive; the contact began at the `impact_speed` [m/s]. It takes numbers, or
    vectors of several configurations. The law is `PowerLaw`.
    """
    stiffness, exponent, damping = joint.contact[0], joint.contact[1], joint.contact[2] / impact_speed
    inside = where_less(0.0, depth, depth, 0.0)
    growth = stiffness * (square_roots(inside) if exponent == _HERTZ else inside ** (exponent - 1.0))
    elastic, bracket = growth * inside, 1.0 + damping * rate
    pressing = where_less(0.0, depth, where_less(0.0, bracket, bracket, 0.0), 0.0)
    return elastic * pressing, elastic, exponent * growth * pressing, where_less(0.0, bracket, damping * elastic, 0.0)


@kernel
def depth_under(joint, load, rate, impact_speed, give):
    """Return the depth [m] at which a contact carries a `load` [N], and the force's slopes there by depth and rate.

    All are zero where the contact is no stiffer than bodies that give way by `give` [m/N], parts, or carries nothing.
    It takes vectors.
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
    """Return the energy [J] that a contact stores at a depth [m]."""
    return _power_energy(joint.contact, depth) if depth > 0.0 else 0.0


@kernel(inlined=False)
def impact_scales(joint, inverse_mass, impact_speed):
    """Return the greatest depth [m] and duration [s] of an undamped impact, by the inverse effective mass [1/kg]."""
    return _power_scales(joint.contact, inverse_mass, impact_speed)


@kernel
def friction_share(joint, sliding_speed):
    """Return the share of the Coulomb force at a sliding speed [m/s], with its sign, and its slope by the speed [s/m].

    Friction is ramped in between two speeds (Y. Li, C. Wang and W. Huang, Mech. Syst. Signal Process. 117 (2019) 188,
    Eqs 41-42). It takes numbers, or vectors of several configurations.
    """
    zero = joint.friction_speed_zero
    steepness = 1.0 / (joint.friction_speed_full - zero)
    ramp = steepness * (abs(sliding_speed) - zero)
    share = where_less(ramp, 1.0, where_less(0.0, ramp, ramp, 0.0), 1.0)
    slope = where_less(0.0, ramp, where_less(ramp, 1.0, steepness, 0.0), 0.0)
    return where_less(sliding_speed, 0.0, -share, share), slope
