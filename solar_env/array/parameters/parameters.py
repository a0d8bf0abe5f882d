"""The parameters of the deployable solar array, with their sources and checks.

Mechanism and defaults follow Table 1 of Y. Li, C. Wang and W. Huang, "Dynamics analysis of planar rigid-flexible
coupling deployable solar array system with multiple revolute clearance joints", Mech. Syst. Signal Process. 117 (2019)
188-209 (below: the paper). Values that the paper leaves open are marked "chosen".

A free-floating main body carries a chain of N panels, folded like an accordion. Joint 1 opens from 0 to pi/2, every
further joint from 0 to pi, in alternating directions. At t = 0 the journals are centred and, by default, all bodies
are at rest.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar, Self

from solar_env.array.parameters import checks as c
from solar_env.array.parameters.checks import number, per_joint, tabulated
from solar_env.array.parameters.rows import JointRow, PanelRow, entry_of
from solar_env.mechanics.joints.laws import SLIDING_READINGS, PowerLaw, Surfaces, contact_law
from solar_env.mechanics.mechanism.description import Bearing, Stop, TorqueTable
from solar_env.support.values import changed, check_name, is_number, plain

PerJoint = float | tuple[float, ...]
Tables = TorqueTable | tuple[TorqueTable, ...]
MAIN_BODY = 0  # index of the main body among the bodies of the mechanism
_LEAST_WORK = 1e-3  # J, lower bound of a spring's work in `friction_rate`


@dataclass(frozen=True)
class ArrayParameters:
    """Parameters of the array in SI units. Bad values are refused on construction with a ValueError.

    A SimulationWarning tells of a contact law that does not reproduce the restitution, and of a value that no
    spacecraft has, which was probably given in a wrong unit. "The paper" is by Li, Wang and Huang (2019).

    Springs, latches, contacts, friction and initial rates may differ by joint, and cable stiffnesses by loop, both
    counted from the root. Each of these takes one number, or a sequence whose last entry also holds for all further
    joints. Lists and arrays become tuples; NumPy numbers become Python numbers.

    Attributes:
        panel_count: number of panels N of a wing; the paper's is 2.
        wings: number of wings, 1 or 2. The second wing is mirrored towards -x, and its joints are numbered after the
            first wing's. Quantities by joint or panel hold for each wing, unless they have more than N entries.
        body_mass: mass of the main body [kg]; by default a 1 m cube of 1500 kg/m3.
        body_inertia: moment of inertia of the main body about its centroid [kg m2].
        body_fixed: whether the main body is held in place; in the paper it floats.
        hinge_x, hinge_y: position of the root hinge from the main body's centroid [m], hinge_x not negative; by default
            mid-side (chosen: the paper does not say). The folded first panel points towards -y; it lies along the
            body's side if hinge_y is half of body_size.
        body_size: length of the main body's sides [m].
        panel_length, panel_width, panel_thickness: length, width and thickness by panel [m].
        panel_density: mass of the panels per volume [kg/m3], by panel.
        panel_area_mass: mass of the panels per area [kg/m2], by panel; None computes it from the density.
        panel_young: modulus of elasticity E of the panels, used by flexible models [Pa], by panel.
        panel_bending_stiffness: bending stiffness E I [N m2], by panel; None computes it from E, width and thickness.
        panel_damping: retardation time of the panels' material [s]: stress = E (strain + panel_damping * strain rate)
            (chosen: it damps kilohertz modes and leaves bending below 100 Hz alone; the paper has no damping).
        panel_masses: masses fixed to the panels, such as hinge fittings: lists of panel number, from 1 at the root,
            distance from the panel's inner hinge [m], and mass [kg]; modal panels cannot have such masses.
        folding: "accordion" if the hinges open alternately counter-clockwise and clockwise, "wrap" if all hinges open
            counter-clockwise.
        fold_angle: angle from the folded position to the position in line with the inboard body, by joint [rad]; None
            takes a quarter turn at the root, half turns beyond.
        lock_angle: joint angle at which a hinge latches, by joint [rad]; None takes the fold_angle.
        latching: whether a hinge latches at its lock angle, by joint: 1, or 0 for a stop without a latch.
        release_time: time until which a hold-down holds the folded joint, by joint [s]; 0 for no hold-down.
        release_after: number of the joint, from 1 at the root, from whose latching the release_time is counted, by
            joint; 0 counts the release_time from t = 0.
        spring_stiffness: stiffness of the torsion springs, by joint [N m/rad].
        spring_preload_angle: angle at which a spring is relaxed, by joint, at most a turn [rad]; at the latch, the
            torque of the spring is spring_stiffness * (spring_preload_angle - lock_angle).
        spring_torque: table of a torque by joint angle that adds to the torsion spring: pairs (angle [rad],
            torque [N m]); one table for all joints, or one table per joint; opening torques are positive.
        harness_torque: table of a wire harness's torque by joint angle [N m], in the form of spring_torque.
        hinge_damping: damping of a viscous or eddy-current damper in each hinge, by joint [N m s/rad].
        hinge_friction_torque: torque of dry friction in each hinge, by joint [N m], in addition to journal friction.
        hinge_friction_rate: joint rate over which hinge friction smoothly changes sign, by joint [rad/s]; None takes a
            hundredth of the rate at which the spring would open a lone panel (chosen: far below opening rates).
        cable_stiffness: stiffness of the closed cable loops between neighbouring joints, by loop [N m/rad]; 0 for
            no loops (chosen: keeps the joint angles at 1 : 2 within a degree up to the latching).
        cable_torque_ratio: torque on the inner joint of a loop divided by the torque on the outer one; None takes the
            wheel ratio (2 at the root), which conserves energy (chosen). A ratio of 1 agrees with the paper's latch
            time, but destroys half of the springs' work, 0.24 J of 0.49 J up to the latching.
        cable_preload_force: preload of a strand [N], whose tension is never negative (chosen: no strand goes slack).
        cable_wheel_radius: radius of the outer joint's wheel [m] (chosen: without cable_bearing_forces, it only sets
            the torque at which a strand goes slack).
        cable_bearing_forces: whether the strands also pull on the bearings: the paper's Eq 3, corrected so that the
            forces conserve energy. The paper's solution steps use the cable's torques alone, Eq 4.
        latch_gap: free play of the latch, and of the stop at the folded position (stow stop), to either side [rad], 0
            allowed (chosen, like the four values below: together they give contact forces of some hundred newtons
            after latching, as in the paper's Fig. 10).
        latch_stiffness: stiffness of latch and stow stop [N m/rad^exponent].
        latch_exponent: exponent of the elastic torque of latch and stow stop.
        latch_ramp_depth: depth over which the damping of latch and stow stop sets in [rad].
        latch_damping: damping of latch and stow stop [N m s/rad].
        clearance: bearing radius minus journal radius, by joint [m].
        journal_radius: journal radius of all joints [m].
        contact_law: contact law of journal and bearing. For spheres: "lankarani-nikravesh", "flores", "restitution"
            (which gives exactly the restitution) or "hertz" (which conserves energy). For a cylinder in a long bearing:
            "pereira". For surfaces far stiffer than bracket_stiffness: "bracket".
        restitution: coefficient of restitution for the contact law.
        contact_stiffness: stiffness K of spheres in contact [N/m^1.5], by joint. None computes K by the paper's Eq 40
            from the radii and the four moduli below; K then rises as the clearance shrinks. "pereira" computes a
            stiffness of another unit from these and bearing_width. Both "pereira" and "bracket" need None.
        bracket_stiffness: radial stiffness of bracket and bush in series for the contact law "bracket", by joint [N/m]
            (chosen: 1 kN bends a small aluminium bracket by 0.1 mm).
        journal_young, journal_poisson, bearing_young, bearing_poisson: moduli [Pa] and Poisson's ratios, used only
            if the contact stiffness is computed; by default a steel journal in a brass bearing.
        minimum_impact_speed: lower bound of the impact speed in the damping term [m/s], by joint (chosen: 2 to 3 % of
            the median impact speed in deployments of the default array).
        friction_coefficient: Coulomb's coefficient of sliding friction.
        friction_speed_zero, friction_speed_full: sliding speeds between which friction rises from zero to Coulomb's
            value [m/s], the paper's Eq 42 (chosen: below the speeds of impacts, which meet the full friction).
        friction_sliding: sliding speed in the friction law. "material" takes the relative speed of the material points
            in contact. The others ignore the bodies' rotation: "centres" takes the relative speed of the centres across
            their line; "places" multiplies this speed by depth / (clearance + depth), as the paper's Eq 35 does.
        wear_coefficient: Archard's k = K_W/H [m2/N] (chosen so that the deepest bin of one deployment comes to the
            order of 1e-14 to 1e-13 m, as the paper reports).
        bearing_width: axial length of the bearings [m] (chosen: the hinge line spans the panel).
        wear_bins: number of circumferential bins for the wear of each surface.
        gravity: acceleration of free fall in a test on the ground [m/s2], for which the main body must be fixed.
        gravity_angle: direction of gravity in the plane, from the x axis [rad].
        offloading_share: fraction of each panel's weight that a hanger at the panel's centre of mass carries.
        offloading_friction: friction force of a hanger divided by the weight that the hanger carries; the force acts at
            the panel's centre of mass against the opening or closing of the hinge.
        initial_spin: angular velocity of the main body about its centroid at t = 0 [rad/s].
        initial_rate: rate of the joint angles at t = 0, by joint, positive for opening [rad/s].
    """

    # Names of parameters: real numbers; values that may differ by joint; values drawn separately for each joint.
    CONTINUOUS: ClassVar[tuple[str, ...]]
    BY_JOINT: ClassVar[tuple[str, ...]]
    DRAWN_BY_JOINT: ClassVar[tuple[str, ...]]
    # Names of parameters that determine the number of coordinates and state variables.
    STRUCTURAL: ClassVar[tuple[str, ...]] = ("panel_count", "wings", "body_fixed", "wear_bins")

    panel_count: int = number(2, c.Rule(1, 100, "must lie between 1 and 100"))
    wings: int = number(1, c.Rule(1, 2, "must be 1 or 2"))
    body_mass: float = number(1500.0, c.POSITIVE, c.Usual(0.05, 1e6, "kg", "g or t"))
    body_inertia: float = number(250.0, c.POSITIVE, c.Usual(1e-5, 1e9, "kg m2", "kg mm2"))
    body_fixed: bool = False
    hinge_x: float = number(0.5, c.OPENING_TO_X, c.PLACE)
    hinge_y: float = number(0.0, usual=c.PLACE)
    body_size: float = number(1.0, c.POSITIVE, c.LENGTH)
    panel_length: PerJoint = per_joint(1.5, c.POSITIVE, c.LENGTH)
    panel_width: PerJoint = per_joint(1.0, c.POSITIVE, c.LENGTH)
    panel_thickness: PerJoint = per_joint(0.02, c.POSITIVE, c.Usual(1e-5, 0.5, "m", "mm"))
    panel_density: PerJoint = per_joint(200.0, c.POSITIVE, c.Usual(8.0, 3e4, "kg/m3", "kg/m2 or g/cm3"))
    panel_area_mass: PerJoint | None = per_joint(None, c.POSITIVE, c.Usual(0.05, 500.0, "kg/m2", "g/m2"), optional=True)
    panel_young: PerJoint = per_joint(280e6, c.POSITIVE, c.PANEL_MODULUS)
    panel_bending_stiffness: PerJoint | None = per_joint(None, c.POSITIVE, c.BENDING, optional=True)
    panel_damping: PerJoint = per_joint(1e-5, c.NOT_NEGATIVE, c.Usual(0.0, 0.01, "s", "parts of the critical damping"))
    panel_masses: tuple[tuple[float, float, float], ...] = tabulated(())
    folding: str = number("accordion", among=("accordion", "wrap"))
    fold_angle: PerJoint | None = per_joint(None, c.FOLD, optional=True)
    lock_angle: PerJoint | None = per_joint(None, c.FOLD, optional=True)
    latching: int | tuple[int, ...] = per_joint(1, c.SWITCH)
    release_time: PerJoint = per_joint(0.0, c.NOT_NEGATIVE, c.Usual(1e-3, 1e5, "s", "ms"))
    release_after: int | tuple[int, ...] = per_joint(0, c.NOT_NEGATIVE)
    spring_stiffness: PerJoint = per_joint((0.1, 0.075), c.NOT_NEGATIVE, c.SPRING, drawn_by_joint=True)
    spring_preload_angle: PerJoint = per_joint((math.pi / 2, math.pi), c.TURN, drawn_by_joint=True)
    spring_torque: Tables = tabulated(())
    harness_torque: Tables = tabulated(())
    hinge_damping: PerJoint = per_joint(0.0, c.NOT_NEGATIVE, c.Usual(1e-6, 1e4, "N m s/rad", "N mm s/rad"))
    hinge_friction_torque: PerJoint = per_joint(0.0, c.NOT_NEGATIVE, c.Usual(1e-6, 20.0, "N m", "N mm"))
    hinge_friction_rate: PerJoint | None = per_joint(
        None, c.POSITIVE, c.Usual(1e-6, 0.5, "rad/s", "degrees per second"), optional=True
    )
    cable_stiffness: PerJoint = per_joint(20.0, c.NOT_NEGATIVE, c.CABLE)
    cable_torque_ratio: float | None = number(None, c.NOT_NEGATIVE, optional=True)
    cable_preload_force: float = number(50.0, c.NOT_NEGATIVE, c.Usual(0.01, 1e4, "N", "mN"))
    cable_wheel_radius: float = number(0.05, c.POSITIVE, c.Usual(1e-4, 5.0, "m", "mm"))
    cable_bearing_forces: bool = False
    latch_gap: PerJoint = per_joint(0.01, c.PLAY, c.PLAY_ANGLE)
    latch_stiffness: PerJoint = per_joint(1e3, c.POSITIVE, c.LATCH)
    latch_exponent: PerJoint = per_joint(1.0, c.AT_LEAST_ONE)
    latch_ramp_depth: PerJoint = per_joint(1e-3, c.POSITIVE, c.Usual(0.0, 0.3, "rad", "degrees"))
    latch_damping: PerJoint = per_joint(10.0, c.NOT_NEGATIVE, c.Usual(1e-4, 5e3, "N m s/rad", "N mm s/rad"))
    clearance: PerJoint = per_joint(2e-4, c.GAP, c.Usual(1e-9, 1e-2, "m", "mm"), drawn_by_joint=True)
    journal_radius: float = number(0.01, c.POSITIVE, c.Usual(1e-4, 0.5, "m", "mm"))
    contact_law: str = "lankarani-nikravesh"
    restitution: PerJoint = per_joint(0.9, c.SHARE)
    contact_stiffness: PerJoint | None = per_joint(7.39e10, c.POSITIVE, c.HERTZIAN, optional=True)
    bracket_stiffness: PerJoint = per_joint(1e7, c.POSITIVE, c.Usual(3e4, 1e10, "N/m", "N/mm"))
    journal_young: float = number(207e9, c.POSITIVE, c.MODULUS)
    journal_poisson: float = number(0.3, c.POISSON)
    bearing_young: float = number(105e9, c.POSITIVE, c.MODULUS)
    bearing_poisson: float = number(0.34, c.POISSON)
    minimum_impact_speed: PerJoint = per_joint(1e-4, c.POSITIVE, c.SPEED)
    friction_coefficient: PerJoint = per_joint(0.15, c.NOT_NEGATIVE, c.Usual(0.0, 2.0, "", "per cent"))
    friction_speed_zero: PerJoint = per_joint(1e-4, c.NOT_NEGATIVE, c.SPEED)
    friction_speed_full: PerJoint = per_joint(1e-3, usual=c.SPEED)
    friction_sliding: str = number("material", among=tuple(SLIDING_READINGS))
    wear_coefficient: float = number(1e-14, c.NOT_NEGATIVE, c.Usual(0.0, 1e-6, "m2/N", "mm3/(N m)"))
    bearing_width: float = number(1.0, c.POSITIVE, c.Usual(1e-4, 50.0, "m", "mm"))
    wear_bins: int = number(360, c.Rule(1, 100_000, "must lie between 1 and 100000"))
    gravity: float = number(0.0, c.NOT_NEGATIVE, c.Usual(0.1, 30.0, "m/s2", "g or mm/s2"))
    gravity_angle: float = number(-math.pi / 2, c.TURN)
    offloading_share: float = number(0.0, c.PORTION)
    offloading_friction: float = number(0.0, c.NOT_NEGATIVE, c.Usual(0.0, 1.0, "", "per cent"))
    initial_spin: float = number(0.0, usual=c.ANGULAR_RATE)
    initial_rate: PerJoint = per_joint(0.0, usual=c.ANGULAR_RATE, drawn_by_joint=True)

    def __post_init__(self) -> None:
        for item in fields(self):
            object.__setattr__(self, item.name, plain(getattr(self, item.name)))
        c.check_parameters(self)

    def entries(self, name: str) -> tuple[Any, ...]:
        """Return a parameter's given values by joint as a tuple; the last value also holds for all further joints."""
        value = getattr(self, name)
        entries = value if isinstance(value, tuple) else (value,)
        return entries[: self.panel_count] if entries == _ROWS[name][0] else entries

    def by_joint(self, name: str, joint: int) -> Any:
        """Return a parameter's value at `joint`, counted from 0; the last given value holds for all further joints."""
        entry = entry_of(self.entries(name), joint, self.panel_count)
        return None if entry is None else float(entry)

    def for_each_joint(self, name: str) -> tuple[Any, ...]:
        """Return a parameter's value at every joint, in the order of `joints`."""
        return tuple(self.by_joint(name, joint.index) for joint in self.joints)

    @classmethod
    def preset(cls, name: str) -> Self:
        """Return a named parameter set, "default" or "paper"; an unknown name raises a ValueError.

        "paper" follows Li, Wang and Huang (2019) as printed, except where its own results contradict it. It has
        hinge_y = -0.5, so that the folded panels extend beyond the main body, and cable_torque_ratio = 1; both together
        match the paper's latch time. Panels are undamped. The wear coefficient gives the paper's greatest wear depth.
        """
        check_name("preset", name, PRESETS)
        return cls(**PRESETS[name])

    def with_changes(self, changes: Mapping[str, object]) -> Self:
        """Return a copy with some parameters changed; an unknown name or a refused value raises a ValueError."""
        return changed("parameter", self, changes)

    @property
    def body_length(self) -> float:
        """Distance [m] of the two points that locate the main body: hinge_x, or body_size if hinge_x is nearly zero."""
        return self.hinge_x if self.hinge_x > 1e-3 * self.body_size else self.body_size

    @property
    def joint_count(self) -> int:
        """Number of joints of all wings."""
        return self.panel_count * self.wings

    @cached_property
    def joints(self) -> tuple[JointRow, ...]:
        """The joints in order: wing by wing, and from the root outwards within each wing."""
        return tuple(self._joint(k) for k in range(self.joint_count))

    def _joint(self, index: int) -> JointRow:
        wing, k = divmod(index, self.panel_count)
        side = -1 if wing else 1
        fold = self.by_joint("fold_angle", index) or (math.pi if k else math.pi / 2)
        sign = -side if k % 2 and self.folding == "accordion" else side
        panel = MAIN_BODY + index + 1
        inboard = panel - 1 if k else MAIN_BODY
        return JointRow(index, inboard, panel, side, sign, fold, self.by_joint("lock_angle", index) or fold)

    def panel(self, joint: int) -> PanelRow:
        """Return the panel that a joint, counted from 0, carries."""
        names = ("length", "width", "thickness", "density", "young", "damping", "area_mass", "bending_stiffness")
        length, width, thickness, density, young, damping, area_mass, bending = (
            self.by_joint(f"panel_{name}", joint) for name in names
        )
        section = width * thickness
        return PanelRow(
            length,
            thickness,
            density * section if area_mass is None else area_mass * width,
            young * section,
            young * section * thickness**2 / 12.0 if bending is None else bending,
            damping,
            tuple(
                (place, mass)
                for number, place, mass in self.panel_masses
                if number - 1 in (joint, joint % self.panel_count)
            ),
        )

    @property
    def unsupported_gravity(self) -> tuple[float, float]:
        """Components (x, y) of the gravity that off-loading hangers do not carry [m/s2]."""
        left = self.gravity * (1.0 - self.offloading_share)
        return left * math.cos(self.gravity_angle), left * math.sin(self.gravity_angle)

    def friction_torque(self, joint: int) -> float:
        """Return the dry friction torque [N m] at hinge `joint` (from 0): the hinge's and its off-loading hanger's."""
        panel = self.panel(joint)
        of_hanger = self.offloading_friction * self.offloading_share * panel.mass * self.gravity
        return float(self.by_joint("hinge_friction_torque", joint) + of_hanger * panel.centroid)

    def friction_rate(self, joint: int) -> float:
        """Return the rate [rad/s] over which dry friction of hinge `joint`, counted from 0, smoothly changes sign."""
        given = self.by_joint("hinge_friction_rate", joint)
        if given is not None:
            return float(given)
        lock, panel, table = self.joints[joint].lock_angle, self.panel(joint), self.table("spring_torque", joint)
        stiffness, relaxed = (self.by_joint(f"spring_{name}", joint) for name in ("stiffness", "preload_angle"))
        work = stiffness * lock * (relaxed - lock / 2)
        if len(table) > 1:
            work += sum(0.5 * (t + u) * (b - a) for (a, t), (b, u) in pairwise(table))
        elif table:
            work += table[0][1] * lock
        return 0.01 * math.sqrt(max(work, _LEAST_WORK) * 6.0 / (panel.mass * panel.length**2))

    def table(self, name: str, joint: int) -> TorqueTable:
        """Return the table "spring_torque" or "harness_torque" of a joint, counted from 0; empty if not given."""
        tables = getattr(self, name)
        alone = not tables or is_number(tables[0][0])
        return tables if alone else entry_of(tables, joint, self.panel_count)

    def stop(self, joint: int) -> Stop:
        """Return the torque law (`Stop`) that `joint`, counted from 0, has for both its latch and its stow stop."""
        names = ("gap", "stiffness", "exponent", "ramp_depth", "damping")
        return Stop(*(self.by_joint(f"latch_{name}", joint) for name in names))

    def surfaces(self, joint: int) -> Surfaces:
        """Return geometry and stiffnesses of journal and bearing in `joint`, counted from 0, for the contact law."""
        return Surfaces(
            bearing_radius=self.journal_radius + self.by_joint("clearance", joint),
            journal_radius=self.journal_radius,
            length=self.bearing_width,
            bearing_young=self.bearing_young,
            bearing_poisson=self.bearing_poisson,
            journal_young=self.journal_young,
            journal_poisson=self.journal_poisson,
            stiffness=self.by_joint("contact_stiffness", joint),
            bracket_stiffness=self.by_joint("bracket_stiffness", joint),
        )

    def contact(self, joint: int) -> PowerLaw:
        """Return the contact law between journal and bearing of `joint`, counted from 0."""
        return contact_law(self.contact_law, self.surfaces(joint), self.by_joint("restitution", joint))

    def bearing(self, joint: int) -> Bearing:
        """Return the bearing of `joint`, counted from 0, with its clearance, contact law, friction and wear."""
        return Bearing(
            clearance=self.by_joint("clearance", joint),
            journal_radius=self.journal_radius,
            contact=self.contact(joint),
            minimum_impact_speed=self.by_joint("minimum_impact_speed", joint),
            friction_coefficient=self.by_joint("friction_coefficient", joint),
            friction_speeds=(self.by_joint("friction_speed_zero", joint), self.by_joint("friction_speed_full", joint)),
            sliding=self.friction_sliding,
            wear_coefficient=self.wear_coefficient,
            width=self.bearing_width,
        )

    def to_dict(self) -> dict[str, object]:
        """Return all parameters as values that JSON can store; `with_changes` accepts these values."""
        return {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(self).items()}


_ROWS = {item.name: (item.default, c.row_of(item)) for item in fields(ArrayParameters)}
ArrayParameters.CONTINUOUS = tuple(
    name for name, (default, row) in _ROWS.items() if not row.table and not isinstance(default, (str, int))
)
ArrayParameters.BY_JOINT = tuple(name for name, (_, row) in _ROWS.items() if row.by_joint)
ArrayParameters.DRAWN_BY_JOINT = tuple(name for name, (_, row) in _ROWS.items() if row.drawn_by_joint)

PRESETS: dict[str, dict[str, Any]] = {
    "default": {},
    "paper": {"hinge_y": -0.5, "cable_torque_ratio": 1.0, "panel_damping": 0.0, "wear_coefficient": 4e-15},
}
