"""Search for the best design: a grid over one or two parameters, or CMA-ES over more."""

import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solar_env.array.motorization import listed, motorization, weakest
from solar_env.studies.common.motion import Level
from solar_env.studies.common.tables import Row
from solar_env.studies.design.plan import DesignPlan
from solar_env.studies.design.points import Bench, Point
from solar_env.studies.loads.quantities import QUANTITIES
from solar_env.studies.loads.statistics import rounded, shortened
from solar_env.support.minimisation import minimise

MAPPED = 2  # greatest number of parameters of which all combinations are tried


@dataclass(frozen=True)
class Design:
    """Result of a design study.

    Attributes:
        level, reason: Model level at which designs were compared, and why it was chosen.
        today, points: The present array, and all designs tried.
        best: The best design that keeps all conditions; None where every design fails.
        confirmed: The best design, simulated with other ensemble members at the finest level; None if `best` is None.
    """

    plan: DesignPlan
    level: Level
    reason: str
    today: Point
    points: Sequence[Point]
    best: Point | None
    confirmed: Point | None


def find_design(bench: Bench, seed: int, progress: bool) -> Design:
    """Search for the best design with simulations by `bench`; return a `Design` with the best and all designs tried.

    The best design is simulated again, with other ensemble members and at the finest model level.
    """
    plan = bench.plan
    level, reason = bench.level()
    (today,) = bench.measured([(plan.today(), level, 0)])
    if len(plan.changes) <= MAPPED:
        points = bench.measured([(values, level, 0) for values in _grid(plan)], "designs")
    else:
        points = _searched(bench, level, today, seed, progress)
    good = [point for point in (today, *points) if not point.failing]
    best = min(good, key=lambda point: point.figures[plan.least], default=None)
    confirmed = None
    if best is not None:
        (confirmed,) = bench.measured([(best.values, bench.finest, plan.members)], "runs of the best design")
    return Design(plan, level, reason, today, points, best, confirmed)


def _grid(plan: DesignPlan) -> list[dict[str, float]]:
    """Return all combinations of evenly spaced parameter values; the last parameter varies fastest."""
    count = max(2, round(plan.points ** (1.0 / len(plan.changes))))
    axes = [[change.value(share) for share in np.linspace(0.0, 1.0, count)] for change in plan.changes]
    return [dict(zip(plan.change, values, strict=True)) for values in itertools.product(*axes)]


def _searched(bench: Bench, level: Level, today: Point, seed: int, progress: bool) -> list[Point]:
    """Search by CMA-ES at the model level `level`, starting at the present design `today`; return all designs tried."""
    plan, tried = bench.plan, []
    scale = today.figures[plan.least] if np.isfinite(today.figures[plan.least]) else 1.0

    def costs(asked: Sequence[np.ndarray]) -> list[float]:
        values = [
            {change.name: change.value(share) for change, share in zip(plan.changes, np.clip(x, 0.0, 1.0), strict=True)}
            for x in asked
        ]
        points = bench.measured([(each, level, 0) for each in values])
        tried.extend(points)
        return [1e6 + min(p.excess, 1e6) if p.failing else p.figures[plan.least] / scale for p in points]

    values = plan.today()
    start = np.array([change.share(values[change.name]) for change in plan.changes])
    minimise(costs, start, plan.points, seed, progress)
    return tried


def row_of(plan: DesignPlan, point: Point) -> Row:
    """Return a design's table row: parameter values, quantities in printed units, and the reason if it fails."""
    names = {change.name: change.label for change in plan.changes}
    row: Row = {names[name]: value for name, value in point.values.items()}
    for name in plan.quantities:
        row[f"{name} [{QUANTITIES[name].unit or 1}]"] = point.figures[name]
    return row | {"standard error": point.scatter, "failing": point.failing}


def answer(design: Design) -> list[str]:
    """Return sentences that compare the best design with the present array, and tell of failing designs and runs."""
    plan, best, confirmed = design.plan, design.best, design.confirmed
    least, labels = QUANTITIES[plan.least], {change.name: change.label for change in plan.changes}
    lines = []
    if best is None or confirmed is None:
        lines.append(f"None of {len(design.points)} designs keeps {' and '.join(map(str, plan.keep)) or 'latching'}.")
    else:
        values = ", ".join(f"{labels[name]} = {value:g}" for name, value in best.values.items())
        now = design.today.figures[plan.least]
        kept = "".join(
            f", {QUANTITIES[name].name} {shortened(confirmed.figures[name], 3)} {QUANTITIES[name].unit}"
            for name in plan.quantities[1:]
        )
        figure, before = (rounded(p.figures[plan.least], p.scatter) for p in (confirmed, best))
        lines.append(
            f"{values}: {least.name} {figure} {least.unit}{kept}, by fresh runs at the finest level; at "
            f"{design.level.name} it is {before} {least.unit}, and {shortened(now, 3)} {least.unit} as the array is."
        )
        hinges = motorization(weakest(plan.parameters(best.values), plan.array.randomize))
        lines.append(f"Motorization of this design: {listed(hinges)}.")
        driven = all(hinge.ratio[0] >= 1.0 for hinge in hinges)
        if confirmed.failing:
            lines.append(f"At the finest level this design fails ({confirmed.failing}): ask for more than you need.")
        shares = {change.label: change.share(best.values[change.name]) for change in plan.changes}
        if driven and (edges := [label for label, share in shares.items() if share in (0.0, 1.0)]):
            lines.append(f"It lies at the end of the range of {' and '.join(edges)}; a wider one may hold better ones.")
    failing = Counter(point.failing for point in design.points if point.failing)
    told = ", ".join(f"{reason}: {count}" for reason, count in failing.most_common())
    lines.append(f"{failing.total()} of {len(design.points)} designs fail{f' ({told})' if told else ''}.")
    runs = "1 run" if plan.members == 1 else f"{plan.members} runs"
    lines.append(f"{runs} of each at {design.level.name}: {design.reason}.")
    return lines
