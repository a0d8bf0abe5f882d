"""Levels of the model, rigid panels and 1 to 24 elements: their error and cost, measured and drawn."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from solar_env.array.methods import default_integrator
from solar_env.pictures.style import LEVEL_LOOKS, STYLE, Look, look_of
from solar_env.studies.common.bootstrap import mean_band
from solar_env.studies.common.drawing import make_figure, save, use_decades
from solar_env.studies.common.measures import angle_error, latch_error
from solar_env.studies.common.motion import Motion, Scene, run_own
from solar_env.studies.common.plans import Plan
from solar_env.studies.common.tables import Row, Table
from solar_env.studies.common.timing import time_interleaved
from solar_env.studies.precision.ensembles import member_rows


def _levels(plan: Plan) -> list[tuple[str, int]]:
    """Kind of panel and number of elements, which is zero for rigid ones."""
    return [("rigid", 0), *(("flexible", elements) for elements in plan.levels)]


def _scene(plan: Plan, panel: str, elements: int, joint: str) -> Scene:
    scene = plan.deployment(f"{panel}-{joint}")
    return replace(scene, elements=elements) if elements else scene


def count_levels(plan: Plan) -> int:
    """How many runs `run_levels` announces."""
    return len(_levels(plan)) * (1 + plan.level_members)


def _solve(scene: Scene) -> Motion:
    return run_own(scene, default_integrator(scene.model))


def run_levels(plan: Plan, announce: Callable[[str], None]) -> dict[str, list[Row]]:
    """Run a deployment with ideal joints, and an ensemble with clearance, at every level with default settings.

    "levels" gets cost and errors with ideal joints, against the level of the most elements; "levels_clearance" a row
    for every joint of every run with clearance, see `ensembles.statistics_of`.
    """
    levels = _levels(plan)
    jobs = {level: partial(_solve, _scene(plan, *level, "ideal")) for level in levels}
    measured = time_interleaved(
        jobs, plan.repeats, plan.long_run, lambda level: announce(f"levels, {level[0]}-ideal, {level[1]} elements")
    )
    finest = measured[levels[-1]].motion
    rows: list[Row] = []
    for panel, elements in levels:
        result = measured[panel, elements]
        if result.motion is None or finest is None:
            continue
        rows.append(
            {
                "panel": panel,
                "elements": elements,
                "repeats": len(result.walls),
                "wall_s": result.wall,
                "angle_error_rad": angle_error(result.motion, finest, plan.before_latch),
                "latch_error_s": latch_error(result.motion, finest),
                "energy_residual": result.motion.energy_residual,
            }
        )
    members: list[Row] = []
    for member in range(plan.level_members):
        for panel, elements in levels:
            announce(f"levels, {panel}-clearance, {elements} elements, run {member + 1}")
            scene = _scene(plan, panel, elements, "clearance")
            duration = plan.ensemble_duration["flexible"]
            labels: Row = {"panel": panel, "elements": elements, "duration_s": duration}
            members += member_rows(replace(scene, duration=duration), member, _solve, labels)
    return {"levels": rows, "levels_clearance": members}


def level_name(panel: str, elements: float) -> str:
    """Name of a level in figures."""
    if panel == "rigid" or math.isnan(elements):
        return "rigid"
    return f"{elements:g} element{'s' * (elements > 1)}"


ERRORS = {"angle_error_rad": "error of angles before the latch [rad]", "latch_error_s": "error of latch times [s]"}
MEANS = {
    "peak_force_N": "peak force [N]",
    "impulse_Ns": "impulse [N s]",
    "sliding_work_J": "sliding work [J]",
    "impacts": "number of impacts",
}


def draw_levels(rows: Table, members: Table, folder: Path) -> list[Path]:
    """Draw errors with ideal joints, then means with clearance for each joint, against wall time; returns the file."""
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


def _draw_errors(axis: Axes, rows: Table, error: str, looks: dict[str, Look]) -> None:
    axis.set_xscale("log")
    axis.set_yscale("log")
    for name, x, y in zip(looks, rows.column(error), rows.column("wall_s"), strict=True):
        if np.isfinite(x) and x > 0.0:
            axis.plot([x], [y], markersize=4.5, **looks[name])
    use_decades(axis, "x")
    use_decades(axis, "y")


def _draw_means(axis: Axes, rows: Table, statistic: str, looks: dict[str, Look]) -> None:
    axis.set_yscale("log")
    for panel, elements in dict.fromkeys((row["panel"], row["elements"]) for row in rows.rows):
        own = rows.where(panel=panel, elements=elements)
        mean, low, high = mean_band(own.column(statistic))
        wall = float(np.median(own.column("wall_s")))
        style = looks[level_name(str(panel), float(elements))]
        axis.errorbar([mean], [wall], xerr=[[mean - low], [high - mean]], markersize=4.5, linewidth=0.8, **style)
    use_decades(axis, "y")
