"""One impact in closed form: m depth'' = -K depth^1.5 (1 + d depth' / v), from depth 0 at the speed v.

With u = depth' / v the equation separates into u du / (1 + d u) = -K depth^1.5 d(depth) / (m v^2), which
integrates to (u - ln(1 + d u) / d) / d on the left and a power of the depth on the right.
"""

from __future__ import annotations

import math

from scipy.optimize import brentq
from scipy.special import gamma


def restitution(d: float) -> float:
    """Ratio e of exit to entry speed: d (1 + e) = ln[(1 + d) / (1 - d e)]; independent of m, v and K."""
    if d == 0.0:
        return 1.0

    def excess(e: float) -> float:
        return math.log1p(d) - math.log1p(-d * e) - d * (1.0 + e)

    return float(brentq(excess, 0.0, min(1.0, 1.0 / d) * (1.0 - 1e-15), xtol=1e-15))


def greatest_depth(mass: float, stiffness: float, speed: float, d: float) -> float:
    """Depth at which the approach ends [m]; Hertz's (5 m v^2 / (4 K))^0.4 for d = 0."""
    bracket = (d - math.log1p(d)) / d**2 if d else 0.5
    return float((2.5 * mass * speed**2 / stiffness * bracket) ** 0.4)


def hertz_duration(mass: float, stiffness: float, speed: float) -> float:
    """Duration [s] of an impact without damping: 2 sqrt(pi) Gamma(7/5) / Gamma(9/10) = 2.94328 depths over
    speed.

    K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, section 11.4.
    """
    factor = 2.0 * math.sqrt(math.pi) * gamma(1.4) / gamma(0.9)
    return float(factor * greatest_depth(mass, stiffness, speed, 0.0) / speed)
