"""Verification of a single contact: a block strikes the wall of its gap. The equation of motion is separable.

The contact force is K depth^n (1 + d u). Here d is the damping factor, v the impact speed, and u = depth' / v. The
block's equation is m depth'' = -K depth^n (1 + d u), from depth 0 at u = 1. It separates: the integral of u / (1 + d u)
with respect to u equals the integral of -K depth^n / (m v^2) with respect to the depth. The left integral is
(u - ln(1 + d u) / d) / d, and the right integral is a power of the depth.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
from scipy.optimize import brentq
from scipy.special import beta

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, ModalRadau, RungeKutta
from solar_env.mechanics.joints.laws import CONTACT_LAWS, PowerLaw, Surfaces, contact_law, lankarani_damping
from solar_env.mechanics.mechanism import Bearing
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.verification.checks import MOMENTUM, Check, compare

MASS, CLEARANCE = 6.0, 2e-4  # kg, m
# Undamped Hertzian contact, and surfaces of a steel journal in a brass bearing.
UNDAMPED = PowerLaw(7.39e10)
SURFACES = Surfaces(0.0102, 0.0100, 1.0, 105e9, 0.34, 207e9, 0.3, bracket_stiffness=1e9)
# Impact speeds. Generalized-alpha warns at lower speeds, where a free block's constraint forces are rounding errors.
SPEEDS = {
    "runge-kutta": (1e-4, 1e-3, 1e-2, 0.1, 1.0),
    "generalized-alpha": (0.1, 1.0),
    "modal-radau": (1e-4, 1e-3, 1e-2, 0.1, 1.0),
}  # m/s
COEFFICIENTS = (0.1, 0.2, 0.4, 0.5, 0.7, 0.8, 0.9, 1.0)
RESOLVING: tuple[Integrator, ...] = (RungeKutta(), GeneralizedAlpha())
# Relative tolerances of exit speeds and of other results, three to seven times the greatest errors found.
EXIT_SPEED_ERROR = {"runge-kutta": 2.5e-4, "generalized-alpha": 0.005, "modal-radau": 0.02}
IMPACT_ERROR = {"runge-kutta": 2e-5, "generalized-alpha": 2e-4}
SEPARABLE = "exact: separable equation of motion"
HERTZ = "H. Hertz, 1881; K. L. Johnson, Contact Mechanics, 1985, section 11.4"


def restitution(d: float) -> float:
    """Return the exit/entry speed ratio e for damping factor d: d (1 + e) = ln[(1 + d) / (1 - d e)], at any speed."""
    if d == 0.0:
        return 1.0

    def excess(e: float) -> float:
        return math.log1p(d) - math.log1p(-d * e) - d * (1.0 + e)

    return float(brentq(excess, 0.0, min(1.0, 1.0 / d) * (1.0 - 1e-15), xtol=1e-15))


def greatest_depth(contact: PowerLaw, speed: float) -> float:
    """Return the greatest depth [m] in a 6 kg block's impact; undamped Hertz contact has (5 m v^2 / (4 K))^0.4."""
    d, power = contact.damping, contact.exponent + 1.0
    bracket = (d - math.log1p(d)) / d**2 if d else 0.5
    return float((power * MASS * speed**2 / contact.stiffness * bracket) ** (1.0 / power))


def undamped_duration(contact: PowerLaw, speed: float) -> float:
    """Return the duration [s] of an undamped impact: depth / speed times 2 B(1 / (n + 1), 1/2) / (n + 1).

    Here depth is the greatest depth, B the beta function, and the force K depth^n. With n = 1.5 the duration is
    2.94328 depth / speed (K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, section 11.4).
    """
    power = contact.exponent + 1.0
    depth = greatest_depth(replace(contact, damping=0.0), speed)
    return float(2.0 / power * beta(1.0 / power, 0.5) * depth / speed)


def _resolving(integrator: Integrator, duration: float, steps: int = 100) -> Integrator:
    """Return the integrator; a fixed step, if it has one, becomes `duration` [s] divided by `steps`."""
    return replace(integrator, step=duration / steps) if isinstance(integrator, GeneralizedAlpha) else integrator


def _bearing(contact: PowerLaw) -> Bearing:
    return Bearing(CLEARANCE, 0.01, contact)


def _speed_ratio(contact: PowerLaw, speed: float, integrator: Integrator) -> float:
    """Simulate one impact of a block on a wall; return the ratio of exit to entry speed."""
    duration = undamped_duration(contact, speed)
    simulation = Simulation(bouncing_block(_bearing(contact), MASS, speed), _resolving(integrator, duration, 40))
    simulation.advance(CLEARANCE / speed + 0.5 * duration)
    while simulation.state.joints[0]["in_contact"]:
        simulation.advance(simulation.time + duration)
    return -float(simulation.state.v[0]) / speed


def restitution_curve() -> Iterator[Check]:
    """Check the exit/entry speed ratio of every contact law by three integrators, at the worst of several speeds."""
    for integrator in (*RESOLVING, ModalRadau()):
        for law, coefficient in product(CONTACT_LAWS, COEFFICIENTS):
            contact = contact_law(law, SURFACES, coefficient)
            # The contact law `restitution` promises the restitution that it is given.
            exact = coefficient if law == "restitution" else restitution(contact.damping)
            ratios = np.array([_speed_ratio(contact, speed, integrator) for speed in SPEEDS[integrator.name]])
            obtained = ratios[np.argmax(np.abs(ratios - exact))]
            quantity = f"exit/entry speed, {law}, Ce = {coefficient:g}, {integrator.name}"
            yield Check(quantity, exact, obtained, EXIT_SPEED_ERROR[integrator.name], SEPARABLE, relative=True)


def _one_impact(contact: PowerLaw, speed: float, integrator: Integrator) -> Trajectory:
    """Return the motion of a block from mid-gap through its impact on a wall, with 2000 samples per impact duration."""
    duration = undamped_duration(contact, speed)
    mechanism = bouncing_block(_bearing(contact), MASS, speed)
    end = CLEARANCE / speed + 2.0 * duration
    return simulate(mechanism, end, integrator=_resolving(integrator, duration), output_step=duration / 2000)


def single_impact() -> Iterator[Check]:
    """Check a Hertzian impact, the depth of a damped impact, and a damped impact on a freely floating housing."""
    speed, housing = 0.1, 2.0 * MASS
    damped = replace(UNDAMPED, damping=lankarani_damping(0.5))
    for integrator in RESOLVING:
        depth = greatest_depth(UNDAMPED, speed)
        motion = _one_impact(UNDAMPED, speed, integrator)
        contact = motion.contacts[0]
        figures = (
            ("duration [s]", undamped_duration(UNDAMPED, speed), contact["end_s"] - contact["start_s"]),
            ("greatest depth [m]", depth, motion.penetration.max()),
            ("peak force [N]", UNDAMPED.stiffness * depth**1.5, contact["peak_force"]),
            ("impulse [N s]", 2.0 * MASS * speed, contact["impulse"]),
        )
        tolerance = IMPACT_ERROR[integrator.name]
        yield from compare(figures, f"Hertz, {{}}, {integrator.name}", tolerance, HERTZ, relative=True)
        obtained = _one_impact(damped, speed, integrator).penetration.max()
        quantity = f"Lankarani-Nikravesh, Ce = 0.5, greatest depth [m], {integrator.name}"
        yield Check(quantity, greatest_depth(damped, speed), obtained, tolerance, SEPARABLE, relative=True)
        resolving = _resolving(integrator, undamped_duration(damped, speed))
        struck = Simulation(bouncing_block(_bearing(damped), MASS, speed, housing), resolving)
        struck.advance(2.0 * CLEARANCE / speed)
        housing_speed, block_speed = float(struck.state.v[0]), float(struck.state.v[4])
        obtained = (housing_speed - block_speed) / speed
        quantity = f"free housing: separation speed over approach speed, {integrator.name}"
        exact = restitution(damped.damping)
        yield Check(quantity, exact, obtained, EXIT_SPEED_ERROR[integrator.name], SEPARABLE, relative=True)
        obtained = MASS * block_speed + housing * housing_speed
        quantity = f"free housing: momentum after impact [kg m/s], {integrator.name}"
        yield Check(quantity, MASS * speed, obtained, 1e-12, MOMENTUM, relative=True)
