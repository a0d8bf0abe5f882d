"""Cases of a mass that strikes the end of a free panel: along its axis, and across it."""

import math
from collections.abc import Iterator

import numpy as np

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.beams import BEAM, PANEL
from solar_env.mechanics.mechanism.description import Bearing, Body, Joint, Mechanism
from solar_env.verification.checks import Check
from solar_env.verification.panels.impact_theory import Impact, Struck, struck_bar, struck_beam
from solar_env.verification.panels.mechanisms import modal, start
from solar_env.verification.panels.theory import FineBeam

CLEARANCE = 0.01  # m
# Hertz's stiffness of the array's joints, whose contacts rise to an axial wave's force in 0.07 ms.
STIFF = 7.39e10  # N/m^1.5
STRIKER = "striker"


def _strike(impact: Impact, direction: complex, modes: int, duration: float) -> tuple[float, float, float, float]:
    """Peak force [N], impulse [N s], speed of the striker afterwards [m/s], and number of contacts."""
    place, velocity = CLEARANCE * direction, impact.speed * direction
    origin, motion = (place.real, place.imag), (velocity.real, velocity.imag)
    striker = Body(STRIKER, impact.mass, 1.0, 1.0, (0.0, 0.0), position=origin, velocity=motion)
    bearing = Bearing(CLEARANCE, 0.1, PowerLaw(impact.stiffness))
    joint = Joint("contact", BEAM, STRIKER, (0.0, 0.0), (0.0, 0.0), bearing=bearing)
    simulation = start(Mechanism((modal(PANEL, modes), striker), (joint,)), rtol=1e-5)
    simulation.advance(duration)
    own = simulation.state.joints[0]
    first = int(simulation.model.bodies["offset"][1])
    speed = complex(simulation.state.v[first], simulation.state.v[first + 1]) * direction.conjugate()
    impulse = m.joint_integrals(simulation.state.integrals)[0, m.IMPULSE]
    return float(own["peak_force"]), float(impulse), speed.real, float(own["contact_starts"])


def _checks(
    impact: Impact, exact: Struck, direction: complex, modes: int, errors: tuple[float, float, float], source: str
) -> Iterator[Check]:
    label = f"{impact.mass:g} kg at {impact.speed:g} m/s, modes = {modes}"
    found = _strike(impact, direction, modes, float(exact.time[-1]))
    names = ("peak force [N]", "impulse [N s]", "speed of the mass afterwards [m/s]")
    whole = float(np.trapezoid(exact.force, exact.time))
    wanted = (float(exact.force.max()), whole, exact.exit_speed)
    for name, expected, obtained, tolerance in zip(names, wanted, found, errors, strict=False):
        # Of the speed relative to that before.
        scale = impact.speed if "speed" in name else abs(expected)
        yield Check(f"{label}: {name}", expected, obtained, tolerance * scale, source)
    if modes > 100:
        contacts = np.count_nonzero((exact.force[1:] > 0.0) & (exact.force[:-1] <= 0.0))
        yield Check(f"{label}: contacts", int(contacts), found[3], 0.0, source)


def struck_along() -> Iterator[Check]:
    """A bar struck at its end, until the wave that its other end returns as tension parts the two."""
    impedance = math.sqrt(PANEL.axial_stiffness * PANEL.linear_density)
    wave_speed = math.sqrt(PANEL.axial_stiffness / PANEL.linear_density)
    impact = Impact(6.0, 0.01, STIFF)
    exact = struck_bar(impact, PANEL.length, impedance, wave_speed)
    # Half as many axial modes; the error of the peak falls with their number.
    for modes, errors in ((24, (0.05, 1e-3, 1e-3)), (96, (3e-3, 5e-5, 5e-5)), (200, (3e-4, 1e-5, 1e-5))):
        yield from _checks(impact, exact, 1.0 + 0.0j, modes, errors, "St. Venant's waves, with Hertz's contact")


def struck_across() -> Iterator[Check]:
    """A beam struck across its end: a dozen contacts in four milliseconds, and one that lasts."""
    theory = FineBeam(PANEL, modes=3000)
    hard, soft = Impact(2.0, 0.1, STIFF), Impact(0.5, 0.01, 0.1 * STIFF)
    for impact, modes, errors in (
        (hard, 24, (0.02, 0.01, 2.5e-3)),
        (hard, 200, (1e-4, 1e-5, 1e-5)),
        (soft, 24, (0.01, 4e-3, 2e-3)),
        (soft, 200, (3e-5, 1e-6, 1e-6)),
    ):
        exact = struck_beam(impact, theory, 4e-3, 4000)
        yield from _checks(impact, exact, 1j, modes, errors, "Euler-Bernoulli, 3000 exact modes, Hertz's contact")
