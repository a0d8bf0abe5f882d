"""The simple pendulum of 1 m and 1 kg under 9.81 m/s2, released at rest from the horizontal.

E. T. Whittaker, A Treatise on the Analytical Dynamics of Particles and Rigid Bodies, 4th ed., Cambridge 1937,
section 44.
"""

import math

from scipy.special import ellipj, ellipk

GRAVITY = 9.81
PARAMETER = 0.5  # sin^2 of half the amplitude, which is a right angle


def exact_period() -> float:
    """Period [s]."""
    return 4.0 * float(ellipk(PARAMETER)) / math.sqrt(GRAVITY)


def exact_pendulum(time: float) -> tuple[float, float, float]:
    """Position (x, y) [m] of the bob and tension [N] at a time [s], for 1 m, 1 kg and g = 9.81 m/s2."""
    frequency = math.sqrt(GRAVITY)
    _, cn, dn, _ = ellipj(frequency * time, PARAMETER)
    angle = 2.0 * math.asin(math.sqrt(PARAMETER) * cn / dn)  # from the vertical
    # Energy gives the centripetal acceleration 2 g cos(angle).
    return math.sin(angle), -math.cos(angle), 3.0 * GRAVITY * math.cos(angle)
