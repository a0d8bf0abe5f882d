"""Normal forces that grow with a power of the depth, damped in proportion to it.

F = K depth^n (1 + d rate / v), never attractive, with the speed v at which the contact began and a damping factor d
(K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440, doi:10.1115/1.3423596). The static
methods are compiled in `normal_force.py`; they hold for positive depths.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import ClassVar

from solar_env.mechanics.numerics.checks import require, require_finite, require_signs


def impact_defect(d: float, e: float) -> float:
    """Defect ln[(1 + d) / (1 - d e)] - d (1 + e) of the equation between damping factor and exit over entry speed."""
    room = 1.0 - d * e
    return math.log1p(d) - math.log(room) - d * (1.0 + e) if room > 0.0 else math.inf


def bisect(function: Callable[[float], float], low: float, high: float) -> float:
    """Root of a function that is negative at `low` and positive at `high`."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if function(middle) > 0.0 else (middle, high)
    return low


@dataclass(frozen=True)
class PowerLaw:
    """The normal force F = K depth^n (1 + d rate / v).

    Attributes:
        stiffness: K [N/m^n]: its unit depends on the exponent.
        exponent: n (dimensionless, 1 to 2); 1.5 for the point contact of spheres.
        damping: damping factor d (dimensionless).
    """

    code: ClassVar[int] = 0

    stiffness: float
    exponent: float = 1.5
    damping: float = 0.0

    def __post_init__(self) -> None:
        require_finite(self)
        require_signs(self, positive=("stiffness",), not_negative=("damping",))
        require(1.0 <= self.exponent <= 2.0, self, "exponent", self.exponent, "must lie between 1 and 2")

    def parameters(self) -> tuple[float, ...]:
        """The attributes, and the duration of an undamped impact in units of greatest depth over impact speed.

        That is twice the integral of dx / sqrt(1 - x^(n+1)) from 0 to 1: 2 sqrt(pi) Gamma(1 + p) / Gamma(1/2 + p) with
        p = 1 / (n + 1); 2.94328 for n = 1.5 (K. L. Johnson, Contact Mechanics, 1985, section 11.4).
        """
        p = 1.0 / (self.exponent + 1.0)
        duration = 2.0 * math.sqrt(math.pi) * math.gamma(1.0 + p) / math.gamma(0.5 + p)
        return (*(getattr(self, item.name) for item in fields(self)), duration)

    def depth_under(self, load: float) -> float:
        """Depth [m] at which the contact at rest carries a load [N]."""
        return float((load / self.stiffness) ** (1.0 / self.exponent))

    def exit_speed_ratio(self) -> float:
        """Exit over entry speed of an impact, whatever mass, speed, stiffness and exponent.

        The equation of motion m depth'' = -F separates: d (1 + e) = ln[(1 + d) / (1 - d e)].
        """
        d = self.damping
        if d < 3e-4:
            return 1.0 - 2.0 / 3.0 * d + 4.0 / 9.0 * d * d  # the terms of the equation cancel there
        return bisect(lambda e: impact_defect(d, e), 0.0, min(1.0, 1.0 / d))

    @staticmethod
    def force(
        parameters: Sequence[float], depth: float, rate: float, impact_speed: float
    ) -> tuple[float, float, float, float]:
        """Normal force [N], compressive positive, its elastic part, and its slopes by depth [N/m] and rate [N s/m]."""
        stiffness, exponent, damping = parameters[0], parameters[1], parameters[2]
        # A square root costs a tenth of a power.
        growth = math.sqrt(depth) if exponent == 1.5 else depth ** (exponent - 1.0)
        elastic = stiffness * depth * growth
        bracket = 1.0 + damping * rate / impact_speed
        if bracket <= 0.0:
            return 0.0, elastic, 0.0, 0.0
        return elastic * bracket, elastic, exponent * stiffness * growth * bracket, elastic * damping / impact_speed

    @staticmethod
    def energy(parameters: Sequence[float], depth: float) -> float:
        """Stored energy [J]."""
        stiffness, exponent = parameters[0], parameters[1]
        growth = math.sqrt(depth) if exponent == 1.5 else depth ** (exponent - 1.0)
        return 1.0 / (exponent + 1.0) * stiffness * depth * depth * growth

    @staticmethod
    def impact_scales(parameters: Sequence[float], inverse_mass: float, impact_speed: float) -> tuple[float, float]:
        """Greatest depth [m] and duration [s] of an impact without damping, at an inverse effective mass [1/kg]."""
        stiffness, power = parameters[0], parameters[1] + 1.0
        depth = (0.5 * power * impact_speed * impact_speed / (inverse_mass * stiffness)) ** (1.0 / power)
        return depth, parameters[3] * depth / impact_speed
