"""Work against precision: every method at every setting, its error against a reference, and what it cost.

Errors are those of the method, not of the panels: every run is compared with the reference on the same panels. The
reference is the finest run of the first of two methods, or the finest of the only method that takes the panels; the
greatest deviation of the other reference runs from it is the floor below which an error says nothing. With clearance
the floor is what chaos leaves: see `convergence`, also for errors of the panels.
"""

import math
from collections.abc import Mapping
from functools import partial

from solar_env.studies.common.measures import angle_error, latch_error
from solar_env.studies.common.motion import Motion
from solar_env.studies.common.plans import ChartPlan
from solar_env.studies.common.tables import Row
from solar_env.studies.common.timing import Job, Measured
from solar_env.studies.precision.methods import (
    METHODS,
    MODAL_REFERENCES,
    REFERENCES,
    SHORT_REFERENCES,
    Pairs,
    find_method,
)

Key = tuple[str, str, float]  # model, method and setting
_COUNTS = ("steps", "evaluations", "factorizations", "energy_residual")


def references(model: str, plan: ChartPlan) -> tuple[Pairs, ...]:
    """Names and settings of the reference runs of a model, for each kind of panels."""
    pairs = (REFERENCES if plan.dear else SHORT_REFERENCES)[model]
    return (pairs, MODAL_REFERENCES[model]) if model in MODAL_REFERENCES else (pairs,)


def work_precision_jobs(plan: ChartPlan) -> dict[Key, Job]:
    """Every method at every setting on every model, the reference runs included."""
    jobs: dict[Key, Job] = {}
    for model in plan.models:
        chosen = [
            (method.name, value)
            for method in METHODS
            if method.available
            for value in (
                *method.settings.get(model, ())[: plan.settings],
                *(method.dear.get(model, ()) if plan.dear else ()),
            )
        ]
        chosen += [(name, value) for pairs in references(model, plan) for name, values in pairs for value in values]
        for name, value in chosen:
            solve = partial(find_method(name).solve, plan.deployment(model), value)
            title = f"work and precision, {model}: {name}, {value:g}"
            jobs[model, name, value] = Job(title, solve, plan.repeats)
    return jobs


def work_precision_rows(plan: ChartPlan, results: Mapping[Key, Measured]) -> list[Row]:
    """A row for every method at every setting, with the floor of its model and panels."""
    by_panels: dict[tuple[str, str], tuple[Motion, float]] = {}
    for model in plan.models:
        for pairs in references(model, plan):
            right, *others = _motions(model, results, pairs)
            floor = max(angle_error(motion, right, plan.before_latch) for motion in others)
            by_panels[model, find_method(pairs[0][0]).size(plan.deployment(model))] = right, floor
    rows: list[Row] = []
    for (model, name, value), result in results.items():
        method, scene = find_method(name), plan.deployment(model)
        panels = method.size(scene)
        right, floor = by_panels[model, panels]
        labels: Row = {
            "model": model,
            "panels": panels,
            "duration_s": scene.duration,
            "method": name,
            "setting": method.setting,
            "value": value,
            "failure": result.failure,
        }
        rows.append(labels | _costs(result) | errors_of(result.motion, right, plan) | {"floor_rad": floor})
    return rows


def _motions(model: str, results: Mapping[Key, Measured], pairs: Pairs) -> list[Motion]:
    motions = []
    for name, values in pairs:
        for value in values:
            result = results[model, name, value]
            if result.motion is None:
                raise ValueError(f"a reference run failed: {name} at {value:g}: {result.failure}")
            motions.append(result.motion)
    return motions


def _costs(result: Measured) -> Row:
    """Times and counts of a run; nan if it did not reach its end."""
    return result.times() | {name: getattr(result.motion, name, math.nan) for name in _COUNTS}


def errors_of(motion: Motion | None, right: Motion, plan: ChartPlan) -> Row:
    """Errors of a run, of angles before the latch and of latch times; nan if it did not reach its end."""
    if motion is None:
        return {"angle_error_rad": math.nan, "latch_error_s": math.nan}
    return {
        "angle_error_rad": angle_error(motion, right, plan.before_latch),
        "latch_error_s": latch_error(motion, right),
    }
