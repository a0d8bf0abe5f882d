"""Friction smoothed by a hyperbolic tangent: E. Pennestri et al., Nonlinear Dyn. 83 (2016) 1785."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class TanhCoulomb:
    """Coulomb's friction with tanh(v / speed) in place of the sign of the sliding speed v; speed in m/s."""

    code: ClassVar[int] = 2
    speed: float = 1e-3

    def __post_init__(self) -> None:
        if not 0.0 < self.speed < math.inf:
            raise ValueError(f"TanhCoulomb.speed = {self.speed!r}: must be positive")

    def parameters(self) -> tuple[float, ...]:
        """The attributes."""
        return (self.speed,)

    @staticmethod
    def share(parameters: Sequence[float], sliding_speed: float) -> tuple[float, float]:
        """Share of the Coulomb force at a sliding speed [m/s], with its sign, and its slope by the speed [s/m]."""
        step = math.tanh(sliding_speed / parameters[0])
        return step, (1.0 - step * step) / parameters[0]


def law(speed_zero: float, speed_full: float, static_ratio: float) -> TanhCoulomb:
    """The law at the second of the two friction speeds of the array's parameters."""
    return TanhCoulomb(speed_full)
