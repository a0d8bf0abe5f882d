"""Wall times of whole deployments by this library, and by Exudyn at its cheapest settings, compared at equal error.

Errors include both the integrator's and the panel model's, because users get the sum. With flexible panels, angles and
latch times are compared with beams of 24 elements, four times as many as in Exudyn's runs. Peak forces are compared
with means of a converged ensemble: more modes or a tighter tolerance would not change them (study `convergence`).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray

from solar_env.array import ModelLevel
from solar_env.pictures.style import METHOD_LOOKS, STYLE, look_of
from solar_env.studies.common.drawing import make_figure, save
from solar_env.studies.common.motion import FINEST, Level, perturbed, perturbed_setting, with_panels
from solar_env.studies.common.plans import ChartPlan
from solar_env.studies.common.tables import Cell, Row, Table, number
from solar_env.studies.common.timing import Job, Measured
from solar_env.studies.precision.convergence import run_level
from solar_env.studies.precision.methods import METHODS
from solar_env.studies.precision.work_precision import ERRORS, draw_curves, errors_of
from solar_env.support.files import write_text
from solar_env.support.markdown import markdown_table

Array = NDArray[np.float64]

DEFAULT = "default settings"
_LONG_RUN = 60.0  # s; time beyond which a run is not repeated
Entry = tuple[str, float]

# Model -> methods and settings: ours at looser and tighter tolerances, the peer's at the cheapest settings.
OURS: dict[str, tuple[Entry, ...]] = {
    "rigid-ideal": (("runge-kutta", 1e-6), ("runge-kutta", 5e-10)),
    "rigid-clearance": (("runge-kutta", 1e-5), ("runge-kutta", 1e-7)),
    "flexible-ideal": (("modal-radau", 8e-3), ("modal-radau", 1e-3), ("rosenbrock", 1e-4)),
    "flexible-clearance": (("modal-radau", 8e-3), ("modal-radau", 1e-3), ("rosenbrock", 1e-4)),
}
PEER: dict[str, tuple[Entry, ...]] = {
    "rigid-ideal": (("Exudyn explicit", 1e-2), ("Exudyn generalized-alpha", 1e-3)),
    "rigid-clearance": (("Exudyn generalized-alpha", 1e-4), ("Exudyn explicit", 5e-5), ("Exudyn explicit", 2e-5)),
    "flexible-ideal": (("Exudyn generalized-alpha", 5e-3), ("Exudyn generalized-alpha", 1e-3)),
    "flexible-clearance": (("Exudyn generalized-alpha", 5e-4), ("Exudyn generalized-alpha", 1e-4)),
}
# Reference runs of angles and latch times (REFERENCES), and reference ensembles of peak forces (CONVERGED).
REFERENCES: dict[str, Entry] = {
    "rigid-ideal": ("runge-kutta", 1e-12),
    "rigid-clearance": ("runge-kutta", 1e-11),
    "flexible-ideal": ("rosenbrock", 1e-5),
    "flexible-clearance": ("rosenbrock", 1e-4),
}
CONVERGED: dict[str, Level] = {
    "rigid-clearance": Level("rigid-clearance", tighter=1e3),
    "flexible-clearance": FINEST,
}
_REFERENCE, _ENSEMBLE = "reference", "converged ensemble"
_COLUMNS = (
    "wall time [s]", "times real time", *ERRORS.values(),
    "peak forces divided by the converged ensemble's, joints 1 / 2",
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A run of the comparison with Exudyn, the peer: its model, method, setting, and number in an ensemble."""

    model: str  # one of `array.MODELS`
    method: str  # name of a method or DEFAULT; _REFERENCE or _ENSEMBLE for runs that others are compared with
    value: float = 0.0  # value of the method's setting (step or tolerance)
    member: int = 0  # member of the ensemble; only the nominal run, member 0, is timed
    watched: bool = False  # whether the peer records contact forces at every step, which costs time


def _job(plan: ChartPlan, case: Case) -> Job:
    scene = replace(plan.deployment(case.model), duration=plan.side_duration, forces_kept=case.watched)
    title = f"side by side, {case.model}: {case.method}, {case.value:g}, run {case.member + 1}"
    title += ", forces kept" * case.watched
    repeats = 1 if case.member or case.watched or case.method in (_REFERENCE, _ENSEMBLE) else plan.repeats
    if case.method in (DEFAULT, _ENSEMBLE):
        level = Level(case.model) if case.method == DEFAULT else CONVERGED[case.model]
        return Job(title, partial(run_level, level, scene, case.member), repeats)
    name, value = REFERENCES[case.model] if case.method == _REFERENCE else (case.method, case.value)
    if case.method == _REFERENCE:
        scene = replace(scene, model=with_panels(case.model, f"{4 * scene.level.count} elements"))
    scene = replace(scene, parameters=perturbed(scene.parameters, case.member))
    solve = partial(METHODS[name].solve, scene, perturbed_setting(value, case.member))
    return Job(title, solve, repeats, _LONG_RUN)


def runs(plan: ChartPlan) -> dict[Case, Job]:
    """Return a mapping from `Case` (model, method, setting, ensemble member) to `Job`, a run to be timed.

    Each model has a reference run, and runs with methods of this library and of Exudyn. A model with clearance also has
    ensembles of this library's runs, and runs of Exudyn that record contact forces, to compare peak forces.
    """
    cases: list[Case] = []
    for model in plan.models:
        ours = [Case(model, DEFAULT), *(Case(model, *entry) for entry in OURS[model])]
        peer = [Case(model, *entry) for entry in PEER[model] if METHODS[entry[0]].available]
        cases += [Case(model, _REFERENCE), *ours, *peer]
        if model in CONVERGED:
            members = range(plan.ensemble_size)
            cases += [Case(model, _ENSEMBLE, member=member) for member in members]
            cases += [replace(case, member=member) for case in ours for member in members[1:]]
            cases += [replace(case, watched=True) for case in peer]
    return {case: _job(plan, case) for case in cases}


def tabulate(plan: ChartPlan, results: Mapping[Case, Measured]) -> list[Row]:
    """Return a table row per model, method and setting, with wall times, errors, and ratios of peak forces.

    A ratio is a joint's mean peak force divided by its mean in an ensemble of more accurate runs.
    """
    rows: list[Row] = []
    for case, result in results.items():
        if case.member or case.watched or case.method in (_REFERENCE, _ENSEMBLE):
            continue
        reference = results[Case(case.model, _REFERENCE)].motion
        if reference is None:
            raise ValueError(f"the reference of {case.model} could not be simulated to its end")
        default, scene = ModelLevel.of(case.model), plan.deployment(case.model)
        labels: Row = {
            "model": case.model,
            "duration_s": plan.side_duration,
            "method": case.method,
            "panels": default.size if case.method == DEFAULT else METHODS[case.method].size(scene),
            "value": case.value,
            "peer": int(case.method != DEFAULT and METHODS[case.method].peer),
            "failure": result.failure,
        }
        rows.append(labels | result.times() | errors_of(result.motion, reference, plan) | _force_ratios(case, results))
    return rows


def _peak_forces(case: Case, results: Mapping[Case, Measured]) -> Array:
    """Return the (runs, joints) peak forces after latching [N] from a case's ensemble runs that recorded forces."""
    peaks = [
        result.motion.totals["peak_force_N"]
        for of, result in results.items()
        if replace(of, member=0, watched=False) == case and result.motion is not None
        and "peak_force_N" in result.motion.totals
    ]  # fmt: skip
    return np.array(peaks).reshape(-1, 2)


def _force_ratios(case: Case, results: Mapping[Case, Measured]) -> Row:
    """Return table cells: each joint's mean peak force divided by the converged ensemble's, and its standard error.

    The converged ensemble is the runs in `results` of the same model and the method _ENSEMBLE. All cells are nan if
    `case` has no forces, or if the ensemble has fewer than two runs or a joint without force.
    """
    means, errors = np.full(2, math.nan), np.full(2, math.nan)
    forces, right = (_peak_forces(of, results) for of in (case, Case(case.model, _ENSEMBLE)))
    if len(forces) and len(right) > 1 and right.mean(axis=0).min() > 0.0:
        # Assume that a single run of the peer scatters like the runs of the converged ensemble.
        shares = [
            (of.std(axis=0, ddof=1) if len(of) > 1 else right.std(axis=0, ddof=1)) / math.sqrt(len(of))
            for of in (forces, right)
        ] / right.mean(axis=0)
        means = forces.mean(axis=0) / right.mean(axis=0)
        errors = np.hypot(shares[0], shares[1] * means)
    names = [f"force_ratio_{joint}{suffix}" for suffix in ("", "_error") for joint in (1, 2)]
    return dict(zip(names, [*means.tolist(), *errors.tolist()], strict=True))


def draw(rows: Table, folder: Path) -> list[Path]:
    """Draw wall time against angle error in one plot per model, and write a Markdown table; return the files."""
    looks = {str(name): look_of(str(name), METHOD_LOOKS) for name in rows.values("method")}
    models = rows.values("model")
    figure, axes = make_figure(1, len(models), (2.15, 2.1), len(looks))
    with mpl.rc_context(STYLE):
        for axis, model in zip(axes[0], models, strict=True):
            draw_curves(axis, rows.where(model=model), "angle_error_rad", "wall_s", looks)
            axis.set_title(str(model))
        axes[0, 0].set_ylabel("wall time [s]")
    picture, page = folder / "side_by_side.png", folder / "side_by_side.md"
    save(figure, picture, looks, _conclusion(rows), f"{ERRORS['angle_error_rad']}, panels included")
    write_text(page, _page(rows))
    return [picture, page]


def ratio_at_equal_error(rows: Table, peer: Mapping[str, Cell]) -> float:
    """Return the wall time in row `peer` divided by our least wall time at no larger errors; nan without such a run."""
    walls = [
        number(row, "wall_s")
        for row in rows.where(model=peer["model"], peer=0).rows
        if all(number(row, name) <= number(peer, name) for name in ERRORS)
    ]
    return number(peer, "wall_s") / min(walls, default=math.nan)


def _conclusion(rows: Table) -> str:
    """Return a title with each model's least `ratio_at_equal_error` of Exudyn's wall time to this library's."""
    least: dict[str, float] = {}
    for row in rows.where(peer=1).rows:
        ratio = ratio_at_equal_error(rows, row)
        if math.isfinite(ratio):
            model = str(row["model"])
            least[model] = min(ratio, least.get(model, math.inf))
    clauses = [f"{ratio:.3g} times with {model}" for model, ratio in least.items()]
    return f"At no larger error a peer takes at least {', '.join(clauses)}" if clauses else "No peer was measured"


def _page(rows: Table) -> str:
    """Return two Markdown tables of wall time, errors and peak forces: runs at our default settings; Exudyn's runs."""
    ours = [[str(row["model"]), str(row["panels"]), *_cells(row)] for row in rows.where(method=DEFAULT).rows]
    peer = []
    for row in rows.where(peer=1).rows:
        ratio = ratio_at_equal_error(rows, row)
        words = "" if row["failure"] else "none of ours is as accurate" if math.isnan(ratio) else f"{ratio:.3g}"
        peer.append([str(row["model"]), f"{row['method']}, {row['value']:g}", *_cells(row), words])
    last = "its time divided by ours, at no larger error"
    return (
        f"This library with its default settings:\n\n{markdown_table(('model', 'panels', *_COLUMNS), ours)}\n\n"
        f"Exudyn, a peer:\n\n{markdown_table(('model', 'method, step [s]', *_COLUMNS, last), peer)}\n"
    )


def _cells(row: Mapping[str, Cell]) -> list[str]:
    if row["failure"]:
        return ["failed", *[""] * (len(_COLUMNS) - 1)]
    wall, duration = number(row, "wall_s"), number(row, "duration_s")
    return [f"{wall:.3g}", f"{duration / wall:.3g}", *(f"{number(row, name):.1e}" for name in ERRORS), _forces(row)]


def _forces(row: Mapping[str, Cell]) -> str:
    ratios = [number(row, f"force_ratio_{joint}") for joint in (1, 2)]
    return "" if math.isnan(ratios[0]) else " / ".join(f"{ratio:.2f}" for ratio in ratios)
