"""Verification cases of the simple pendulum, released from the horizontal; elliptic functions are the exact solution.

E. T. Whittaker, A Treatise on the Analytical Dynamics of Particles and Rigid Bodies, 4th ed., 1937, section 44.
"""

import math
from collections.abc import Iterator

import numpy as np
from scipy.special import ellipj, ellipk

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism import STANDARD_GRAVITY, pendulum
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.checks import ARNOLD_BRULS, Check, compare

EXACT = "exact: elliptic functions"
_PARAMETER = 0.5  # sin^2 of half the amplitude, which is a right angle


def exact_period() -> float:
    """Return the exact period [s] of the pendulum, of amplitude 90 degrees, by the complete elliptic integral."""
    return 4.0 * float(ellipk(_PARAMETER)) / math.sqrt(STANDARD_GRAVITY)


def exact_pendulum(time: float) -> tuple[float, float, float]:
    """Return x, y [m] and tension [N] of a pendulum (1 m, 1 kg, 9.81 m/s2) `time` [s] after release from (1, 0)."""
    frequency = math.sqrt(STANDARD_GRAVITY)
    _, cn, dn, _ = ellipj(frequency * time, _PARAMETER)
    angle = 2.0 * math.asin(math.sqrt(_PARAMETER) * cn / dn)  # from the vertical
    # Energy gives the centripetal acceleration 2 g cos(angle).
    return math.sin(angle), -math.cos(angle), 3.0 * STANDARD_GRAVITY * math.cos(angle)


def _run(integrator: Integrator, time: float) -> Simulation:
    simulation = Simulation(pendulum(), integrator)
    simulation.advance(time)
    return simulation


def _bob(simulation: Simulation) -> tuple[float, float]:
    return float(simulation.state.q[2]), float(simulation.state.q[3])


def _tension(simulation: Simulation) -> float:
    # Length multipliers of the bodies follow the pins' multipliers; times the length, 1 m, this one is the tension.
    return float(simulation.state.multipliers[simulation.model.constraints.target.size])


def _period(integrator: Integrator, exact: float) -> float:
    """Return the simulated period [s], from the time of the passage through the bottom near 5/4 of the exact period."""
    simulation = _run(integrator, 1.25 * exact)
    x, y = _bob(simulation)
    speed = float(np.hypot(*simulation.state.v[2:4]))
    return (simulation.time + math.atan2(x, -y) / speed) / 1.25


def pendulum_motion() -> Iterator[Check]:
    """Check period, positions, tension and energy of the simulated pendulum."""
    period = exact_period()
    # Tolerances allow for the local tolerance, and for (omega h)^2 = 1e-7 of the second-order method.
    for integrator, tolerance in ((RungeKutta(rtol=1e-10), 1e-8), (GeneralizedAlpha(step=1e-4), 1e-6)):
        figures = [("period [s]", period, _period(integrator, period))]
        for time in (1.0, 2.0):
            simulation = _run(integrator, time)
            names = ("x", "y", "tension")
            obtained = (*_bob(simulation), _tension(simulation))
            for name, exact, value in zip(names, exact_pendulum(time), obtained, strict=True):
                figures.append((f"{name} at t = {time:g} s [{'N' if name == 'tension' else 'm'}]", exact, value))
        figures.append(("energy gained in 2 s [J]", 0.0, simulation.energy_residual()))
        for name, expected, value in figures:
            yield Check(f"{name}, {integrator.name}", expected, value, tolerance * max(1.0, abs(expected)), EXACT)


def _errors(step: float, rho_inf: float) -> tuple[float, float]:
    """Return the errors of position [m] and tension [N] after 1 s of generalized-alpha with a fixed `step` [s]."""
    simulation = _run(GeneralizedAlpha(step=step, rho_inf=rho_inf), 1.0)
    x, y, tension = exact_pendulum(1.0)
    bob = _bob(simulation)
    return math.hypot(bob[0] - x, bob[1] - y), abs(_tension(simulation) - tension)


def generalized_alpha_order() -> Iterator[Check]:
    """Check the convergence order of generalized-alpha in coordinates and in multipliers, by halving the step."""
    for rho_inf in (0.0, 0.8, 1.0):
        coarse, fine = (np.array(_errors(step, rho_inf)) for step in (4e-3, 2e-3))
        figures = zip(("coordinates", "multipliers"), (2.0, 2.0), np.log2(coarse / fine), strict=True)
        quantity = f"order of convergence in {{}}, rho_inf = {rho_inf:g}"
        yield from compare(figures, quantity, 0.1, ARNOLD_BRULS)
