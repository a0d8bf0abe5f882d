"""Ensembles: beyond the horizon of prediction, a method is right if the statistics of its runs are.

The runs of an ensemble differ by tens of nanometres in the place of the root hinge; they part after some impacts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.measures import impacts_of
from solar_env.studies.common.motion import Motion, Scene
from solar_env.studies.common.plans import Plan
from solar_env.studies.common.tables import Row
from solar_env.studies.precision.methods import find_method
from solar_env.support.campaigns import ONE, Workers, each_done

PERTURBATION = 1e-8  # m, between the hinges of two runs
STATISTICS = (
    "peak_force_N",
    "median_force_N",
    "high_force_N",
    "impulse_Ns",
    "impacts",
    "sliding_work_J",
    "wear_depth_m",
    "energy_lost",
)


@dataclass(frozen=True)
class Contestant:
    """A method at one setting.

    Attributes:
        method: its name.
        value: of its setting.
        dear: whether only the full chart makes its runs, and no more than FEW of them.
    """

    method: str
    value: float
    dear: bool = False


FEW = 6
# The first is the reference.
CONTESTANTS: dict[str, tuple[Contestant, ...]] = {
    "rigid-clearance": (
        Contestant("runge-kutta", 1e-10),
        Contestant("runge-kutta", 5e-7),
        Contestant("runge-kutta", 1e-4),
        Contestant("generalized-alpha", 1e-4),
        Contestant("generalized-alpha", 5e-5),
        Contestant("generalized-alpha, adaptive", 1e-5),
        Contestant("paper's scheme", 1e-4),
        Contestant("Exudyn generalized-alpha", 1e-4),
        Contestant("Exudyn explicit", 2e-5, dear=True),
    ),
    "flexible-clearance": (
        Contestant("runge-kutta", 1e-7),
        Contestant("runge-kutta", 1e-5),
        Contestant("rosenbrock", 1e-4),
        Contestant("rosenbrock", 1e-3),
        Contestant("generalized-alpha", 1e-4),
        Contestant("generalized-alpha", 5e-5, dear=True),
        Contestant("Exudyn generalized-alpha", 5e-4, dear=True),
    ),
}


def perturbed(parameters: ArrayParameters, member: int, distance: float = PERTURBATION) -> ArrayParameters:
    """The array with its root hinge moved by `member` times `distance` [m]."""
    return replace(parameters, hinge_y=parameters.hinge_y + member * distance)


def statistics_of(motion: Motion) -> list[dict[str, float]]:
    """By joint, what a run comes to after its first latching; nan where the program does not say.

    peak_force_N: greatest contact force; median_force_N, high_force_N: median and 95 % quantile of the impacts' peak
    forces; impulse_Ns; impacts: their number; sliding_work_J; wear_depth_m: greatest, of the whole run; energy_lost:
    dissipated over the whole run, relative to the energy put in.
    """
    latched = float(np.nanmin([*motion.latch_times, math.inf]))
    unknown = np.full(len(motion.latch_times), math.nan)

    def total(name: str, joint: int) -> float:
        return float(motion.totals.get(name, unknown)[joint])

    rows = []
    for joint in range(len(motion.latch_times)):
        own = impacts_of(motion, joint)
        forces = own["peak_force"][own["start_s"] > latched]
        rows.append(
            {
                "peak_force_N": total("peak_force", joint),
                "median_force_N": _quantile(forces, 0.5),
                "high_force_N": _quantile(forces, 0.95),
                "impulse_Ns": total("impulse", joint),
                "impacts": float(len(forces)),
                "sliding_work_J": total("sliding_work", joint),
                "wear_depth_m": total("wear_depth", joint),
                "energy_lost": total("energy_lost", joint),
            }
        )
    return rows


def _quantile(values: NDArray[np.float64], share: float) -> float:
    return float(np.quantile(values, share)) if len(values) else math.nan


def member_rows(scene: Scene, member: int, solve: Callable[[Scene], Motion], labels: Row) -> list[Row]:
    """A row for each joint of one run of an ensemble: labels, then the statistics; none if the run could not go on."""
    try:
        motion = solve(replace(scene, parameters=perturbed(scene.parameters, member)))
    except SimulationError:
        return []
    return [
        {**labels, "member": member, "joint": joint + 1, "wall_s": motion.wall_time, **values}
        for joint, values in enumerate(statistics_of(motion))
    ]


@dataclass(frozen=True)
class Member:
    """One run of an ensemble: of a scene, with a method at a setting, and the number of its perturbation."""

    scene: Scene
    contestant: Contestant
    member: int

    @property
    def name(self) -> str:
        """In words."""
        chosen = self.contestant
        return f"ensembles, {self.scene.model}: {chosen.method}, {chosen.value:g}, run {self.member + 1}"


def _chosen(plan: Plan) -> Iterator[Member]:
    """Member by member, so that what disturbs the machine meets all methods alike."""
    for model in plan.models:
        duration = plan.ensemble_duration[model.partition("-")[0]]
        scene = replace(plan.deployment(model), duration=duration, every_contact=True)
        for member in range(plan.ensemble_size):
            for contestant in CONTESTANTS.get(model, ()):
                left_out = contestant.dear and (not plan.dear or member >= FEW)
                if find_method(contestant.method).available and not left_out:
                    yield Member(scene, contestant, member)


def count_ensembles(plan: Plan) -> int:
    """How many runs `run_ensembles` announces."""
    return sum(1 for _ in _chosen(plan))


def run_ensembles(plan: Plan, announce: Callable[[str], None], workers: Workers = ONE) -> dict[str, list[Row]]:
    """Run every ensemble.

    Args:
        plan: what and how often.
        announce: called with a description of each run, before it where runs follow each other.
        workers: where. Wall times mean something only if the runs follow each other.

    Returns:
        "ensembles": a row for every joint of every run that reached its end.
    """
    rows: dict[Member, list[Row]] = {}
    chosen = list(_chosen(plan))
    if workers == ONE:
        for run in chosen:
            announce(run.name)
            rows[run] = run_rows(run)
    else:
        for run, found in each_done(run_rows, chosen, workers):
            announce(run.name)
            rows[run] = found
    return {"ensembles": [row for run in chosen for row in rows[run]]}


def run_rows(run: Member) -> list[Row]:
    """The rows of one run."""
    contestant, method = run.contestant, find_method(run.contestant.method)
    labels: Row = {
        "model": run.scene.model,
        "method": method.name,
        "setting": method.setting,
        "value": contestant.value,
    }
    return member_rows(run.scene, run.member, lambda scene: method.solve(scene, contestant.value), labels)
