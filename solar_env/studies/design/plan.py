"""Question of a design study: parameters that may change, conditions that must hold, and the quantity to minimise."""

import operator
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np

from solar_env.array import ArrayParameters, ParameterFile
from solar_env.array.motorization import slowest_damper
from solar_env.array.parameters.checks import row_of
from solar_env.studies.loads.quantities import QUANTITIES
from solar_env.support.values import check_name, is_number

DEADLINE = 60.0  # s; time by which all joints must have latched, unless a condition asks for less
_FACTOR = 10.0  # factor by which a parameter is made smaller and greater where no range is given
_COMPARISONS = {"<": operator.lt, ">": operator.gt}


@dataclass(frozen=True)
class Condition:
    """Condition on a quantity: a lower (">") or upper ("<") bound, in the unit in which the quantity is printed."""

    quantity: str
    comparison: str  # "<" or ">"
    bound: float

    def __str__(self) -> str:
        """Return the condition as text with its unit, such as "latch_time < 30 s"."""
        return f"{self.quantity} {self.comparison} {self.bound:g} {QUANTITIES[self.quantity].unit}".rstrip()

    def excess(self, value: float) -> float:
        """Return the distance of a value from the bound, as a fraction of the bound; 0 if the condition holds."""
        if _COMPARISONS[self.comparison](value, self.bound):
            return 0.0
        return abs(value - self.bound) / max(abs(self.bound), 1e-12)


def parse_condition(text: str) -> Condition:
    """Parse a condition such as "latch_time < 30"; the quantity's name may have spaces instead of underscores.

    Raises:
        ValueError: The condition cannot be read, or the quantity is unknown.
    """
    match = re.fullmatch(r"\s*(.+?)\s*([<>])\s*(\S+)\s*", text)
    try:
        bound = float(match[3]) if match else np.nan
    except ValueError:
        bound = np.nan
    if match is None or not np.isfinite(bound):
        raise ValueError(f'cannot read the condition {text!r}; write for example "latch_time < 30"')
    return Condition(quantity_name(match[1]), match[2], bound)


def quantity_name(text: str) -> str:
    """Return `text` with underscores instead of spaces, and check that it names a quantity.

    Raises:
        ValueError: The quantity is unknown.
    """
    name = "_".join(text.split())
    check_name("quantity", name, QUANTITIES)
    return name


@dataclass(frozen=True)
class Change:
    """Parameter and its range; if `factor` is true, the range of a number that multiplies each joint's own value."""

    name: str
    low: float
    high: float
    factor: bool

    @property
    def label(self) -> str:
        """Label in a table or on a plot's axis: the parameter's name, followed by "times" for factors."""
        return f"{self.name} times" if self.factor else self.name

    @property
    def logarithmic(self) -> bool:
        """True if values are spaced logarithmically, because the range spans a factor of ten or more."""
        return self.low > 0.0 and self.high / self.low >= _FACTOR

    def value(self, share: float) -> float:
        """Return the value at the fraction `share` (0 to 1) of the range, on a linear or logarithmic scale."""
        if self.logarithmic:
            return float(f"{self.low * (self.high / self.low) ** share:.4g}")
        return float(f"{self.low + share * (self.high - self.low):.4g}")

    def share(self, value: float) -> float:
        """Return the fraction of the range at which a value lies, clipped to [0, 1]; the method `value` inverts it."""
        if self.logarithmic:
            share = np.log(max(value, self.low) / self.low) / np.log(self.high / self.low)
        else:
            share = (value - self.low) / (self.high - self.low)
        return float(np.clip(share, 0.0, 1.0))


@dataclass(frozen=True)
class DesignPlan:
    """Question that a design study answers.

    Attributes:
        array: Nominal parameters, and ranges from which ensemble members sample some of them.
        change: Name of each parameter that the study may change -> range (low, high), or None for the usual range.
        keep: Conditions on quantities, each to hold at the joint where its quantity is greatest.
        least: Name of the quantity to minimise, at the joint where it is greatest.
        members: Number of ensemble members (runs) that are simulated for a design.
        points: Number of designs to try.

    Raises:
        ValueError: On construction, if a parameter cannot take its range or be changed, or a count is not positive.
    """

    array: ParameterFile
    change: Mapping[str, Any]
    keep: Sequence[Condition]
    least: str
    members: int = 2
    points: int = 49

    def __post_init__(self) -> None:
        for name, count in (("runs", self.members), ("points", self.points)):
            if count < 1:
                raise ValueError(f"{name} = {count!r} must be at least 1")
        if not self.change:
            raise ValueError("nothing is to change; name parameters, for example --change hinge_damping latch_damping")
        drawn = [name for name in self.change if name in self.array.randomize]
        if drawn:
            raise ValueError(f"{drawn[0]} is drawn from a range of the file; take it out there to choose it")
        for change in self.changes:
            for end in (change.low, change.high):
                self.parameters({change.name: end})

    @cached_property
    def changes(self) -> tuple[Change, ...]:
        """The parameters that the study may change, with ranges from `change`, or usual ranges where it has None."""
        return tuple(_change(self.array.parameters, name, given, self.deadline) for name, given in self.change.items())

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the quantities to compute: first the quantity to minimise, then the conditions' quantities."""
        return tuple(dict.fromkeys([self.least, *(condition.quantity for condition in self.keep)]))

    @property
    def deadline(self) -> float:
        """Time by which all joints must have latched [s]: the least bound on "latch_time" in `keep`, or DEADLINE."""
        bounds = [c.bound for c in self.keep if c.quantity == "latch_time" and c.comparison == "<" and c.bound > 0.0]
        return min(bounds, default=DEADLINE)

    def parameters(self, values: Mapping[str, float]) -> ArrayParameters:
        """Return the array's parameters changed by `values`, which maps names of parameters to numbers.

        A parameter whose nominal values differ between joints is multiplied by its number; others are set to it.

        Raises:
            ValueError: The array refuses a value.
        """
        nominal, factors = self.array.parameters, {change.name: change.factor for change in self.changes}
        return nominal.with_changes(
            {
                name: tuple(value * entry for entry in nominal.entries(name)) if factors[name] else value
                for name, value in values.items()
            }
        )

    def today(self) -> dict[str, float]:
        """Return present values by name of the parameters that may change; for one scaled by a factor, return 1."""
        return {
            change.name: 1.0 if change.factor else float(self.array.parameters.entries(change.name)[0])
            for change in self.changes
        }


def _change(parameters: ArrayParameters, name: str, given: Any, deadline: float) -> Change:
    check_name("parameter", name, vars(parameters))
    entries = parameters.entries(name)
    if name not in ArrayParameters.CONTINUOUS or None in entries:
        raise ValueError(f"{name} = {getattr(parameters, name)!r} is not a real number and cannot be changed in steps")
    factor = len(set(entries)) > 1
    if given is None:
        nominal = 1.0 if factor else entries[0]
        if nominal > 0.0:
            rule = row_of(next(item for item in fields(parameters) if item.name == name)).rule
            given = (max(nominal / _FACTOR, rule.least), min(nominal * _FACTOR, rule.greatest))
        elif name == "hinge_damping":
            given = (0.0, slowest_damper(parameters, deadline))
        else:
            raise ValueError(f"{name} = {nominal!r} says nothing of a usual range; give one, {name}=LOW,HIGH")
    if not (isinstance(given, tuple) and len(given) == 2 and all(map(is_number, given)) and given[0] < given[1]):
        raise ValueError(f"the range of {name}, {given!r}, must be two numbers LOW,HIGH with LOW < HIGH")
    return Change(name, float(given[0]), float(given[1]), factor)
