"""The paper's figures, drawn from their tables alone, panel for panel."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solar_env.array import MODELS
from solar_env.pictures.style import COLOURS, FAINT, STEEL, STYLE
from solar_env.studies.common.tables import Table
from solar_env.studies.paper.cases import EQ_40
from solar_env.studies.paper.conclusions import CONCLUSIONS, JOINT_NUMBERS, shown_of_models
from solar_env.support.files import save_figure

PHASES = ("initial", "deployment", "after latching")
# Where the paper's axes end: Figs 20 and 21 [N], 22 and 23 [m], and 5 [s].
PAPER_FORCE, PAPER_WEAR, PAPER_TURN = 300.0, 7e-14, (2.00, 2.08)

# Beginnings of the columns of Figs 20 to 23, and the contact stiffness that they belong to.
STIFFNESSES = (("", "stiffness of Table 1"), (EQ_40, "stiffness of Eq 40"))


def draw_figure(table: Table, kind: str, title: str, path: Path) -> None:
    """Draw a figure, of a `kind` in DRAWERS, from its table to a PNG file; the same table gives the same file."""
    with mpl.rc_context(STYLE):
        figure = Figure(layout="constrained")
        DRAWERS[kind](figure, table)
        figure.suptitle(f"{title}:\n{CONCLUSIONS[kind](table)}", fontsize=9)
        save_figure(figure, path, dpi=80)


def _draw_angles(figure: Figure, table: Table) -> None:
    figure.set_size_inches(5.0, 3.0)
    axis = figure.subplots()
    for joint in JOINT_NUMBERS:
        _draw_median(axis, table, "time_s", f"angle_{joint}_rad", COLOURS[joint - 1], label=f"joint {joint}")
    _finish_time(axis, table, "joint angle [rad]")
    axis.legend()


def _draw_median(axis: Axes, table: Table, place: str, name: str, colour: str, **look: Any) -> None:
    """A curve of medians, and the range round it where the table has one."""
    places = table.column(place)
    axis.plot(places, table.column(name), color=colour, **look)
    if f"{name}_least" in table.rows[0]:
        least, greatest = (table.column(f"{name}_{end}") for end in ("least", "greatest"))
        axis.fill_between(places, least, greatest, color=colour, alpha=0.25, linewidth=0.0)


def _draw_path(figure: Figure, table: Table) -> None:
    figure.set_size_inches(9.0, 6.0)
    axes = figure.subplot_mosaic([list(PHASES), ["x"] * 3, ["y"] * 3], height_ratios=(3.0, 1.0, 1.0))
    time, phase, x, y = (table.column(name) for name in ("time_s", "phase", "x_um", "y_um"))
    clearance = float(table.column("clearance_um")[0])
    around = np.linspace(0.0, 2.0 * np.pi, 361)
    for number, name in enumerate(PHASES, start=1):
        axis, own = axes[name], phase == number
        axis.plot(clearance * np.cos(around), clearance * np.sin(around), color=STEEL)
        axis.plot(x[own], y[own], color=COLOURS[number - 1], linewidth=1.5 if number == 2 else 0.4)
        axis.set(aspect="equal", title=name, xlabel="x [µm]", ylabel="y [µm]")
    for name, values in (("x", x), ("y", y)):
        axes[name].plot(time, values, color=COLOURS[0], linewidth=0.5)
        _finish_time(axes[name], table, f"{name} [µm]")
        for number in (2, 3):
            if np.any(phase == number):
                axes[name].axvline(time[phase == number][0], color=FAINT, linestyle=":")


def _draw_by_joint(column: str, label: str, figure: Figure, table: Table) -> None:
    figure.set_size_inches(6.0, 4.0)
    _draw_joints(figure.subplots(2, sharex=True), column, label, table)


def _draw_joints(axes: Iterable[Axes], column: str, label: str, table: Table) -> None:
    """A column of each joint against time, each on its own axis."""
    for joint, axis in zip(JOINT_NUMBERS, axes, strict=True):
        axis.plot(table.column("time_s"), table.column(column.format(joint)), color=COLOURS[joint - 1], linewidth=0.6)
        _finish_time(axis, table, f"joint {joint}\n{label}")


def _draw_models(figure: Figure, table: Table) -> None:
    """Angles or rates of the models, and their differences from the first model's in each of the three phases."""
    figure.set_size_inches(13.0, 5.0)
    time, phase = table.column("time_s"), table.column("phase")
    quantity, unit = shown_of_models(table)
    for joint, row in zip(JOINT_NUMBERS, figure.subplots(2, 4, sharex="col"), strict=True):
        reference = table.column(f"{MODELS[0]}_{quantity}_{joint}_{unit}")
        for colour, model in zip(COLOURS, MODELS, strict=False):
            values = table.column(f"{model}_{quantity}_{joint}_{unit}")
            row[0].plot(time, values, color=colour, label=model, linewidth=0.8)
            for number, axis in enumerate(row[1:], start=1):
                own = phase == number
                axis.plot(time[own], (values - reference)[own], color=colour, linewidth=0.6)
        row[0].set_ylabel(f"joint {joint}\n{quantity} [{unit.replace('_', '/')}]")
        row[1].set_ylabel(f"difference from {MODELS[0]}")
    for axis, name in zip(figure.axes, (quantity, *PHASES), strict=False):
        axis.set_title(name)
    for axis in figure.axes[4:]:
        axis.set_xlabel("time [s]")
    figure.axes[0].legend()


def _draw_wear(figure: Figure, table: Table) -> None:
    figure.set_size_inches(9.0, 3.6)
    axes = figure.subplots(1, 2, sharey=True)
    for axis, (prefix, stiffness) in zip(axes, STIFFNESSES, strict=True):
        for joint in JOINT_NUMBERS:
            for surface, line in (("bearing", "-"), ("journal", ":")):
                name, label = f"{prefix}{surface}_{joint}_m", f"joint {joint}, {surface}"
                look = {"label": label, "linestyle": line, "linewidth": 0.8}
                _draw_median(axis, table, "angle_deg", name, COLOURS[joint - 1], **look)
        _frame(axis, PAPER_WEAR)
        axis.set(xlabel="angle round the bearing, or the journal [deg]", xlim=(0.0, 360.0), title=stiffness)
    axes[0].set_ylabel("wear depth [m]")
    axes[0].legend()


def _draw_small_forces(figure: Figure, table: Table) -> None:
    figure.set_size_inches(9.0, 4.0)
    for column, (prefix, stiffness) in zip(figure.subplots(2, 2, sharex=True, sharey=True).T, STIFFNESSES, strict=True):
        column[0].set_title(stiffness)
        _draw_joints(column, f"{prefix}force_{{}}_N", "contact force [N]", table)
        for axis in column:
            _frame(axis, PAPER_FORCE)


def _frame(axis: Axes, top: float) -> None:
    """The end of the paper's axis."""
    axis.axhline(top, color=FAINT, linestyle="--", label="end of the paper's axis")


def _draw_four_bar(figure: Figure, table: Table) -> None:
    figure.set_size_inches(12.0, 3.4)
    for axis, quantity in zip(figure.subplots(1, 3), table.values("quantity"), strict=True):
        for colour, turns in zip(COLOURS, table.where(quantity=quantity).values("turns"), strict=False):
            own = table.where(quantity=quantity, turns=turns)
            label = f"turn {turns}" if turns else "ideal joint"
            axis.plot(own.column("place"), own.column("value"), color=colour, label=label, linewidth=0.7)
        axis.set(ylabel=quantity)
        axis.legend()
    for axis in figure.axes[:2]:
        axis.set(xlabel="time [s]", xlim=PAPER_TURN)
    figure.axes[2].set(xlabel="angle round the journal [deg]", xlim=(0.0, 360.0))


def _finish_time(axis: Axes, table: Table, label: str) -> None:
    axis.set(xlabel="time [s]", ylabel=label, xlim=(0.0, float(table.column("time_s").max())))
    axis.label_outer()


DRAWERS: Mapping[str, Callable[[Figure, Table], None]] = {
    "angles": _draw_angles,
    "path": _draw_path,
    "forces": partial(_draw_by_joint, "force_{}_N", "contact force [N]"),
    "small-forces": _draw_small_forces,
    "torques": partial(_draw_by_joint, "torque_{}_Nm", "torque [N m]"),
    "models": _draw_models,
    "wear": _draw_wear,
    "four-bar": _draw_four_bar,
}
