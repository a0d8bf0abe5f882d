"""Work against precision: every method at every setting, its errors against a reference, and what it cost.

The reference of a scene is the finest run of the first of two methods; the greatest deviation of the other reference
runs from it is the floor below which an error says nothing. With clearance the floor of whole deployments is what chaos
leaves: for the ensembles see `ensembles`.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

from solar_env.array import has_flexible_panels
from solar_env.studies.common import measures
from solar_env.studies.common.motion import Motion, Scene
from solar_env.studies.common.plans import Plan
from solar_env.studies.common.tables import Row
from solar_env.studies.common.timing import Measured, time_interleaved
from solar_env.studies.precision.methods import (
    DEPLOYMENT_REFERENCES,
    IMPACT_REFERENCES,
    METHODS,
    SHORT_REFERENCES,
    Method,
    Pairs,
    find_method,
)

DEPLOYMENT, IMPACTS = "deployment", "impacts"
Key = tuple[str, float]  # method and setting


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


def scenes(plan: Plan) -> Iterator[tuple[str, Scene]]:
    """Kind and scene of everything that is measured."""
    for model in plan.models:
        yield DEPLOYMENT, plan.deployment(model)
        if model.endswith("clearance"):
            yield IMPACTS, plan.initial_phase(model)


def runs(kind: str, scene: Scene, plan: Plan) -> dict[Key, Method]:
    """Method by name and setting of what is measured of a scene, the reference runs included."""
    chosen: dict[Key, Method] = {}
    for method in METHODS:
        settings = (method.deployments if kind == DEPLOYMENT else method.impacts).get(scene.model, ())[: plan.settings]
        if kind == DEPLOYMENT and plan.dear:
            settings += method.dear.get(scene.model, ())
        if method.available:
            chosen.update({(method.name, value): method for value in settings})
    for name, values in references(kind, scene, plan):
        chosen.update({(name, value): find_method(name) for value in values})
    return chosen


def references(kind: str, scene: Scene, plan: Plan) -> Pairs:
    """Names and settings of the two reference methods of a scene; fewer in a short plan."""
    if kind == DEPLOYMENT:
        return (DEPLOYMENT_REFERENCES if plan.dear else SHORT_REFERENCES)[scene.model]
    pairs = IMPACT_REFERENCES[scene.model]
    return pairs if plan.dear else tuple((name, values[:1]) for name, values in pairs)


def count_work_precision(plan: Plan) -> int:
    """How many different runs `run_work_precision` announces."""
    return sum(len(runs(kind, scene, plan)) for kind, scene in scenes(plan))


def run_work_precision(plan: Plan, announce: Callable[[str], None]) -> dict[str, list[Row]]:
    """Measure every scene.

    "work_precision" gets rows of every method at every setting, "work_precision_floors" rows of every scene's floors.
    """
    rows: list[Row] = []
    floors: list[Row] = []
    for kind, scene in scenes(plan):
        methods = runs(kind, scene, plan)
        jobs = {key: partial(method.solve, scene, key[1]) for key, method in methods.items()}

        def say(key: Key, kind: str = kind, model: str = scene.model) -> None:
            announce(f"{kind}, {model}: {key[0]}, {key[1]:g}")

        measured = time_interleaved(jobs, plan.repeats, plan.long_run, say)
        pairs = references(kind, scene, plan)
        reference = Reference(_motions(measured, pairs))
        rows += [_row(kind, scene, methods[key], key, result, reference, plan) for key, result in measured.items()]
        floors.append(_floor(kind, scene, pairs, reference, plan))
    return {"work_precision": rows, "work_precision_floors": floors}


def _motions(measured: dict[Key, Measured[Key]], pairs: Pairs) -> tuple[Motion, ...]:
    motions = []
    for name, values in pairs:
        for value in values:
            result = measured[name, value]
            if result.motion is None:
                raise ValueError(f"a reference run failed: {name} at {value:g}: {result.failure}")
            motions.append(result.motion)
    return tuple(motions)


def _errors(kind: str, motion: Motion, reference: Reference, plan: Plan) -> Row:
    right, counts = reference.motions[0], reference.impacts
    errors: Row = dict.fromkeys(_ERRORS, math.nan)
    if kind == DEPLOYMENT:
        errors["angle_error_rad"] = measures.angle_error(motion, right, plan.before_latch)
        errors["latch_error_s"] = measures.latch_error(motion, right)
        return errors
    start, force = measures.impact_errors(motion, right, measures.compared_impacts(counts))
    predicted = measures.predicted_impacts(motion, right, counts)
    return errors | {"impact_start_error_s": start, "impact_force_error": force, "impacts_predicted": predicted}


def _row(
    kind: str, scene: Scene, method: Method, key: Key, result: Measured[Key], reference: Reference, plan: Plan
) -> Row:
    row: Row = {
        "scene": kind,
        "model": scene.model,
        "elements": scene.elements if has_flexible_panels(scene.model) else 0,
        "duration_s": scene.duration,
        "method": method.name,
        "setting": method.setting,
        "value": key[1],
        "failure": result.failure,
        "repeats": len(result.walls),
    }
    motion = result.motion
    if motion is None:
        unknown = ("wall_s", "wall_min_s", "wall_max_s", *_COUNTS, *_ERRORS)
        return row | dict.fromkeys(unknown, math.nan)
    row |= {"wall_s": result.wall, "wall_min_s": min(result.walls), "wall_max_s": max(result.walls)}
    row |= {name: getattr(motion, name) for name in _COUNTS}
    return row | _errors(kind, motion, reference, plan)


_COUNTS = ("steps", "evaluations", "factorizations", "energy_residual", "constraint_drift")
_ERRORS = ("angle_error_rad", "latch_error_s", "impact_start_error_s", "impact_force_error", "impacts_predicted")


def _floor(kind: str, scene: Scene, pairs: Pairs, reference: Reference, plan: Plan) -> Row:
    """The greatest errors that other reference runs have against the first one."""
    others = [_errors(kind, motion, reference, plan) for motion in reference.motions[1:]]
    worst: Row = {name: max(float(errors[name]) for errors in others) for name in _ERRORS[:-1]}
    return {
        "scene": kind,
        "model": scene.model,
        "references": "; ".join(f"{name} {', '.join(f'{value:g}' for value in values)}" for name, values in pairs),
        **worst,
        "impacts_in_horizon": sum(reference.impacts) if kind == IMPACTS else math.nan,
        "impacts_compared": sum(measures.compared_impacts(reference.impacts)) if kind == IMPACTS else math.nan,
        "horizon_s": reference.horizon if kind == IMPACTS else math.nan,
    }
