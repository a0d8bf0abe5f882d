"""Checks: one number of a verification case beside its expected value."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

ENERGY, MOMENTUM = "conservation of energy", "conservation of momentum"
ARNOLD_BRULS = "M. Arnold and O. Bruls, Multibody Syst. Dyn. 18 (2007) 185"


@dataclass(frozen=True)
class Check:
    """A number obtained from the engine beside the value that theory or literature expects.

    Attributes:
        quantity: what it is, with its unit.
        expected: from theory, an independent calculation or a publication.
        obtained: from the engine.
        tolerance: greatest error that passes; absolute in the quantity's unit, or relative to `expected`.
        source: where `expected` comes from.
        relative: whether error and tolerance are relative.
    """

    quantity: str
    expected: float
    obtained: float
    tolerance: float
    source: str
    relative: bool = False

    @property
    def error(self) -> float:
        """Distance of obtained from expected, in the measure of the tolerance."""
        distance = abs(self.obtained - self.expected)
        return distance / abs(self.expected) if self.relative else distance

    @property
    def passed(self) -> bool:
        """Whether the error is within the tolerance; false for nan."""
        return math.isfinite(self.error) and bool(self.error <= self.tolerance)


def compare(
    figures: Iterable[tuple[Any, ...]], quantity: str, tolerance: float | None, source: str, relative: bool = False
) -> Iterator[Check]:
    """Checks that have a source in common.

    Args:
        figures: name, expected and obtained number of each, and its tolerance where they have none in common.
        quantity: of all of them, with {} for the name.
        tolerance, source, relative: of `Check`.
    """
    for name, expected, obtained, *own in figures:
        bound = own[0] if tolerance is None else tolerance
        yield Check(quantity.format(name), float(expected), float(obtained), bound, source, relative)


@dataclass(frozen=True, kw_only=True)
class Row(Check):
    """A check of a named case.

    Attributes:
        case: name of the case, a key of `suite.CASES`.
    """

    case: str

    def to_dict(self) -> dict[str, Any]:
        """Plain values, ready for JSON; a number that is not finite becomes None."""
        values: dict[str, Any] = {"case": self.case, "quantity": self.quantity}
        numbers = {"expected": self.expected, "obtained": self.obtained, "error": self.error}
        values |= {name: float(x) if math.isfinite(x) else None for name, x in numbers.items()}
        return values | {
            "tolerance": float(self.tolerance),
            "measure": "relative" if self.relative else "absolute",
            "source": self.source,
            "passed": self.passed,
        }
