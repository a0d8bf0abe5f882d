"""Cases of the free-floating array with clearance: conservation of momenta and energy."""

from collections.abc import Iterator

import numpy as np

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.verification.beams.fields import momenta
from solar_env.verification.checks import Check

BOOKS = "conservation of energy: stored + dissipated = put in"
NO_LOADS = "no external force or moment acts"
ARCHARD = "J. F. Archard, J. Appl. Phys. 24 (1953) 981"


def conserved(
    quantity: str,
    mechanism: Mechanism,
    motion: Trajectory,
    linear_tolerance: float = 1e-13,
    angular_tolerance: float = 3e-7,
) -> Iterator[Check]:
    """Momenta and energy that a free array must keep.

    Args:
        quantity: of the checks, with {} for what is conserved.
        mechanism, motion: of the array.
        linear_tolerance, angular_tolerance: by default six or more times the errors of explicit steps at rtol 1e-6.
    """
    linear, angular = momenta(mechanism, motion)
    # The linear one is subject to rounding alone; the angular one, a product, to the steps' local error.
    for name, both, tolerance in (("linear", linear, linear_tolerance), ("angular", angular, angular_tolerance)):
        obtained = np.abs(both.sum(axis=1)).max() / np.abs(both).sum(axis=1).max()
        yield Check(
            quantity.format(f"{name} momentum over the sum of the bodies' ones"), 0.0, obtained, tolerance, NO_LOADS
        )
    # Some ten times the local tolerance
    obtained = motion.energy_residual / motion.energy_put_in
    yield Check(quantity.format("energy residual over the energy put in"), 0.0, obtained, 1e-5, BOOKS)


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
        volume = motion.wear_bearing.sum(axis=1) * 2.0 * np.pi / parameters.wear_bins
        volume *= (motion.journal_radius + motion.clearance) * parameters.bearing_width
        worn = parameters.wear_coefficient * motion.sliding_work[-1]
        quantity = f"{{}}, {duration:g} s, {integrator.name}"
        yield from conserved(quantity, mechanism, motion, linear_tolerance, angular_tolerance)
        obtained = np.abs(volume / worn - 1.0).max()
        yield Check(quantity.format("worn volume less k * sliding work, relative"), 0.0, obtained, 1e-9, ARCHARD)
