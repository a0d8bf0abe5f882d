"""Figure of the levels, from their tables alone: error of the model against its cost."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from solar_env.pictures.style import LEVEL_LOOKS, STYLE, Look, look_of
from solar_env.studies.common.bootstrap import mean_band
from solar_env.studies.common.drawing import make_figure, save, use_decades
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
    looks = {name: look_of(name, LEVEL_LOOKS) for name in names}
    figure, axes = make_figure(2, 1 + len(MEANS), (2.6, 2.1), len(looks), gap=0.7)
    with mpl.rc_context(STYLE):
        for axis, (error, label) in zip(axes[:, 0], ERRORS.items(), strict=True):
            _draw_errors(axis, rows, error, looks)
            axis.set_xlabel(label)
            axis.set_ylabel("wall time [s]")
        axes[0, 0].set_title(f"ideal joints, against {names[-1]}")
        for column, (statistic, label) in zip(axes.T[1:], MEANS.items(), strict=True):
            for axis, joint in zip(column, (1, 2), strict=True):
                _draw_means(axis, members.where(joint=joint), statistic, looks)
                axis.set_title(f"clearance, joint {joint}")
                axis.set_xlabel(label)
                axis.set_ylabel("wall time [s]")
    path = folder / "levels.png"
    note = "after the first latching, means and their 95 % bootstrap bands; default settings"
    save(figure, path, looks, _title(members), note)
    return [path]


def _title(members: Table) -> str:
    """How much the mean peak force still changes between the two finest levels."""
    coarse, fine = members.values("elements")[-2:]
    changes = []
    for joint in members.values("joint"):
        means = [members.where(joint=joint, elements=count).column("peak_force_N").mean() for count in (coarse, fine)]
        if means[1] > 0.0:
            changes.append(abs(means[0] / means[1] - 1.0))
    if not changes:
        return "Nothing was struck: no joint has latched"
    return f"Peak forces depend on the mesh: up to {max(changes):.0%} change from {coarse} to {fine} elements"


def _draw_errors(axis: Any, rows: Table, error: str, looks: dict[str, Look]) -> None:
    axis.set_xscale("log")
    axis.set_yscale("log")
    for name, x, y in zip(looks, rows.column(error), rows.column("wall_s"), strict=True):
        if np.isfinite(x) and x > 0.0:
            axis.plot([x], [y], markersize=4.5, **looks[name])
    use_decades(axis, "x")
    use_decades(axis, "y")


def _draw_means(axis: Any, rows: Table, statistic: str, looks: dict[str, Look]) -> None:
    axis.set_yscale("log")
    for panel, elements in dict.fromkeys((row["panel"], row["elements"]) for row in rows.rows):
        own = rows.where(panel=panel, elements=elements)
        mean, low, high = mean_band(own.column(statistic))
        wall = float(np.median(own.column("wall_s")))
        style = looks[level_name(str(panel), float(elements))]
        axis.errorbar([mean], [wall], xerr=[[mean - low], [high - mean]], markersize=4.5, linewidth=0.8, **style)
    use_decades(axis, "y")
