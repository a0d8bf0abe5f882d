"""Stability maps, which show where numerical methods fail: definition of a map, and measurement of its cells.

A map has two axes and one or more panels. Each cell of a map is one small run with a known answer, classified by how
it fails. The library's report is kept: an error, a warning, or a quantity of the result. A run that fails without a
report is a fault of this library (`silent_failures`).
"""

import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TypeVar

from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.tables import Cell, Table

Value = float | int
Result = TypeVar("Result")


class Kind(StrEnum):
    """Outcomes of the runs of a stability map, in the order of the plot's legend."""

    FINE = "fine"
    STIFF = "stiff"  # is right, with steps far shorter than the motion needs
    CREEPS = "creeps"  # creeps as the friction law prescribes, where dry friction would stick
    OVER_DAMPED = "over-damped"  # loses energy that no physical law dissipates
    WRONG = "wrong value"  # finishes with a wrong answer
    SPIKES = "spikes"  # is wrong for a while, then recovers
    GROWING = "growing"  # gains energy, or alternates with growing amplitude
    NO_END = "does not end"  # takes more steps than allowed
    NO_SOLUTION = "Newton failure"  # ends in an error of Newton's iteration
    BLOW_UP = "blow-up"  # ends in meaningless numbers
    REFUSED = "refused"  # not accepted as input


class Said(StrEnum):
    """Kind of report by this library on a simulation: an error, a warning, a quantity in its result, or no report."""

    ERROR = "error"
    WARNING = "warning"
    FIGURE = "figure"
    SILENT = ""


@dataclass(frozen=True)
class Axis:
    """An axis of a stability map: table column, label, and grid values of a quick and of a full measurement."""

    column: str  # column of the table
    label: str  # label with its unit
    quick: tuple[Value, ...]  # values of a quick run
    full: tuple[Value, ...]


@dataclass(frozen=True)
class Finding:
    """Result of a run: outcome, quantity in a stability map (nan after an error), and this library's report, if any."""

    kind: Kind
    value: float
    said: Said = Said.SILENT  # kind of this library's report: error, warning, or a quantity in the result
    message: str = ""  # text of the report


@dataclass(frozen=True)
class StabilityMap:
    """A stability map: runs over a grid of two parameters, each classified by how a numerical method fails."""

    name: str  # name for the command line and of the files
    title: str
    x: Axis
    y: Axis
    panels: tuple[str, ...]  # panels in the order in which they are drawn
    quantity: str  # meaning of a cell's value, with its unit
    advice: str  # one sentence with a remedy for the failures
    measure: Callable[[str, float, float], Finding]  # function from panel, x and y to the cell's finding
    limit: Callable[[str, float], float] = lambda panel, y: math.nan  # theoretical limit on x; nan where unknown
    limit_label: str = ""  # meaning and origin of the limit

    def cells(self, quick: bool) -> Iterator[tuple[str, Value, Value]]:
        """Yield (subplot's name, x, y) of every run of the map, on the coarse grid if `quick`, or the full grid."""
        for panel in self.panels:
            for y in self.y.quick if quick else self.y.full:
                for x in self.x.quick if quick else self.x.full:
                    yield panel, x, y

    def row(self, panel: str, x: Value, y: Value) -> Mapping[str, Cell]:
        """Simulate and classify the run of subplot `panel` at the grid point (x, y), and return its table row."""
        cell = self.measure(panel, x, y)
        place = {"panel": panel, self.x.column: x, self.y.column: y, "class": cell.kind, "value": cell.value}
        return {**place, "limit": self.limit(panel, y), "said": cell.said, "message": cell.message}

    def description(self) -> dict[str, str]:
        """Return a plot's texts by key: "title", "x", "y", "x label", "y label", "value", "limit" and "advice".

        Keys "x" and "y" hold the axes' table columns. "value" explains a run's number, "limit" the limit line.
        """
        axes = {"x": self.x.column, "y": self.y.column, "x label": self.x.label, "y label": self.y.label}
        texts = {"value": self.quantity, "limit": self.limit_label, "advice": self.advice}
        return {"title": self.title, **axes, **texts}


def listen(run: Callable[[], Result], judge: Callable[[Result], Finding]) -> Finding:
    """Return the finding `judge(run())`; if `run` warns, its warnings replace the finding's report.

    If `run` raises a SimulationError or ValueError, return a finding with the error's class and text and a nan value.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", SimulationWarning)
        try:
            result = run()
        except SimulationError as error:
            kinds = {"newton": Kind.NO_SOLUTION, "step_size": Kind.NO_SOLUTION, "steps": Kind.NO_END}
            return Finding(kinds.get(error.reason, Kind.BLOW_UP), math.nan, Said.ERROR, str(error))
        except ValueError as error:
            return Finding(Kind.REFUSED, math.nan, Said.ERROR, str(error))
    cell = judge(result)
    if not caught:
        return cell
    return replace(cell, said=Said.WARNING, message="; ".join(str(one.message) for one in caught))


def classify_ratios(lowest: float, highest: float, tolerance: float) -> Kind:
    """Classify a run by the lowest and the highest ratio of a simulated quantity to its exact value.

    Ratios within `tolerance` of 1 are fine; a higher one is growing, above 2 or nan a blow-up, a lower one over-damped.
    """
    if not highest <= 2.0:
        return Kind.BLOW_UP
    if highest > 1.0 + tolerance:
        return Kind.GROWING
    return Kind.OVER_DAMPED if lowest < 1.0 - tolerance else Kind.FINE


def silent_failures(table: Table) -> Table:
    """Return the rows of a map's table whose runs failed, unreported by this library; there should be no such row."""
    kept = (row for row in table.rows if row["class"] != Kind.FINE and row["said"] == Said.SILENT)
    return Table(tuple(kept), table.provenance)


def log_range(first: float, last: float, count: int) -> tuple[float, ...]:
    """Return `count` values from first to last at equal ratios, rounded to three digits."""
    ratio = (last / first) ** (1.0 / (count - 1))
    return tuple(float(f"{first * ratio**k:.3g}") for k in range(count))
