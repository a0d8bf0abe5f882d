"""Plots of stability maps, drawn from their tables alone."""

import math
import textwrap
from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from solar_env.pictures.style import OUTCOME_COLOURS, STEEL, STYLE
from solar_env.studies.common.drawing import short
from solar_env.studies.common.tables import Table, number, read_table
from solar_env.studies.stability.maps import Kind
from solar_env.support.files import save_figure

_DARK = (Kind.NO_SOLUTION, Kind.BLOW_UP)
CELL_WIDTH, CELL_HEIGHT = 0.4, 0.24  # inch
_NARROWEST = 7.4  # least width of a figure [inch]
_CHARACTERS = 15.0  # characters per inch of text
_IN_A_LINE = 6  # classes in a line of the legend


def draw_map(table_path: Path, figure_path: Path) -> None:
    """Plot a stability map from its CSV table: outcome and number of each run, theoretical limit, advice.

    The number is the quantity that the map is about, and the advice tells how to avoid failures.

    Raises:
        ValueError: if the table is not a map's table.
    """
    table = read_table(table_path)
    about, panels, present = table.provenance, table.values("panel"), table.values("class")
    if not set(present) <= set(Kind):
        raise ValueError(f"{table_path} is damaged or lacks classes of cells; measure it anew")
    columns, rows = len(table.values(about["x"])), len(table.values(about["y"]))
    width = max(1.0 + columns * CELL_WIDTH, _NARROWEST)
    height = len(panels) * (max(rows * CELL_HEIGHT, 1.2) + 0.4) + 2.6
    with mpl.rc_context({**STYLE, "axes.grid": False, "axes.spines.top": True, "axes.spines.right": True}):
        figure = Figure(figsize=(width, height), layout="constrained")
        all_axes = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
        for axes, panel in zip(all_axes, panels, strict=True):
            _draw_panel(axes, table.where(panel=panel), about)
            axes.set_title(str(panel))
        all_axes[-1].set_xlabel(about["x label"])
        figure.supylabel(about["y label"], fontsize="medium")
        figure.suptitle(about["title"], weight="bold")
        shown = [(kind, colour) for kind, colour in OUTCOME_COLOURS.items() if kind in present]
        handles = [Patch(facecolor=colour, edgecolor=STEEL, linewidth=0.4, label=kind) for kind, colour in shown]
        marks = f"Number in a cell: {about['value']}. Dot: the library says so."
        marks += f" Line: {about['limit']}." if about["limit"] else ""
        foot = "\n".join(textwrap.fill(text, int(width * _CHARACTERS)) for text in (marks, about["advice"]))
        figure.legend(handles=handles, title=foot, loc="outside lower center", ncols=_IN_A_LINE)
        save_figure(figure, figure_path, dpi=160)


def _draw_panel(axes: Axes, table: Table, about: Mapping[str, str]) -> None:
    x_ticks, y_ticks = (np.array(table.values(about[axis]), dtype=float) for axis in "xy")
    for row in table.rows:
        i, k = (int(np.flatnonzero(ticks == row[about[axis]])[0]) for axis, ticks in (("x", x_ticks), ("y", y_ticks)))
        colour, ink = OUTCOME_COLOURS[str(row["class"])], "white" if row["class"] in _DARK else "black"
        axes.add_patch(Rectangle((i - 0.5, k - 0.5), 1.0, 1.0, facecolor=colour, edgecolor="white", linewidth=0.4))
        value = number(row, "value")
        if math.isfinite(value):
            text = axes.text(i, k, short(value), ha="center", va="center", fontsize=7, color=ink, zorder=3)
            # Interrupt the limit line where it would cross the number.
            text.set_path_effects([withStroke(linewidth=3.0, foreground=colour)])
        if row["said"]:
            axes.plot(i + 0.42, k + 0.4, ".", color=ink, markersize=2.0)
        place = _place(number(row, "limit"), x_ticks)
        if i == 0 and math.isfinite(place):
            axes.plot([place, place], [k - 0.5, k + 0.5], color="black", linewidth=1.6, solid_capstyle="butt", zorder=2)
    axes.set_xlim(-0.5, len(x_ticks) - 0.5)
    axes.set_ylim(-0.5, len(y_ticks) - 0.5)
    axes.set_xticks(range(len(x_ticks)), [f"{x:.3g}" for x in x_ticks], rotation=90)
    axes.set_yticks(range(len(y_ticks)), [f"{y:.3g}" for y in y_ticks])
    axes.tick_params(length=2.0, labelsize=8)


def _place(limit: float, ticks: NDArray[np.float64]) -> float:
    """Return the position of `limit` on an axis with ticks drawn 1 apart, by logarithmic interpolation; nan outside."""
    if not limit > 0.0 or not (ticks > 0.0).all():
        return math.nan
    places = np.interp(math.log(limit), np.log(ticks), np.arange(len(ticks)), left=math.nan, right=math.nan)
    return float(places)
