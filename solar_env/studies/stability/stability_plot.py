"""Figures of stability maps, drawn from their tables alone."""

import math
import textwrap
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke

from solar_env.pictures.style import OUTCOME_COLOURS, STEEL, STYLE
from solar_env.studies.common.drawing import short
from solar_env.studies.common.tables import Table, choice, number, read_table
from solar_env.studies.stability.maps import Kind, Said
from solar_env.support.files import save_figure

_DARK = (Kind.NO_SOLUTION, Kind.BLOW_UP)
CELL_WIDTH, CELL_HEIGHT = 0.36, 0.24  # inch
_LEFT, _BETWEEN, _RIGHT, _TOP, _TICKS, _LINE = 0.95, 0.25, 0.15, 0.55, 0.85, 0.15  # inch
_NARROWEST, _WIDEST = 7.4, 11.0  # inch; of wider ones the panels stand one above the other, for numbers to be read
_LEAST_PANEL = (1.9, 1.5)  # inch
_CHARACTERS = 17.0  # an inch of text
_IN_A_LINE = 6  # classes of the legend


def draw_map(table_path: Path, figure_path: Path) -> None:
    """Draw the figure of a map from its CSV file: panels of cells with class and value, limit, legend and advice.

    Raises:
        ValueError: if the table is not that of a map.
    """
    table = read_table(table_path)
    missing = {"title", "x", "y", "advice"} - table.provenance.keys()
    if missing:
        raise ValueError(f"{table_path} is not the table of a stability map: it lacks {', '.join(sorted(missing))}")
    about = table.provenance
    panels = table.values("panel")
    columns, rows = len(table.values(about["x"])), len(table.values(about["y"]))
    grid = (max(columns * CELL_WIDTH, _LEAST_PANEL[0]), max(rows * CELL_HEIGHT, _LEAST_PANEL[1]))
    across = len(panels)
    if _LEFT + across * (grid[0] + _BETWEEN) > _WIDEST:
        across = 1
    down = len(panels) // across
    wanted = _LEFT + across * grid[0] + (across - 1) * _BETWEEN + _RIGHT
    width = max(wanted, _NARROWEST)
    foot = _foot(table, int((width - 0.4) * _CHARACTERS))
    bottom = _TICKS + _LINE * (len(foot) + 2 * (1 + (len(table.values("class")) - 1) // _IN_A_LINE))
    height = _TOP + down * grid[1] + (down - 1) * (_TICKS + _BETWEEN) + bottom
    with mpl.rc_context({**STYLE, "axes.grid": False, "axes.spines.top": True, "axes.spines.right": True}):
        figure = Figure(figsize=(width, height))
        FigureCanvasAgg(figure)
        for k, panel in enumerate(panels):
            left = _LEFT + 0.5 * (width - wanted) + k % across * (grid[0] + _BETWEEN)
            foot_of = bottom + (down - 1 - k // across) * (grid[1] + _TICKS + _BETWEEN)
            axes = figure.add_axes((left / width, foot_of / height, grid[0] / width, grid[1] / height))
            _draw_panel(axes, table.where(panel=panel), about, first=k % across == 0)
            axes.set_title(str(panel))
            if k % across == 0:
                axes.set_ylabel(textwrap.fill(about["y label"], int(grid[1] * _CHARACTERS)))
        centre = (_LEFT - _RIGHT + width) / 2.0 / width
        figure.text(centre, (bottom - _TICKS + 0.22) / height, about["x label"], ha="center", va="bottom")
        figure.text(0.5, 1.0 - 0.18 / height, about["title"], ha="center", va="center", fontsize=9.5, weight="bold")
        _draw_legend(figure, table, (0.5, (_LINE * len(foot) + 0.1) / height))
        figure.text(0.5, 0.1 / height, "\n".join(foot), ha="center", va="bottom", linespacing=1.2)
        save_figure(figure, figure_path, dpi=160)


def _foot(table: Table, characters: int) -> list[str]:
    """Lines under the legend: what numbers, lines and dots mean, and the advice."""
    about = table.provenance
    marks = f"Number in a cell: {about['value']}. Dot: the library says so."
    if about["limit"]:
        marks += f" Line: {about['limit']}."
    return [*textwrap.wrap(marks, characters), *textwrap.wrap(about["advice"], characters)]


def _draw_panel(axes: Axes, table: Table, about: Any, first: bool) -> None:
    x_values, y_values = table.column(about["x"]), table.column(about["y"])
    x_ticks, y_ticks = (np.array(table.values(about[axis]), dtype=float) for axis in "xy")
    for row, x, y in zip(table.rows, x_values, y_values, strict=True):
        i, k = int(np.flatnonzero(x_ticks == x)[0]), int(np.flatnonzero(y_ticks == y)[0])
        kind = choice(row, "class", Kind)
        axes.add_patch(
            Rectangle((i - 0.5, k - 0.5), 1.0, 1.0, facecolor=OUTCOME_COLOURS[kind], edgecolor="white", linewidth=0.4)
        )
        ink = "white" if kind in _DARK else "black"
        value = number(row, "value")
        if math.isfinite(value):
            text = axes.text(i, k, short(value), ha="center", va="center", fontsize=7, color=ink, zorder=3)
            # The line of the limit ends round a number that it would strike out.
            text.set_path_effects([withStroke(linewidth=3.0, foreground=OUTCOME_COLOURS[kind])])
        if choice(row, "said", Said) != Said.SILENT:
            axes.plot(i + 0.42, k + 0.4, ".", color=ink, markersize=2.0)
    for k, y in enumerate(table.values(about["y"])):
        place = _place(number(table.first(**{about["y"]: y}), "limit"), x_ticks)
        if math.isfinite(place):
            axes.plot([place, place], [k - 0.5, k + 0.5], color="black", linewidth=1.6, solid_capstyle="butt", zorder=2)
    axes.set_xlim(-0.5, len(x_ticks) - 0.5)
    axes.set_ylim(-0.5, len(y_ticks) - 0.5)
    axes.set_xticks(range(len(x_ticks)), [f"{x:.3g}" for x in x_ticks], rotation=90)
    axes.set_yticks(range(len(y_ticks)), [f"{y:.3g}" for y in y_ticks] if first else [""] * len(y_ticks))
    axes.tick_params(length=2.0, labelsize=8)


def _place(limit: float, ticks: Any) -> float:
    """Place of a value among ticks that are drawn at equal distances, by interpolating its logarithm; nan outside."""
    if not limit > 0.0 or not (ticks > 0.0).all():
        return math.nan
    places = np.interp(math.log(limit), np.log(ticks), np.arange(len(ticks)), left=math.nan, right=math.nan)
    return float(places)


def _draw_legend(figure: Any, table: Table, place: tuple[float, float]) -> None:
    present = table.values("class")
    shown = [(kind, colour) for kind, colour in OUTCOME_COLOURS.items() if kind in present]
    handles = [Patch(facecolor=colour, edgecolor=STEEL, linewidth=0.4, label=kind) for kind, colour in shown]
    figure.legend(handles=handles, loc="lower center", bbox_to_anchor=place, ncols=_IN_A_LINE, columnspacing=1.2)
