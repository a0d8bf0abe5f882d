"""Ensembles: beyond the horizon of prediction, a method is right if the statistics of its runs are.

The runs of an ensemble differ by tens of nanometres in the place of the root hinge; they part after some impacts.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from solar_env.mechanics.running.errors import SimulationError
from solar_env.pictures.style import FAINT, METHOD_LOOKS, STYLE, Look, look_of
from solar_env.studies.common.bootstrap import mean_band
from solar_env.studies.common.drawing import make_figure, save, use_decades
from solar_env.studies.common.measures import impacts_of
from solar_env.studies.common.motion import Motion, Scene, perturbed
from solar_env.studies.common.plans import Plan
from solar_env.studies.common.tables import Row, Table
from solar_env.studies.precision.methods import find_method
from solar_env.support.campaigns import ONE, Workers, each_done


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
    """Run every ensemble; "ensembles" gets a row for every joint of every run that reached its end.

    Runs are announced before they start where they follow each other; only then do wall times mean something.
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


LABELS = {
    "peak_force_N": "peak force",
    "median_force_N": "impacts' median force",
    "high_force_N": "impacts' 95 % force",
    "impulse_Ns": "impulse",
    "impacts": "number of impacts",
    "sliding_work_J": "sliding work",
    "wear_depth_m": "wear depth",
    "energy_lost": "energy dissipated",
}

_WIDE = 2.5  # a method that is so far off is shown on a logarithmic axis, lest it hide the others' differences


def draw_ensembles(rows: Table, folder: Path) -> list[Path]:
    """Draw means over the reference's against wall time: a column for each joint of each model; returns the file."""
    columns = [(model, joint) for model in rows.values("model") for joint in rows.where(model=model).values("joint")]
    looks = {str(name): look_of(str(name), METHOD_LOOKS) for name in rows.values("method")}
    figure, axes = make_figure(len(LABELS), len(columns), (2.6, 1.35), len(looks))
    with mpl.rc_context(STYLE):
        for (model, joint), panels in zip(columns, axes.T, strict=True):
            own = rows.where(model=model, joint=joint)
            for axis, (statistic, label) in zip(panels, LABELS.items(), strict=True):
                _draw_panel(axis, own, statistic, looks)
                axis.set_ylabel(label)
            panels[0].set_title(f"{model}, joint {joint}\n{len(own.where(**_first(own)).rows)} runs of the reference")
            panels[-1].set_xlabel("wall time of a run [s]")
    path = folder / "ensembles.png"
    note = (
        "mean over the mean of the reference (the first method's finest setting), 95 % bootstrap bands; grey: its band"
    )
    save(figure, path, looks, _title(rows), note)
    return [path]


def _first(rows: Table) -> dict[str, Any]:
    """The reference: the first method and setting of a table."""
    return {"method": rows.rows[0]["method"], "value": rows.rows[0]["value"]}


def _title(rows: Table) -> str:
    """The methods whose mean peak force is that of the reference within sampling bands, at every joint."""
    within: dict[str, bool] = {}
    for model, joint in dict.fromkeys((row["model"], row["joint"]) for row in rows.rows):
        own = rows.where(model=model, joint=joint)
        _, low, high = mean_band(own.where(**_first(own)).column("peak_force_N"))
        for method in map(str, own.values("method")):
            settings = [own.where(method=method, value=value) for value in own.where(method=method).values("value")]
            bands = [mean_band(of.column("peak_force_N")) for of in settings]
            meets = all(bottom <= high and top >= low for _, bottom, top in bands)
            within[method] = within.get(method, True) and meets
    return "Right in peak force, at every setting measured: " + "; ".join(
        name for name, meets in within.items() if meets
    )


def _draw_panel(axis: Axes, rows: Table, statistic: str, looks: dict[str, Look]) -> None:
    mean, low, high = mean_band(rows.where(**_first(rows)).column(statistic))
    axis.set_xscale("log")
    if np.isfinite(mean) and mean != 0.0:
        axis.axhspan(low / mean, high / mean, color=FAINT, alpha=0.5, linewidth=0.0, zorder=0)
        for method, value in dict.fromkeys((row["method"], row["value"]) for row in rows.rows):
            own = rows.where(method=method, value=value)
            middle, bottom, top = (x / mean for x in mean_band(own.column(statistic)))
            if np.isfinite(middle):
                wall = float(np.median(own.column("wall_s")))
                reach = [[middle - bottom], [top - middle]]
                axis.errorbar([wall], [middle], yerr=reach, markersize=3.5, linewidth=0.8, **looks[str(method)])
        use_decades(axis, "x")
        if axis.get_ylim()[1] > _WIDE:
            axis.set_yscale("log")
        else:
            axis.ticklabel_format(axis="y", useOffset=False)
