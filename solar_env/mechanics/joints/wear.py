"""Archard wear of journal and bearing, stored as a depth for each circumferential bin.

Archard's law is dh = k p ds: wear depth h, coefficient k, pressure p, sliding distance s (J. F. Archard, J. Appl. Phys.
24 (1953) 981, doi:10.1063/1.1721448). The pressure is uniform over the arc that the journal presses into the bearing,
so that the worn volume of either surface is exactly k * integral of (normal force * sliding speed) dt. During a step
the middle of the pressed arc moves at constant speed along a second arc, the path of the contact on the surface.
"""

import math

from solar_env.mechanics.numerics.jit import kernel

_NARROWEST = 1e-9  # rad, narrowest half angle of an arc


@kernel
def pressed_half_angle(depth, clearance):
    """Return the half angle [rad] of the arc where a journal overlaps its bearing: arccos(c / (c + depth))."""
    return math.acos(clearance / (clearance + depth))


@kernel
def share_below(angle, wide, narrow):
    """Return the fraction of a step's wear at angles below `angle` [rad], measured from the middle of the worn zone.

    The middle of the contact's arc moves at constant speed along a second arc, its path. `wide` is the half angle of
    the wider arc, `narrow` of the narrower arc [rad]. The worn depth is the convolution of both arcs: uniform in the
    middle, with a linear fall to both sides.
    """
    distance = abs(angle)
    rest = wide + narrow - distance
    if rest <= 0.0:
        share = 0.0
    elif distance > wide - narrow:
        share = rest * rest / (8.0 * wide * narrow)
    else:
        share = 0.5 - 0.5 * distance / wide
    return share if angle < 0.0 else 1.0 - share


@kernel
def add_wear(depths, angle, pressed, moved, section, radius):
    """Add the wear of a step to a surface's bins: a pressed arc wears all places that it passes as its middle moves.

    Bin b of `depths` (bins,) [m] spans [b, b + 1) * 2 pi / bins in the surface's frame.

    Args:
        depths: wear depths; written.
        angle: middle of both arcs [rad].
        pressed, moved: half angles of the pressed arc and of the arc that its middle moves along [rad].
        section: worn cross-section area [m2].
        radius: radius of the surface [m].
    """
    bins = depths.size
    width = 2.0 * math.pi / bins
    wide, narrow = max(pressed, moved, _NARROWEST), min(pressed, moved)
    first, last = math.floor((angle - wide - narrow) / width), math.floor((angle + wide + narrow) / width)
    b, below = int(first) % bins, 0.0
    for k in range(int(last - first) + 1):
        end = first + k + 1.0
        share = share_below(end * width - angle, wide, narrow) if end <= last else 1.0
        depths[b] += (share - below) * section / (radius * width)
        below = share
        b = b + 1 if b + 1 < bins else 0
