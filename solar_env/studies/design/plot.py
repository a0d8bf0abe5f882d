"""Plot of designs: a map over two parameters, or the minimised quantity against each parameter."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solar_env.pictures.style import COLOURS, STYLE
from solar_env.studies.common.drawing import short
from solar_env.studies.design.search import Design
from solar_env.studies.loads.quantities import QUANTITIES
from solar_env.support.files import save_figure


def draw_design(design: Design, path: Path) -> None:
    """Plot the minimised quantity of all designs of a study, whose result is `design`, to a file.

    Crosses mark designs that fail, and a rectangle frames the best one.
    """
    plan, quantity = design.plan, QUANTITIES[design.plan.least]
    what = f"{quantity.name} [{quantity.unit}]"
    two = len(plan.changes) == 2
    with mpl.rc_context({**STYLE, "axes.grid": not two}):
        count = 1 if two else len(plan.changes)
        figure = Figure(figsize=(7.0 if two else 4.0 * count, 5.0 if two else 3.6), layout="constrained")
        axes = figure.subplots(1, count, squeeze=False)[0]
        if two:
            _draw_map(axes[0], design)
        else:
            for axis, change in zip(axes, plan.changes, strict=True):
                _draw_over(axis, design, change.name)
            axes[0].set_ylabel(what)
        lines = ["No design keeps all conditions"]
        if design.best is not None:
            best = [f"{change.label} = {design.best.values[change.name]:.3g}" for change in plan.changes]
            lines = [f"Least {what}: {short(design.best.figures[plan.least])}", f"at {', '.join(best)}"]
        crosses = " (crosses fail)" if any(point.failing for point in design.points) else ""
        figure.suptitle("\n".join(lines) + crosses, fontsize=10)
        save_figure(figure, path, dpi=100)


def _draw_map(axis: Axes, design: Design) -> None:
    """Draw a map of the minimised quantity over the two parameters, with its value at every combination."""
    x, y = design.plan.changes
    columns, rows = (sorted({point.values[change.name] for point in design.points}) for change in (x, y))
    values, failing = np.full((len(rows), len(columns)), np.nan), []
    for point in design.points:
        k, i = columns.index(point.values[x.name]), rows.index(point.values[y.name])
        values[i, k] = point.figures[design.plan.least]
        if point.failing:
            failing.append((k, i))
        if point is design.best:
            axis.add_patch(mpl.patches.Rectangle((k - 0.46, i - 0.46), 0.92, 0.92, fill=False, linewidth=1.8))
    known = values[np.isfinite(values)]
    wide = known.size and known.min() > 0.0 and known.max() > 10.0 * known.min()
    axis.imshow(values, origin="lower", aspect="auto", cmap="YlOrRd", norm="log" if wide else "linear")
    middle = (np.sqrt(known.min() * known.max()) if wide else 0.5 * (known.min() + known.max())) if known.size else 0.0
    for (i, k), value in np.ndenumerate(values):
        if np.isfinite(value):
            ink = "white" if value > middle else "black"
            axis.text(k, i, short(float(value)), ha="center", va="center", fontsize=7, color=ink)
    axis.plot(*np.array(failing).reshape(-1, 2).T, "x", color=COLOURS[0], markersize=14, markeredgewidth=1.0)
    axis.set_xticks(range(len(columns)), [f"{value:.3g}" for value in columns])
    axis.set_yticks(range(len(rows)), [f"{value:.3g}" for value in rows])
    axis.set(xlabel=x.label, ylabel=y.label)


def _draw_over(axis: Axes, design: Design, name: str) -> None:
    """Plot designs' minimised quantity against parameter `name`; crosses at the lower edge mark unknown quantities."""
    (change,) = (change for change in design.plan.changes if change.name == name)
    least = design.plan.least
    look: dict[str, Any] = {"linestyle": "", "markersize": 4.0}
    for failing, mark in ((False, "o"), (True, "x")):
        points = [point for point in design.points if bool(point.failing) is failing]
        x, y = ([p.values[name] for p in points], [p.figures[least] for p in points])
        axis.plot(x, y, marker=mark, color=COLOURS[int(failing)], **look)
    without = [point.values[name] for point in design.points if not np.isfinite(point.figures[least])]
    foot = axis.get_xaxis_transform()
    axis.plot(without, [0.02] * len(without), marker="x", color=COLOURS[1], transform=foot, **look)
    if design.best is not None:
        axis.plot(design.best.values[name], design.best.figures[least], "s", mfc="none", color="black", markersize=10.0)
    axis.set(xlabel=change.label, xscale="log" if change.logarithmic else "linear")
