"""Contact laws compiled, and their dispatch: the normal force of a joint's contact by the code of its law."""

import math

from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.numerics.jit import kernel

POWER_LAW = PowerLaw.code
_power_force = kernel(PowerLaw.force, inlined=True)
_power_energy = kernel(PowerLaw.energy)
_power_scales = kernel(PowerLaw.impact_scales)


@kernel(inlined=True)
def normal_force(joint, depth, rate, impact_speed):
    """Normal force [N], compressive positive, its elastic part, and its slopes by depth [N/m] and rate [N s/m].

    Args:
        joint: row of the model.
        depth: of penetration [m]; nothing acts where it is not positive.
        rate: of the depth [m/s].
        impact_speed: with which the contact began [m/s], positive.
    """
    if depth <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    if joint.contact_law == POWER_LAW:
        return _power_force(joint.contact, depth, rate, impact_speed)
    return math.nan, math.nan, math.nan, math.nan


@kernel
def contact_energy(joint, depth):
    """Energy [J] that a contact stores at a depth [m]."""
    if depth <= 0.0:
        return 0.0
    if joint.contact_law == POWER_LAW:
        return _power_energy(joint.contact, depth)
    return math.nan


@kernel
def impact_scales(joint, inverse_mass, impact_speed):
    """Greatest depth [m] and duration [s] of an impact without damping, at an inverse effective mass [1/kg]."""
    if joint.contact_law == POWER_LAW:
        return _power_scales(joint.contact, inverse_mass, impact_speed)
    return math.nan, math.nan
