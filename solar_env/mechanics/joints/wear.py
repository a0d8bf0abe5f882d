"""Archard wear of journal and bearing, kept as a depth per circumferential bin.

dh = k p ds (J. F. Archard, J. Appl. Phys. 24 (1953) 981, doi:10.1063/1.1721448), with the pressure p spread evenly
over the arc that the journal presses into the bearing, so that the worn volume of either surface is
k * integral of (normal force * sliding speed) dt exactly.
"""

import math

from solar_env.mechanics.numerics.jit import kernel


@kernel
def pressed_half_angle(depth, clearance):
    """Half angle [rad] of the arc along which a journal circle overlaps its bearing's: arccos(c / (c + depth))."""
    return math.acos(clearance / (clearance + depth))


@kernel
def add_wear(depths, angle, half_angle, depth_increment_times_arc, radius):
    """Spread a wear increment over the bins that the arc angle +- half_angle covers, each by its covered share.

    Bin b of `depths` (bins,) [m] spans [b, b + 1) * 2 pi / bins in the surface's frame. The increment is the worn
    cross-section area [m2], the radius that of the surface [m].
    """
    bins = depths.size
    width = 2.0 * math.pi / bins
    half = max(half_angle, 1e-9)
    per_radian = depth_increment_times_arc / (2.0 * half) / (radius * width)
    low = (angle - half) / width
    high = (angle + half) / width
    first = math.floor(low)
    last = math.floor(high)
    b = int(first) % bins
    for k in range(int(last - first) + 1):
        covered = (min(high, first + k + 1.0) - max(low, first + k)) * width
        depths[b] += per_radian * covered
        b = b + 1 if b + 1 < bins else 0
