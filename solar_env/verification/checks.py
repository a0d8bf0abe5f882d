"""Checks: one number of a verification case beside its expected value."""

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
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
        measure = "relative" if self.relative else "absolute"
        return values | {
            "tolerance": float(self.tolerance),
            "measure": measure,
            "source": self.source,
            "passed": self.passed,
        }
