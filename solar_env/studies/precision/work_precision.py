"""Work against precision: the cost of every method at every setting, and its error against a reference.

Errors are the integrator's, not the panels': every run is compared with the finest run on the same panels. The floor is
the deviation of the second finest run from the finest; errors below the floor have no meaning. With clearance, chaos
sets the floor. For errors of the panel models see `convergence`.
"""

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from solar_env.array import ModelLevel
from solar_env.pictures.style import FAINT, METHOD_LOOKS, STYLE, Look, look_of
from solar_env.studies.common.drawing import make_figure, save, short, use_decades
from solar_env.studies.common.motion import Motion, angle_error, latch_error
from solar_env.studies.common.plans import ChartPlan
from solar_env.studies.common.tables import Cell, Row, Table, number
from solar_env.studies.common.timing import Job, Measured
from solar_env.studies.precision.methods import METHODS, REFERENCES
from solar_env.support.files import write_text
from solar_env.support.markdown import markdown_table

Key = tuple[str, str, float]  # model, method and setting
ERRORS = {
    "angle_error_rad": "error of angles before the latch [rad]",
    "latch_error_s": "error of latch times [s]",
}
COSTS = {"wall_s": "wall time [s]", "evaluations": "evaluations", "factorizations": "factorisations"}
ERROR = "angle_error_rad"
GOAL = 1e-4  # greatest error that the conclusion accepts [rad]
# Errors up to this multiple of the floor are left out when an order is fitted.
_ABOVE_FLOOR = 10.0
_FITTED = 3  # number of settings to which an order is fitted


def runs(plan: ChartPlan) -> dict[Key, Job]:
    """Return the jobs: every method at every setting on every model, reference runs included."""
    jobs: dict[Key, Job] = {}
    for model in plan.models:
        chosen = [
            (name, value)
            for name, method in METHODS.items()
            if method.available
            for value in method.settings.get(model, ())[: plan.settings]
        ]
        chosen += [(name, value) for name, values in REFERENCES[model] for value in values]
        for name, value in chosen:
            solve = partial(METHODS[name].solve, plan.deployment(model), value)
            title = f"work and precision, {model}: {name}, {value:g}"
            jobs[model, name, value] = Job(title, solve, plan.repeats)
    return jobs


def tabulate(plan: ChartPlan, results: Mapping[Key, Measured]) -> list[Row]:
    """Return a table row per model, method and setting, with errors and the floor below which they have no meaning."""
    by_panels: dict[tuple[str, str], tuple[Motion, float]] = {}
    for model in plan.models:
        for name, values in REFERENCES[model]:
            right, other = (results[model, name, value].motion for value in values)
            if right is None or other is None:
                raise ValueError(f"the reference {name} of {model} could not be simulated to its end")
            panels = METHODS[name].size(plan.deployment(model))
            by_panels[model, panels] = right, angle_error(other, right, plan.before_latch)
    rows: list[Row] = []
    for (model, name, value), result in results.items():
        method, scene, motion = METHODS[name], plan.deployment(model), result.motion
        right, floor = by_panels[model, method.size(scene)]
        row: Row = {
            "model": model,
            "panels": method.size(scene),
            "duration_s": scene.duration,
            "method": name,
            "setting": method.setting,
            "value": value,
            "failure": result.failure,
        }
        row |= result.times()
        for count in ("steps", "evaluations", "factorizations", "energy_residual"):
            row[count] = getattr(motion, count, math.nan)
        rows.append(row | errors_of(motion, right, plan) | {"floor_rad": floor})
    return rows


def errors_of(motion: Motion | None, right: Motion, plan: ChartPlan) -> Row:
    """Return table cells with the greatest errors of a run's angles before latching [rad] and of its latch times [s].

    `right` is the reference run. Both errors are nan if the run failed (`motion` is None).
    """
    if motion is None:
        return dict.fromkeys(ERRORS, math.nan)
    return {
        "angle_error_rad": angle_error(motion, right, plan.before_latch),
        "latch_error_s": latch_error(motion, right),
    }


def draw(rows: Table, folder: Path) -> list[Path]:
    """Plot costs against angle error, one subplot per cost and model; write a Markdown table; return both files."""
    looks = {str(name): look_of(str(name), METHOD_LOOKS) for name in rows.values("method")}
    models = rows.values("model")
    figure, axes = make_figure(len(COSTS), len(models), (max(2.15, 6.4 / len(models)), 1.9), len(looks))
    with mpl.rc_context(STYLE):
        for column, model in zip(axes.T, models, strict=True):
            shown = rows.where(model=model)
            for axis, cost in zip(column, COSTS, strict=True):
                axis.sharex(column[0])  # before curves are drawn, so that the errors of all costs fit
                draw_curves(axis, shown, ERROR, cost, looks)
                axis.axvspan(0.0, number(shown.rows[0], "floor_rad"), color=FAINT, alpha=0.5, linewidth=0.0, zorder=0)
            column[0].set_title(_title(shown), fontsize=7.5)
        for axis, label in zip(axes[:, 0], COSTS.values(), strict=True):
            axis.set_ylabel(label)
    picture, page = folder / "angles.png", folder / "work_precision.md"
    note = f"{ERRORS[ERROR]}; grey: what the two finest runs of the reference disagree by; modes: their finest run"
    save(figure, picture, looks, _conclusion(rows), note)
    write_text(page, _page(rows))
    return [picture, page]


def draw_curves(axis: Axes, rows: Table, error: str, cost: str, looks: Mapping[str, Look], by: str = "method") -> None:
    """Plot column `cost` against column `error` on logarithmic axes, a curve for each value of column `by`."""
    axis.set(xscale="log", yscale="log")
    for name in rows.values(by):
        curve = rows.where(**{by: name})
        points = np.array([curve.column(error), curve.column(cost)])
        errors, costs = points[:, np.all(np.isfinite(points) & (points > 0.0), axis=0)]
        axis.plot(errors, costs, markersize=4, **looks[str(name)])
    use_decades(axis, "x")
    use_decades(axis, "y")


def cheapest(rows: Table) -> Mapping[str, Cell] | None:
    """Return the row of least wall time with an angle error of GOAL or less; None if no row is so accurate."""
    within = [row for row in rows.rows if 0.0 < number(row, ERROR) <= GOAL]
    return min(within, key=lambda row: number(row, "wall_s"), default=None)


def order(rows: Table) -> float:
    """Return a method's observed order p: errors go as n^-p with n steps, or n evaluations where steps are unknown.

    `rows` are one method's settings. The order is fitted by least squares to the three finest with errors well above
    the reference's own error. It is nan if fewer qualify, or with clearance, where chaos, not step size, sets errors.
    """
    steps, errors = rows.column("steps"), rows.column(ERROR)
    counts = np.where(np.isfinite(steps), steps, rows.column("evaluations"))
    above = np.isfinite(counts) & (errors > _ABOVE_FLOOR * rows.column("floor_rad"))
    counts, errors = counts[above], errors[above]
    if len(counts) < _FITTED or ModelLevel.of(str(rows.rows[0]["model"])).clearance:
        return math.nan
    finest = np.argsort(counts)[-_FITTED:]
    return -float(np.polyfit(np.log(counts[finest]), np.log(errors[finest]), 1)[0])


def _conclusion(rows: Table) -> str:
    """Return a title that names each model's fastest method among those with an angle error of GOAL or less."""
    best: dict[str, list[str]] = {}
    for model in rows.values("model"):
        row = cheapest(rows.where(model=model))
        if row is not None:
            best.setdefault(str(row["method"]), []).append(str(model))
    # Non-breaking spaces keep each method on one line.
    clauses = [f"{method} ({', '.join(models)})".replace(" ", "\N{NO-BREAK SPACE}") for method, models in best.items()]
    return f"Cheapest to within {short(GOAL)}: {'; '.join(clauses)}"


def _page(rows: Table) -> str:
    """Return a Markdown table, methods by models: least wall time for an error of GOAL or less, and observed order."""
    models = rows.values("model")
    lines = [
        [str(method), *(_least(rows.where(model=model, method=method)) for model in models)]
        for method in rows.values("method")
    ]
    text = f"Least wall time [s] with an error of angles within {short(GOAL)} rad, and the observed order in brackets:"
    return f"{text}\n\n{markdown_table(('method', *map(str, models)), lines)}\n"


def _least(rows: Table) -> str:
    """Return text such as "0.2 (4.9)": least wall time [s] at an angle error up to GOAL, and order; "" without rows."""
    row = cheapest(rows)
    found = order(rows) if rows.rows else math.nan
    words = f"{row['wall_s']:.3g}" if row else "not reached" if rows.rows else ""
    return words if math.isnan(found) else f"{words} ({found:.1f})"


def _title(rows: Table) -> str:
    """Format a plot title from a model's rows: the model, its panels, and the number of failed runs."""
    details = [str(panels) for panels in rows.values("panels") if panels != "rigid"]
    failed = sum(1 for row in rows.rows if row["failure"])
    if failed:
        details.append(f"{failed} failed")
    return f"{rows.rows[0]['model']}\n{', '.join(details)}"
