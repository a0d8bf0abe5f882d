"""Checks, which compare a number from the engine with its expected value, and their output as a table and as JSON."""

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

ENERGY, MOMENTUM = "conservation of energy", "conservation of momentum"
ARNOLD_BRULS = "M. Arnold and O. Bruls, Multibody Syst. Dyn. 18 (2007) 185"


@dataclass(frozen=True)
class Check:
    """A number obtained from the simulation engine, beside the value that theory or literature gives.

    Attributes:
        quantity: name of the number, with its unit.
        expected: number from theory, an independent calculation or a publication.
        obtained: number from the engine.
        tolerance: greatest error that passes; absolute in the quantity's unit, or relative to `expected`.
        source: where `expected` comes from.
        relative: whether error and tolerance are relative.
        case: name of the verification case that yields the check; `suite.run` sets it.
    """

    quantity: str
    expected: float
    obtained: float
    tolerance: float
    source: str
    relative: bool = False
    case: str = ""

    @property
    def error(self) -> float:
        """Distance of `obtained` from `expected`, divided by the absolute expected value if `relative`."""
        distance = abs(self.obtained - self.expected)
        return distance / abs(self.expected) if self.relative else distance

    @property
    def passed(self) -> bool:
        """True if the error is within the tolerance; False for nan."""
        return math.isfinite(self.error) and bool(self.error <= self.tolerance)


def compare(
    figures: Iterable[tuple[Any, ...]], quantity: str, tolerance: float | None, source: str, relative: bool = False
) -> Iterator[Check]:
    """Yield one `Check` for each of several numbers whose expected values have the same source.

    Args:
        figures: (name, expected, obtained) of each check; (name, expected, obtained, tolerance) if `tolerance` is None.
        quantity: text for `Check.quantity`, in which {} stands for the name.
        tolerance, source, relative: see `Check`.
    """
    for name, expected, obtained, *bounds in figures:
        bound = bounds[0] if tolerance is None else tolerance
        yield Check(quantity.format(name), float(expected), float(obtained), bound, source, relative)


def make_table(checks: Sequence[Check]) -> Table:
    """Make a table for a terminal, with a row for every check and headings for cases and sources."""
    failed = sum(not check.passed for check in checks)
    title = f"{len(checks)} checks, {failed} failed" if failed else f"{len(checks)} checks, all passed"
    table = Table(title=title, caption="r: relative to the expected value", title_justify="left", box=box.SIMPLE)
    table.add_column("case, source, quantity", overflow="fold", min_width=24)
    for name in ("expected", "obtained", "error", "tolerance"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    case = source = ""
    for check in checks:
        if check.case != case:
            table.add_section()
            case, source = check.case, ""
            table.add_row(Text(case, style="bold"))
        if check.source != source:
            source = check.source
            table.add_row(Text(source, style="italic dim"))
        mark = "r" if check.relative else ""
        table.add_row(
            Text(check.quantity),
            f"{check.expected:.9g}",
            f"{check.obtained:.9g}",
            f"{check.error:.1e}{mark}",
            f"{check.tolerance:.1e}{mark}",
            Text("pass", style="green") if check.passed else Text("FAIL", style="bold red"),
        )
    return table


def to_json(checks: Sequence[Check]) -> str:
    """Return JSON text: whether all checks passed, and an object for each check, in which nan and inf become null."""
    rows = []
    for check in checks:
        row = {**vars(check), "error": check.error, "passed": check.passed}
        numbers = {name: float(row[name]) for name in ("expected", "obtained", "error", "tolerance")}
        rows.append(row | {name: x if math.isfinite(x) else None for name, x in numbers.items()})
    return json.dumps({"passed": all(check.passed for check in checks), "rows": rows}, indent=2)
