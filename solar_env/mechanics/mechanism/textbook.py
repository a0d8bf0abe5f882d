"""Textbook mechanisms, built from the same parts as the solar array.

x points to the right, y up; link angles count from the x axis, counter-clockwise positive. All quantities are in SI
units. Initial states meet the constraints. Journals with clearance start centred unless a docstring says otherwise.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from solar_env.mechanics.joints.laws import PowerLaw, lankarani_damping
from solar_env.mechanics.mechanism.description import GROUND, Bearing, Body, Drive, Joint, Mechanism, Point

STANDARD_GRAVITY = 9.81  # m/s2, as textbooks round it
FOUR_BAR_PINS = ("ground-crank", "crank-coupler", "coupler-rocker", "ground-rocker")


@dataclass(frozen=True)
class Link:
    """Straight link between two pins, with its centroid halfway.

    Attributes:
        length: distance between the pins [m].
        mass: mass of the link [kg].
        inertia: moment of inertia about the centroid [kg m2].
    """

    length: float
    mass: float
    inertia: float

    @classmethod
    def slender(cls, length: float, mass: float) -> Link:
        """Return a uniform slender rod: inertia = mass * length^2 / 12."""
        return cls(length, mass, mass * length**2 / 12.0)

    def body(self, name: str, position: complex, angle: float, velocity: complex, spin: float) -> Body:
        """Return the link as a body; `position` and `velocity` of its first pin are complex numbers x + i y."""
        body = Body(name, self.mass, self.inertia, self.length, (self.length / 2.0, 0.0), angle=angle, spin=spin)
        return replace(body, position=(position.real, position.imag), velocity=(velocity.real, velocity.imag))


def pendulum(
    length: float = 1.0, mass: float = 1.0, angle: float = 0.0, gravity: float = STANDARD_GRAVITY
) -> Mechanism:
    """Return a pendulum: a point mass on a massless link, pinned at the origin, at rest at `angle` [rad] to the x axis.

    Equal point masses at both ends make the body's inertia regular; the mass at the pin does not move. The multiplier
    of the constraint that keeps the ends' distance is exactly the link's tension divided by the length [N/m].
    """
    body = Link(length, 2.0 * mass, 0.5 * mass * length**2).body("bob", 0j, angle, 0j, 0.0)
    joint = Joint("pivot", GROUND, "bob", (0.0, 0.0), (0.0, 0.0))
    return Mechanism((body,), (joint,), gravity=(0.0, -gravity))


def flores_bearing(clearance: float = 5e-4) -> Bearing:
    """Return the bearing of P. Flores, Nonlinear Dyn. 61 (2010) 633, doi:10.1007/s11071-010-9676-8; `clearance` [m].

    The bearing has radius 10 mm, friction 0.03, and the Lankarani-Nikravesh contact law with restitution 0.9.
    """
    return Bearing(
        clearance=clearance,
        journal_radius=0.010 - clearance,
        contact=PowerLaw(6.61e10, damping=lankarani_damping(0.9)),
        friction_coefficient=0.03,
    )


def four_bar(
    crank: Link | None = None,
    coupler: Link | None = None,
    rocker: Link | None = None,
    ground_length: float = 0.40,
    crank_rate: float = 2.0 * math.pi,
    crank_angle: float = math.pi / 2.0,
    gravity: float = STANDARD_GRAVITY,
    clearances: Mapping[str, Bearing] | None = None,
) -> Mechanism:
    """Return the four-bar linkage with a crank that turns at a constant rate, in its open configuration.

    Crank and rocker are pinned at (0, 0) and (ground_length, 0). The default links are slender rods of 0.10 m, 0.35 m
    and 0.25 m with 1 kg per metre. They make a crank-rocker; by default, the crank turns once per second.

    Args:
        crank, coupler, rocker: links; None takes the defaults.
        ground_length: distance between the fixed pins [m].
        crank_rate: rate of the crank [rad/s].
        crank_angle: angle of the crank at t = 0 [rad].
        gravity: gravity towards -y [m/s2].
        clearances: bearings by pin, a name of FOUR_BAR_PINS; the other pins are ideal.

    Raises:
        ValueError: if a pin is unknown, or the links do not close at the crank angle.
    """
    crank = crank or Link.slender(0.10, 0.10)
    coupler = coupler or Link.slender(0.35, 0.35)
    rocker = rocker or Link.slender(0.25, 0.25)
    crank_pin = cmath.rect(crank.length, crank_angle)
    diagonal = ground_length - crank_pin
    reach = abs(diagonal)
    cosine = (reach**2 + coupler.length**2 - rocker.length**2) / (2.0 * reach * coupler.length)
    if not abs(cosine) < 1.0:
        raise ValueError(f"the links do not close at crank_angle = {crank_angle!r}")
    coupler_angle = cmath.phase(diagonal) + math.acos(cosine)
    rocker_arm = crank_pin + cmath.rect(coupler.length, coupler_angle) - ground_length
    rocker_angle = cmath.phase(rocker_arm)
    # Velocities close the loop: crank + coupler = rocker, projected on the directions of rocker and coupler.
    sine = math.sin(rocker_angle - coupler_angle)
    coupler_spin = -crank_rate * crank.length * math.sin(rocker_angle - crank_angle) / (coupler.length * sine)
    rocker_spin = -crank_rate * crank.length * math.sin(coupler_angle - crank_angle) / (rocker.length * sine)
    bodies = (
        crank.body("crank", 0j, crank_angle, 0j, crank_rate),
        coupler.body("coupler", crank_pin, coupler_angle, 1j * crank_rate * crank_pin, coupler_spin),
        rocker.body("rocker", complex(ground_length), rocker_angle, 0j, rocker_spin),
    )
    bearings = dict(clearances or {})
    places: tuple[tuple[str, str, Point, Point], ...] = (
        (GROUND, "crank", (0.0, 0.0), (0.0, 0.0)),
        ("crank", "coupler", (crank.length, 0.0), (0.0, 0.0)),
        ("coupler", "rocker", (coupler.length, 0.0), (rocker.length, 0.0)),
        (GROUND, "rocker", (ground_length, 0.0), (0.0, 0.0)),
    )
    pins = zip(FOUR_BAR_PINS, places, strict=True)
    joints = tuple(Joint(name, *place, bearing=bearings.pop(name, None)) for name, place in pins)
    if bearings:
        raise ValueError(f"clearances name the unknown pin {min(bearings)!r}; the pins are {', '.join(FOUR_BAR_PINS)}")
    drives = (Drive("crank", crank_angle, crank_rate),)
    return Mechanism(bodies, joints, drives=drives, gravity=(0.0, -gravity))


def bouncing_block(
    bearing: Bearing, mass: float = 1.0, speed: float = 0.1, housing_mass: float | None = None
) -> Mechanism:
    """Return a block that bounces in a gap: a journal that moves on a diameter of its bearing, centred at t = 0.

    Args:
        bearing: bearing whose clearance is half the gap; without friction the block stays on the x axis.
        mass: mass of the block [kg].
        speed: speed along x at t = 0 [m/s].
        housing_mass: mass of a free housing that carries the bearing [kg]; None fixes the bearing.
    """
    radius = bearing.journal_radius
    block = Body("block", mass, 0.5 * mass * radius**2, radius, (0.0, 0.0), velocity=(speed, 0.0))
    housing = Body("housing", housing_mass or 1.0, (housing_mass or 1.0) * radius**2, radius, (0.0, 0.0))
    inboard, bodies = (GROUND, (block,)) if housing_mass is None else (housing.name, (housing, block))
    return Mechanism(bodies, (Joint("gap", inboard, "block", (0.0, 0.0), (0.0, 0.0), bearing=bearing),))


def loaded_journal(
    bearing: Bearing, load: float = 10.0, lean: float = 0.0, rate: float | None = None, wear_bins: int = 1
) -> Mechanism:
    """Return a journal of 1 kg, loaded by a force, in a bearing that is fixed to the ground.

    The journal starts at the depth that carries the load, at rest or turning. Driven at a constant rate, it slides and
    wears. A free journal to which a caller adds a torque creeps at the sliding speed whose friction balances the
    torque; its moment of inertia, 0.01 kg m2, keeps it from rolling to and fro in the bearing.

    Args:
        bearing: clearance, friction and wear.
        load: load towards -y [N].
        lean: initial angle of the journal's centre from the bottom of the bearing towards -x [rad].
        rate: prescribed angular velocity [rad/s]; None leaves the journal free, at rest.
        wear_bins: number of circumferential bins of each surface.

    Raises:
        ValueError: if the load is not positive.
    """
    if not load > 0.0:
        raise ValueError(f"load = {load!r} N must be positive")
    reach = bearing.clearance + bearing.contact.depth_under(load * math.cos(lean))
    place = (-reach * math.sin(lean), -reach * math.cos(lean))
    journal = Body("journal", 1.0, 0.01, bearing.journal_radius, (0.0, 0.0), position=place, spin=rate or 0.0)
    joint = Joint("journal bearing", GROUND, "journal", (0.0, 0.0), (0.0, 0.0), bearing=bearing)
    drives = () if rate is None else (Drive("journal", 0.0, rate),)
    return Mechanism((journal,), (joint,), drives=drives, gravity=(0.0, -load), wear_bins=wear_bins)
