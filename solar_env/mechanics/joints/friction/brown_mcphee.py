"""Smooth friction of P. Brown and J. McPhee, J. Comput. Nonlinear Dyn. 11 (2016) 054502, doi:10.1115/1.4033658.

Without its viscous part.
"""

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from typing import ClassVar

from solar_env.mechanics.numerics.checks import require, require_finite, require_signs


@dataclass(frozen=True)
class BrownMcPhee:
    """Friction that is infinitely often differentiable, with a peak of static friction.

    Attributes:
        transition_speed: sliding speed of the greatest friction [m/s].
        static_ratio: coefficient of static over that of sliding friction, at least 1.
    """

    code: ClassVar[int] = 1

    transition_speed: float = 1e-3
    static_ratio: float = 1.0

    def __post_init__(self) -> None:
        require_finite(self)
        require_signs(self, positive=("transition_speed",))
        require(self.static_ratio >= 1.0, self, "static_ratio", self.static_ratio, "must be at least 1")

    def parameters(self) -> tuple[float, ...]:
        """The attributes."""
        return astuple(self)

    @staticmethod
    def share(parameters: Sequence[float], sliding_speed: float) -> tuple[float, float]:
        """Share of the Coulomb force at a sliding speed [m/s], with its sign, and its slope by the speed [s/m].

        tanh(4 x) + (static ratio - 1) x / (x^2 / 4 + 3 / 4)^2 with x = sliding over transition speed.
        """
        x = sliding_speed / parameters[0]
        bump = parameters[1] - 1.0
        step = math.tanh(4.0 * x)
        width = 0.25 * x * x + 0.75
        slope = 4.0 * (1.0 - step * step) + bump * (width - x * x) / width**3
        return step + bump * x / (width * width), slope / parameters[0]


def law(speed_zero: float, speed_full: float, static_ratio: float) -> BrownMcPhee:
    """The law of Brown and McPhee with its greatest friction at the second speed; it sets in at once."""
    return BrownMcPhee(speed_full, static_ratio)
