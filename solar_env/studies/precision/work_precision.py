"""Work against precision: every method at every setting, its errors against a reference, and what it cost.

Errors are those of the method, not of the panels: every run is compared with the reference on the same panels. The
reference of a scene is the finest run of the first of two methods, or the finest of the only method that takes the
panels; the greatest deviation of the other reference runs from it is the floor below which an error says nothing. With
clearance the floor of whole deployments is what chaos leaves: see `ensembles`, and `levels` for errors of the panels.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial

from solar_env.array import has_clearance
from solar_env.studies.common import measures
from solar_env.studies.common.motion import Motion, Scene
from solar_env.studies.common.plans import ChartPlan
from solar_env.studies.common.tables import Row
from solar_env.studies.common.timing import Job, Measured
from solar_env.studies.precision.methods import (
    DEPLOYMENT_REFERENCES,
    IMPACT_REFERENCES,
    METHODS,
    MODAL_REFERENCES,
    SHORT_REFERENCES,
    Method,
    Pairs,
    Settings,
    find_method,
)

DEPLOYMENT, IMPACTS = "deployment", "impacts"
Key = tuple[str, str, str, float]  # kind of scene, model, method and setting


@dataclass(frozen=True)
class Reference:
    """Reference that errors are taken against.

    Attributes:
        motions: of all reference runs, the first of which is right.
        impacts: by joint, how many first impacts all of them tell alike.
    """

    motions: tuple[Motion, ...]

    @property
    def impacts(self) -> tuple[int, ...]:
        """By joint, how many first impacts all reference runs tell alike."""
        counts = [measures.horizon(self.motions[0], other) for other in self.motions[1:]]
        return tuple(min(joint) for joint in zip(*counts, strict=True))

    @property
    def horizon(self) -> float:
        """Start of the last impact that all reference runs tell alike [s]; nan if there is none."""
        starts = [
            float(measures.impacts_of(self.motions[0], joint)["start_s"][count - 1])
            for joint, count in enumerate(self.impacts)
            if count > 0
        ]
        return max(starts, default=math.nan)


def scenes(plan: ChartPlan) -> Iterator[tuple[str, Scene]]:
    """Kind and scene of everything that is measured."""
    for model in plan.models:
        yield DEPLOYMENT, plan.deployment(model)
        if has_clearance(model):
            yield IMPACTS, plan.initial_phase(model)


def _settings(method: Method, kind: str, model: str, plan: ChartPlan) -> Settings:
    """Settings of a method that are measured, besides those of the references."""
    if kind == IMPACTS:
        return method.impacts.get(model, ())[: plan.settings]
    dear = method.dear.get(model, ()) if plan.dear else ()
    return method.deployments.get(model, ())[: plan.settings] + dear


def references(kind: str, model: str, plan: ChartPlan) -> tuple[Pairs, ...]:
    """Names and settings of the reference runs of a scene, for each model of panels; fewer in a short plan."""
    if kind == DEPLOYMENT:
        pairs = (DEPLOYMENT_REFERENCES if plan.dear else SHORT_REFERENCES)[model]
    else:
        pairs = IMPACT_REFERENCES[model]
        pairs = pairs if plan.dear else tuple((name, values[:1]) for name, values in pairs)
    return (pairs, MODAL_REFERENCES[model]) if model in MODAL_REFERENCES else (pairs,)


def work_precision_jobs(plan: ChartPlan) -> dict[Key, Job]:
    """Every method at every setting on every scene, the reference runs included."""
    jobs: dict[Key, Job] = {}
    for kind, scene in scenes(plan):
        chosen = {
            (method.name, value): method
            for method in METHODS
            if method.available
            for value in _settings(method, kind, scene.model, plan)
        }
        for pairs in references(kind, scene.model, plan):
            chosen |= {(name, value): find_method(name) for name, values in pairs for value in values}
        for (name, value), method in chosen.items():
            solve = partial(method.solve, scene, value)
            title = f"{kind}, {scene.model}: {name}, {value:g}"
            jobs[kind, scene.model, name, value] = Job(title, solve, plan.repeats)
    return jobs


def work_precision_rows(plan: ChartPlan, results: Mapping[Key, Measured]) -> dict[str, list[Row]]:
    """Rows by table.

    "work_precision": of every method at every setting; "work_precision_floors": floors of every scene and its panels.
    """
    rows: list[Row] = []
    floors: list[Row] = []
    for kind, scene in scenes(plan):
        measured = {key[2:]: result for key, result in results.items() if key[:2] == (kind, scene.model)}
        by_panels: dict[str, Reference] = {}
        for pairs in references(kind, scene.model, plan):
            panels = find_method(pairs[0][0]).size(scene)
            by_panels[panels] = reference = Reference(_motions(measured, pairs))
            floors.append(_floor(kind, scene, panels, pairs, reference, plan))
        for (name, value), result in measured.items():
            method = find_method(name)
            panels = method.size(scene)
            labels: Row = {
                "scene": kind,
                "model": scene.model,
                "panels": panels,
                "duration_s": scene.duration,
                "method": name,
                "setting": method.setting,
                "value": value,
            }
            rows.append(labels | _figures(kind, result, by_panels[panels], plan))
    return {"work_precision": rows, "work_precision_floors": floors}


def _motions(measured: Mapping[tuple[str, float], Measured], pairs: Pairs) -> tuple[Motion, ...]:
    motions = []
    for name, values in pairs:
        for value in values:
            result = measured[name, value]
            if result.motion is None:
                raise ValueError(f"a reference run failed: {name} at {value:g}: {result.failure}")
            motions.append(result.motion)
    return tuple(motions)


def _errors(kind: str, motion: Motion, reference: Reference, plan: ChartPlan) -> Row:
    right, counts = reference.motions[0], reference.impacts
    errors: Row = dict.fromkeys(_ERRORS, math.nan)
    if kind == DEPLOYMENT:
        errors["angle_error_rad"] = measures.angle_error(motion, right, plan.before_latch)
        errors["latch_error_s"] = measures.latch_error(motion, right)
        return errors
    start, force = measures.impact_errors(motion, right, measures.compared_impacts(counts))
    predicted = measures.predicted_impacts(motion, right, counts)
    return errors | {"impact_start_error_s": start, "impact_force_error": force, "impacts_predicted": predicted}


def _figures(kind: str, result: Measured, reference: Reference, plan: ChartPlan) -> Row:
    """Costs and errors of a run; nan if it did not reach its end."""
    row: Row = {"failure": result.failure, "repeats": len(result.walls)}
    motion = result.motion
    if motion is None:
        return row | dict.fromkeys(("wall_s", "wall_min_s", "wall_max_s", *_COUNTS, *_ERRORS), math.nan)
    row |= {"wall_s": result.wall, "wall_min_s": min(result.walls), "wall_max_s": max(result.walls)}
    row |= {name: getattr(motion, name) for name in _COUNTS}
    return row | _errors(kind, motion, reference, plan)


_COUNTS = ("steps", "evaluations", "factorizations", "energy_residual", "constraint_drift")
_ERRORS = ("angle_error_rad", "latch_error_s", "impact_start_error_s", "impact_force_error", "impacts_predicted")


def _floor(kind: str, scene: Scene, panels: str, pairs: Pairs, reference: Reference, plan: ChartPlan) -> Row:
    """The greatest errors that other reference runs have against the first one."""
    others = [_errors(kind, motion, reference, plan) for motion in reference.motions[1:]]
    worst: Row = {name: max(float(errors[name]) for errors in others) for name in _ERRORS[:-1]}
    return {
        "scene": kind,
        "model": scene.model,
        "panels": panels,
        "references": "; ".join(f"{name} {', '.join(f'{value:g}' for value in values)}" for name, values in pairs),
        **worst,
        "impacts_in_horizon": sum(reference.impacts) if kind == IMPACTS else math.nan,
        "impacts_compared": sum(measures.compared_impacts(reference.impacts)) if kind == IMPACTS else math.nan,
        "horizon_s": reference.horizon if kind == IMPACTS else math.nan,
    }
