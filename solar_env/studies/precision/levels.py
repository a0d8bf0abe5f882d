"""Levels of the model: rigid panels and flexible ones of few or many elements, what they err by and what they cost."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from solar_env.array.methods import default_integrator
from solar_env.studies.common.measures import angle_error, latch_error
from solar_env.studies.common.motion import Motion, Scene, run_own
from solar_env.studies.common.plans import Plan
from solar_env.studies.common.tables import Row
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

    Args:
        plan: what and how often.
        announce: called with a description before each run.

    Returns:
        "levels": cost and errors with ideal joints, against the level of the most elements. "levels_clearance": a row
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
