"""Textbook beams as mechanisms of one flexible body: cantilever, spin-up, falling pendulum, free flight.

Beams start straight, along the x axis unless an angle is given, with the first end at the origin. Quantities are in SI
units; angles are counter-clockwise positive.
"""

from __future__ import annotations

from dataclasses import dataclass

from solar_env.mechanics.mechanism.description import GROUND, Drive, FlexibleBody, Joint, Load, Mechanism, Point
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY

BEAM = "beam"


@dataclass(frozen=True)
class Beam:
    """Uniform beam with axial and bending stiffness.

    Attributes:
        length: beam length [m].
        linear_density: mass per length [kg/m].
        axial_stiffness: E A [N].
        bending_stiffness: E I [N m2].
        damping: retardation time of the material [s].
    """

    length: float
    linear_density: float
    axial_stiffness: float
    bending_stiffness: float
    damping: float = 0.0

    @classmethod
    def solid(cls, length: float, area: float, second_moment: float, density: float, young: float) -> Beam:
        """Return a beam from section area [m2], second moment of area [m4], density [kg/m3], Young's modulus [Pa]."""
        return cls(length, density * area, young * area, young * second_moment)

    @property
    def mass(self) -> float:
        """Mass of the whole beam [kg]."""
        return self.linear_density * self.length

    def body(self, elements: int, angle: float = 0.0, velocity: Point = (0.0, 0.0), spin: float = 0.0) -> FlexibleBody:
        """Return the beam as a `FlexibleBody`; its first end is at the origin and moves at `velocity` [m/s]."""
        return FlexibleBody(
            name=BEAM,
            length=self.length,
            elements=elements,
            linear_density=self.linear_density,
            axial_stiffness=self.axial_stiffness,
            bending_stiffness=self.bending_stiffness,
            damping=self.damping,
            angle=angle,
            velocity=velocity,
            spin=spin,
        )


# Panel of 1.5 m x 1 m x 0.02 m: Y. Li, C. Wang and W. Huang, Mech. Syst. Signal Process. 117 (2019) 188, Table 1.
PANEL = Beam.solid(1.5, 0.02, 0.02**3 / 12.0, 200.0, 280e6)
# J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986) 855, doi:10.1115/1.3171871; shear deformation is left out.
SPIN_UP_BEAM = Beam(length=10.0, linear_density=1.2, axial_stiffness=2.8e7, bending_stiffness=1.4e4)
# M. Berzeri and A. A. Shabana, J. Sound Vib. 235 (2000) 539, doi:10.1006/jsvi.1999.2935.
PENDULUM_BEAM = Beam.solid(1.2, 0.0018, 1.215e-8, 5540.0, 0.7e6)


def _pivot() -> tuple[Joint, ...]:
    return (Joint("pivot", GROUND, BEAM, (0.0, 0.0), (0.0, 0.0)),)


def cantilever(
    beam: Beam = PANEL,
    elements: int = 6,
    tip_force: Point = (0.0, 0.0),
    tip_torque: float = 0.0,
    angle: float = 0.0,
    gravity: Point = (0.0, 0.0),
) -> Mechanism:
    """Return a mechanism: a beam clamped at the origin, at `angle` [rad] to the x axis, with dead loads at its tip."""
    load = Load(BEAM, (beam.length, 0.0), tip_force, tip_torque)
    return Mechanism(
        (beam.body(elements, angle),), _pivot(), drives=(Drive(BEAM, angle, 0.0),), loads=(load,), gravity=gravity
    )


def spin_up_beam(
    beam: Beam = SPIN_UP_BEAM, elements: int = 16, rate: float = 6.0, ramp_time: float = 15.0
) -> Mechanism:
    """Return a beam whose root is turned from rest up to `rate` [rad/s] in `ramp_time` [s] (Simo and Vu-Quoc 1986)."""
    drive = Drive(BEAM, 0.0, rate, ramp_time=ramp_time)
    return Mechanism((beam.body(elements),), _pivot(), drives=(drive,))


def flexible_pendulum(
    beam: Beam = PENDULUM_BEAM, elements: int = 12, angle: float = 0.0, gravity: float = STANDARD_GRAVITY
) -> Mechanism:
    """Return a pinned beam at rest at `angle` [rad] to the x axis (Berzeri and Shabana 2000); gravity is towards -y."""
    return Mechanism((beam.body(elements, angle),), _pivot(), gravity=(0.0, -gravity))


def free_beam(
    beam: Beam = PANEL,
    elements: int = 6,
    velocity: Point = (0.0, 0.0),
    spin: float = 0.0,
    angle: float = 0.0,
    loads: tuple[Load, ...] = (),
) -> Mechanism:
    """Return a beam without supports; `velocity` [m/s] is its first end's; `loads` must name `BEAM` as their body."""
    return Mechanism((beam.body(elements, angle, velocity, spin),), loads=loads)
