"""Growth of the cost with the size of the model: wall time against elements, modes and panels, measured and drawn."""

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, PanelModel, has_flexible_panels
from solar_env.array.methods import default_integrator
from solar_env.array.panels import ANCF, MODAL
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator
from solar_env.pictures.style import METHOD_LOOKS, STYLE, Look, look_of
from solar_env.studies.common.drawing import Box, Label, make_figure, place_labels, save, use_decades
from solar_env.studies.common.motion import Scene, run_own
from solar_env.studies.common.plans import ChartPlan
from solar_env.studies.common.tables import Cell, Row, Table
from solar_env.studies.common.timing import Job, Measured
from solar_env.studies.precision.methods import MODES

# Label of what is varied.
COUNTS = {"elements": "elements of a panel", "modes": "modes of a panel", "panels": "panels"}
ELEMENTS, BENDING_MODES, PANELS = COUNTS
_REPEATS = 5  # of runs that are short in every plan


@dataclass(frozen=True)
class Case:
    """One model, method and size that is timed.

    Attributes:
        varied: one of COUNTS.
        model: one of `array.MODELS`.
        panels: model of the panels.
        fixed: whether the step is fixed; else the integrator is the default one.
        count: of what is varied.
    """

    varied: str
    model: str
    panels: PanelModel
    fixed: bool
    count: int

    @property
    def integrator(self) -> Integrator:
        """The integrator."""
        return GeneralizedAlpha(step=1e-4) if self.fixed else default_integrator(self.model, self.panels)


def _cases(plan: ChartPlan) -> Iterator[Case]:
    for count in plan.growth_modes:
        yield Case(BENDING_MODES, "flexible-ideal", PanelModel(MODAL, count), False, count)
    for count in plan.growth_panels:
        yield Case(PANELS, "flexible-ideal", MODES, False, count)
    for fixed in (False, True):
        for count in plan.growth_elements:
            yield Case(ELEMENTS, "flexible-ideal", PanelModel(ANCF, count), fixed, count)
        for model in ("rigid-ideal", "flexible-ideal"):
            for count in plan.growth_panels:
                yield Case(PANELS, model, plan.panels, fixed, count)


def _scene(plan: ChartPlan, case: Case) -> Scene:
    duration = plan.growth_duration
    parameters = with_panels(plan.parameters, case.count) if case.varied == PANELS else plan.parameters
    return Scene(case.model, parameters, duration, duration, case.panels)


def with_panels(parameters: ArrayParameters, count: int) -> ArrayParameters:
    """Parameters of an array of another number of panels: further joints are like the last, fewer drop the last."""
    by_joint = {
        name: tuple(parameters.by_joint(name, joint) for joint in range(count))
        for name in ArrayParameters.BY_JOINT
        if isinstance(getattr(parameters, name), tuple)
    }
    return replace(parameters, panel_count=count, **by_joint)  # type: ignore[arg-type]


def growth_jobs(plan: ChartPlan) -> dict[Case, Job]:
    """The start of deployments of growing size."""
    return {
        case: Job(
            f"growth, {case.model}, {case.integrator.name}: {case.count} {case.varied}",
            partial(run_own, _scene(plan, case), case.integrator),
            _REPEATS,
        )
        for case in _cases(plan)
    }


def growth_rows(plan: ChartPlan, results: dict[Case, Measured]) -> dict[str, list[Row]]:
    """Rows by table: "growth" gets one for every run that reached its end."""
    rows: list[Row] = []
    for case, result in results.items():
        motion = result.motion
        if motion is None:
            continue
        rows.append(
            {
                "varied": case.varied,
                "model": case.model,
                "method": case.integrator.name,
                "count": case.count,
                "steps": motion.steps,
                "wall_s": result.wall,
                "wall_per_step_s": result.wall / motion.steps,
                "wall_per_simulated_second": result.wall / plan.growth_duration,
            }
        )
    return {"growth": rows}


COSTS = {
    "wall_per_step_s": "wall time of a step [s]",
    "wall_per_simulated_second": "wall time of a simulated second [s]",
}


def fitted_exponent(counts: NDArray[np.float64], costs: NDArray[np.float64]) -> float:
    """Exponent p of the least-squares fit of costs (n,) by a counts^p over the upper half of the range of counts.

    Small models have a cost of their own that does not grow, which the lower half would mix in.
    """
    upper = counts >= min(np.sqrt(counts.min() * counts.max()), np.sort(counts)[-2])
    return float(np.polyfit(np.log(counts[upper]), np.log(costs[upper]), 1)[0])


def draw_growth(rows: Table, folder: Path) -> list[Path]:
    """Draw cost against elements and against panels; returns the file."""
    looks = {f"{row['model']}, {row['method']}": _look(row) for row in rows.rows}
    figure, axes = make_figure(len(COSTS), len(COUNTS), (3.4, 2.4), len(looks))
    with mpl.rc_context(STYLE):
        for column, (varied, count_label) in zip(axes.T, COUNTS.items(), strict=True):
            for axis, (cost, label) in zip(column, COSTS.items(), strict=True):
                _draw_panel(axis, rows.where(varied=varied), cost)
                axis.set_xlabel(count_label)
                axis.set_ylabel(label)
    path = folder / "growth.png"
    note = "numbers: fitted exponents over the upper half of the range"
    note += "; with explicit methods the stable step shrinks too"
    save(figure, path, looks, _title(rows), note)
    return [path]


def _look(row: Mapping[str, Cell]) -> Look:
    """The look of a method, open markers for rigid panels."""
    filled = {} if has_flexible_panels(str(row["model"])) else {"markerfacecolor": "white"}
    return {**look_of(str(row["method"]), METHOD_LOOKS), **filled}


def _title(rows: Table) -> str:
    """The range of the fitted exponents of a step's cost with flexible panels."""
    parts = []
    for varied in COUNTS:
        own = rows.where(varied=varied, model="flexible-ideal")
        exponents = [
            fitted_exponent(of.column("count"), of.column("wall_per_step_s"))
            for of in (own.where(method=method) for method in own.values("method"))
        ]
        low, high = f"{min(exponents):.2f}", f"{max(exponents):.2f}"
        parts.append(f"{varied} to the power {low if low == high else f'{low} to {high}'}")
    return "With flexible panels a step's time grows with " + ", ".join(parts)


def _draw_panel(axis: Axes, rows: Table, cost: str) -> None:
    axis.set_xscale("log", base=2)
    axis.set_yscale("log")
    labels: list[Label] = []
    marks: list[tuple[float, float]] = []
    lines: list[Box] = []
    for model, method in dict.fromkeys((row["model"], row["method"]) for row in rows.rows):
        own = rows.where(model=model, method=method)
        counts, costs = own.column("count"), own.column(cost)
        style = _look(own.rows[0])
        axis.plot(counts, costs, markersize=3.5, **style)
        exponent = f"{fitted_exponent(counts, costs):.2f}"
        labels.append(Label(exponent, counts[-1], costs[-1], str(style["color"])))
        points = list(zip(counts, costs, strict=True))
        marks += points
        lines += [(*start, *end) for start, end in itertools.pairwise(points)]
    low, high = axis.get_xlim()
    axis.set_xlim(low, 1.6 * high)
    axis.xaxis.set_major_formatter("{x:g}")
    use_decades(axis, "y")
    place_labels(axis, labels, marks, lines)
