"""Convergence of the panels: rigid ones, beams of 1 to 48 elements and 4 to 48 modes, their errors and costs.

With ideal joints a level is compared with the finest modal panels. With clearance motions are chaotic, and what can be
compared are the means of ensembles, whose runs are released at slightly different rates, see `perturbed`.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from solar_env.array.level import MODES
from solar_env.studies.common.levels import Level
from solar_env.studies.common.measures import angle_error, force_error, latch_error
from solar_env.studies.common.motion import Motion, Scene, perturbed, run_own
from solar_env.studies.common.plans import ChartPlan, Ensemble
from solar_env.studies.common.tables import Row
from solar_env.studies.common.timing import Job, Measured

RIGID = "rigid"
STATISTICS = ("peak_force_N", "sliding_work_J", "impacts", "wear_depth_m")
"""Totals of a `Motion` whose means over an ensemble are compared, each joint's after the first latching."""

# Level, and the member of its ensemble with clearance; None for the run with ideal joints.
Key = tuple[Ensemble, int | None]


def family(level: Ensemble) -> str:
    """Kind of the panels: "rigid", "elements" or "modes"."""
    return _level(level, "ideal").panels.unit or RIGID


def _level(level: Ensemble, joint: str) -> Level:
    model = f"flexible-{joint}:{level.panels}" if level.panels else f"rigid-{joint}"
    return Level(model, level.tighter)


def _keys(plan: ChartPlan) -> Iterator[Key]:
    """With clearance member by member, so that what disturbs the machine meets all levels alike."""
    yield from ((level, None) for level in plan.levels)
    for member in range(max(level.members for level in plan.levels)):
        yield from ((level, member) for level in plan.levels if member < level.members)


def convergence_jobs(plan: ChartPlan) -> dict[Key, Job]:
    """A deployment with ideal joints, and an ensemble with clearance, at every level."""
    jobs: dict[Key, Job] = {}
    for ensemble, member in _keys(plan):
        level = _level(ensemble, "ideal" if member is None else "clearance")
        solve = partial(run_level, level, replace(plan.deployment(level.model), duration=plan.ensemble_duration))
        name = f"convergence, {level.name}"
        if member is None:
            jobs[ensemble, member] = Job(name, solve, plan.repeats)
        else:
            jobs[ensemble, member] = Job(f"{name}, run {member + 1}", partial(solve, member))
    return jobs


def run_level(level: Level, scene: Scene, member: int = 0) -> Motion:
    """A member of the ensemble of a scene at a level.

    Raises:
        SimulationError: if the run cannot go on.
    """
    parameters = perturbed(scene.parameters, member)
    return run_own(replace(scene, parameters=parameters, model=level.model), level.integrator(member))


def convergence_rows(plan: ChartPlan, results: dict[Key, Measured]) -> list[Row]:
    """A row for every level: cost and errors with ideal joints, then means of its ensemble with clearance.

    Raises:
        ValueError: if the level that others are compared with could not be simulated to its end.
    """
    finest = [level for level in plan.levels if family(level) == MODES][-1]
    reference = results[finest, None].motion
    if reference is None:
        raise ValueError("the level that others are compared with could not be simulated to its end")
    rows: list[Row] = []
    for level in plan.levels:
        ideal = results[level, None]
        if ideal.motion is None:
            continue
        labels: Row = {
            "level": _level(level, "ideal").size,
            "family": family(level),
            "duration_s": plan.ensemble_duration,
            "reference": _level(finest, "ideal").size,
            "wall_ideal_s": ideal.wall,
            "angle_error_rad": angle_error(ideal.motion, reference, plan.before_latch),
            "latch_error_s": latch_error(ideal.motion, reference),
            "reaction_error": force_error(ideal.motion, reference),
        }
        rows.append(labels | _means([results[level, member] for member in range(level.members)]))
    return rows


def _means(ensemble: list[Measured]) -> Row:
    """Number and median time of the runs that reached their end; means by statistic and joint, and standard errors."""
    ended = [(result.wall, result.motion.totals) for result in ensemble if result.motion is not None]
    count = len(ended)
    row: Row = {"runs": count, "wall_s": float(np.median([wall for wall, _ in ended])) if ended else math.nan}
    for statistic in STATISTICS:
        values = np.array([totals[statistic] for _, totals in ended]).reshape(count, -1)
        for joint, column in enumerate(values.T, start=1):
            row[f"{statistic}_{joint}"] = float(column.mean())
            row[f"{statistic}_{joint}_error"] = float(column.std(ddof=1)) / math.sqrt(count) if count > 1 else math.nan
    return row
