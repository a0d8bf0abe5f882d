"""Checks of parameters, each with a one-sentence ValueError that names the owner, quantity, value and rule."""

import math
from dataclasses import fields
from itertools import pairwise

MOST_POINTS = 24  # most points of a table


def require(condition: bool, owner: object, name: str, value: object, rule: str) -> None:
    """Raise a ValueError that states `owner`'s class, `name`, `value` and `rule`, unless `condition` holds."""
    if not condition:
        raise ValueError(f"{type(owner).__name__}.{name} = {value!r}: {rule}")


def require_signs(owner: object, positive: tuple[str, ...] = (), not_negative: tuple[str, ...] = ()) -> None:
    """Check that the fields of `owner` in `positive` are positive, and the fields in `not_negative` not negative."""
    for name in positive:
        require(getattr(owner, name) > 0.0, owner, name, getattr(owner, name), "must be positive")
    for name in not_negative:
        require(getattr(owner, name) >= 0.0, owner, name, getattr(owner, name), "must not be negative")


def require_count(owner: object, name: str, least: int, greatest: int) -> None:
    """Check that the field `name` of `owner` is a whole number from `least` to `greatest`."""
    value = getattr(owner, name)
    require(type(value) is int, owner, name, value, "must be a whole number")
    require(least <= value <= greatest, owner, name, value, f"must lie between {least} and {greatest}")


def require_finite(owner: object, *skip: str) -> None:
    """Check that all numbers in the fields of `owner` are finite, except in the fields named in `skip`."""
    for item in fields(owner):  # type: ignore[arg-type]
        value = getattr(owner, item.name)
        if item.name in skip:
            continue
        values = value if isinstance(value, tuple) else (value,)
        for number in values:
            if isinstance(number, float) and not math.isfinite(number):
                require(False, owner, item.name, value, "must be finite")


def check_table(name: str, table: tuple[tuple[float, float], ...]) -> None:
    """Check that a torque table (angle, torque) has finite numbers, rising angles, and at most MOST_POINTS points."""
    if len(table) > MOST_POINTS:
        raise ValueError(f"{name} has {len(table)} points; give at most {MOST_POINTS}")
    if not all(math.isfinite(number) for point in table for number in point):
        raise ValueError(f"{name} = {table!r} must hold finite angles [rad] and torques [N m]")
    if any(after[0] - before[0] < 1e-6 for before, after in pairwise(table)):
        raise ValueError(f"{name} = {table!r} must hold pairs (angle, torque) whose angles rise, by 1e-6 rad at least")
