"""Figure of the levels, from their tables alone: error of the model against its cost."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from solar_env.pictures.plots import STYLE
from solar_env.studies.common.bootstrap import mean_band
from solar_env.studies.common.drawing import look_of, make_figure, save, use_decades
from solar_env.studies.common.tables import Table
from solar_env.studies.precision.levels import level_name

ERRORS = {"angle_error_rad": "error of angles before the latch [rad]", "latch_error_s": "error of latch times [s]"}
MEANS = {
    "peak_force_N": "peak force [N]",
    "impulse_Ns": "impulse [N s]",
    "sliding_work_J": "sliding work [J]",
    "impacts": "number of impacts",
}


def draw_levels(rows: Table, members: Table, folder: Path) -> list[Path]:
    """Draw errors with ideal joints, then means with clearance for each joint, against wall time; returns the file."""
    import matplotlib as mpl

    names = [level_name(str(row["panel"]), float(row["elements"])) for row in rows.rows]
    look = look_of(names)
    figure, axes = make_figure(2, 1 + len(MEANS), (2.6, 2.1), len(names), gap=0.7)
    with mpl.rc_context(STYLE):
        for axis, (error, label) in zip(axes[:, 0], ERRORS.items(), strict=True):
            _draw_errors(axis, rows, error, names, look)
            axis.set_xlabel(label)
            axis.set_ylabel("wall time [s]")
        axes[0, 0].set_title(f"ideal joints, against {names[-1]}")
        for column, (statistic, label) in zip(axes.T[1:], MEANS.items(), strict=True):
            for axis, joint in zip(column, (1, 2), strict=True):
                _draw_means(axis, members.where(joint=joint), statistic, look)
                axis.set_title(f"clearance, joint {joint}")
                axis.set_xlabel(label)
                axis.set_ylabel("wall time [s]")
    path = folder / "levels.png"
    save(figure, path, names, look, "after the first latching, means and their 95 % bootstrap bands; default settings")
    return [path]


def _draw_errors(axis: Any, rows: Table, error: str, names: list[str], look: dict[str, dict[str, Any]]) -> None:
    axis.set_xscale("log")
    axis.set_yscale("log")
    for name, x, y in zip(names, rows.column(error), rows.column("wall_s"), strict=True):
        if np.isfinite(x) and x > 0.0:
            axis.plot([x], [y], markersize=4.5, **look[name])
    use_decades(axis, "x")
    use_decades(axis, "y")


def _draw_means(axis: Any, rows: Table, statistic: str, look: dict[str, dict[str, Any]]) -> None:
    axis.set_yscale("log")
    for panel, elements in dict.fromkeys((row["panel"], row["elements"]) for row in rows.rows):
        own = rows.where(panel=panel, elements=elements)
        mean, low, high = mean_band(own.column(statistic))
        wall = float(np.median(own.column("wall_s")))
        style = look[level_name(str(panel), float(elements))]
        axis.errorbar([mean], [wall], xerr=[[mean - low], [high - mean]], markersize=4.5, linewidth=0.8, **style)
    use_decades(axis, "y")
