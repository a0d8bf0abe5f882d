"""Verification cases of a mass that strikes the end of a free panel, along the panel's axis and across it.

The reference solutions are elastic waves in a bar, and thousands of exact modes of a beam.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism import Bearing, Body, Joint, Mechanism
from solar_env.mechanics.mechanism.beams import BEAM, PANEL
from solar_env.verification.beams.theory import FineBeam
from solar_env.verification.checks import Check
from solar_env.verification.panels.mechanisms import modal, start

Array = NDArray[np.float64]

ST_VENANT = "St. Venant's waves, with Hertz's contact"
EXACT_MODES = "Euler-Bernoulli, 3000 exact modes, Hertz's contact"
CLEARANCE = 0.01  # m
# Hertz's stiffness of the array's joints; a contact force reaches the force of an axial wave in 0.07 ms.
STIFF = 7.39e10  # N/m^1.5


@dataclass(frozen=True)
class Impact:
    """A rigid mass that strikes an end of a free beam or bar through a Hertzian contact, F = K depth^1.5.

    Attributes:
        mass: mass of the striker [kg].
        speed: speed of the striker before the impact [m/s].
        stiffness: K [N/m^1.5].
    """

    mass: float
    speed: float
    stiffness: float

    def force(self, depth: float) -> float:
        """Return the Hertzian contact force [N] at a depth [m]."""
        return self.stiffness * max(depth, 0.0) ** 1.5


@dataclass(frozen=True)
class Struck:
    """Outcome of an impact: times [s], contact forces [N] at these times, and striker's speed afterwards [m/s]."""

    time: Array
    force: Array
    exit_speed: float


def struck_bar(impact: Impact, length: float, impedance: float, wave_speed: float) -> Struck:
    """Return times, contact forces and the striker's exit speed (`Struck`) for an axial impact on an end of a free bar.

    The far end reflects waves as tension. Under the contact force F the struck end has the speed
    F(t) / z + 2 sum_n F(t - n T) / z, T = 2 length / wave_speed (J. N. Goodier and S. P. Timoshenko, Theory of
    Elasticity, 3rd ed., 1970; K. F. Graff, Wave Motion in Elastic Solids, 1975). A rigid contact would give St.
    Venant's solution, F = z v0 exp(-z t / m) up to T.

    Args:
        impact: mass m and speed v0 of the striker, and stiffness of the contact.
        length: length of the bar [m].
        impedance: z = sqrt(E A rho A) [kg/s].
        wave_speed: sqrt(E / rho) [m/s].
    """
    there_and_back = 2.0 * length / wave_speed
    segments: list[Callable[[float], Array]] = []

    def slope(time: float, state: Array) -> tuple[float, float, float]:
        force = impact.force(state[0] - state[2])
        returned = 0.0
        for number, segment in enumerate(reversed(segments), 1):
            then = segment(time - number * there_and_back)
            returned += 2.0 * impact.force(float(then[0] - then[2]))
        return float(state[1]), -force / impact.mass, (force + returned) / impedance

    def parted(_: float, state: Array) -> float:
        return float(state[0] - state[2]) if state[1] < impact.speed else 1.0

    parted.terminal, parted.direction = True, -1.0  # type: ignore[attr-defined]
    state, times, forces = np.array([0.0, impact.speed, 0.0]), [], []
    while True:
        first = len(segments) * there_and_back
        found = solve_ivp(
            slope,
            (first, first + there_and_back),
            state,
            "DOP853",
            dense_output=True,
            events=parted,
            rtol=1e-10,
            atol=1e-16,
            max_step=there_and_back / 200.0,
        )
        time = np.linspace(first, found.t[-1], 2000)
        times.append(time)
        forces.append(np.array([impact.force(float(y[0] - y[2])) for y in found.sol(time).T]))
        state = found.y[:, -1]
        segments.append(found.sol)
        if found.status == 1:
            return Struck(np.concatenate(times), np.concatenate(forces), float(state[1]))


def struck_beam(impact: Impact, beam: FineBeam, duration: float, steps: int) -> Struck:
    """Return times, contact forces and striker's exit speed (`Struck`) of an impact across a free beam's first end.

    The response of the beam's modes to a piecewise linear force is exact. The force at the end of every step solves one
    scalar equation. The error falls with the square of the step.

    Args:
        impact: mass and speed of the striker, and stiffness of the contact.
        beam: the beam, undamped.
        duration: simulated time [s]; the contact must have ended by then.
        steps: number of steps.
    """
    h = duration / steps
    omega, row = beam.frequencies, beam.first_end[0]
    cosine, sine = np.cos(omega * h), np.sin(omega * h) / omega
    # Modal values and rates after loads that rise from 0 to 1, and that fall from 1 to 0, in a step.
    rise, rise_rate = (h - sine) / (omega**2 * h), (1.0 - cosine) / (omega**2 * h)
    fall, fall_rate = (1.0 - cosine) / omega**2 - rise, sine - rise_rate
    # Sum of inverse masses: of the striker, and of the end of a beam that does not bend.
    rigid = 1.0 / impact.mass + 4.0 / beam.beam.mass
    gain = h * h / 6.0 * rigid + float(row**2 @ rise)
    y, v = np.zeros(beam.modes), np.zeros(beam.modes)
    # Position and speed of the striker relative to the unbent beam's end.
    approach, closing, impulse = 0.0, impact.speed, 0.0
    forces = np.zeros(steps + 1)
    for n in range(1, steps + 1):
        force = forces[n - 1]
        y, v = (
            cosine * y + sine * v + row * fall * force,
            cosine * v - omega**2 * sine * y + row * fall_rate * force,
        )
        approach += h * closing - h * h / 3.0 * rigid * force
        depth = approach - float(row @ y)
        if depth > 0.0:
            # Solve F = K (depth - gain F)^1.5 for x, the square root of the depth under the force.
            cubic = gain * impact.stiffness
            x = brentq(lambda x, d=depth, c=cubic: x * x * (1.0 + c * x) - d, 0.0, math.sqrt(depth), xtol=1e-20)
            forces[n] = impact.stiffness * x**3
        y += row * rise * forces[n]
        v += row * rise_rate * forces[n]
        approach -= h * h / 6.0 * rigid * forces[n]
        closing -= 0.5 * h * (force + forces[n]) * rigid
        impulse += 0.5 * h * (force + forces[n])
    return Struck(np.linspace(0.0, duration, steps + 1), forces, impact.speed - impulse / impact.mass)


def _strike(impact: Impact, direction: complex, modes: int, duration: float) -> tuple[float, float, float, float]:
    """Simulate a mass that strikes a panel's end along the panel's axis (`direction` 1) or across the axis (1j).

    Return peak force [N], impulse [N s], exit speed of the mass along `direction` [m/s], and number of contacts.
    """
    place, velocity = CLEARANCE * direction, impact.speed * direction
    origin, motion = (place.real, place.imag), (velocity.real, velocity.imag)
    striker = Body("striker", impact.mass, 1.0, 1.0, (0.0, 0.0), position=origin, velocity=motion)
    bearing = Bearing(CLEARANCE, 0.1, PowerLaw(impact.stiffness))
    joint = Joint("contact", BEAM, "striker", (0.0, 0.0), (0.0, 0.0), bearing=bearing)
    simulation = start(Mechanism((modal(PANEL, modes), striker), (joint,)), rtol=1e-5)
    simulation.advance(duration)
    contact = simulation.state.joints[0]
    first = int(simulation.model.bodies["offset"][1])
    speed = complex(simulation.state.v[first], simulation.state.v[first + 1]) * direction.conjugate()
    impulse = m.joint_integrals(simulation.state.integrals)[0, m.IMPULSE]
    return float(contact["peak_force"]), float(impulse), speed.real, float(contact["contact_starts"])


def _checks(
    impact: Impact, exact: Struck, direction: complex, modes: int, errors: tuple[float, float, float], source: str
) -> Iterator[Check]:
    label = f"{impact.mass:g} kg at {impact.speed:g} m/s, modes = {modes}"
    *found, contacts = _strike(impact, direction, modes, float(exact.time[-1]))
    peak, impulse = float(exact.force.max()), float(np.trapezoid(exact.force, exact.time))
    # The error of the speed is relative to the speed before the impact.
    wanted = (
        ("peak force [N]", peak, peak),
        ("impulse [N s]", impulse, impulse),
        ("speed of the mass afterwards [m/s]", exact.exit_speed, impact.speed),
    )
    for (name, expected, scale), obtained, tolerance in zip(wanted, found, errors, strict=True):
        yield Check(f"{label}: {name}", expected, obtained, tolerance * scale, source)
    if modes > 100:
        starts = int(np.count_nonzero((exact.force[1:] > 0.0) & (exact.force[:-1] <= 0.0)))
        yield Check(f"{label}: contacts", starts, contacts, 0.0, source)


def struck_along() -> Iterator[Check]:
    """Check a mass that strikes a panel's end along its axis, until a tension wave from the far end parts the two."""
    impedance = math.sqrt(PANEL.axial_stiffness * PANEL.linear_density)
    wave_speed = math.sqrt(PANEL.axial_stiffness / PANEL.linear_density)
    impact = Impact(6.0, 0.01, STIFF)
    exact = struck_bar(impact, PANEL.length, impedance, wave_speed)
    # A panel has half as many axial modes as `modes`; the error of the peak falls with their number.
    for modes, errors in ((24, (0.05, 1e-3, 1e-3)), (96, (3e-3, 5e-5, 5e-5)), (200, (3e-4, 1e-5, 1e-5))):
        yield from _checks(impact, exact, 1.0 + 0.0j, modes, errors, ST_VENANT)


def struck_across() -> Iterator[Check]:
    """Check force, impulse and exit speed of a mass that strikes a panel's end transversely, once or a dozen times."""
    theory = FineBeam(PANEL, modes=3000)
    hard, soft = Impact(2.0, 0.1, STIFF), Impact(0.5, 0.01, 0.1 * STIFF)
    for impact, few, many in (
        (hard, (0.02, 0.01, 2.5e-3), (1e-4, 1e-5, 1e-5)),
        (soft, (0.01, 4e-3, 2e-3), (3e-5, 1e-6, 1e-6)),
    ):
        exact = struck_beam(impact, theory, 4e-3, 4000)
        for modes, errors in ((24, few), (200, many)):
            yield from _checks(impact, exact, 1j, modes, errors, EXACT_MODES)
