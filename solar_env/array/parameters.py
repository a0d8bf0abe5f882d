"""The parameters of the deployable solar array, with their sources and checks.

Scene and defaults: Y. Li, C. Wang and W. Huang, "Dynamics analysis of planar rigid-flexible coupling deployable solar
array system with multiple revolute clearance joints", Mech. Syst. Signal Process. 117 (2019) 188-209,
(below: the paper), Table 1. What the paper leaves open is marked "chosen".

A free-floating main body carries a chain of N panels, folded like an accordion: joint 1 opens from 0 to pi/2 and every
further joint from 0 to pi, in alternating senses. At t = 0 the journals are centred and, by default, everything is at
rest.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, ClassVar, Self

import numpy as np

from solar_env.array.names import changed, unknown_name
from solar_env.mechanics.joints.contact.laws import ContactLaw, contact_law
from solar_env.mechanics.joints.contact.surfaces import Surfaces
from solar_env.mechanics.joints.friction.laws import FRICTION_LAWS, SLIDING_READINGS, FrictionLaw
from solar_env.mechanics.mechanism.description import Bearing, Stop
from solar_env.mechanics.running.diagnosis import check_restitution

_POSITIVE = (
    "body_mass", "body_inertia", "body_size", "panel_length", "panel_width", "panel_thickness", "panel_density",
    "panel_young", "cable_wheel_radius", "latch_stiffness", "latch_ramp_depth", "journal_radius", "journal_young",
    "bearing_young", "minimum_impact_speed", "bearing_width",
)  # fmt: skip
_NOT_NEGATIVE = (
    "panel_damping", "cable_stiffness", "cable_preload_force", "latch_gap", "latch_damping", "friction_coefficient",
    "friction_speed_zero", "wear_coefficient",
)  # fmt: skip
# Parameters for which None is a value.
OPTIONAL = ("cable_torque_ratio", "contact_stiffness")


@dataclass(frozen=True)
class ArrayParameters:
    """Parameters of the array in SI units. Bad values are refused on construction with a ValueError.

    A contact law that turns the restitution into quite another exit speed is accepted with a SimulationWarning.

    Quantities by joint or by panel take one number, or a sequence whose last entry also holds for all further joints.
    Lists and arrays become tuples, NumPy's numbers Python's.

    Attributes:
        panel_count: number of panels N; the paper's is 2.
        body_mass: of the main body [kg]; a 1 m cube of 1500 kg/m3.
        body_inertia: of the main body about its centroid [kg m2].
        body_fixed: whether the main body is held in place; the paper's floats.
        hinge_x, hinge_y: root hinge from the main body's centroid [m], hinge_x not negative; mid-side (chosen: the
            paper does not say).
        body_size: side of the main body [m].
        panel_length, panel_width, panel_thickness: of each panel [m].
        panel_density: mass of the panels over their volume [kg/m3].
        panel_young: modulus of elasticity E of the panels, used by flexible models [Pa].
        panel_damping: retardation time of the panels' material [s]: stress = E (strain + panel_damping * strain rate)
            (chosen: it damps kilohertz modes and leaves bending below 100 Hz alone; the paper has none).
        spring_stiffness: of the torsion springs, by joint [N m/rad].
        spring_preload_angle: angle at which a spring is relaxed, by joint [rad].
        cable_stiffness: of the closed cable loops between neighbouring joints [N m/rad] (chosen: keeps the joint angles
            at 1 : 2 within a degree up to the latching).
        cable_torque_ratio: torque on the inner over that on the outer joint of a loop; None takes the wheel ratio
            (2 at the root), which conserves energy (chosen); 1 is the couple that the paper's latch time points to.
        cable_preload_force: of a strand [N]; a strand's tension is never negative (chosen: no strand goes
            slack).
        cable_wheel_radius: of the outer joint's wheel [m] (chosen: it sets only the torque at which a strand
            goes slack).
        latch_gap: free play of latch and stow stop to either side [rad] (chosen, like the four below: together they
            give contact forces of some hundred newtons after latching, like the paper's Fig. 10).
        latch_stiffness: of latch and stow stop [N m/rad^exponent].
        latch_exponent: of the stop's elastic torque.
        latch_ramp_depth: depth over which the stop's damping is ramped in [rad].
        latch_damping: of latch and stow stop [N m s/rad].
        clearance: bearing radius minus journal radius, by joint [m].
        journal_radius: of all joints [m].
        contact_law: "lankarani-nikravesh", "flores", "restitution" (whose exit speed is exactly the restitution) or
            "hertz" (which conserves energy) between spheres; "pereira" for a cylinder in a long bearing.
        restitution: coefficient of restitution of the contact law.
        contact_stiffness: K [N/m^1.5] between spheres; None computes it by the paper's Eq 40 from the radii and the
            four moduli that follow, by joint; it then rises as the clearance shrinks. "pereira" computes its own, of
            another unit, from these and bearing_width, and needs None.
        journal_young, journal_poisson, bearing_young, bearing_poisson: moduli [Pa] and Poisson's ratios, used only
            where the stiffness is computed; a steel journal in a brass bearing.
        minimum_impact_speed: lower bound of the impact speed in the damping term [m/s] (chosen: a hundredth of the
            slower impacts').
        friction_law: "ramp" (the paper's Eq 42), or "brown-mcphee" (smooth, with static friction, setting in at once).
        friction_coefficient: Coulomb's, of sliding.
        static_friction_ratio: coefficient of static over that of sliding friction, at least 1; 1 for "ramp".
        friction_speed_zero, friction_speed_full: sliding speeds between which friction sets in [m/s] (chosen: below
            those of impacts, which see all of Coulomb's friction); "brown-mcphee" peaks at the second.
        friction_sliding: "material" for the speed of the material points in contact; "centres" for the paper's Eq 35,
            which leaves the bodies' rotation out.
        wear_coefficient: Archard's k = K_W/H [m2/N] (chosen so that the deepest bin of one deployment comes to the
            order of 1e-14 to 1e-13 m, as the paper reports).
        bearing_width: axial length of the bearings [m] (chosen: the hinge line spans the panel).
        wear_bins: circumferential bins of each surface.
        initial_spin: angular velocity of the main body about its centroid at t = 0 [rad/s].
        initial_rate: rate of the joint angles at t = 0, by joint, positive opens [rad/s].
    """

    # Quantities that may differ from joint to joint.
    BY_JOINT: ClassVar[tuple[str, ...]] = ("spring_stiffness", "spring_preload_angle", "clearance", "initial_rate")
    # They decide how many numbers describe the mechanism and its state.
    STRUCTURAL: ClassVar[tuple[str, ...]] = ("panel_count", "body_fixed", "wear_bins")
    # Everything that is a real number.
    CONTINUOUS: ClassVar[frozenset[str]]
    # Parameters that must stay below another one.
    BELOW_ANOTHER: ClassVar[tuple[str, ...]] = ("clearance", "friction_speed_zero")

    panel_count: int = 2
    body_mass: float = 1500.0
    body_inertia: float = 250.0
    body_fixed: bool = False
    hinge_x: float = 0.5
    hinge_y: float = 0.0
    body_size: float = 1.0
    panel_length: float = 1.5
    panel_width: float = 1.0
    panel_thickness: float = 0.02
    panel_density: float = 200.0
    panel_young: float = 280e6
    panel_damping: float = 1e-5
    spring_stiffness: float | tuple[float, ...] = (0.1, 0.075)
    spring_preload_angle: float | tuple[float, ...] = (math.pi / 2, math.pi)
    cable_stiffness: float = 20.0
    cable_torque_ratio: float | None = None
    cable_preload_force: float = 50.0
    cable_wheel_radius: float = 0.05
    latch_gap: float = 0.01
    latch_stiffness: float = 1e3
    latch_exponent: float = 1.0
    latch_ramp_depth: float = 1e-3
    latch_damping: float = 10.0
    clearance: float | tuple[float, ...] = 2e-4
    journal_radius: float = 0.01
    contact_law: str = "lankarani-nikravesh"
    restitution: float = 0.9
    contact_stiffness: float | None = 7.39e10
    journal_young: float = 207e9
    journal_poisson: float = 0.3
    bearing_young: float = 105e9
    bearing_poisson: float = 0.34
    minimum_impact_speed: float = 1e-4
    friction_law: str = "ramp"
    friction_coefficient: float = 0.15
    static_friction_ratio: float = 1.0
    friction_speed_zero: float = 1e-4
    friction_speed_full: float = 1e-3
    friction_sliding: str = "material"
    wear_coefficient: float = 1e-14
    bearing_width: float = 1.0
    wear_bins: int = 360
    initial_spin: float = 0.0
    initial_rate: float | tuple[float, ...] = 0.0

    def __post_init__(self) -> None:
        for item in fields(self):
            object.__setattr__(self, item.name, _plain(getattr(self, item.name)))
            self._check_type(item.name, getattr(self, item.name), item.default)
        for name in _POSITIVE:
            self._require(name, getattr(self, name) > 0.0, "must be positive")
        for name in _NOT_NEGATIVE:
            self._require(name, getattr(self, name) >= 0.0, "must not be negative")
        self._require("hinge_x", self.hinge_x >= 0.0, "must not be negative: the panels open towards +x")
        self._require("latch_exponent", self.latch_exponent >= 1.0, "must be at least 1")
        for name in ("journal_poisson", "bearing_poisson"):
            self._require(name, -1.0 < getattr(self, name) <= 0.5, "must lie in (-1, 0.5]")
        rule = f"must be below friction_speed_full = {self.friction_speed_full!r}"
        self._require("friction_speed_zero", self.friction_speed_zero < self.friction_speed_full, rule)
        self._require("panel_count", 1 <= self.panel_count <= 100, "must lie between 1 and 100")
        self._require("wear_bins", 1 <= self.wear_bins <= 100_000, "must lie between 1 and 100000")
        clearances = self._entries("clearance")
        self._require("clearance", min(clearances) > 0.0, "must be positive; for no clearance choose an ideal model")
        self._require("clearance", max(clearances) < self.journal_radius, "must be below journal_radius")
        self._require("spring_stiffness", min(self._entries("spring_stiffness")) >= 0.0, "must not be negative")
        self._require("restitution", 0.0 < self.restitution <= 1.0, "must lie in (0, 1]")
        self._require("friction_sliding", self.friction_sliding in SLIDING_READINGS, "must be material or centres")
        self._require("friction_law", self.friction_law in FRICTION_LAWS, f"must be one of {', '.join(FRICTION_LAWS)}")
        self._require("static_friction_ratio", self.static_friction_ratio >= 1.0, "must be at least 1")
        self.friction()
        self._require("initial_spin", self.initial_spin == 0.0 or not self.body_fixed, "needs a body that is not fixed")
        stiffness = self.contact_stiffness
        self._require("contact_stiffness", stiffness is None or stiffness > 0.0, "must be positive")
        for joint in range(self.panel_count):
            contact = self.contact(joint)
        given = contact.exit_speed_ratio()
        # A law that conserves energy does so whatever it is asked for.
        if given < 1.0:
            check_restitution(self.contact_law, self.restitution, given)
        if self.cable_torque_ratio is not None:
            self._require("cable_torque_ratio", self.cable_torque_ratio >= 0.0, "must not be negative")

    def _check_type(self, name: str, value: Any, default: Any) -> None:
        if isinstance(default, (str, bool)):
            self._require(name, isinstance(value, type(default)), f"must be of type {type(default).__name__}")
            return
        if value is None and name in OPTIONAL:
            return
        entries = value if isinstance(value, tuple) else (value,)
        self._require(name, name in self.BY_JOINT or not isinstance(value, tuple), "must be a single number")
        self._require(name, len(entries) > 0, "must not be empty")
        for entry in entries:
            number = isinstance(entry, (int, float)) and not isinstance(entry, bool)
            self._require(name, number and math.isfinite(entry), "must be a finite number")
        if isinstance(default, int):
            self._require(name, isinstance(value, int), "must be a whole number")
        if isinstance(value, tuple) and value != default:
            self._require(name, len(value) <= self.panel_count, f"has more entries than panels ({self.panel_count})")

    def _require(self, name: str, condition: bool, rule: str) -> None:
        if not condition:
            raise ValueError(f"{name} = {getattr(self, name)!r} {rule}")

    def _entries(self, name: str) -> tuple[float, ...]:
        value = getattr(self, name)
        return value if isinstance(value, tuple) else (value,)

    def by_joint(self, name: str, joint: int) -> float:
        """Entry of a quantity by joint for `joint`, counted from 0; the last one holds for all further joints."""
        entries = self._entries(name)
        return float(entries[min(joint, len(entries) - 1)])

    @classmethod
    def preset(cls, name: str) -> Self:
        """Named parameter sets: "default", and "paper", which reads the paper as literally as its results allow.

        "paper": hinge at the side's end that the folded panels point away from and a cable couple of torque ratio 1,
        which together reproduce its latch time; sliding speed of the joint centres (its Eq 35). Where a preset is
        named to simulate, its flexible panels are beams of cable elements, too.

        Raises:
            ValueError: if the name is unknown.
        """
        if name not in PRESETS:
            raise ValueError(unknown_name("preset", name, PRESETS))
        return cls(**PRESETS[name])

    def with_changes(self, changes: Mapping[str, Any]) -> Self:
        """A copy with some parameters changed.

        Raises:
            ValueError: if a name is unknown or a value is refused.
        """
        return changed("parameter", self, changes)

    def lock_angle(self, joint: int) -> float:
        """Angle at which a joint latches [rad]: pi/2 at the root, pi further out."""
        return math.pi / 2 if joint == 0 else math.pi

    def stop(self) -> Stop:
        """The stop of latch and stow stop."""
        p = self
        return Stop(p.latch_gap, p.latch_stiffness, p.latch_exponent, p.latch_ramp_depth, p.latch_damping)

    def surfaces(self, joint: int) -> Surfaces:
        """Journal and bearing of a joint, counted from 0, as its contact law takes them."""
        return Surfaces(
            bearing_radius=self.journal_radius + self.by_joint("clearance", joint),
            journal_radius=self.journal_radius,
            length=self.bearing_width,
            bearing_young=self.bearing_young,
            bearing_poisson=self.bearing_poisson,
            journal_young=self.journal_young,
            journal_poisson=self.journal_poisson,
            stiffness=self.contact_stiffness,
        )

    def contact(self, joint: int) -> ContactLaw:
        """The contact law of a joint, counted from 0."""
        return contact_law(self.contact_law, self.surfaces(joint), self.restitution)

    def friction(self) -> FrictionLaw:
        """The friction law of all joints."""
        law = FRICTION_LAWS[self.friction_law]
        return law(self.friction_speed_zero, self.friction_speed_full, self.static_friction_ratio)

    def bearing(self, joint: int) -> Bearing:
        """The clearance bearing of a joint, counted from 0."""
        return Bearing(
            clearance=self.by_joint("clearance", joint),
            journal_radius=self.journal_radius,
            contact=self.contact(joint),
            minimum_impact_speed=self.minimum_impact_speed,
            friction_coefficient=self.friction_coefficient,
            friction=self.friction(),
            sliding=self.friction_sliding,
            wear_coefficient=self.wear_coefficient,
            width=self.bearing_width,
        )

    def to_dict(self) -> dict[str, Any]:
        """All parameters as values that JSON keeps; `with_changes` takes them back."""
        return {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(self).items()}


ArrayParameters.CONTINUOUS = frozenset(
    item.name for item in fields(ArrayParameters) if not isinstance(item.default, (str, int))
)


def _plain(value: Any) -> Any:
    """A value with Python's types in place of NumPy's, and tuples in place of lists."""
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    return tuple(_plain(entry) for entry in value) if isinstance(value, (list, tuple)) else value


PRESETS: dict[str, dict[str, Any]] = {
    "default": {},
    "paper": {"hinge_y": -0.5, "cable_torque_ratio": 1.0, "friction_sliding": "centres", "panel_damping": 0.0},
}
