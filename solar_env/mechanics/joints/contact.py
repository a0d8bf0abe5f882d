"""Contact of a journal in its bearing, compiled: its motion, its normal force, and its friction."""

from typing import NamedTuple

from solar_env.mechanics.joints.laws import MATERIAL, PLACES, PowerLaw
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import square_roots, where_less

_power_force = kernel(PowerLaw.force)
_power_depth = kernel(PowerLaw.depth_and_slopes)
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
        slip: of the journal's material point over the bearing's [m/s].
        sliding_speed: the one that the joint's friction and wear go by [m/s]: the slip, the centres' speed, or that of
            the places of contact.
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
    """Sliding speed over the slip or, where the bodies' rotation is left out, over the centres' speed."""
    if joint.sliding == PLACES:
        return where_less(0.0, depth, depth / (joint.clearance + depth), 1.0)
    return 1.0 + 0.0 * depth


@kernel
def contact_motion(joint, ex, ey, ux, uy, outboard_spin, inboard_spin):
    """Motion of a journal whose centre lies (ex, ey) [m] off its bearing's and moves at (ux, uy) [m/s].

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
    """Normal force [N], compressive positive, its elastic part, and its slopes by depth [N/m] and rate [N s/m].

    Nothing acts where the depth is not positive; the contact began at the `impact_speed` [m/s].
    """
    if depth <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    return _power_force(joint.contact, depth, rate, impact_speed)


@kernel
def depth_under(joint, load, rate, impact_speed, give):
    """Depth [m] at which a contact carries a positive `load` [N], and the force's slopes there by depth and rate.

    All are zero where the contact is no stiffer than what gives way by `give` [m/N], or parts.
    """
    return _power_depth(joint.contact, load, rate, impact_speed, give)


@kernel(inlined=False)
def contact_energy(joint, depth):
    """Energy [J] that a contact stores at a depth [m]."""
    return _power_energy(joint.contact, depth) if depth > 0.0 else 0.0


@kernel(inlined=False)
def impact_scales(joint, inverse_mass, impact_speed):
    """Greatest depth [m] and duration [s] of an impact without damping, at an inverse effective mass [1/kg]."""
    return _power_scales(joint.contact, inverse_mass, impact_speed)


@kernel
def friction_share(joint, sliding_speed):
    """Share of the Coulomb force at a sliding speed [m/s], with its sign, and its slope by the speed [s/m].

    Friction is ramped in between two speeds (Y. Li, C. Wang and W. Huang, Mech. Syst. Signal Process. 117 (2019) 188,
    Eqs 41-42).
    """
    zero, full = joint.friction_speed_zero, joint.friction_speed_full
    magnitude = abs(sliding_speed)
    if magnitude <= zero:
        return 0.0, 0.0
    sign = 1.0 if sliding_speed > 0.0 else -1.0
    if magnitude >= full:
        return sign, 0.0
    return sign * (magnitude - zero) / (full - zero), 1.0 / (full - zero)
