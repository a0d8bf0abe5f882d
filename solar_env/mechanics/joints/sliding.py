"""How a journal that touches its bearing approaches it and slides in it."""

import math
from typing import NamedTuple

from solar_env.mechanics.joints.friction.laws import MATERIAL, PLACES
from solar_env.mechanics.numerics.jit import kernel


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


@kernel(inlined=True)
def sliding_share(joint, depth):
    """Sliding speed over the slip or, where the bodies' rotation is left out, over the centres' speed."""
    return depth / (joint.clearance + depth) if joint.sliding == PLACES and depth > 0.0 else 1.0


@kernel(inlined=True)
def contact_motion(joint, ex, ey, ux, uy, outboard_spin, inboard_spin):
    """Motion of a journal relative to its bearing, along and across the line of centres.

    Args:
        joint: row of the model.
        ex, ey: journal's centre relative to the bearing's [m].
        ux, uy: its rate [m/s].
        outboard_spin, inboard_spin: of journal and bearing [rad/s].
    """
    radius = math.sqrt(ex * ex + ey * ey)
    # A centred journal has no line of centres, and no contact either.
    size = radius if radius > 0.0 else 1.0
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
