"""Plot of all model levels' costs against their errors, with a chart for each computed result, such as "wear"."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes

from solar_env.array import ModelLevel
from solar_env.array.ladder import QUESTIONS, Answer, steps
from solar_env.pictures.style import LEVEL_LOOKS, STEEL, STYLE, look_of
from solar_env.studies.common.drawing import make_figure, save, use_decades

_COLUMNS = 2
_TOLERANCE = 0.1  # relative error that the title's conclusion accepts
_SMALLEST = 1e-6  # least error drawn; smaller errors are drawn at this value
_NOTE = (
    "mark: error and 95 % sampling half-width (line), the tolerance from which a level answers; "
    "open: ideal joints; grey: the level chosen"
)


def draw_ladder(answers: Sequence[Answer], folder: Path) -> Path:
    """Plot relative wall time against error of the levels in `answers`, a chart per result; return the PNG's path."""
    asked = [question for question in QUESTIONS if any(answer.question == question for answer in answers)]
    looks = {_size(answer): look_of(_size(answer), LEVEL_LOOKS) for answer in answers}
    rows = -(-len(asked) // _COLUMNS)
    figure, axes = make_figure(rows, _COLUMNS, (4.1, 2.4), len(looks))
    with mpl.rc_context(STYLE):
        for axis, question in zip(axes.flat, asked, strict=False):
            _draw_panel(axis, [answer for answer in answers if answer.question == question])
            axis.set_title(question)
            axis.set_xlabel("share of pairs" if question == "controller-ranking" else "error (relative), tolerance")
            axis.set_ylabel("wall time / reference's")
        for axis in axes.flat[len(asked) :]:
            axis.set_axis_off()
    path = folder / "ladder.png"
    save(figure, path, looks, conclusion(answers, asked), _NOTE)
    return path


def conclusion(answers: Sequence[Answer], asked: Sequence[str]) -> str:
    """Return a title that names the fastest accurate panel model for each result in `asked`, such as "wear".

    Accurate models have errors up to _TOLERANCE with 95 % confidence; `answers` hold the errors against a finer model.
    """
    chosen: dict[str, list[str]] = {}
    for question in asked:
        within = [answer for answer in steps(answers, question) if answer.bound <= _TOLERANCE]
        panels = _size(within[-1]).replace("rigid", "rigid panels") if within else "none"
        chosen.setdefault(panels, []).append(question)
    most = max(chosen, key=lambda panels: len(chosen[panels]))
    clauses = [f"{panels} for {' and '.join(questions)}" for panels, questions in chosen.items() if panels != most]
    rest = f"{most} for all else" if clauses else f"{most} for all questions"
    return f"Cheapest within {_TOLERANCE:.0%}: {', '.join([*clauses, rest])}"


def _size(answer: Answer) -> str:
    return ModelLevel.of(answer.level).size


def _draw_panel(axis: Axes, answers: Sequence[Answer]) -> None:
    axis.set_xscale("log")
    axis.set_yscale("log")
    for answer in answers:
        bound, look = max(answer.bound, _SMALLEST), look_of(_size(answer), LEVEL_LOOKS) | {"linestyle": "none"}
        if not ModelLevel.of(answer.level).clearance:
            look["markerfacecolor"] = "white"
        if answer.error > 0.0:
            axis.plot([answer.error, bound], [answer.cost_ratio] * 2, linewidth=0.8, color=look["color"])
        axis.plot([bound], [answer.cost_ratio], markersize=4, **look)
    # Draw the cheapest level's cost against the tolerance, beginning at the finest level.
    chosen = steps(answers, answers[0].question)
    bounds, costs = [max(answer.bound, _SMALLEST) for answer in chosen], [answer.cost_ratio for answer in chosen]
    end = 2.0 * axis.get_xlim()[1]
    axis.step([*bounds, end], [*costs, costs[-1]], where="post", color=STEEL, linewidth=2.5, alpha=0.5, zorder=1)
    axis.set_xlim(0.3 * bounds[0], end)
    use_decades(axis, "x")
    use_decades(axis, "y")
