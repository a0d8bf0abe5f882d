"""Ensembles: beyond the horizon of prediction, a method is right if the statistics of its runs are.

The runs of an ensemble are released at slightly different rates and take slightly different steps, see `perturbed`.
Every method is compared with the reference on the same panels: what the panels themselves make of a deployment is the
subject of `levels`.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from solar_env.pictures.style import FAINT, METHOD_LOOKS, STYLE, Look, look_of
from solar_env.studies.common.bootstrap import mean_band
from solar_env.studies.common.drawing import make_figure, save, use_decades
from solar_env.studies.common.measures import impacts_of
from solar_env.studies.common.motion import Motion, Scene, perturbed, perturbed_setting
from solar_env.studies.common.plans import ChartPlan
from solar_env.studies.common.tables import Row, Table
from solar_env.studies.common.timing import Job, Measured
from solar_env.studies.precision.methods import find_method


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
# The first with the same panels is the reference.
CONTESTANTS: dict[str, tuple[Contestant, ...]] = {
    "rigid-clearance": (
        Contestant("runge-kutta", 1e-10),
        Contestant("runge-kutta", 2e-6),
        Contestant("runge-kutta", 1e-4),
        Contestant("modal-radau", 1e-3),
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
        Contestant("modal-radau", 1e-5),
        Contestant("modal-radau", 1e-3),
        Contestant("modal-radau", 1e-2),
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


def member_job(name: str, scene: Scene, solve: Callable[[Scene, float], Motion], setting: float, member: int) -> Job:
    """The run of a member of an ensemble, of a name in words, by a solver at a setting."""
    own = replace(scene, parameters=perturbed(scene.parameters, member))
    return Job(f"{name}, run {member + 1}", partial(solve, own, perturbed_setting(setting, member)))


def member_rows(labels: Row, member: int, result: Measured) -> list[Row]:
    """A row for each joint of one run of an ensemble: labels, then the statistics; none if the run could not go on."""
    if result.motion is None:
        return []
    return [
        {**labels, "member": member, "joint": joint + 1, "wall_s": result.wall, **values}
        for joint, values in enumerate(statistics_of(result.motion))
    ]


# Model, contestant and number of the member.
Key = tuple[str, Contestant, int]


def _scene(plan: ChartPlan, model: str) -> Scene:
    duration = plan.ensemble_duration.of(model)
    return replace(plan.deployment(model), duration=duration, every_contact=True)


def _keys(plan: ChartPlan) -> Iterator[Key]:
    """Member by member, so that what disturbs the machine meets all methods alike."""
    for model in plan.models:
        for member in range(plan.ensemble_size):
            for contestant in CONTESTANTS.get(model, ()):
                left_out = contestant.dear and (not plan.dear or member >= FEW)
                if find_method(contestant.method).available and not left_out:
                    yield model, contestant, member


def ensemble_jobs(plan: ChartPlan) -> dict[Key, Job]:
    """The runs of every ensemble."""
    return {
        (model, chosen, member): member_job(
            f"ensembles, {model}: {chosen.method}, {chosen.value:g}",
            _scene(plan, model), find_method(chosen.method).solve, chosen.value, member,
        )
        for model, chosen, member in _keys(plan)
    }  # fmt: skip


def ensemble_rows(plan: ChartPlan, results: dict[Key, Measured]) -> dict[str, list[Row]]:
    """Rows by table: "ensembles" gets one for every joint of every run that reached its end."""
    rows: list[Row] = []
    for (model, chosen, member), result in results.items():
        method = find_method(chosen.method)
        labels: Row = {
            "model": model,
            "panels": method.size(_scene(plan, model)),
            "method": method.name,
            "setting": method.setting,
            "value": chosen.value,
        }
        rows += member_rows(labels, member, result)
    return {"ensembles": rows}


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
            members = len(_settings(own)[0].rows)
            panels[0].set_title(f"{model}, joint {joint}\n{members} runs of the reference")
            panels[-1].set_xlabel("wall time of a run [s]")
    path = folder / "ensembles.png"
    note = "mean over the mean of the reference (the finest setting with the same panels), 95 % bootstrap bands; grey: "
    save(figure, path, looks, _title(rows), note + "its band")
    return [path]


def _settings(rows: Table) -> list[Table]:
    """The rows of every method and setting; the first is the reference."""
    return [
        rows.where(method=method, value=value)
        for method, value in dict.fromkeys((row["method"], row["value"]) for row in rows.rows)
    ]


def _title(rows: Table) -> str:
    """The methods whose mean peak force is that of the reference within sampling bands, at every joint."""
    within: dict[str, bool] = {}
    for model, panels, joint in dict.fromkeys((row["model"], row["panels"], row["joint"]) for row in rows.rows):
        settings = _settings(rows.where(model=model, panels=panels, joint=joint))
        bands = [mean_band(of.column("peak_force_N")) for of in settings]
        for of, (_, bottom, top) in zip(settings, bands, strict=True):
            meets = bottom <= bands[0][2] and top >= bands[0][1]
            method = str(of.rows[0]["method"])
            within[method] = within.get(method, True) and meets
    return "Right in peak force, at every setting measured: " + "; ".join(
        name for name, meets in within.items() if meets
    )


def _draw_panel(axis: Axes, rows: Table, statistic: str, looks: dict[str, Look]) -> None:
    axis.set_xscale("log")
    for panels in rows.values("panels"):
        settings = _settings(rows.where(panels=panels))
        mean, low, high = mean_band(settings[0].column(statistic))
        if not np.isfinite(mean) or mean == 0.0:
            continue
        axis.axhspan(low / mean, high / mean, color=FAINT, alpha=0.5, linewidth=0.0, zorder=0)
        for own in settings:
            middle, bottom, top = (x / mean for x in mean_band(own.column(statistic)))
            if np.isfinite(middle):
                wall = float(np.median(own.column("wall_s")))
                reach = [[middle - bottom], [top - middle]]
                style = looks[str(own.rows[0]["method"])]
                axis.errorbar([wall], [middle], yerr=reach, markersize=3.5, linewidth=0.8, **style)
        use_decades(axis, "x")
        if axis.get_ylim()[1] > _WIDE:
            axis.set_yscale("log")
        else:
            axis.ticklabel_format(axis="y", useOffset=False)
