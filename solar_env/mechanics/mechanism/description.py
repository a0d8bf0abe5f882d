"""Mechanisms as data: bodies, joints, force elements. `equations.build.compile_mechanism` turns them into arrays.

All quantities are in SI units, angles in rad and counter-clockwise positive. Constructors refuse bad parameters.
"""

import math
from dataclasses import dataclass, field

from solar_env.mechanics.bodies.description import GROUND, AnyBody, Body, FlexibleBody, ModalPanel, Point  # noqa: F401
from solar_env.mechanics.joints.laws import SLIDING_READINGS, PowerLaw
from solar_env.mechanics.numerics.checks import check_table, require, require_finite, require_signs


@dataclass(frozen=True)
class Spring:
    """Torsion spring: torque = stiffness [N m/rad] * (preload_angle - joint angle [rad]) (Li et al. 2019, Eq 1)."""

    stiffness: float
    preload_angle: float

    def __post_init__(self) -> None:
        require_finite(self)
        require_signs(self, not_negative=("stiffness",))


@dataclass(frozen=True)
class Stop:
    """Two-sided stop with free play on either side: ADAMS' functions BISTOP and STEP (Li et al. 2019, Eqs 5-7).

    Attributes:
        gap: free play to each side [rad].
        stiffness: elastic stiffness [N m / rad^exponent].
        exponent: exponent of the elastic torque.
        ramp_depth: depth over which the damping is ramped in [rad].
        damping: damping beyond the ramp depth [N m s/rad].
    """

    gap: float
    stiffness: float
    exponent: float
    ramp_depth: float
    damping: float

    def __post_init__(self) -> None:
        require_finite(self)
        require_signs(self, positive=("stiffness", "ramp_depth"), not_negative=("gap", "damping"))
        require(self.exponent >= 1.0, self, "exponent", self.exponent, "must be at least 1")


@dataclass(frozen=True)
class Bearing:
    """Bearing with clearance: dimensions, contact, friction and wear (laws: `joints`).

    Attributes:
        clearance: radial clearance [m].
        journal_radius: radius of the journal [m].
        contact: law of the normal force.
        minimum_impact_speed: lower bound of the impact speed in the contact law [m/s].
        friction_coefficient: Coulomb's coefficient of friction.
        friction_speeds: sliding speeds at which friction sets in, and at which it reaches Coulomb's force [m/s].
        sliding: definition of the sliding speed in friction and wear: "material", relative speed of the touching
            material points; "centres", speed of the journal's centre across the line of centres; "places", speed at
            which the contact point moves round the bearing, some percent of the centres' speed (Eq 35 of Li et al. as
            printed). The last two leave the bodies' rotation out.
        wear_coefficient: Archard's k [m2/N].
        width: axial length of the bearing [m].
    """

    clearance: float
    journal_radius: float
    contact: PowerLaw
    minimum_impact_speed: float = 1e-4
    friction_coefficient: float = 0.0
    friction_speeds: tuple[float, float] = (1e-4, 1e-3)
    sliding: str = "material"
    wear_coefficient: float = 0.0
    width: float = 1.0

    def __post_init__(self) -> None:
        require_finite(self)
        positive = ("clearance", "journal_radius", "minimum_impact_speed", "width")
        require_signs(self, positive, not_negative=("friction_coefficient", "wear_coefficient"))
        zero, full = self.friction_speeds
        require(0.0 <= zero < full, self, "friction_speeds", self.friction_speeds, "must satisfy 0 <= first < second")
        require(self.sliding in SLIDING_READINGS, self, "sliding", self.sliding, f"must be one of {SLIDING_READINGS}")


TorqueTable = tuple[Point, ...]


@dataclass(frozen=True)
class Joint:
    """Revolute joint between a point of the inboard body (bearing) and a point of the outboard body (journal).

    Attributes:
        name: unique name.
        inboard, outboard: body names; the inboard one may be "ground".
        inboard_point, outboard_point: points of the joint in the body frames [m].
        sign: +1 if the joint angle grows with the outboard body's counter-clockwise turn, else -1.
        folded_angle: angle from the inboard to the outboard x axis at joint angle 0 [rad].
        middle: middle of the joint angle's range, which is 2 pi wide [rad].
        bearing: bearing with clearance; None for an ideal joint.
        spring: torsion spring, if any.
        stop: parameters of both latch and stow stop.
        lock_angle: joint angle at which the joint latches; None for no latch.
        stow_angle: joint angle below which the stop pushes back; None for no stow stop.
        latches: whether the joint latches at the lock angle; otherwise the lock angle has only a stop, and the joint
            counts as latched from its first arrival on.
        release_time: time [s] at which a hold-down releases the joint, which it holds folded until then; None for no
            hold-down.
        release_after: joint from whose latching `release_time` counts; None counts it from t = 0.
        spring_table: angles [rad] and torques [N m] of a spring of any characteristic, in addition to `spring`.
        harness: angles [rad] and torques [N m] of any other torque that depends on the joint angle.
        damping: coefficient of a viscous damper [N m s/rad].
        friction_torque: Coulomb torque of dry friction [N m].
        friction_ramp_rate: rate over which dry friction reverses smoothly [rad/s].
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
    latches: bool = True
    release_time: float | None = None
    release_after: str | None = None
    spring_table: TorqueTable = ()
    harness: TorqueTable = ()
    damping: float = 0.0
    friction_torque: float = 0.0
    friction_ramp_rate: float = 1e-3

    def __post_init__(self) -> None:
        require_finite(self, "spring_table", "harness")
        require_signs(self, ("friction_ramp_rate",), not_negative=("damping", "friction_torque"))
        for name in ("spring_table", "harness"):
            check_table(f"Joint.{name}", getattr(self, name))
        require(self.sign in (1, -1), self, "sign", self.sign, "must be +1 or -1")
        require(self.inboard != self.outboard, self, "outboard", self.outboard, "must differ from the inboard body")
        if self.stop is None:
            for name in ("lock_angle", "stow_angle"):
                require(getattr(self, name) is None, self, name, getattr(self, name), "needs a stop")
        if self.release_time is not None:
            require(self.release_time >= 0.0, self, "release_time", self.release_time, "must not be negative")
            require(self.stow_angle is not None, self, "release_time", self.release_time, "needs a stow_angle")
        if self.lock_angle is not None and self.stow_angle is not None:
            rule = f"must be below lock_angle = {self.lock_angle!r}"
            require(self.stow_angle < self.lock_angle, self, "stow_angle", self.stow_angle, rule)


@dataclass(frozen=True)
class CableLoop:
    """Closed cable loop over the wheels of two joints: a belt along the body between them (Li et al. 2019, Eqs 2-4).

    The wheel at joint a is fixed to joint a's inboard body, the wheel at joint b to joint b's outboard body. The
    strands run from hinge to hinge along the chord of the body between. On a rigid body the wheels' angles are the
    joint angles; on one that bends, they are measured relative to the chord. With the mismatch s = wheel_ratio *
    angle_a - angle_b and both strands taut, the torque is K s on the wheel at joint b and -torque_ratio * K s at joint
    a. The reaction acts on the body between, as a pair of forces at its hinges. The loop conserves energy if the two
    ratios are equal.

    Attributes:
        joint_a, joint_b: joint names; the outboard body of joint a is the inboard body of joint b.
        stiffness: K [N m/rad].
        wheel_ratio: factor of angle_a in the mismatch (dimensionless).
        torque_ratio: minus the torque at joint a divided by the torque at joint b (dimensionless).
        preload_torque: strand preload times the wheel radius of joint b [N m]; infinite for a loop that never slackens.
        wheel_radius: radius of the wheel at joint b [m]; the strands then run from wheel centre to wheel centre, and
            pull on the bearings, too (Eq 3). None leaves these forces out.
    """

    joint_a: str
    joint_b: str
    stiffness: float
    wheel_ratio: float
    torque_ratio: float
    preload_torque: float = math.inf
    wheel_radius: float | None = None

    def __post_init__(self) -> None:
        require_finite(self, "preload_torque")
        require_signs(self, ("wheel_ratio",), not_negative=("stiffness", "torque_ratio", "preload_torque"))
        if self.wheel_radius is not None:
            require_signs(self, ("wheel_radius", "stiffness"))
            require(math.isfinite(self.preload_torque), self, "preload_torque", self.preload_torque, "must be finite")


@dataclass(frozen=True)
class Drive:
    """Prescribed direction of a body at a point: angle + rate * t, or a smooth run-up to the rate.

    With a ramp time T the angle is angle + (rate / T) (t^2 / 2 + (T / 2 pi)^2 (cos(2 pi t / T) - 1)) up to T and angle
    + rate (t - T / 2) from then on: J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986) 855, doi:10.1115/1.3171871.

    Attributes:
        body: name of the body.
        angle: direction angle of the body at t = 0 [rad].
        rate: final rate [rad/s].
        ramp_time: T [s]; 0 starts at the full rate.
        point: point in the body's frame [m], which matters for a flexible body.
    """

    body: str
    angle: float
    rate: float
    ramp_time: float = 0.0
    point: Point = (0.0, 0.0)

    def __post_init__(self) -> None:
        require_finite(self)
        require_signs(self, not_negative=("ramp_time",))


@dataclass(frozen=True)
class Load:
    """Constant force (inertial axes) and torque at a point of a body.

    Attributes:
        body: name of the body.
        point: point in the body's frame [m].
        force: force components [N].
        torque: counter-clockwise torque [N m].
    """

    body: str
    point: Point = (0.0, 0.0)
    force: Point = (0.0, 0.0)
    torque: float = 0.0

    def __post_init__(self) -> None:
        require_finite(self)


@dataclass(frozen=True)
class Mechanism:
    """Planar mechanism: bodies, joints, cable loops, drives, loads, gravity [m/s2] and number of wear bins.

    Neighbours in `bodies` should be connected: implicit integration eliminates unknowns in the order of `bodies`.
    """

    bodies: tuple[AnyBody, ...]
    joints: tuple[Joint, ...] = ()
    cables: tuple[CableLoop, ...] = ()
    drives: tuple[Drive, ...] = ()
    loads: tuple[Load, ...] = ()
    gravity: Point = (0.0, 0.0)
    wear_bins: int = field(default=1)

    def __post_init__(self) -> None:
        require_finite(self)
        require(len(self.bodies) > 0, self, "bodies", self.bodies, "must hold at least one body")
        require(self.wear_bins >= 1, self, "wear_bins", self.wear_bins, "must be at least 1")
        for label, parts in (("bodies", self.bodies), ("joints", self.joints)):
            names = [part.name for part in parts]
            require(len(set(names)) == len(names), self, label, names, "names must be unique")
        known = {body.name for body in self.bodies} | {GROUND}
        for joint in self.joints:
            for side in (joint.inboard, joint.outboard):
                require(side in known, joint, "body", side, f"is not a body of the mechanism {sorted(known)}")
        attached: list[Drive | Load] = [*self.drives, *self.loads]
        for part in attached:
            require(part.body != GROUND, part, "body", part.body, "does not move; attach to a body")
            require(part.body in known, part, "body", part.body, f"is not a body of the mechanism {sorted(known)}")
        by_name = {joint.name: joint for joint in self.joints}
        for joint in self.joints:
            seen, after = {joint.name}, joint.release_after
            while after is not None:
                require(
                    after in by_name,
                    joint,
                    "release_after",
                    after,
                    f"is not a joint of the mechanism {sorted(by_name)}",
                )
                require(
                    after not in seen, joint, "release_after", after, "is a joint that waits for this one; name another"
                )
                seen.add(after)
                after = by_name[after].release_after
        for cable in self.cables:
            for name in (cable.joint_a, cable.joint_b):
                require(name in by_name, cable, "joint", name, f"is not a joint of the mechanism {sorted(by_name)}")
            carrier = by_name[cable.joint_a].outboard
            rule = f"must have {carrier!r}, the outboard body of {cable.joint_a!r}, as its inboard body"
            require(by_name[cable.joint_b].inboard == carrier, cable, "joint_b", cable.joint_b, rule)
