"""Checks of array parameters: bad ones are refused by name, value and rule."""

import math
from dataclasses import fields
from typing import Any

from solar_env.array.parameters.plausibility import warn_of_implausible
from solar_env.mechanics.joints.laws import SLIDING_READINGS
from solar_env.mechanics.running.diagnosis import restitution_text, warn
from solar_env.support.numbers import is_number

ArrayParameters = Any  # of `parameters`, which imports this module

_POSITIVE = (
    "body_mass", "body_inertia", "body_size", "panel_length", "panel_width", "panel_thickness", "panel_density",
    "panel_young", "cable_wheel_radius", "latch_stiffness", "latch_ramp_depth", "journal_radius", "journal_young",
    "bearing_young", "minimum_impact_speed", "bearing_width",
)  # fmt: skip
_NOT_NEGATIVE = (
    "panel_damping", "spring_stiffness", "cable_stiffness", "cable_preload_force", "latch_gap", "latch_damping",
    "friction_coefficient", "friction_speed_zero", "wear_coefficient",
)  # fmt: skip
# Bodies and joints are made of products of several parameters, which are to stay within the range of the numbers of a
# computer. Where 0 is a value, less is as good as that.
_LEAST, _GREATEST = 1e-20, 1e20
_LEAST_PROPORTION = 1e-12
_TURN = 2.0 * math.pi
# Parameters for which None is a value.
OPTIONAL = ("cable_torque_ratio", "contact_stiffness")


def check_parameters(p: ArrayParameters) -> None:
    """Refuse parameters without sense.

    Raises:
        ValueError: naming the first of them.

    Warns:
        UnitWarning: of values that were probably given in another unit.
    """
    for item in fields(p):
        _check_type(p, item.name, item.default)
    for name in _POSITIVE:
        _require(p, name, min(p.entries(name)) > 0.0, "must be positive")
        _require(p, name, min(p.entries(name)) >= _LEAST, f"must be at least {_LEAST:g}")
    for name in _NOT_NEGATIVE:
        _require(p, name, min(p.entries(name)) >= 0.0, "must not be negative")
    _require(p, "hinge_x", p.hinge_x >= 0.0, "must not be negative: the panels open towards +x")
    _require(p, "latch_exponent", min(p.entries("latch_exponent")) >= 1.0, "must be at least 1")
    for name in ("journal_poisson", "bearing_poisson"):
        _require(p, name, -1.0 < getattr(p, name) <= 0.5, "must lie in (-1, 0.5]")
    _require(p, "panel_count", 1 <= p.panel_count <= 100, "must lie between 1 and 100")
    _require(p, "wear_bins", 1 <= p.wear_bins <= 100_000, "must lie between 1 and 100000")
    clearances = p.entries("clearance")
    _require(p, "clearance", min(clearances) > 0.0, "must be positive; for no clearance choose an ideal model")
    _require(p, "clearance", max(clearances) < p.journal_radius, f"must be below journal_radius = {p.journal_radius!r}")
    told_apart = p.journal_radius + min(clearances) > p.journal_radius
    rule = f"is lost in rounding beside journal_radius = {p.journal_radius!r}; for no clearance choose an ideal model"
    _require(p, "clearance", told_apart, rule)
    _require(p, "initial_spin", p.initial_spin == 0.0 or not p.body_fixed, "needs a body that is not fixed")
    if p.cable_torque_ratio is not None:
        _require(p, "cable_torque_ratio", p.cable_torque_ratio >= 0.0, "must not be negative")
    _check_bodies(p)
    for name in ("spring_preload_angle", "latch_gap"):
        largest = max(abs(entry) for entry in p.entries(name))
        _require(p, name, largest <= _TURN, "must lie between -2 pi and 2 pi: it is in radians, not in degrees")
    warn_of_implausible(p.entries)
    _check_friction(p)
    _check_contact(p)


def _check_bodies(p: ArrayParameters) -> None:
    length, gyration = p.body_length, math.sqrt(p.body_inertia / p.body_mass)
    rule = (
        f"makes, with body_mass = {p.body_mass!r}, a radius of gyration of {gyration:.3g} m, out of proportion to "
        f"hinge_x = {p.hinge_x!r}, hinge_y = {p.hinge_y!r} and body_size = {p.body_size!r}"
    )
    _require(p, "body_inertia", _in_proportion(gyration / length, 0.0, p.hinge_y / length), rule)
    gyration = math.hypot(p.panel_length, p.panel_thickness) / math.sqrt(12.0)
    rule = f"is out of proportion to panel_length = {p.panel_length!r}"
    _require(p, "panel_thickness", _in_proportion(gyration / p.panel_length, 0.5, 0.0), rule)


def _in_proportion(gyration: float, along: float, across: float) -> bool:
    """Whether the mass of a body and its inertia about a base point can both be told from their sum.

    All in units of the distance of the base points: radius of gyration, and place of the centroid from the first one.
    """
    first, second = (gyration**2 + x**2 + across**2 for x in (1.0 - along, along))
    return gyration**2 > _LEAST_PROPORTION * first * second


def _check_friction(p: ArrayParameters) -> None:
    rule = f"must be below friction_speed_full = {p.friction_speed_full!r}"
    for joint in range(len(p.joints)):
        below = p.by_joint("friction_speed_zero", joint) < p.by_joint("friction_speed_full", joint)
        _require(p, "friction_speed_zero", below, rule)
    readings = f"must be one of {', '.join(SLIDING_READINGS)}"
    _require(p, "friction_sliding", p.friction_sliding in SLIDING_READINGS, readings)


def _check_contact(p: ArrayParameters) -> None:
    for restitution in p.entries("restitution"):
        _require(p, "restitution", 0.0 < restitution <= 1.0, "must lie in (0, 1]")
    for stiffness in p.entries("contact_stiffness"):
        _require(p, "contact_stiffness", stiffness is None or stiffness > 0.0, "must be positive")
        _require(p, "contact_stiffness", stiffness is None or stiffness >= _LEAST, f"must be at least {_LEAST:g}")
    told = set()
    for joint in range(len(p.joints)):
        given, restitution = p.contact(joint).exit_speed_ratio(), p.by_joint("restitution", joint)
        # A law that conserves energy does so whatever it is asked for.
        if given < 1.0 and restitution not in told:
            told.add(restitution)
            warn(restitution_text(p.contact_law, restitution, given))


def _check_type(p: ArrayParameters, name: str, default: Any) -> None:
    value = getattr(p, name)
    if isinstance(default, (str, bool)):
        _require(p, name, isinstance(value, type(default)), f"must be of type {type(default).__name__}")
        return
    if value is None and name in OPTIONAL:
        return
    entries = p.entries(name)
    _require(p, name, name in p.BY_JOINT or not isinstance(value, tuple), "must be a single number")
    _require(p, name, len(entries) > 0, "must not be empty")
    for entry in entries:
        _require(p, name, is_number(entry) and -math.inf < entry < math.inf, "must be a finite number")
        _require(p, name, abs(entry) <= _GREATEST, f"must be at most {_GREATEST:g}, in magnitude")
    if isinstance(default, int):
        _require(p, name, isinstance(value, int), "must be a whole number")
    if isinstance(value, tuple) and value != default:
        _require(p, name, len(value) <= len(p.joints), f"has more entries than joints ({len(p.joints)})")


def _require(p: ArrayParameters, name: str, condition: bool, rule: str) -> None:
    if not condition:
        raise ValueError(f"{name} = {getattr(p, name)!r} {rule}")
