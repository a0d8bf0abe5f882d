"""Cases of the free-floating array with clearance: conservation of momenta and energy."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.verification.beams.fields import momenta
from solar_env.verification.checks import Check

ISOLATED = "no external force or moment acts"


def conserved(
    linear: NDArray[np.complex128],
    angular: NDArray[np.float64],
    motion: Trajectory,
    linear_tolerance: float = 1e-13,
    angular_tolerance: float = 3e-7,
) -> tuple[tuple[str, float, float, str], ...]:
    """Momenta and energy that a free array must keep: what, its relative error, the tolerance, the source.

    Args:
        linear, angular: of the bodies over time, as `momenta` returns them.
        motion: of the array.
        linear_tolerance, angular_tolerance: by default six or more times the errors of explicit steps at rtol 1e-6.
    """
    return (
        (
            "linear momentum over the sum of the bodies' ones",
            np.abs(linear.sum(axis=1)).max() / np.abs(linear).sum(axis=1).max(),
            linear_tolerance,  # rounding
            ISOLATED,
        ),
        (
            "angular momentum over the sum of the bodies' ones",
            np.abs(angular.sum(axis=1)).max() / np.abs(angular).sum(axis=1).max(),
            angular_tolerance,  # a product of coordinates and velocities: the steps' local error
            ISOLATED,
        ),
        (
            "energy residual over the energy put in",
            motion.energy_residual / motion.energy_put_in,
            1e-5,  # some ten times the local tolerance
            "conservation of energy: stored + dissipated = put in",
        ),
    )


def free_array() -> Iterator[Check]:
    """Momentum, energy and wear of a deployment with impacts, friction, latching and a cable loop."""
    parameters = ArrayParameters()
    mechanism = build(parameters, "rigid-clearance")
    # Steps are longest between impacts, when journals rest; generalized-alpha adds the tolerance of Newton's iteration.
    runs: tuple[tuple[Integrator, float, float, float], ...] = (
        (RungeKutta(rtol=1e-6), 30.0, 1.5e-14, 3e-6),
        (GeneralizedAlpha(rtol=1e-6), 15.0, 1e-8, 1e-5),
    )
    for integrator, duration, linear_tolerance, angular_tolerance in runs:
        motion = simulate(mechanism, duration, integrator=integrator)
        linear, angular = momenta(mechanism, motion)
        volume = motion.wear_bearing.sum(axis=1) * 2.0 * np.pi / parameters.wear_bins
        volume *= (motion.journal_radius + motion.clearance) * parameters.bearing_width
        worn = parameters.wear_coefficient * motion.sliding_work[-1]
        figures = (
            *conserved(linear, angular, motion, linear_tolerance, angular_tolerance),
            (
                "worn volume less k * sliding work, relative",
                np.abs(volume / worn - 1.0).max(),
                1e-9,
                "J. F. Archard, J. Appl. Phys. 24 (1953) 981",
            ),
        )
        for name, obtained, tolerance, source in figures:
            yield Check(
                quantity=f"{name}, {duration:g} s, {integrator.name}",
                obtained=float(obtained),
                tolerance=tolerance,
                source=source,
            )
