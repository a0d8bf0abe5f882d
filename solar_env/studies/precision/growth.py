"""How the cost grows with the size of the model: wall time of a step against elements and against panels."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

from solar_env.array import ArrayParameters
from solar_env.array.methods import default_integrator
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator
from solar_env.studies.common.motion import Scene, run_own
from solar_env.studies.common.plans import Plan
from solar_env.studies.common.tables import Row
from solar_env.studies.common.timing import time_interleaved

ELEMENTS, PANELS = "elements", "panels"
_REPEATS = 5  # of runs that are short in every plan


@dataclass(frozen=True)
class Case:
    """One model, method and size that is timed.

    Attributes:
        varied: ELEMENTS or PANELS.
        model: one of `array.MODELS`.
        method: name of the integrator.
        count: of elements of each panel, or of panels.
    """

    varied: str
    model: str
    method: str
    count: int


def _integrator(case: Case) -> Integrator:
    return default_integrator(case.model) if case.method == "default" else GeneralizedAlpha(step=1e-4)


def _cases(plan: Plan) -> Iterator[Case]:
    for method in ("default", "generalized-alpha"):
        for count in plan.growth_elements:
            yield Case(ELEMENTS, "flexible-ideal", method, count)
        for model in ("rigid-ideal", "flexible-ideal"):
            for count in plan.growth_panels:
                yield Case(PANELS, model, method, count)


def _scene(plan: Plan, case: Case) -> Scene:
    duration = plan.growth_duration
    scene = Scene(case.model, plan.parameters, duration, duration, plan.elements)
    if case.varied == ELEMENTS:
        return replace(scene, elements=case.count)
    return replace(scene, parameters=with_panels(plan.parameters, case.count))


def with_panels(parameters: ArrayParameters, count: int) -> ArrayParameters:
    """Parameters of an array of another number of panels: further joints are like the last, fewer drop the last."""
    by_joint = {
        name: tuple(parameters.by_joint(name, joint) for joint in range(count)) for name in ArrayParameters.BY_JOINT
    }
    return replace(parameters, panel_count=count, **by_joint)  # type: ignore[arg-type]


def count_growth(plan: Plan) -> int:
    """How many runs `run_growth` announces."""
    return sum(1 for _ in _cases(plan))


def run_growth(plan: Plan, announce: Callable[[str], None]) -> dict[str, list[Row]]:
    """Time the start of deployments of growing size.

    Args:
        plan: what and how often.
        announce: called with a description before each run.

    Returns:
        "growth": a row for each size.
    """
    cases = list(_cases(plan))
    jobs = {case: partial(run_own, _scene(plan, case), _integrator(case)) for case in cases}
    measured = time_interleaved(
        jobs, _REPEATS, plan.long_run, lambda case: announce(f"growth, {case.model}: {case.count} {case.varied}")
    )
    rows: list[Row] = []
    for case, result in measured.items():
        motion = result.motion
        if motion is None:
            continue
        rows.append(
            {
                "varied": case.varied,
                "model": case.model,
                "method": case.method,
                "count": case.count,
                "steps": motion.steps,
                "wall_s": result.wall,
                "wall_per_step_s": result.wall / motion.steps,
                "wall_per_simulated_second": result.wall / plan.growth_duration,
            }
        )
    return {"growth": rows}
