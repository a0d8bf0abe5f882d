"""The integrators and their settings. Plain Python: choosing an integrator needs no compiler."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from solar_env.support.values import check_positive, is_number, plain

# Fewest steps per impact for an exit speed good to 1 %: measured (`studies/stability/impact_maps.py`).
FEWEST_EXPLICIT_STEPS = 4  # for explicit Runge-Kutta
_FEWEST_IMPLICIT_STEPS = 8  # for generalized-alpha, unless algorithmic damping needs more steps
# Angular frequency of a Hertzian contact at its greatest depth times the impact's duration: sqrt(15 / 8) * 2.94328.
_HERTZ_PHASE = math.sqrt(15.0 / 8.0) * 2.0 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)


@dataclass(frozen=True)
class RungeKutta:
    """Settings of the adaptive explicit Runge-Kutta method (`methods/runge_kutta.py`).

    Attributes:
        rtol: relative tolerance of a step's local error: for velocities relative to velocity_scale + |velocity|, for
            positions relative to the longest body.
        velocity_scale: velocity that is added to |velocity| in the tolerance [m/s].
        max_step: longest step [s].
        impact_resolution: least number of steps per predicted duration of an impact; 4 (`fewest_steps`) or more.
        max_steps: most steps, rejected or not, per `advance` call; the default takes about a minute with rigid panels.
        name: name of the integration method. Every method has this and the following class attributes.
        takes_drives: whether mechanisms may have drives.
        settles_forces: whether multipliers approach the constraint forces only some steps after a change of step size.
        steps_needed_per_impact: number of fixed steps that an impact needs; None if the steps adapt to impacts.
        loosest_in_contact: rtol up to which the forces of single contacts can be trusted.
        remedy: advice that makes the energy balance close better.
    """

    rtol: float = 1e-6
    velocity_scale: float = 0.1
    max_step: float = math.inf
    impact_resolution: float = 16.0
    max_steps: int = 20_000_000

    name = "runge-kutta"
    takes_drives = True
    settles_forces = False
    steps_needed_per_impact = None
    loosest_in_contact = math.inf
    remedy = property(lambda self: f"tighten rtol = {self.rtol:g}")
    fewest_steps = FEWEST_EXPLICIT_STEPS
    least_rtol = 1e-13

    def with_options(self, step: float | None, rtol: float | None) -> RungeKutta:
        """Return a copy with another longest step [s] or another tolerance; None keeps the present value."""
        if step is not None:
            check_positive("step", step, " s")
        return replace(self, max_step=self.max_step if step is None else step, rtol=self.rtol if rtol is None else rtol)

    def __post_init__(self) -> None:
        if not self.least_rtol <= self.rtol <= 1e-1:
            raise ValueError(f"rtol = {self.rtol!r} must lie between {self.least_rtol:g} and 0.1")
        _check_settings(self, ("velocity_scale", "impact_resolution"))
        if not self.max_step > 0.0:
            raise ValueError(f"max_step = {self.max_step!r} s must be positive")
        if self.impact_resolution < self.fewest_steps:
            raise ValueError(
                f"impact_resolution = {self.impact_resolution!r} must be at least {self.fewest_steps}: with fewer "
                "steps the exit speed of an impact is off by more than 1 %"
            )


@dataclass(frozen=True)
class Rosenbrock(RungeKutta):
    """Settings of explicit Runge-Kutta with linearly implicit steps where they save time (`methods/rosenbrock.py`).

    Stiff vibrations of flexible bodies do not limit the size of linearly implicit steps. In impacts, and wherever
    accuracy needs short steps anyway, steps remain explicit. Since impacts amplify earlier errors, explicit steps with
    flexible bodies tighten the tolerance in slow motion: while all speeds are below 2 velocity_scale, the scale in the
    tolerance falls with the square of the greatest speed. Mechanisms with drives are refused.
    """

    rtol: float = 1e-4

    name = "rosenbrock"
    takes_drives = False


@dataclass(frozen=True)
class ModalRadau(RungeKutta):
    """Settings of three-stage Radau IIA for rigid bodies and modal panels; it solves for forces and torques in joints.

    A velocity's tolerance [m/s] is rtol * velocity_scale. If every joint has clearance, slow hinges reduce this scale
    to the present fastest hinge rate times the longest body's length, but not below velocity_scale / 100. Errors of
    contact depths are relative to the depths. Mechanisms with drives or external loads are refused.
    """

    rtol: float = 4e-3
    velocity_scale: float = 0.025
    impact_resolution: float = 3.0

    name = "modal-radau"
    takes_drives = False
    fewest_steps = 3
    least_rtol = 1e-10
    # Up to this rtol no peak force of 30 deployments was wrong; at 0.03 five were, by factors of three to fifteen.
    loosest_in_contact = 1e-2


@dataclass(frozen=True)
class GeneralizedAlpha:
    """Settings of generalized-alpha with a fixed step on the index-3 equations (`methods/generalized_alpha.py`).

    Attributes:
        step: longest step [s]; a call of `advance` is divided into equal steps.
        rho_inf: spectral radius at infinite frequency, in [0, 1]; 1 gives Newmark's trapezoidal scheme.
        newton_tolerance: tolerance of a Newton correction of coordinates, relative to the longest body's length.
        max_steps: most steps per call of `advance`; the default takes about a minute with rigid panels.
    """

    step: float = 1e-4
    rho_inf: float = 0.8
    newton_tolerance: float = 1e-13
    max_steps: int = 20_000_000

    name = "generalized-alpha"
    takes_drives = True
    settles_forces = True
    loosest_in_contact = math.inf
    rtol = None
    remedy = "reduce the step"

    @property
    def steps_needed_per_impact(self) -> int:
        """Number of fixed steps that an impact needs for an exit speed good to 1 %."""
        return steps_per_impact(self.rho_inf)

    def with_options(self, step: float | None, rtol: float | None) -> GeneralizedAlpha:
        """Return a copy with another fixed step [s]; None keeps the present step.

        Raises:
            ValueError: if a tolerance is given.
        """
        if rtol is not None:
            raise ValueError(f"rtol = {rtol!r} does not apply to {self.name!r}, whose step is fixed; give a step")
        return self if step is None else replace(self, step=step)

    def __post_init__(self) -> None:
        if not 0.0 <= self.rho_inf <= 1.0:
            raise ValueError(f"rho_inf = {self.rho_inf!r} must lie in [0, 1]")
        if not 1e-9 <= self.step <= 1.0:
            raise ValueError(f"step = {self.step!r} s must lie between 1e-9 and 1 s")
        _check_settings(self, ("newton_tolerance",))


Integrator = RungeKutta | GeneralizedAlpha
# Settings class of every method, by the method's name; the kernels are in `methods/table.py`.
INTEGRATORS: dict[str, type[Integrator]] = {
    kind.name: kind for kind in (RungeKutta, Rosenbrock, ModalRadau, GeneralizedAlpha)
}


def _check_settings(integrator: Integrator, names: tuple[str, ...]) -> None:
    for name in names:
        check_positive(name, getattr(integrator, name))
    steps = plain(integrator.max_steps)
    if not (is_number(steps) and 1 <= steps < math.inf and int(steps) == steps):
        raise ValueError(f"max_steps = {steps!r} must be a whole number, at least 1")


def alpha_coefficients(rho_inf: float) -> tuple[float, float, float, float]:
    """Return (alpha_m, alpha_f, beta, gamma) for a spectral radius at infinite frequency (Chung and Hulbert 1993)."""
    alpha_m = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0)
    alpha_f = rho_inf / (rho_inf + 1.0)
    gamma = 0.5 + alpha_f - alpha_m
    return alpha_m, alpha_f, 0.25 * (0.5 + gamma) ** 2, gamma


@lru_cache(maxsize=64)
def steps_per_impact(rho_inf: float) -> int:
    """Return the number of steps that generalized-alpha needs in a Hertzian impact for an exit speed good to 1 %.

    At least 8 steps are needed, since an impact starts and ends inside a step. A small `rho_inf` needs more: every step
    multiplies the speed by the amplification matrix's spectral radius at the contact's frequency at the greatest depth.
    """
    steps = _FEWEST_IMPLICIT_STEPS
    while amplification_radius(rho_inf, _HERTZ_PHASE / steps) ** steps < 0.99:
        steps += 1
    return steps


def amplification_radius(rho_inf: float, phase: float) -> float:
    """Return the spectral radius of generalized-alpha for u'' = -omega^2 u at `phase` = omega * step.

    J. Chung and G. M. Hulbert, J. Appl. Mech. 60 (1993) 371, doi:10.1115/1.2900803.
    """
    alpha_m, alpha_f, beta, gamma = alpha_coefficients(rho_inf)
    square = phase * phase
    # Displacement, velocity * step and algorithmic acceleration * step^2 at the end, from those at the start.
    end = np.array([[1.0, 0.0, -beta], [0.0, 1.0, -gamma], [(1.0 - alpha_f) * square, 0.0, 1.0 - alpha_m]])
    start = np.array([[1.0, 1.0, 0.5 - beta], [0.0, 1.0, 1.0 - gamma], [-alpha_f * square, 0.0, -alpha_m]])
    return float(np.abs(np.linalg.eigvals(np.linalg.solve(end, start))).max())
