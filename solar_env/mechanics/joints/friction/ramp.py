"""Coulomb's friction, ramped in linearly between two sliding speeds.

Y. Li, C. Wang and W. Huang, Mech. Syst. Signal Process. 117 (2019) 188, Eqs 41-42.
"""

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from typing import ClassVar


@dataclass(frozen=True)
class RampedCoulomb:
    """Friction that sets in at one sliding speed and is Coulomb's from another one on.

    Attributes:
        speed_zero: sliding speed up to which there is none [m/s].
        speed_full: sliding speed from which on it is full [m/s].
    """

    code: ClassVar[int] = 0

    speed_zero: float = 1e-4
    speed_full: float = 1e-3

    def __post_init__(self) -> None:
        if not 0.0 <= self.speed_zero < self.speed_full < math.inf:
            raise ValueError(
                f"speed_zero = {self.speed_zero!r}, speed_full = {self.speed_full!r} must satisfy 0 <= first < second"
            )

    def parameters(self) -> tuple[float, ...]:
        """The attributes."""
        return astuple(self)

    @staticmethod
    def share(parameters: Sequence[float], sliding_speed: float) -> tuple[float, float]:
        """Share of the Coulomb force at a sliding speed [m/s], with its sign, and its slope by the speed [s/m]."""
        zero, full = parameters[0], parameters[1]
        magnitude = abs(sliding_speed)
        if magnitude <= zero:
            return 0.0, 0.0
        sign = 1.0 if sliding_speed > 0.0 else -1.0
        if magnitude >= full:
            return sign, 0.0
        return sign * (magnitude - zero) / (full - zero), 1.0 / (full - zero)


def law(speed_zero: float, speed_full: float, static_ratio: float) -> RampedCoulomb:
    """Coulomb's friction ramped in between two speeds.

    Raises:
        ValueError: if static friction is to differ from sliding friction, or the speeds do not rise from zero.
    """
    if static_ratio != 1.0:
        raise ValueError(
            f"static_friction_ratio = {static_ratio!r} must be 1 with friction_law = 'ramp'; choose another"
        )
    return RampedCoulomb(speed_zero, speed_full)
