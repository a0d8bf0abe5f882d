"""Friction laws compiled, and their dispatch by the code of a joint's law."""

import math

from solar_env.mechanics.joints.friction.brown_mcphee import BrownMcPhee
from solar_env.mechanics.joints.friction.ramp import RampedCoulomb
from solar_env.mechanics.numerics.jit import kernel

RAMP, BROWN_MCPHEE = RampedCoulomb.code, BrownMcPhee.code
_ramp_share = kernel(RampedCoulomb.share, inlined=True)
_brown_mcphee_share = kernel(BrownMcPhee.share)


@kernel(inlined=True)
def friction_share(joint, sliding_speed):
    """Share of the Coulomb force at a sliding speed [m/s], with its sign, and its slope by the speed [s/m]."""
    if joint.friction_law == RAMP:
        return _ramp_share(joint.friction, sliding_speed)
    if joint.friction_law == BROWN_MCPHEE:
        return _brown_mcphee_share(joint.friction, sliding_speed)
    return math.nan, math.nan
