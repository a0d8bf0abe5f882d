"""Convergence of the panel models: errors and costs of rigid panels, beams of 1 to 48 elements, and 4 to 48 modes.

With ideal joints a model level is compared with the finest modal panels. With clearance the motion is chaotic, and only
ensemble means can be compared. An ensemble's runs start at slightly different release rates, see `perturbed`.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np

from solar_env.array.level import ELEMENTS, MODES
from solar_env.pictures.style import LEVEL_LOOKS, STYLE, look_of
from solar_env.studies.common.drawing import make_figure, save, use_decades
from solar_env.studies.common.motion import Level, Motion, Scene, force_error, perturbed, run_ours
from solar_env.studies.common.plans import ChartPlan, Ensemble
from solar_env.studies.common.tables import Cell, Row, Table, number
from solar_env.studies.common.timing import Job, Measured
from solar_env.studies.precision import work_precision
from solar_env.studies.precision.work_precision import draw_curves, errors_of
from solar_env.support.files import write_text
from solar_env.support.markdown import markdown_table

ERRORS = {**work_precision.ERRORS, "reaction_error": "error of peak reactions"}
# Totals of a `Motion` whose ensemble means are compared -> label, and factor from SI units to the label's units.
MEANS = {
    "peak_force_N": ("peak force [N]", 1.0),
    "sliding_work_J": ("sliding work [mJ]", 1e3),
    "impacts": ("number of impacts", 1.0),
    "wear_depth_m": ("deepest wear [fm]", 1e15),
}
JOINTS = (1, 2)
# Levels that the page shows if it has no room for all.
_ON_PAGE = (
    "rigid", "1 element", "6 elements", "12 elements", "48 elements", "4 modes", "16 modes", "32 modes",
    "32 modes, rtol / 2", "48 modes, rtol / 10",
)  # fmt: skip
_BEYOND = 3.0  # number of standard errors that ten differences of equal means hardly ever exceed
_BAND = 1.96  # number of standard errors on either side of a mean in a 95 % band

# Level, and the member of its ensemble with clearance; None for the run with ideal joints.
Key = tuple[Ensemble, int | None]


def family(level: Ensemble) -> str:
    """Return the panel model of an `Ensemble` (panels, tolerance, number of runs): "rigid", "elements" or "modes"."""
    return _level(level, "ideal").panels.unit or "rigid"


def _level(level: Ensemble, joint: str) -> Level:
    model = f"flexible-{joint}:{level.panels}" if level.panels else f"rigid-{joint}"
    return Level(model, level.tighter)


def runs(plan: ChartPlan) -> dict[Key, Job]:
    """Return timed simulations (jobs) of every panel model: a run with ideal joints, and an ensemble with clearance.

    Keys are (record of the panel model and tolerance, index of the ensemble member or None for ideal joints). Jobs are
    ordered by ensemble member, so that disturbances of the computer affect all panel models alike.
    """
    jobs: dict[Key, Job] = {}
    for member in (None, *range(max(level.members for level in plan.levels))):
        for ensemble in plan.levels:
            if member is not None and member >= ensemble.members:
                continue
            level = _level(ensemble, "ideal" if member is None else "clearance")
            scene = replace(plan.deployment(level.model), duration=plan.ensemble_duration)
            name = f"convergence, {level.name}" + ("" if member is None else f", run {member + 1}")
            solve = partial(run_level, level, scene, member or 0)
            jobs[ensemble, member] = Job(name, solve, plan.repeats if member is None else 1)
    return jobs


def run_level(level: Level, scene: Scene, member: int = 0) -> Motion:
    """Return the deployment's `Motion` with the panels and tolerance of `level`, perturbed as ensemble run `member`."""
    parameters = perturbed(scene.parameters, member)
    return run_ours(replace(scene, parameters=parameters, model=level.model), level.integrator(member))


def tabulate(plan: ChartPlan, results: dict[Key, Measured]) -> list[Row]:
    """Return a table row for each model level (panels and tolerance).

    Wall time and errors are with ideal joints. Ensemble means of forces, work, impacts and wear are with clearance.
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
            **errors_of(ideal.motion, reference, plan),
            "reaction_error": force_error(ideal.motion, reference),
        }
        rows.append(labels | _means([results[level, member] for member in range(level.members)]))
    return rows


def _means(ensemble: list[Measured]) -> Row:
    """Return an ensemble's table cells: number of completed runs, their median wall time [s], and ensemble means.

    Each quantity in MEANS, such as the peak force, has a mean and a standard error for each joint.
    """
    ended = [(result.wall, result.motion.totals) for result in ensemble if result.motion is not None]
    count = len(ended)
    row: Row = {"runs": count, "wall_s": float(np.median([wall for wall, _ in ended])) if ended else math.nan}
    for statistic in MEANS:
        values = np.array([totals[statistic] for _, totals in ended]).reshape(count, -1)
        for joint, column in enumerate(values.T, start=1):
            row[f"{statistic}_{joint}"] = float(column.mean())
            row[f"{statistic}_{joint}_error"] = float(column.std(ddof=1)) / math.sqrt(count) if count > 1 else math.nan
    return row


def draw(rows: Table, folder: Path) -> list[Path]:
    """Plot wall time against errors and ensemble means, and tabulate them on a Markdown page; return both paths."""
    looks = {str(name): look_of(str(name), LEVEL_LOOKS) for name in rows.values("level")}
    figure, axes = make_figure(1 + len(JOINTS), len(MEANS), (2.6, 2.1), len(looks))
    with mpl.rc_context(STYLE):
        for axis, (error, label) in zip(axes[0], ERRORS.items(), strict=False):
            draw_curves(axis, rows, error, "wall_ideal_s", looks, by="level")
            axis.set_title(f"ideal joints, against {rows.rows[0]['reference']}")
            axis.set_xlabel(label)
        for axis in axes[0, len(ERRORS) :]:
            axis.set_axis_off()
        for joint, line in zip(JOINTS, axes[1:], strict=True):
            for axis, (statistic, (label, _)) in zip(line, MEANS.items(), strict=True):
                for row in rows.rows:
                    (mean, spread), look = _mean(row, statistic, joint), looks[str(row["level"])]
                    axis.errorbar([mean], [row["wall_s"]], xerr=_BAND * spread, markersize=4.5, linewidth=0.8, **look)
                axis.set_yscale("log")
                use_decades(axis, "y")
                axis.set_title(f"clearance, joint {joint}")
                axis.set_xlabel(label)
        for axis in axes[:, 0]:
            axis.set_ylabel("wall time [s]")
    picture, page = folder / "convergence.png", folder / "convergence.md"
    note = "with clearance: after the first latching (wear: of the whole run), means and their 95 % bands"
    save(figure, picture, looks, conclusion(rows), note)
    write_text(page, _page(rows))
    return [picture, page]


def difference(first: Mapping[str, Cell], second: Mapping[str, Cell], name: str) -> tuple[float, float]:
    """Return first mean / second mean - 1 in column `name` of two rows, and standard error; nan if the second is 0."""
    (mean, error), (right, right_error) = (
        [number(row, name + end) for end in ("", "_error")] for row in (first, second)
    )
    if right == 0.0:
        return math.nan, math.nan
    return mean / right - 1.0, math.hypot(error, right_error * mean / right) / abs(right)


def conclusion(rows: Table) -> str:
    """Return a title: whether, and by how much at most, ensemble means of the finest beam and modal models differ."""
    beams, modes = (rows.where(family=kind).rows[-1] for kind in (ELEMENTS, MODES))
    found = [
        (*difference(beams, modes, f"{statistic}_{joint}"), f"{label.partition(' [')[0]} of joint {joint}")
        for joint in JOINTS
        for statistic, (label, _) in MEANS.items()
    ]
    found = [entry for entry in found if math.isfinite(entry[0] + entry[1])]
    if not found:
        return "Nothing to compare: no joint has latched, or ensembles have one run"
    beyond = [entry for entry in found if abs(entry[0]) > _BEYOND * entry[1]]
    change, error, what = max(beyond or found, key=lambda entry: abs(entry[0]))
    words = "have not met" if beyond else "go to one limit within sampling"
    names = f"{beams['level']} and {modes['level']}"
    return f"Beams and modes {words}: {names} differ by {change:+.1%} ± {error:.1%} at most, in the {what}"


def _page(rows: Table) -> str:
    """Return Markdown tables of the main model levels: errors with ideal joints, and ensemble means with clearance."""
    shown = [row for row in rows.rows if len(rows.rows) <= len(_ON_PAGE) or row["level"] in _ON_PAGE]
    errors = [
        [str(row["level"]), f"{number(row, 'wall_ideal_s'):.3g}", *(f"{number(row, error):.1e}" for error in ERRORS)]
        for row in shown
    ]
    means = [
        [
            *(str(row["level"]), str(row["runs"]), f"{number(row, 'wall_s'):.3g}"),
            *(" / ".join(_in_words(*_mean(row, statistic, joint)) for joint in JOINTS) for statistic in MEANS),
        ]
        for row in shown
    ]
    columns = ("level", "runs", "wall time [s]", *(label for label, _ in MEANS.values()))
    return (
        f"Ideal joints: errors relative to the level {rows.rows[0]['reference']}:\n\n"
        f"{markdown_table(('level', 'wall time [s]', *ERRORS.values()), errors)}\n\n"
        f"Joints with clearance: ensemble means, for joint 1 / joint 2:\n\n{markdown_table(columns, means)}\n"
    )


def _mean(row: Mapping[str, Cell], statistic: str, joint: int) -> tuple[float, float]:
    """Return a row's mean and standard error of `statistic` at `joint`, in the unit that its label in MEANS names."""
    mean, error = (number(row, f"{statistic}_{joint}{suffix}") for suffix in ("", "_error"))
    return MEANS[statistic][1] * mean, MEANS[statistic][1] * error


def _in_words(mean: float, error: float) -> str:
    """Format a mean with as many digits as its standard error, if known, allows."""
    return f"{mean:.{max(0, 1 - math.floor(math.log10(2.0 * error)))}f}" if error > 0.0 else f"{mean:.3g}"
