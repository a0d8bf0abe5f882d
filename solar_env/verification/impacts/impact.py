"""Cases of a single contact: a block that strikes the wall of its gap."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, ModalRadau, RungeKutta
from solar_env.mechanics.joints.laws import CONTACT_LAWS, PowerLaw, Surfaces, contact_law, lankarani_damping, sphere
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.verification.checks import MOMENTUM, Check, compare
from solar_env.verification.impacts.impact_theory import greatest_depth, restitution, undamped_duration

GOLDSMITH = "W. Goldsmith, Impact, Arnold 1960; hand calculation to three digits"
MASS = 6.0  # kg
# Spheres; a steel journal in a brass bearing.
UNDAMPED = PowerLaw(7.39e10)
DAMPED = replace(UNDAMPED, damping=lankarani_damping(0.9))
SURFACES = Surfaces(0.0102, 0.0100, 1.0, 105e9, 0.34, 207e9, 0.3)
CLEARANCE = 2e-4  # m
# Slower, the constraint forces of a free block are rounding, of which generalized-alpha warns.
SPEEDS = {
    "runge-kutta": (1e-4, 1e-3, 1e-2, 0.1, 1.0),
    "generalized-alpha": (1e-2, 0.1, 1.0),
    "modal-radau": (1e-4, 1e-3, 1e-2, 0.1, 1.0),
}  # m/s
COEFFICIENTS = (0.1, 0.2, 0.4, 0.5, 0.7, 0.8, 0.9, 1.0)
RESOLVING: tuple[Integrator, ...] = (RungeKutta(), GeneralizedAlpha(rtol=1e-5))
# Errors of one impact with them, three to seven times the greatest ones found: of exit speeds, and of the rest.
EXIT_SPEED_ERROR = {"runge-kutta": 2.5e-4, "generalized-alpha": 0.005, "modal-radau": 0.02}
IMPACT_ERROR = {"runge-kutta": 2e-5, "generalized-alpha": 2e-4}
SEPARABLE = "exact: separable equation of motion"
HERTZ = "H. Hertz, 1881; K. L. Johnson, Contact Mechanics, 1985, section 11.4"


def _bearing(contact: PowerLaw) -> Bearing:
    return Bearing(CLEARANCE, 0.01, contact)


def _speed_ratio(contact: PowerLaw, speed: float, integrator: Integrator) -> float:
    """Exit over entry speed of one bounce off the wall."""
    simulation = Simulation(bouncing_block(_bearing(contact), MASS, speed), integrator)
    duration = undamped_duration(MASS, contact, speed)
    own = simulation.state.joints[0]
    simulation.advance(CLEARANCE / speed + 0.5 * duration)
    while own["in_contact"]:
        simulation.advance(simulation.time + duration)
    return -float(simulation.state.v[0]) / speed


def restitution_curve() -> Iterator[Check]:
    """Exit over entry speed for every law, at default tolerance; of several speeds the worst."""
    for integrator in (*RESOLVING, ModalRadau()):
        for law, coefficient in product(CONTACT_LAWS, COEFFICIENTS):
            contact = contact_law(law, SURFACES, coefficient)
            # That law claims to give what it is asked for.
            exact = coefficient if law == "restitution" else restitution(contact.damping)
            ratios = np.array([_speed_ratio(contact, speed, integrator) for speed in SPEEDS[integrator.name]])
            obtained = ratios[np.argmax(np.abs(ratios - exact))]
            quantity = f"exit/entry speed, {law}, Ce = {coefficient:g}, {integrator.name}"
            yield Check(quantity, exact, obtained, EXIT_SPEED_ERROR[integrator.name], SEPARABLE, relative=True)


def _one_impact(contact: PowerLaw, speed: float, integrator: Integrator) -> Trajectory:
    """Motion from the middle of the gap until well before the far wall, sampled 2000 times an impact."""
    duration = undamped_duration(MASS, contact, speed)
    mechanism = bouncing_block(_bearing(contact), MASS, speed)
    return simulate(mechanism, CLEARANCE / speed + 2.0 * duration, integrator=integrator, output_step=duration / 2000)


def single_impact() -> Iterator[Check]:
    """Duration, greatest depth and peak force of a Hertzian impact; depth of a Lankarani-Nikravesh one."""
    speed = 0.1
    for integrator in RESOLVING:
        depth = greatest_depth(MASS, UNDAMPED, speed)
        motion = _one_impact(UNDAMPED, speed, integrator)
        contact = motion.contacts[0]
        figures = (
            ("duration [s]", undamped_duration(MASS, UNDAMPED, speed), contact["end_s"] - contact["start_s"]),
            ("greatest depth [m]", depth, motion.penetration.max()),
            ("peak force [N]", UNDAMPED.stiffness * depth**1.5, contact["peak_force"]),
            ("impulse [N s]", 2.0 * MASS * speed, contact["impulse"]),
        )
        tolerance = IMPACT_ERROR[integrator.name]
        yield from compare(figures, f"Hertz, {{}}, {integrator.name}", tolerance, HERTZ, relative=True)
        damped = replace(UNDAMPED, damping=lankarani_damping(0.5))
        obtained = _one_impact(damped, speed, integrator).penetration.max()
        quantity = f"Lankarani-Nikravesh, Ce = 0.5, greatest depth [m], {integrator.name}"
        yield Check(quantity, greatest_depth(MASS, damped, speed), obtained, tolerance, SEPARABLE, relative=True)


def alternate_walls() -> Iterator[Check]:
    """Ten bounces between the walls of a gap, and one against the wall of a housing that floats freely."""
    speed, bounces = 0.1, 10
    ratio = restitution(DAMPED.damping)
    for integrator in RESOLVING:
        # The n-th flight is 2 c long, the first one c, at speed v e^n.
        flights = CLEARANCE / speed + sum(2.0 * CLEARANCE / (speed * ratio**n) for n in range(1, bounces))
        motion = simulate(
            bouncing_block(_bearing(DAMPED), MASS, speed),
            flights + 0.5 * CLEARANCE / (speed * ratio**bounces) + 10.0 * undamped_duration(MASS, UNDAMPED, speed),
            integrator=integrator,
        )
        yield Check(f"contacts between two walls, {integrator.name}", bounces, motion.contact_starts[0], 0.0, SEPARABLE)
        obtained = abs(float(motion.velocities[-1, 0]))
        quantity = f"speed after {bounces} bounces [m/s], {integrator.name}"
        tolerance = EXIT_SPEED_ERROR[integrator.name] * bounces
        yield Check(quantity, speed * ratio**bounces, obtained, tolerance, SEPARABLE, relative=True)
        housing = 2.0 * MASS
        struck = Simulation(bouncing_block(_bearing(DAMPED), MASS, speed, housing), integrator)
        struck.advance(2.0 * CLEARANCE / speed)
        housing_speed, block_speed = float(struck.state.v[0]), float(struck.state.v[4])
        obtained = (housing_speed - block_speed) / speed
        quantity = f"free housing: separation speed over approach speed, {integrator.name}"
        yield Check(quantity, ratio, obtained, EXIT_SPEED_ERROR[integrator.name], SEPARABLE, relative=True)
        obtained = MASS * block_speed + housing * housing_speed
        quantity = f"free housing: momentum after impact [kg m/s], {integrator.name}"
        yield Check(quantity, MASS * speed, obtained, 1e-12, MOMENTUM, relative=True)


def contact_stiffness() -> Iterator[Check]:
    """Stiffness from radii and materials; a steel journal in a brass bearing."""
    obtained = sphere(SURFACES, 0.0).stiffness
    yield Check("K of steel in brass, R = 10 mm, c = 0.2 mm [N/m^1.5]", 7.43e10, obtained, 0.005e10, GOLDSMITH)
