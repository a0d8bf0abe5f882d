"""Checks of the array's parameters: each against its own rule (allowed values), and some against other parameters.

An error names the parameter, the bad value and the rule. A value that no spacecraft has, most likely given in a wrong
unit, causes a warning before anything is simulated.
"""

import math
import warnings
from dataclasses import Field, field, fields
from functools import partial
from typing import Any, NamedTuple

from solar_env.mechanics.numerics.checks import check_table
from solar_env.mechanics.running.diagnosis import SimulationWarning, restitution_text, warn
from solar_env.support.values import is_number

ArrayParameters = Any  # the class in module `parameters`, which imports this module


class UnitWarning(SimulationWarning):
    """Warning that a parameter was probably given in a wrong unit, or has no effect because of another parameter."""


class Rule(NamedTuple):
    """Least and greatest allowed value of a parameter, and the text of this rule for error messages."""

    least: float
    greatest: float
    text: str


class Usual(NamedTuple):
    """Usual magnitudes of a parameter on spacecraft, its unit, and units often mistaken for it; 0 is always usual."""

    low: float
    high: float
    unit: str
    slip: str


class Row(NamedTuple):
    """Properties of a parameter apart from its default.

    Attributes:
        rule, usual: allowed values, and usual magnitudes on spacecraft.
        by_joint, drawn_by_joint: whether values may differ by joint; whether joints are sampled separately.
        optional, among, table: whether None is allowed; the allowed texts; whether the value is a table of numbers.
    """

    rule: Rule
    usual: Usual | None = None
    by_joint: bool = False
    drawn_by_joint: bool = False
    optional: bool = False
    among: tuple[str, ...] = ()
    table: bool = False


# Bodies and joints have properties that are products of several parameters; these bounds keep the products within the
# range of floating-point numbers. Where 0 is allowed, a value below 1e-20 acts like 0.
ANY = Rule(-1e20, 1e20, "must be at most 1e+20, in magnitude")
POSITIVE = Rule(1e-20, 1e20, "must be positive, at least 1e-20")
NOT_NEGATIVE = Rule(0.0, 1e20, "must not be negative")
AT_LEAST_ONE = Rule(1.0, 1e20, "must be at least 1")
OPENING_TO_X = Rule(0.0, 1e20, "must not be negative: the panels open towards +x")
_ROUNDED = 2e-3  # rad, rounding error that an angle given for a multiple of pi may have
_TURN = 2.0 * math.pi + _ROUNDED
TURN = Rule(-_TURN, _TURN, "must lie between -2 pi and 2 pi: it is in radians, not in degrees")
FOLD = Rule(0.1, 1.9 * math.pi, "must lie between 0.1 and 1.9 pi: it is in radians, not in degrees")
PORTION = Rule(0.0, 1.0, "must lie between 0 and 1")
SWITCH = Rule(0.0, 1.0, "must be 1, or 0 for none")
PLAY = Rule(0.0, 2.0 * math.pi, "must lie between 0 and 2 pi: it is in radians, not in degrees")
GAP = Rule(math.ulp(0.0), 1e20, "must be positive; for no clearance choose an ideal model")
SHARE = Rule(math.ulp(0.0), 1.0, "must lie in (0, 1]")
POISSON = Rule(math.nextafter(-1.0, 0.0), 0.5, "must lie in (-1, 0.5]")
LENGTH, PLACE = Usual(0.005, 50.0, "m", "mm"), Usual(0.0, 50.0, "m", "mm")
PANEL_MODULUS, MODULUS = (Usual(least, 5e12, "Pa", "MPa or GPa") for least in (1e5, 1e6))
SPRING, CABLE, LATCH = (Usual(1e-6, greatest, "N m/rad", "N mm/rad") for greatest in (50.0, 5e3, 3e5))
BENDING = Usual(1e-6, 1e9, "N m2", "N mm2")
HERTZIAN = Usual(1e7, 1e14, "N/m^1.5", "N/mm^1.5")
PLAY_ANGLE = Usual(0.0, 0.3, "rad", "degrees")
SPEED = Usual(1e-9, 0.09, "m/s", "mm/s")
ANGULAR_RATE = Usual(0.0, 10.0, "rad/s", "degrees per second")
_LEAST_PROPORTION = 1e-12
_MODULI = ("journal_young", "journal_poisson", "bearing_young", "bearing_poisson")


def number(default: object, rule: Rule = ANY, usual: Usual | None = None, **marks: Any) -> Any:
    """Return a dataclass field with a `Row` in its metadata: allowed and usual values, other attributes (`marks`)."""
    return field(default=default, metadata={"row": Row(rule, usual, **marks)})


per_joint, tabulated = partial(number, by_joint=True), partial(number, table=True)


def row_of(item: Field[Any]) -> Row:
    """Return a parameter's properties (`Row`), such as its allowed values, from the parameter's dataclass field."""
    return item.metadata.get("row", Row(ANY))


def check_rows(values: Any) -> None:
    """Raise a ValueError for the first field of the dataclass `values` that breaks the rule in the field's metadata.

    Warns:
        UnitWarning: about values that were probably given in a wrong unit.
    """
    for item in fields(values):
        value, (rule, usual, *_) = getattr(values, item.name), row_of(item)
        if "row" in item.metadata and not (is_number(value) and rule.least <= value <= rule.greatest):
            raise ValueError(f"{item.name} = {value!r} {rule.text}")
        if usual:
            _warn_of_implausible(item.name, (value,), usual)


def check_parameters(p: ArrayParameters) -> None:
    """Check every array parameter against its own rule (allowed values), and parameters against each other.

    Raises:
        ValueError: a parameter is refused; the message names the first refused parameter.

    Warns:
        UnitWarning: about values that were probably given in a wrong unit.
    """
    for item in fields(p):
        _check_value(p, item.name, item.default, row_of(item))
    radius, clearances = p.journal_radius, p.entries("clearance")
    _require(p, "clearance", max(clearances) < radius, f"must be below journal_radius = {radius!r}")
    rule = f"is lost in rounding beside journal_radius = {radius!r}; for no clearance choose an ideal model"
    _require(p, "clearance", radius + min(clearances) > radius, rule)
    _require(p, "initial_spin", p.initial_spin == 0.0 or not p.body_fixed, "needs a body that is not fixed")
    rule = "needs body_fixed = true: in a test on the ground the main body is held"
    _require(p, "gravity", p.gravity == 0.0 or p.body_fixed, rule)
    _check_bodies(p)
    rule = f"must be the number of a joint, 1 to {p.joint_count}, or 0 for none"
    _require(p, "release_after", max(p.for_each_joint("release_after")) <= p.joint_count, rule)
    below = all(
        z < f for z, f in zip(*map(p.for_each_joint, ("friction_speed_zero", "friction_speed_full")), strict=True)
    )
    _require(p, "friction_speed_zero", below, f"must be below friction_speed_full = {p.friction_speed_full!r}")
    told = set()
    for joint in range(len(p.joints)):
        given, restitution = p.contact(joint).exit_speed_ratio(), p.by_joint("restitution", joint)
        # A ratio of 1 means that the contact law conserves energy and ignores the restitution: no warning.
        if given < 1.0 and restitution not in told:
            told.add(restitution)
            warn(restitution_text(p.contact_law, restitution, given))
    _tell_of_no_effect(p)
    for name, usual in ((item.name, row_of(item).usual) for item in fields(p)):
        if usual:
            _warn_of_implausible(name, p.entries(name), usual)


def _tell_of_no_effect(p: ArrayParameters) -> None:
    """Warn about elastic moduli that have no effect because `contact_stiffness` is given."""
    usual = {item.name: item.default for item in fields(p)}
    for name in _MODULI:
        if p.contact_stiffness is not None and (value := getattr(p, name)) != usual[name]:
            text = (
                f"{name} = {value!r} changes nothing: contact_stiffness = {p.contact_stiffness!r} is given, which "
                "follows from the moduli only where it is None"
            )
            _tell_once(name, value, text)


def _check_value(p: ArrayParameters, name: str, default: object, row: Row) -> None:
    value = getattr(p, name)
    if isinstance(default, (str, bool)):
        _require(p, name, isinstance(value, type(default)), f"must be of type {type(default).__name__}")
        _require(p, name, not row.among or value in row.among, f"must be one of {', '.join(row.among)}")
        return
    if value is None and row.optional:
        return
    if row.table:
        (_check_masses if name == "panel_masses" else _check_tables)(p, name)
        return
    entries = p.entries(name)
    _require(p, name, row.by_joint or not isinstance(value, tuple), "must be a single number")
    _require(p, name, len(entries) > 0, "must not be empty")
    for entry in entries:
        _require(p, name, is_number(entry) and -math.inf < entry < math.inf, "must be a finite number")
        for rule in (ANY, row.rule):
            _require(p, name, rule.least <= entry <= rule.greatest, rule.text)
    whole = all(isinstance(entry, int) for entry in entries)
    _require(p, name, whole or not isinstance(default, int), "must be a whole number")
    few = value == default or len(entries) <= p.joint_count
    _require(p, name, few, f"has more entries than joints ({p.joint_count})")


def _check_tables(p: ArrayParameters, name: str) -> None:
    rule = "must be a list of pairs (angle [rad], torque [N m]), or one such list by joint"
    for joint in p.joints:
        _require(p, name, isinstance(getattr(p, name), tuple), rule)
        table = p.table(name, joint.index)
        pairs = isinstance(table, tuple) and all(isinstance(pair, tuple) and len(pair) == 2 for pair in table)
        _require(p, name, pairs and all(is_number(number) for pair in table for number in pair), rule)
        check_table(name, table)
        last = joint.lock_angle - _ROUNDED
        reached = not table or (table[0][0] <= _ROUNDED and table[-1][0] >= last) or len(table) == 1
        _require(p, name, reached, f"must reach from 0 to the lock angle of {joint.name}, {joint.lock_angle:.6g} rad")


def _check_masses(p: ArrayParameters, name: str) -> None:
    rule = "must be a list of (number of a panel, distance from its inner hinge [m], mass [kg])"
    given = getattr(p, name)
    _require(p, name, isinstance(given, tuple), rule)
    for entry in given:
        numbers = isinstance(entry, tuple) and len(entry) == 3 and all(is_number(number) for number in entry)
        _require(p, name, numbers and entry[0] in range(1, p.joint_count + 1), rule)
        reach = p.by_joint("panel_length", int(entry[0]) - 1)
        _require(p, name, 0.0 <= entry[1] <= reach and 0.0 < entry[2] < 1e20, f"{rule}; this panel is {reach!r} m long")


def _check_bodies(p: ArrayParameters) -> None:
    length, gyration = p.body_length, math.sqrt(p.body_inertia / p.body_mass)
    rule = (
        f"makes, with body_mass = {p.body_mass!r}, a radius of gyration of {gyration:.3g} m, out of proportion to "
        f"hinge_x = {p.hinge_x!r}, hinge_y = {p.hinge_y!r} and body_size = {p.body_size!r}"
    )
    _require(p, "body_inertia", _in_proportion(gyration / length, 0.0, p.hinge_y / length), rule)
    if gyration > p.body_size:
        text = (
            f"body_inertia = {p.body_inertia:g} kg m2 is a radius of gyration of {gyration:.3g} m, larger than "
            f"body_size = {p.body_size:g} m; give it in kg m2, not in kg mm2, or a larger body_size"
        )
        _tell_once("body_inertia", gyration / p.body_size, text)
    rule = f"is out of proportion to panel_length = {p.panel_length!r}"
    for joint in p.joints:
        length, thickness = p.by_joint("panel_length", joint.index), p.by_joint("panel_thickness", joint.index)
        gyration = math.hypot(length, thickness) / math.sqrt(12.0)
        _require(p, "panel_thickness", _in_proportion(gyration / length, 0.5, 0.0), rule)


def _in_proportion(gyration: float, along: float, across: float) -> bool:
    """Return whether the mass matrix of a body in the coordinates of its two base points is safely non-singular.

    `gyration` is the radius of gyration; `along` and `across` locate the centroid relative to the first base point. All
    three are divided by the distance between the base points.
    """
    first, second = (gyration**2 + x**2 + across**2 for x in (1.0 - along, along))
    return gyration**2 > _LEAST_PROPORTION * first * second


def _require(p: ArrayParameters, name: str, condition: bool, rule: str) -> None:
    if not condition:
        raise ValueError(f"{name} = {getattr(p, name)!r} {rule}")


# Names and rounded values about which this process has warned: an ensemble creates the same array many times.
_told: set[tuple[str, str]] = set()


def _warn_of_implausible(name: str, entries: tuple[float | None, ...], usual: Usual) -> None:
    """Warn about the first entry of a parameter that is outside its usual magnitudes on spacecraft."""
    low, high, unit, slip = usual
    odd = [value for value in entries if value and not low <= abs(value) <= high]
    if odd:
        of = f" {unit}" if unit else ""
        bound = f"large for a spacecraft (over {high:.3g}{of}" if abs(odd[0]) > high else f"small (under {low:.3g}{of}"
        text = f"{name} = {odd[0]:g}{of} is implausibly {bound}); give it in {unit or 'parts of one'}, not in {slip}"
        _tell_once(name, odd[0], text)


def _tell_once(name: str, value: float, text: str) -> None:
    """Issue `text` as a UnitWarning, once per process for a parameter and its value, rounded to two digits."""
    if (name, f"{value:.2g}") not in _told:
        _told.add((name, f"{value:.2g}"))
        warnings.warn(text, UnitWarning, stacklevel=2)
