"""Convergence of the panels: rigid ones, beams of 1 to 48 elements and 4 to 48 modes, their errors and costs."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from solar_env.studies.common.levels import Level
from solar_env.studies.common.measures import angle_error, force_error, latch_error
from solar_env.studies.common.motion import Motion, Scene, run_own
from solar_env.studies.common.plans import ChartPlan, Ensemble
from solar_env.studies.common.tables import Row
from solar_env.studies.common.timing import Job, Measured
from solar_env.studies.precision.ensembles import member_job, member_rows

RIGID = "rigid"
# Level, and the member of its ensemble with clearance; None for the run with ideal joints.
Key = tuple[Ensemble, int | None]


def family(level: Ensemble) -> str:
    """Kind of the panels: "rigid", "ancf" or "modal"."""
    return RIGID if level.panels is None else level.panels.kind


def _level(level: Ensemble, joint: str) -> Level:
    panels = "rigid" if level.panels is None else "flexible"
    return Level(f"{panels}-{joint}", level.panels, level.tighter)


def _scene(plan: ChartPlan, level: Level) -> Scene:
    scene = replace(plan.deployment(level.model), duration=plan.ensemble_duration.flexible)
    return replace(scene, panels=level.panels or scene.panels)


def _keys(plan: ChartPlan) -> Iterator[Key]:
    """With clearance member by member, so that what disturbs the machine meets all levels alike."""
    yield from ((level, None) for level in plan.levels)
    for member in range(max(level.members for level in plan.levels)):
        yield from ((level, member) for level in plan.levels if member < level.members)


def level_jobs(plan: ChartPlan) -> dict[Key, Job]:
    """A deployment with ideal joints, and an ensemble with clearance, at every level."""
    jobs: dict[Key, Job] = {}
    for ensemble, member in _keys(plan):
        level = _level(ensemble, "ideal" if member is None else "clearance")
        scene, name = _scene(plan, level), f"levels, {level.name}"
        if member is None:
            jobs[ensemble, member] = Job(name, partial(run_own, scene, level.integrator()), plan.repeats)
        else:
            jobs[ensemble, member] = member_job(name, scene, partial(solve_member, level), 1.0, member)
    return jobs


def solve_member(level: Level, scene: Scene, share: float) -> Motion:
    """A scene with the integrator of a level, its tolerance times a share."""
    return run_own(scene, replace(level, tighter=level.tighter / share).integrator())


def level_rows(plan: ChartPlan, results: dict[Key, Measured]) -> dict[str, list[Row]]:
    """Rows by table.

    "levels": cost and errors with ideal joints, against the finest of beams and against the finest of modes.
    "levels_clearance": for every joint of every run with clearance, see `ensembles.statistics_of`.
    """
    finest = {family(level): level for level in plan.levels if level.panels is not None}
    rows: list[Row] = []
    members: list[Row] = []
    for (level, member), result in results.items():
        labels: Row = {
            "level": _level(level, "ideal").size,
            "family": family(level),
            "duration_s": plan.ensemble_duration.flexible,
        }
        if member is not None:
            members += member_rows(labels, member, result)
        elif result.motion is not None:
            rows += [
                {**labels, "repeats": len(result.walls), "wall_s": result.wall, "reference": _level(of, "ideal").size}
                | ideal_errors(result.motion, results[of, None].motion, plan)
                for of in finest.values()
            ]
    return {"levels": rows, "levels_clearance": members}


def ideal_errors(motion: Motion, reference: Motion | None, plan: ChartPlan) -> Row:
    """Errors of a run with ideal joints: of angles, latch times, peak reactions and the energy book.

    Raises:
        ValueError: if there is no reference.
    """
    if reference is None:
        raise ValueError("a level that others are compared with could not be simulated to its end")
    return {
        "angle_error_rad": angle_error(motion, reference, plan.before_latch),
        "latch_error_s": latch_error(motion, reference),
        "reaction_error": force_error(motion, reference),
        "energy_residual": motion.energy_residual,
    }
