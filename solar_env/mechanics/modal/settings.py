"""Settings of the method for modal panels. Plain Python: choosing one needs no compiler."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class ModalRadau:
    """Adaptive two-stage Radau IIA on the loads of the joints, for rigid bodies and modal panels (`modal`).

    Attributes:
        rtol: local error of a step, of velocities relative to velocity_scale, of contact depths relative to themselves.
        velocity_scale: [m/s].
        max_step: [s].
        impact_resolution: least number of steps per predicted duration of an impact, 3 or more.
        max_steps: bound on the steps of one call.
    """

    rtol: float = 1e-3
    velocity_scale: float = 0.1
    max_step: float = math.inf
    impact_resolution: float = 6.0
    max_steps: int = 100_000_000

    name = "modal-radau"

    def __post_init__(self) -> None:
        if not 1e-10 <= self.rtol <= 1e-1:
            raise ValueError(f"rtol = {self.rtol!r} must lie between 1e-10 and 0.1")
        for name in ("velocity_scale", "impact_resolution"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} = {getattr(self, name)!r} must be positive and finite")
        if not self.max_step > 0.0:
            raise ValueError(f"max_step = {self.max_step!r} s must be positive")
        if self.impact_resolution < 3.0:
            raise ValueError(
                f"impact_resolution = {self.impact_resolution!r} must be at least 3: with fewer steps the exit speed "
                "of an impact is off by several percent"
            )
        if not (math.isfinite(self.max_steps) and self.max_steps >= 1 and int(self.max_steps) == self.max_steps):
            raise ValueError(f"max_steps = {self.max_steps!r} must be a whole number, at least 1")
