"""Parameters of bodies, with one class per kind. Plain Python: describing a mechanism needs no compiler.

All quantities are in SI units. Angles are in rad, positive counter-clockwise.
"""

import math
from dataclasses import dataclass, field

from solar_env.mechanics.numerics.checks import require, require_count, require_finite, require_signs

Point = tuple[float, float]

GROUND = "ground"


@dataclass(frozen=True)
class AnyBody:
    """Name and initial motion, common to the descriptions of all kinds of body; the motion is keyword-only.

    Attributes:
        name: unique name.
        position: position of the body frame's origin at t = 0 [m].
        angle: angle of the body frame's x axis at t = 0 [rad].
        velocity: velocity of the body frame's origin at t = 0 [m/s].
        spin: angular velocity at t = 0 [rad/s].
    """

    name: str
    position: Point = field(default=(0.0, 0.0), kw_only=True)
    angle: float = field(default=0.0, kw_only=True)
    velocity: Point = field(default=(0.0, 0.0), kw_only=True)
    spin: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        require_finite(self)
        require(self.name != GROUND, self, "name", self.name, "is reserved for the fixed frame")


@dataclass(frozen=True)
class Body(AnyBody):
    """A rigid body in natural coordinates: its base points are the body frame's origin and a point on the x axis.

    Attributes:
        mass: [kg].
        inertia: moment of inertia about the centroid [kg m2].
        length: distance between the two base points [m].
        centroid: position of the centroid in the body frame [m].
        fixed: whether the body is held in place.
    """

    mass: float
    inertia: float
    length: float
    centroid: Point
    fixed: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_signs(self, positive=("mass", "inertia", "length"))


@dataclass(frozen=True)
class FlexibleBody(AnyBody):
    """A slender beam of equal ANCF cable elements, straight and unstrained at t = 0.

    The body frame has its origin at the first end and its x axis along the undeformed centreline. Joints, drives
    and loads attach to nodes: points (x, 0) with x a multiple of length / elements.

    Attributes:
        length: [m].
        elements: number of beam elements.
        linear_density: mass per length [kg/m].
        axial_stiffness: E A [N].
        bending_stiffness: E I [N m2].
        damping: retardation time of the material [s]: stress = modulus * (strain + damping * strain rate).
        masses: lumped masses without moment of inertia, as pairs (position along the axis [m], mass [kg]).
    """

    length: float
    elements: int
    linear_density: float
    axial_stiffness: float
    bending_stiffness: float
    damping: float = 0.0
    masses: tuple[Point, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        for place, mass in self.masses:
            rule = f"must lie from 0 to {self.length!r} m along the beam, and its mass be positive"
            require(0.0 <= place <= self.length and 0.0 < mass < math.inf, self, "masses", (place, mass), rule)
        require_count(self, "elements", 1, 1000)
        require_signs(self, ("length", "linear_density", "axial_stiffness", "bending_stiffness"), ("damping",))

    @property
    def element_length(self) -> float:
        """Length of each beam element [m]."""
        return self.length / self.elements

    def node(self, point: Point) -> int:
        """Return the index of the node at a point of the body frame [m]; raise a ValueError if it is not a node."""
        step = self.element_length
        index = round(point[0] / step)
        met = math.hypot(point[0] - index * step, point[1]) < 1e-9 * self.length
        rule = (
            f"is not a node of flexible body {self.name!r}; its nodes are (k * {step:.6g}, 0), k = 0..{self.elements}"
        )
        require(met and 0 <= index <= self.elements, self, "point", point, rule)
        return index


@dataclass(frozen=True)
class ModalPanel(AnyBody):
    """A slender elastic panel, described by its modes in a floating frame; straight and unstrained at t = 0.

    The body frame has its origin at the first end and its x axis along the undeformed centreline. Joints attach to the
    two ends, (0, 0) and (length, 0). Deflections may reach some percent of the length (package `modal`).

    Attributes:
        length: [m].
        mass: [kg].
        axial_stiffness: E A [N].
        bending_stiffness: E I [N m2].
        damping: retardation time of the material [s]: stress = modulus * (strain + damping * strain rate).
        modes: number of bending modes that are kept; half as many axial modes are kept, rounded up. The end flexibility
            due to all other modes is always included, to first order in the squared frequency.
    """

    length: float
    mass: float
    axial_stiffness: float
    bending_stiffness: float
    damping: float = 0.0
    modes: int = field(kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_count(self, "modes", 0, 200)
        require_signs(self, ("length", "mass", "axial_stiffness", "bending_stiffness"), ("damping",))

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centre of mass [kg m2]; the panel's thickness is neglected."""
        return self.mass * self.length**2 / 12.0

    @property
    def centroid(self) -> Point:
        """Centre of mass in the body frame [m]."""
        return (self.length / 2, 0.0)

    def end(self, point: Point) -> int:
        """Return the index, 0 or 1, of the panel end at a body-frame point [m]; raise a ValueError if it is no end."""
        for index, x in enumerate((0.0, self.length)):
            if math.hypot(point[0] - x, point[1]) < 1e-9 * self.length:
                return index
        rule = f"is not an end of panel {self.name!r}, which are (0, 0) and ({self.length:.6g}, 0)"
        raise ValueError(f"ModalPanel.point = {point!r}: {rule}; use a FlexibleBody for joints in between")
