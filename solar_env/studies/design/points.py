"""Measurement of each design by an ensemble of runs, at the cheapest model level that is accurate for the array."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from solar_env.studies.common.motion import Level
from solar_env.studies.design.plan import DesignPlan
from solar_env.studies.loads.ensemble import LoadsPlan, run_member
from solar_env.studies.loads.quantities import QUANTITIES
from solar_env.support.campaigns import Campaign, Cell

STORE = "design.jsonl"
WINDOW = 10.0  # s; time simulated after the last latching
TOLERANCE = 0.1  # greatest relative error of a quantity at an accurate model level
# Model levels from the cheapest; modal panels take no fittings (point masses).
CANDIDATES = ("rigid-clearance", "flexible-clearance:8 modes", "flexible-clearance")
WITH_FITTINGS = ("rigid-clearance", "flexible-clearance:4 elements")


@dataclass(frozen=True)
class Point:
    """A design with its simulated quantities.

    Attributes:
        values: Values, by name, of the parameters that may change.
        figures: Name of each quantity -> its greatest magnitude among the joints, averaged over the ensemble, in the
            printed unit; nan if the design was refused, or a run failed or did not latch.
        scatter: Standard error of the mean of the quantity to minimise.
        failing: Reason why the design is not acceptable; empty if it is.
        excess: Sum of `Condition.excess` over all conditions; inf if the quantities are unknown.
    """

    values: Mapping[str, float]
    figures: Mapping[str, float]
    scatter: float
    failing: str
    excess: float


class Bench:
    """Runner that simulates designs on `workers` processes; results in `folder` let an interrupted study continue."""

    def __init__(self, plan: DesignPlan, folder: Path, workers: int, console: Console) -> None:
        self.plan, self._store, self._workers, self._console = plan, folder / STORE, workers, console
        self._loads = LoadsPlan(plan.array, members=plan.members, window=WINDOW, deadline=plan.deadline)
        self.finest = self._loads.levels[1]

    def level(self) -> tuple[Level, str]:
        """Choose the cheapest level of model fidelity whose results for the present array are near the finest level's.

        The results are the quantities that the study minimises or limits; near means a relative error up to TOLERANCE.
        Return the level, and the reason in words. If a run of the present array at the finest level fails or does not
        latch, the level is the default one of `LoadsPlan`.
        """
        levels = [*map(Level, WITH_FITTINGS if self.plan.array.parameters.panel_masses else CANDIDATES)]
        results = self.measured([(self.plan.today(), level, 0) for level in (*levels, self.finest)], "levels")
        reference = results.pop()
        if not np.isfinite(list(reference.figures.values())).all():
            return self._loads.levels[0], "the array as it is fails: the level is that of loads"
        for level, point in zip(levels, results, strict=True):
            right = {name: figure for name, figure in reference.figures.items() if figure}
            pairs = ((abs(point.figures[name] / figure - 1.0), name) for name, figure in right.items())
            error, worst = max(pairs, default=(0.0, self.plan.least))
            if error <= TOLERANCE:
                return level, f"on the array as it is {worst} is {100.0 * error:.1g} % off the finest level's"
        return self.finest, f"no cheaper one is within {TOLERANCE:.0%} of it"

    def measured(self, asked: Sequence[tuple[Mapping[str, float], Level, int]], what: str = "") -> list[Point]:
        """Simulate designs, each given as (parameter values, model level, number k); return a `Point` for each.

        Runs k + 1 to k + `plan.members` of the design's ensemble are simulated. A label, `what`, shows a progress bar.
        """
        cells: list[list[Cell]] = []
        for values, level, first in asked:
            members = range(first + 1, first + self.plan.members + 1)
            try:
                array = self.plan.parameters(values)
                cells.append([self._loads.cell(level, array, self.plan.array.randomize, k) for k in members])
            except ValueError:
                cells.append([])
        campaign = Campaign(run_member, [cell for several in cells for cell in several], self._store)
        if what:
            campaign.run_shown(self._workers, self._console, what)
        else:
            list(campaign.run(self._workers))
        return [
            self._point(values, [campaign.result(cell) for cell in several])
            for (values, *_), several in zip(asked, cells, strict=True)
        ]

    def _point(self, values: Mapping[str, float], runs: Sequence[Mapping[str, Any]]) -> Point:
        unknown = dict.fromkeys(self.plan.quantities, np.nan)
        if not runs:
            return Point(values, unknown, np.nan, "refused", np.inf)
        if any("failed" in run for run in runs):
            return Point(values, unknown, np.nan, "simulation failed", np.inf)
        if not all(run["latched"] for run in runs):
            return Point(values, unknown, np.nan, f"no latching within {self.plan.deadline:g} s", np.inf)
        table = {
            name: QUANTITIES[name].scale * np.array([np.max(np.abs(run["quantities"][name])) for run in runs])
            for name in self.plan.quantities
        }
        figures = {name: float(column.mean()) for name, column in table.items()}
        least = table[self.plan.least]
        scatter = float(least.std(ddof=1)) / len(least) ** 0.5 if len(least) > 1 else np.nan
        missed = [condition for condition in self.plan.keep if condition.excess(figures[condition.quantity]) > 0.0]
        excess = sum(condition.excess(figures[condition.quantity]) for condition in missed)
        return Point(values, figures, scatter, " and ".join(f"not {condition}" for condition in missed), excess)
