"""Work against precision as a figure and as a table, from the measured table alone."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from solar_env.array import ModelLevel
from solar_env.pictures.style import METHOD_LOOKS, STEEL, STYLE, Look, look_of
from solar_env.studies.common.drawing import draw_floor, make_figure, positive_points, save, short, use_decades
from solar_env.studies.common.tables import Cell, Table, number
from solar_env.support.files import write_text
from solar_env.support.markdown import markdown_table

COSTS = {"wall_s": "wall time [s]", "evaluations": "evaluations", "factorizations": "factorisations"}
ERROR, LABEL = "angle_error_rad", "error of angles before the latch [rad]"
GOAL = 1e-4  # error that the conclusion asks for [rad]
# Errors closer to the floor than this factor follow no order.
_ABOVE_FLOOR = 10.0
_FITTED = 3  # settings
# Of one panel with its labels, and of all in a row at least [inch].
_WIDTH, _HEIGHT, _LEAST_WIDTH = 2.15, 1.9, 6.4


def draw_work_precision(rows: Table, folder: Path) -> list[Path]:
    """Draw a column for each model and a row for each cost, and write the table in Markdown; returns the files."""
    looks = {str(name): look_of(str(name), METHOD_LOOKS) for name in rows.values("method")}
    models = rows.values("model")
    size = max(_WIDTH, _LEAST_WIDTH / len(models)), _HEIGHT
    figure, axes = make_figure(len(COSTS), len(models), size, len(looks))
    with mpl.rc_context(STYLE):
        for column, model in zip(axes.T, models, strict=True):
            own = rows.where(model=model)
            for axis, (cost, label) in zip(column, COSTS.items(), strict=True):
                _draw_panel(axis, own, cost, looks)
                draw_floor(axis, number(own.rows[0], "floor_rad"))
                if column[0] is axes[0, 0]:
                    axis.set_ylabel(label)
            column[0].set_title(_title(own), fontsize=7.5)
            _share_errors(column)
    picture, page = folder / "angles.png", folder / "work_precision.md"
    note = f"{LABEL}; grey: what two independent methods disagree by; modes are compared with their finest run"
    save(figure, picture, looks, _conclusion(rows), note)
    write_text(page, _page(rows))
    return [picture, page]


def cheapest(rows: Table) -> Mapping[str, Cell] | None:
    """The row of least wall time among those whose error is within the goal; None if there is none."""
    within = [row for row in rows.rows if 0.0 < number(row, ERROR) <= GOAL]
    return min(within, key=lambda row: number(row, "wall_s"), default=None)


def order(rows: Table) -> float:
    """Observed order of a method: exponent p of its errors, proportional to n^-p for n steps, or n evaluations.

    Fitted by least squares to the three finest settings whose errors are well above the floor. nan if there are fewer,
    and with clearance, where impacts bound the errors.
    """
    steps, errors = rows.column("steps"), rows.column(ERROR)
    counts = np.where(np.isfinite(steps), steps, rows.column("evaluations"))
    counts, errors = positive_points(counts, np.where(errors > _ABOVE_FLOOR * rows.column("floor_rad"), errors, 0.0))
    if len(counts) < _FITTED or ModelLevel.of(str(rows.rows[0]["model"])).clearance:
        return math.nan
    finest = np.argsort(counts)[-_FITTED:]
    return -float(np.polyfit(np.log(counts[finest]), np.log(errors[finest]), 1)[0])


def _conclusion(rows: Table) -> str:
    """The cheapest method of each model within the goal."""
    best: dict[str, list[str]] = {}
    for model in rows.values("model"):
        row = cheapest(rows.where(model=model))
        if row is not None:
            best.setdefault(str(row["method"]), []).append(str(model))
    # Lines break between methods, not within.
    clauses = [f"{method} ({', '.join(models)})".replace(" ", "\N{NO-BREAK SPACE}") for method, models in best.items()]
    return f"Cheapest to within {short(GOAL)}: {'; '.join(clauses)}"


def _page(rows: Table) -> str:
    """Order and cheapest setting of every method on every model in Markdown."""
    columns = (
        "model",
        "panels",
        "method",
        "observed order",
        "cheapest setting within the goal",
        "wall time [s]",
        LABEL,
    )
    lines = []
    for model, panels, method in dict.fromkeys((row["model"], row["panels"], row["method"]) for row in rows.rows):
        own = rows.where(model=model, method=method)
        row, found = cheapest(own), order(own)
        cells = ["none", "", ""]
        if row is not None:
            cells = [f"{row['setting']} {row['value']:g}", f"{row['wall_s']:.3g}", f"{row[ERROR]:.1e}"]
        lines.append([str(model), str(panels), str(method), "" if math.isnan(found) else f"{found:.1f}", *cells])
    return f"Goal: {short(GOAL)} rad.\n\n{markdown_table(columns, lines)}\n"


def _draw_panel(axis: Axes, rows: Table, cost: str, looks: dict[str, Look]) -> None:
    """Points of every method from its coarsest to its finest setting."""
    axis.set_xscale("log")
    axis.set_yscale("log")
    drawn = 0
    for name in rows.values("method"):
        own = rows.where(method=name)
        errors, costs = positive_points(own.column(ERROR), own.column(cost))
        if len(errors):
            axis.plot(errors, costs, markersize=3.5, **looks[str(name)])
        drawn += len(errors)
    if drawn == 0:
        axis.text(0.5, 0.5, "none", transform=axis.transAxes, ha="center", color=STEEL)
        axis.set_yticks([])
        return
    use_decades(axis, "y")


def _share_errors(column: Any) -> None:
    """The panels of a model have one scale of errors."""
    limits = [axis.get_xlim() for axis in column if len(axis.get_yticks())]
    for axis in column if limits else ():
        axis.set_xlim(min(low for low, _ in limits), max(high for _, high in limits))
        use_decades(axis, "x")


def _title(rows: Table) -> str:
    """Model; its panels, and runs that could not go on."""
    details = [str(panels) for panels in rows.values("panels") if panels != "rigid"]
    failed = sum(1 for row in rows.rows if row["failure"])
    if failed:
        details.append(f"{failed} failed")
    return f"{rows.rows[0]['model']}\n{', '.join(details)}"
