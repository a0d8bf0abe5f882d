"""Mechanisms as data: bodies, joints, force elements. ``build.compile_mechanism`` turns them into arrays.

All quantities in SI units; angles in rad; counter-clockwise positive. Bad parameters are refused on construction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields

Point = tuple[float, float]

GROUND = "ground"


def _require(condition: bool, owner: object, name: str, value: object, rule: str) -> None:
    if not condition:
        raise ValueError(f"{type(owner).__name__}.{name} = {value!r}: {rule}")


def _require_finite(owner: object, *skip: str) -> None:
    for item in fields(owner):  # type: ignore[arg-type]
        value = getattr(owner, item.name)
        if item.name in skip:
            continue
        values = value if isinstance(value, tuple) else (value,)
        for number in values:
            if isinstance(number, float) and not math.isfinite(number):
                _require(False, owner, item.name, value, "must be finite")


@dataclass(frozen=True)
class Body:
    """A rigid body with its initial motion.

    The body frame has its origin at the first base point and its x axis towards the second.

    Attributes:
        name: unique name.
        mass: [kg].
        inertia: about the centroid [kg m2].
        length: distance of the two base points [m].
        centroid: in the body frame [m].
        position: of the first base point at t = 0 [m].
        angle: of the x axis at t = 0 [rad].
        velocity: of the first base point at t = 0 [m/s].
        spin: angular velocity at t = 0 [rad/s].
        fixed: whether the body is held in place.
    """

    name: str
    mass: float
    inertia: float
    length: float
    centroid: Point
    position: Point = (0.0, 0.0)
    angle: float = 0.0
    velocity: Point = (0.0, 0.0)
    spin: float = 0.0
    fixed: bool = False

    def __post_init__(self) -> None:
        _require_finite(self)
        _require(self.name != GROUND, self, "name", self.name, "is reserved for the fixed frame")
        for name in ("mass", "inertia", "length"):
            _require(getattr(self, name) > 0.0, self, name, getattr(self, name), "must be positive")


@dataclass(frozen=True)
class FlexibleBody:
    """A slender elastic body of equal beam elements (``flexible.py``), straight and unstrained at t = 0.

    The body frame has its origin at the first end and its x axis along the undeformed centreline. Joints, drives,
    guides and loads attach to nodes: points (x, 0) with x a multiple of length / elements.

    Attributes:
        name: unique name.
        length: [m].
        elements: number of beam elements.
        linear_density: mass per length [kg/m].
        axial_stiffness: E A [N].
        bending_stiffness: E I [N m2].
        damping: retardation time of the material [s]: stress = modulus * (strain + damping * strain rate).
        position: of the first end at t = 0 [m].
        angle: of the centreline at t = 0 [rad].
        velocity: of the first end at t = 0 [m/s].
        spin: angular velocity at t = 0 [rad/s].
    """

    name: str
    length: float
    elements: int
    linear_density: float
    axial_stiffness: float
    bending_stiffness: float
    damping: float = 0.0
    position: Point = (0.0, 0.0)
    angle: float = 0.0
    velocity: Point = (0.0, 0.0)
    spin: float = 0.0

    def __post_init__(self) -> None:
        _require_finite(self)
        _require(self.name != GROUND, self, "name", self.name, "is reserved for the fixed frame")
        _require(type(self.elements) is int, self, "elements", self.elements, "must be a whole number")
        _require(1 <= self.elements <= 1000, self, "elements", self.elements, "must lie between 1 and 1000")
        for name in ("length", "linear_density", "axial_stiffness", "bending_stiffness"):
            _require(getattr(self, name) > 0.0, self, name, getattr(self, name), "must be positive")
        _require(self.damping >= 0.0, self, "damping", self.damping, "must not be negative")

    def node(self, point: Point) -> int:
        """Index of the node at a point of the body frame [m].

        Raises:
            ValueError: if there is none.
        """
        step = self.length / self.elements
        index = round(point[0] / step)
        met = math.hypot(point[0] - index * step, point[1]) < 1e-9 * self.length
        rule = (
            f"is not a node of flexible body {self.name!r}; its nodes are (k * {step:.6g}, 0), k = 0..{self.elements}"
        )
        _require(met and 0 <= index <= self.elements, self, "point", point, rule)
        return index


@dataclass(frozen=True)
class ModalPanel:
    """A slender elastic panel, described by its modes in a floating frame; straight and unstrained at t = 0.

    The body frame has its origin at the first end and its x axis along the undeformed centreline. Joints attach to the
    two ends, (0, 0) and (length, 0). Deflections may come to some percent of the length (``modal``).

    Attributes:
        name: unique name.
        length: [m].
        mass: [kg].
        axial_stiffness: E A [N].
        bending_stiffness: E I [N m2].
        damping: retardation time of the material [s]: stress = modulus * (strain + damping * strain rate).
        modes: number of bending modes that are kept; of axial ones half as many are. What the others contribute to the
            flexibility of the ends is kept whatever the number.
        position: of the first end at t = 0 [m].
        angle: of the centreline at t = 0 [rad].
        velocity: of the first end at t = 0 [m/s].
        spin: angular velocity at t = 0 [rad/s].
    """

    name: str
    length: float
    mass: float
    axial_stiffness: float
    bending_stiffness: float
    damping: float = 0.0
    modes: int = 24
    position: Point = (0.0, 0.0)
    angle: float = 0.0
    velocity: Point = (0.0, 0.0)
    spin: float = 0.0

    def __post_init__(self) -> None:
        _require_finite(self)
        _require(self.name != GROUND, self, "name", self.name, "is reserved for the fixed frame")
        _require(type(self.modes) is int, self, "modes", self.modes, "must be a whole number")
        _require(0 <= self.modes <= 200, self, "modes", self.modes, "must lie between 0 and 200")
        for name in ("length", "mass", "axial_stiffness", "bending_stiffness"):
            _require(getattr(self, name) > 0.0, self, name, getattr(self, name), "must be positive")
        _require(self.damping >= 0.0, self, "damping", self.damping, "must not be negative")

    @property
    def inertia(self) -> float:
        """About the centre of mass [kg m2]; the panel has no thickness."""
        return self.mass * self.length**2 / 12.0

    @property
    def centroid(self) -> Point:
        """Centre of mass in the body frame [m]."""
        return (self.length / 2, 0.0)

    def end(self, point: Point) -> int:
        """0 or 1 for the end of the panel at a point of the body frame [m].

        Raises:
            ValueError: if the point is neither.
        """
        for index, x in enumerate((0.0, self.length)):
            if math.hypot(point[0] - x, point[1]) < 1e-9 * self.length:
                return index
        rule = f"is not an end of panel {self.name!r}, which are (0, 0) and ({self.length:.6g}, 0)"
        raise ValueError(f"ModalPanel.point = {point!r}: {rule}; use a FlexibleBody for joints in between")


AnyBody = Body | FlexibleBody | ModalPanel


@dataclass(frozen=True)
class Spring:
    """Torsion spring: torque = stiffness * (preload_angle - joint angle) [N m] (paper, Eq 1)."""

    stiffness: float
    preload_angle: float

    def __post_init__(self) -> None:
        _require_finite(self)
        _require(self.stiffness >= 0.0, self, "stiffness", self.stiffness, "must not be negative")


@dataclass(frozen=True)
class Stop:
    """Two-sided stop with free play `gap` on either side of its angle (BISTOP with STEP damping, paper Eqs 5-7).

    Attributes:
        gap: free play to each side [rad].
        stiffness: [N m / rad^exponent].
        exponent: of the elastic torque.
        ramp_depth: depth over which the damping is ramped in [rad].
        damping: [N m s/rad].
    """

    gap: float
    stiffness: float
    exponent: float
    ramp_depth: float
    damping: float

    def __post_init__(self) -> None:
        _require_finite(self)
        _require(self.gap >= 0.0, self, "gap", self.gap, "must not be negative")
        _require(self.stiffness > 0.0, self, "stiffness", self.stiffness, "must be positive")
        _require(self.exponent >= 1.0, self, "exponent", self.exponent, "must be at least 1")
        _require(self.ramp_depth > 0.0, self, "ramp_depth", self.ramp_depth, "must be positive")
        _require(self.damping >= 0.0, self, "damping", self.damping, "must not be negative")


@dataclass(frozen=True)
class Bearing:
    """Clearance of a joint with its contact, friction and wear (laws: ``contact.py``, ``wear.py``).

    Attributes:
        clearance: radial [m].
        journal_radius: [m].
        stiffness: contact stiffness K [N/m^1.5].
        damping_factor: d of the contact law, see ``contact.damping_factor``.
        minimum_impact_speed: lower bound of the impact speed in the damping term [m/s].
        friction_coefficient: Coulomb's.
        friction_speeds: sliding speeds at which friction sets in and is full [m/s].
        material_sliding: True takes the sliding speed of the material points; False that of the joint's centres
            (paper, Eq 35, which leaves the bodies' rotation out).
        wear_coefficient: Archard's k [m2/N].
        width: axial length of the bearing [m].
    """

    clearance: float
    journal_radius: float
    stiffness: float
    damping_factor: float
    minimum_impact_speed: float = 1e-4
    friction_coefficient: float = 0.0
    friction_speeds: tuple[float, float] = (1e-4, 1e-3)
    material_sliding: bool = True
    wear_coefficient: float = 0.0
    width: float = 1.0

    def __post_init__(self) -> None:
        _require_finite(self)
        for name in ("clearance", "journal_radius", "stiffness", "minimum_impact_speed", "width"):
            _require(getattr(self, name) > 0.0, self, name, getattr(self, name), "must be positive")
        for name in ("damping_factor", "friction_coefficient", "wear_coefficient"):
            _require(getattr(self, name) >= 0.0, self, name, getattr(self, name), "must not be negative")
        low, high = self.friction_speeds
        _require(0.0 <= low < high, self, "friction_speeds", self.friction_speeds, "must satisfy 0 <= first < second")


@dataclass(frozen=True)
class Joint:
    """A revolute joint between a point of the inboard body (bearing) and one of the outboard body (journal).

    Attributes:
        name: unique name.
        inboard, outboard: body names; the inboard one may be "ground".
        inboard_point, outboard_point: in the body frames [m].
        sign: +1 if the joint angle grows with the outboard body's counter-clockwise turn, else -1.
        folded_angle: angle from the inboard to the outboard x axis at joint angle 0 [rad].
        middle: middle of the joint angle's range, which is 2 pi wide [rad].
        bearing: the clearance; None for an ideal joint.
        spring: torsion spring, if any.
        stop: shared by latch and stow stop.
        lock_angle: joint angle at which the joint latches; None for no latch.
        stow_angle: joint angle below which the stop pushes back; None for no stow stop.
    """

    name: str
    inboard: str
    outboard: str
    inboard_point: Point
    outboard_point: Point
    sign: int = 1
    folded_angle: float = 0.0
    middle: float = 0.0
    bearing: Bearing | None = None
    spring: Spring | None = None
    stop: Stop | None = None
    lock_angle: float | None = None
    stow_angle: float | None = None

    def __post_init__(self) -> None:
        _require_finite(self)
        _require(self.sign in (1, -1), self, "sign", self.sign, "must be +1 or -1")
        _require(self.inboard != self.outboard, self, "outboard", self.outboard, "must differ from the inboard body")
        if self.stop is None:
            for name in ("lock_angle", "stow_angle"):
                _require(getattr(self, name) is None, self, name, getattr(self, name), "needs a stop")


@dataclass(frozen=True)
class CableLoop:
    """Closed cable loop over the wheels of two joints (paper, Eqs 2-4).

    With the mismatch s = wheel_ratio * angle_a - angle_b, the torque on joint b is K s and on joint a
    -torque_ratio * K s while both strands are taut. The loop conserves energy if the two ratios are equal.

    Attributes:
        joint_a, joint_b: joint names.
        stiffness: K [N m/rad].
        wheel_ratio: dimensionless.
        torque_ratio: dimensionless.
        preload_torque: strand preload times the wheel radius of joint b [N m]; infinite for a loop that never slackens.
    """

    joint_a: str
    joint_b: str
    stiffness: float
    wheel_ratio: float
    torque_ratio: float
    preload_torque: float = math.inf

    def __post_init__(self) -> None:
        _require_finite(self, "preload_torque")
        _require(self.stiffness >= 0.0, self, "stiffness", self.stiffness, "must not be negative")
        _require(self.wheel_ratio > 0.0, self, "wheel_ratio", self.wheel_ratio, "must be positive")
        _require(self.torque_ratio >= 0.0, self, "torque_ratio", self.torque_ratio, "must not be negative")
        _require(self.preload_torque >= 0.0, self, "preload_torque", self.preload_torque, "must not be negative")


@dataclass(frozen=True)
class Guide:
    """Keeps a point of a body on the line normal . r = offset."""

    body: str
    point: Point
    normal: Point
    offset: float = 0.0

    def __post_init__(self) -> None:
        _require_finite(self)
        _require(abs(math.hypot(*self.normal) - 1.0) < 1e-12, self, "normal", self.normal, "must have length 1")


@dataclass(frozen=True)
class Drive:
    """Prescribes a body's direction at a point: angle + rate * t, or a smooth run-up to that rate.

    With a ramp time T the angle is angle + (rate / T) (t^2 / 2 + (T / 2 pi)^2 (cos(2 pi t / T) - 1)) up to T and
    angle + rate (t - T / 2) from then on: J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986) 855,
    doi:10.1115/1.3171871.

    Attributes:
        body: name.
        angle: of the body's direction at t = 0 [rad].
        rate: final rate [rad/s].
        ramp_time: T [s]; 0 starts at the full rate.
        point: of the body's frame [m]; matters for a flexible body.
    """

    body: str
    angle: float
    rate: float
    ramp_time: float = 0.0
    point: Point = (0.0, 0.0)

    def __post_init__(self) -> None:
        _require_finite(self)
        _require(self.ramp_time >= 0.0, self, "ramp_time", self.ramp_time, "must not be negative")


@dataclass(frozen=True)
class Load:
    """A constant force (inertial axes) and torque at a point of a body.

    Attributes:
        body: name.
        point: of the body's frame [m].
        force: [N].
        torque: counter-clockwise [N m].
    """

    body: str
    point: Point = (0.0, 0.0)
    force: Point = (0.0, 0.0)
    torque: float = 0.0

    def __post_init__(self) -> None:
        _require_finite(self)


@dataclass(frozen=True)
class Mechanism:
    """A planar mechanism.

    Neighbours in ``bodies`` should be neighbours in the mechanism: implicit integration eliminates in this order.
    """

    bodies: tuple[AnyBody, ...]
    joints: tuple[Joint, ...] = ()
    cables: tuple[CableLoop, ...] = ()
    guides: tuple[Guide, ...] = ()
    drives: tuple[Drive, ...] = ()
    loads: tuple[Load, ...] = ()
    gravity: Point = (0.0, 0.0)
    wear_bins: int = field(default=1)

    def __post_init__(self) -> None:
        _require_finite(self)
        _require(len(self.bodies) > 0, self, "bodies", self.bodies, "must hold at least one body")
        _require(self.wear_bins >= 1, self, "wear_bins", self.wear_bins, "must be at least 1")
        for label, parts in (("bodies", self.bodies), ("joints", self.joints)):
            names = [part.name for part in parts]
            _require(len(set(names)) == len(names), self, label, names, "names must be unique")
        known = {body.name for body in self.bodies} | {GROUND}
        for joint in self.joints:
            for side in (joint.inboard, joint.outboard):
                _require(side in known, joint, "body", side, f"is not a body of the mechanism {sorted(known)}")
        attached: list[Guide | Drive | Load] = [*self.guides, *self.drives, *self.loads]
        for part in attached:
            _require(part.body != GROUND, part, "body", part.body, "does not move; attach to a body")
            _require(part.body in known, part, "body", part.body, f"is not a body of the mechanism {sorted(known)}")
        joint_names = {joint.name for joint in self.joints}
        for cable in self.cables:
            for name in (cable.joint_a, cable.joint_b):
                _require(
                    name in joint_names, cable, "joint", name, f"is not a joint of the mechanism {sorted(joint_names)}"
                )
