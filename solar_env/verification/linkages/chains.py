"""Cases of open chains: natural coordinates with constraints against minimal coordinates without."""

import math
from collections.abc import Iterator

import numpy as np

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY, Link, double_pendulum
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.checks import Check, compare
from solar_env.verification.linkages.chain_theory import MINIMAL, Chain, ChainLink


def double_pendulum_motion() -> Iterator[Check]:
    """A double pendulum of unequal links, released with spin, against its minimal coordinates after 2 s."""
    upper, lower = Link(1.0, 1.0, 0.1), Link(0.7, 2.0, 0.05)
    angles, spins, duration = (0.4, -0.8), (1.0, -2.0), 2.0
    links = [ChainLink(link.mass, link.inertia, link.length / 2 + 0j, link.length + 0j) for link in (upper, lower)]
    chain = Chain(links, gravity=STANDARD_GRAVITY)
    solution = chain.solve(angles, spins, lambda a, w: np.zeros(2), [duration])
    first, second = (float(angle) for angle in solution.y[:2, -1])
    elbow = np.array([math.cos(first), math.sin(first)]) * upper.length
    tip = elbow + np.array([math.cos(second), math.sin(second)]) * lower.length
    # Local tolerances add up; the second-order method's error is some (omega h)^2, omega = 10 rad/s.
    choices: tuple[tuple[Integrator, float], ...] = (
        (RungeKutta(rtol=1e-11), 1e-8),
        (GeneralizedAlpha(step=1e-4), 1e-5),
    )
    for integrator, tolerance in choices:
        simulation = Simulation(double_pendulum(upper, lower, angles, spins), integrator)
        simulation.advance(duration)
        figures = (("elbow", elbow, simulation.state.q[2:4]), ("tip", tip, simulation.state.q[6:8]))
        for name, expected, obtained in figures:
            quantity = f"{{}} of the {name} at t = 2 s [m], {integrator.name}"
            yield from compare(zip("xy", expected, obtained, strict=True), quantity, tolerance, MINIMAL)
