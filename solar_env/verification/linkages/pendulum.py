"""Cases of the simple pendulum released from the horizontal, whose motion elliptic functions give exactly."""

import math
import warnings
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism.description import Body, Mechanism
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY, pendulum
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.checks import ARNOLD_BRULS, Check, compare
from solar_env.verification.linkages.pendulum_theory import exact_pendulum, exact_period

RESTART = "a step change is a start from a state of second-order accuracy"
CARDONA_GERADIN = "A. Cardona and M. Geradin, Comput. Struct. 33 (1989) 801: weak instability"
EXACT = "exact: elliptic functions"
_START = 1.0  # s, when transients of the multipliers are looked at


def _run(integrator: Integrator, time: float) -> Simulation:
    simulation = Simulation(pendulum(), integrator)
    simulation.advance(time)
    return simulation


def _bob(simulation: Simulation) -> tuple[float, float]:
    return float(simulation.state.q[2]), float(simulation.state.q[3])


def _tension(simulation: Simulation) -> float:
    # The multipliers of the lengths, by body, follow those of the pins; times the length, 1 m, it is the tension.
    return float(simulation.state.multipliers[simulation.model.constraints.target.size])


def _period(integrator: Integrator, exact: float) -> float:
    """Period [s] from the fifth passage through a quarter period, which lies at the bottom."""
    simulation = _run(integrator, 1.25 * exact)
    x, y = _bob(simulation)
    speed = float(np.hypot(*simulation.state.v[2:4]))
    return (simulation.time + math.atan2(x, -y) / speed) / 1.25


def pendulum_motion() -> Iterator[Check]:
    """Period, positions, tension and energy."""
    period = exact_period()
    # The local tolerance, and (omega h)^2 = 1e-7 of the second-order method.
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
    """Errors of position [m] and of tension [N] after 1 s of fixed steps."""
    simulation = _run(GeneralizedAlpha(step=step, rho_inf=rho_inf), 1.0)
    x, y, tension = exact_pendulum(1.0)
    bob = _bob(simulation)
    return math.hypot(bob[0] - x, bob[1] - y), abs(_tension(simulation) - tension)


def generalized_alpha_order() -> Iterator[Check]:
    """Order of generalized-alpha in coordinates and in multipliers, from halving the step."""
    for rho_inf in (0.0, 0.8, 1.0):
        coarse, fine = (np.array(_errors(step, rho_inf)) for step in (4e-3, 2e-3))
        figures = zip(("coordinates", "multipliers"), (2.0, 2.0), np.log2(coarse / fine), strict=True)
        quantity = f"order of convergence in {{}}, rho_inf = {rho_inf:g}"
        yield from compare(figures, quantity, 0.1, ARNOLD_BRULS)


def _multiplier_errors(simulation: Simulation, step: float, count: int) -> NDArray[np.float64]:
    """(count,) errors of the tension [N] in the next steps."""
    errors = np.zeros(count)
    start = simulation.time
    for k in range(count):
        simulation.advance(start + (k + 1) * step)
        errors[k] = _tension(simulation) - exact_pendulum(_START + simulation.time - start)[2]
    return errors


def _moving_pendulum() -> Mechanism:
    """The pendulum as it passes at _START."""
    x, y, _ = exact_pendulum(_START)
    x_next, y_next, _ = exact_pendulum(_START + 1e-6)
    spin = math.copysign(math.sqrt(-2.0 * STANDARD_GRAVITY * y), x * y_next - y * x_next)
    released = pendulum(angle=math.atan2(y, x))
    (bob,) = released.bodies
    assert isinstance(bob, Body)
    return replace(released, bodies=(replace(bob, spin=spin),))


def multiplier_transients() -> Iterator[Check]:
    """The mode of the multipliers that every start or step change from a state with velocity excites."""
    fresh = Simulation(_moving_pendulum(), GeneralizedAlpha(step=1e-3))
    start_error = np.abs(_multiplier_errors(fresh, 1e-3, 200)).max()
    changed = _run(GeneralizedAlpha(step=1e-2), _START)
    changed.integrator = GeneralizedAlpha(step=1e-3)
    obtained = np.abs(_multiplier_errors(changed, 1e-3, 200)).max() / start_error
    quantity = "tension's error after a step change 0.01 -> 0.001 s over that after a start, rho_inf = 0.8"
    yield Check(quantity, 1.0, obtained, 1.0, RESTART)
    trapezoidal = Simulation(_moving_pendulum(), GeneralizedAlpha(step=1e-2, rho_inf=1.0))
    with warnings.catch_warnings():
        # What the library warns of is what is measured here.
        warnings.simplefilter("ignore", SimulationWarning)
        errors = _multiplier_errors(trapezoidal, 1e-2, 40)
    obtained = errors[-1] / errors[-2]
    yield Check("factor of the tension's error from step to step, rho_inf = 1", -1.0, obtained, 0.1, CARDONA_GERADIN)
