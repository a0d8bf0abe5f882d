"""Figures of work against precision, from their tables alone: a column for each model, a row for each cost."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from solar_env.pictures.style import METHOD_LOOKS, STEEL, STYLE, Look, look_of
from solar_env.studies.common.drawing import draw_floor, make_figure, positive_points, save, short, use_decades
from solar_env.studies.common.tables import Cell, Table, number

COSTS = (("wall_s", "wall time [s]"), ("evaluations", "evaluations"), ("factorizations", "factorisations"))
# Of one panel with its labels, and of all in a row at least [inch].
_WIDTH, _HEIGHT, _LEAST_WIDTH = 2.15, 1.9, 6.4


@dataclass(frozen=True)
class Question:
    """One figure.

    Attributes:
        file: its name without suffix.
        scene: kind of scene.
        error: column of the error.
        label: of the error's axis.
        note: what the reader must know.
        goal: error that the title asks for.
        counts: whether the "error" is a number of right predictions, on a linear axis.
    """

    file: str
    scene: str
    error: str
    label: str
    note: str
    goal: float = 1e-4
    counts: bool = False


_FLOOR_NOTE = "grey: what two independent methods disagree by; modes are compared with their finest run"
QUESTIONS = (
    Question("angles", "deployment", "angle_error_rad", "error of angles before the latch [rad]", _FLOOR_NOTE),
    Question("latch", "deployment", "latch_error_s", "error of latch times [s]", _FLOOR_NOTE),
    Question(
        "impacts", "impacts", "impact_force_error", "error of the first impacts' peak forces",
        f"{_FLOOR_NOTE}; first impacts of each joint",
    ),
    Question(
        "horizon", "impacts", "impacts_predicted", "impacts with the right peak force (1 %)",
        "more is better; beyond the horizon two independent methods disagree", counts=True,
    ),
    Question(
        "energy", "deployment", "energy_residual", "energy not in the books / energy put in",
        "not an error of the motion: what the method's own energy balance leaves open",
    ),
)  # fmt: skip


def draw_work_precision(rows: Table, floors: Table, folder: Path) -> list[Path]:
    """Draw the figure of every question that the tables have an answer to; returns the files."""
    drawn = []
    for question in QUESTIONS:
        asked = rows.where(scene=question.scene)
        if asked.rows:
            drawn.append(_draw(question, asked, floors.where(scene=question.scene), folder))
    return drawn


def _draw(question: Question, rows: Table, floors: Table, folder: Path) -> Path:
    shown = [str(name) for name in rows.values("method") if _shows(rows.where(method=name), question)]
    looks = {name: look_of(name, METHOD_LOOKS) for name in shown}
    models = rows.values("model")
    size = max(_WIDTH, _LEAST_WIDTH / len(models)), _HEIGHT
    figure, axes = make_figure(len(COSTS), len(models), size, len(looks))
    with mpl.rc_context(STYLE):
        for column, model in zip(axes.T, models, strict=True):
            known = floors.first(model=model)
            floor = number(known, question.error) if question.error in known else 0.0
            for axis, (cost, label) in zip(column, COSTS, strict=True):
                _draw_panel(axis, rows.where(model=model), question, cost, looks)
                draw_floor(axis, floor)
                if column[0] is axes[0, 0]:
                    axis.set_ylabel(label)
            column[0].set_title(_title(rows.where(model=model), known), fontsize=7.5)
            _share_errors(column, question)
        # Once for all models: it is wider than one panel.
        figure.text(0.5, axes[-1, 0].get_position().y0 - 0.4 / figure.get_figheight(), question.label, ha="center")
    path = folder / f"{question.file}.png"
    save(figure, path, looks, _conclusion(rows, question), question.note)
    return path


def _conclusion(rows: Table, question: Question) -> str:
    """The best method of each model: the cheapest within the goal, or the one with most right predictions."""
    best: dict[str, list[str]] = {}
    for model in rows.values("model"):
        own = [row for row in rows.where(model=model).rows if math.isfinite(number(row, question.error))]
        if question.counts:
            ranked = sorted(own, key=lambda row: (-number(row, question.error), number(row, "wall_s")))
        else:
            within = [row for row in own if 0.0 < number(row, question.error) <= question.goal]
            ranked = sorted(within, key=lambda row: number(row, "wall_s"))
        if ranked:
            best.setdefault(str(ranked[0]["method"]), []).append(str(model))
    head = "Most impacts right" if question.counts else f"Cheapest to within {short(question.goal)}"
    # Lines break between methods, not within.
    clauses = [f"{method} ({', '.join(models)})".replace(" ", "\N{NO-BREAK SPACE}") for method, models in best.items()]
    return f"{head}: {'; '.join(clauses)}"


def _shows(rows: Table, question: Question) -> bool:
    """Whether a method has a point in the figure."""
    errors = rows.column(question.error)
    return bool(np.any(np.isfinite(errors) & ((errors > 0.0) | question.counts)))


def _draw_panel(axis: Axes, rows: Table, question: Question, cost: str, looks: dict[str, Look]) -> None:
    """Points of every method from its coarsest to its finest setting."""
    axis.set_xscale("linear" if question.counts else "log")
    axis.set_yscale("log")
    drawn = 0
    for name in rows.values("method"):
        own = rows.where(method=name)
        errors, costs = own.column(question.error), own.column(cost)
        errors, costs = (errors, costs) if question.counts else positive_points(errors, costs)
        if len(errors) and str(name) in looks:
            axis.plot(errors, costs, markersize=3.5, **looks[str(name)])
        drawn += len(errors)
    if drawn == 0:
        axis.text(0.5, 0.5, "none", transform=axis.transAxes, ha="center", color=STEEL)
        axis.set_yticks([])
        return
    use_decades(axis, "y")


def _share_errors(column: Any, question: Question) -> None:
    """The panels of a model have one scale of errors."""
    limits = [axis.get_xlim() for axis in column if len(axis.get_yticks())]
    for axis in column if limits else ():
        axis.set_xlim(min(low for low, _ in limits), max(high for _, high in limits))
        if not question.counts:
            use_decades(axis, "x")


def _title(rows: Table, known: Mapping[str, Cell]) -> str:
    """Model; its panels, impacts that errors are taken over, runs that could not go on."""
    model = rows.rows[0]["model"]
    details = [str(panels) for panels in rows.values("panels") if panels != "rigid"]
    compared, predictable = number(known, "impacts_compared"), number(known, "impacts_in_horizon")
    if math.isfinite(compared):
        details.append(f"{compared:g} of {predictable:g} impacts")
    failed = sum(1 for row in rows.rows if row["failure"])
    if failed:
        details.append(f"{failed} failed")
    return f"{model}\n{', '.join(details)}"
