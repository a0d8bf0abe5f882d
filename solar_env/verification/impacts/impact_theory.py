"""One impact in closed form: m depth'' = -K depth^n (1 + d depth' / v), from depth 0 at the speed v.

With u = depth' / v the equation separates into u du / (1 + d u) = -K depth^n d(depth) / (m v^2), which
integrates to (u - ln(1 + d u) / d) / d on the left and a power of the depth on the right.
"""

import math
from dataclasses import replace

from scipy.optimize import brentq
from scipy.special import beta

from solar_env.mechanics.joints.laws import PowerLaw


def restitution(d: float) -> float:
    """Ratio e of exit to entry speed: d (1 + e) = ln[(1 + d) / (1 - d e)]; independent of m, v, K and n."""
    if d == 0.0:
        return 1.0

    def excess(e: float) -> float:
        return math.log1p(d) - math.log1p(-d * e) - d * (1.0 + e)

    return float(brentq(excess, 0.0, min(1.0, 1.0 / d) * (1.0 - 1e-15), xtol=1e-15))


def greatest_depth(mass: float, contact: PowerLaw, speed: float) -> float:
    """Depth at which the approach ends [m]; Hertz's (5 m v^2 / (4 K))^0.4 for n = 1.5 and d = 0."""
    d, power = contact.damping, contact.exponent + 1.0
    bracket = (d - math.log1p(d)) / d**2 if d else 0.5
    return float((power * mass * speed**2 / contact.stiffness * bracket) ** (1.0 / power))


def undamped_duration(mass: float, contact: PowerLaw, speed: float) -> float:
    """Duration [s] of an impact if it is not damped: 2 B(1 / (n + 1), 1/2) / (n + 1) depths over speed.

    With the beta function B it is twice the integral of d(depth) / rate; 2.94328 for n = 1.5 (K. L. Johnson, Contact
    Mechanics, Cambridge University Press 1985, section 11.4).
    """
    power = contact.exponent + 1.0
    return float(
        2.0 / power * beta(1.0 / power, 0.5) * greatest_depth(mass, replace(contact, damping=0.0), speed) / speed
    )
