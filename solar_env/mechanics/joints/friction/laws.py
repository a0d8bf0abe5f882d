"""Table of the friction laws by name. Plain Python: describing a mechanism needs no compiler."""

from collections.abc import Callable

from solar_env.mechanics.joints.friction import brown_mcphee, ramp

FrictionLaw = ramp.RampedCoulomb | brown_mcphee.BrownMcPhee
# Readings of the sliding speed: that of the material points in contact, that of the centres across their line, or that
# of the places of contact, which travel round with this line: depth / (clearance + depth) of the centres' (Eq 35).
SLIDING_READINGS = ("material", "centres", "places")
MATERIAL, CENTRES, PLACES = range(3)

# By the speeds at which friction sets in and is full [m/s], and the ratio of static to sliding friction.
FRICTION_LAWS: dict[str, Callable[[float, float, float], FrictionLaw]] = {
    "ramp": ramp.law,
    "brown-mcphee": brown_mcphee.law,
}
