"""Table of the friction laws by name. Plain Python: describing a mechanism needs no compiler."""

from __future__ import annotations

from solar_env.mechanics.joints.friction.ramp import RampedCoulomb

FrictionLaw = RampedCoulomb
# Readings of the sliding speed: that of the material points in contact, or of the centres (paper, Eq 35).
SLIDING_READINGS = ("material", "centres")
MATERIAL, CENTRES = range(2)

FRICTION_LAWS: dict[str, type[FrictionLaw]] = {"ramp": RampedCoulomb}
