"""Kinds of figures in the reproduced paper (Y. Li et al., Mech. Syst. Signal Process. 117 (2019) 188).

Each kind makes a table from trajectories, and from the table alone a picture with the paper's subplots. As in the
paper, joint angles are in radians, angles round a bearing in degrees, and a journal's path within it in micrometres.
"""

import itertools
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from solar_env.array import MODELS
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.pictures.style import COLOURS, FAINT, STEEL, STYLE
from solar_env.studies.common.tables import Row, Table
from solar_env.studies.paper.cases import EQ_40, JOINTS, MEMBERS, Member
from solar_env.studies.paper.measures import greatest_force, phase_of
from solar_env.support.files import save_figure

Array = NDArray[np.float64]

# s; force curves show the greatest force in windows of this length, because samples would miss impacts.
FORCE_WINDOW = 0.01
PHASES = ("initial", "deployment", "after latching")
JOINT_NUMBERS = (1, 2)  # joints as the table columns count them
SURFACES = {"bearing": "-", "journal": ":"}
# Ends of the vertical axes in the paper's Figs 20 and 21 [N], 22 and 23 [m].
PAPER_FORCE, PAPER_WEAR = 300.0, 7e-14
# Column prefixes in the tables of Figs 20 to 23, each with the contact stiffness that the prefix stands for.
STIFFNESSES = (("", "stiffness of Table 1"), (EQ_40, "stiffness of Eq 40"))


@dataclass(frozen=True)
class PaperFigure(ABC):
    """A figure of the paper, reproduced from simulations.

    Attributes:
        number: number of the figure in the paper.
        title: content of the figure.
        cases: names of the deployments shown; the second of two has the contact stiffness of the paper's Eq 40.
        ensemble: true if the figure shows median and range of an ensemble, false if it shows the nominal run.
    """

    number: int
    title: str
    cases: tuple[str, ...]

    ensemble = False

    @abstractmethod
    def table(self, members: Sequence[Member]) -> list[Row]:
        """Return the figure's table; `members` holds each ensemble member's trajectories by case name."""

    @abstractmethod
    def _draw(self, figure: Figure, table: Table) -> None:
        """Draw the table into an empty Matplotlib figure, as one or more subplots."""

    @abstractmethod
    def _conclude(self, table: Table) -> str:
        """Return the conclusion from the table in words, for the title."""

    @property
    def stem(self) -> str:
        """Name of the figure's files, without the suffix."""
        return f"figure-{self.number:02d}"

    @property
    def heading(self) -> str:
        """Heading with the figure's number, its title, and the runs that the figure shows."""
        shown = f"median and range of {MEMBERS} runs" if self.ensemble else "nominal run"
        return f"Fig. {self.number}: {self.title}" + (f"; {shown}" if self.cases else "")

    @property
    def members(self) -> range:
        """Numbers of the ensemble members that the figure shows."""
        return range(MEMBERS if self.ensemble else 1)

    def draw(self, table: Table, path: Path) -> None:
        """Draw the figure from its table to a PNG file; the same table gives the same file."""
        with mpl.rc_context(STYLE):
            figure = Figure(layout="constrained")
            self._draw(figure, table)
            figure.suptitle(f"{self.heading}:\n{self._conclude(table)}", fontsize=9)
            save_figure(figure, path, dpi=80)


class DeploymentFigure(PaperFigure):
    """A figure of deployments; its table has a column for the abscissa, such as time, and one for each curve."""

    def table(self, members: Sequence[Member]) -> list[Row]:
        """Return a row for each abscissa value, with numbers of nine significant digits.

        Each of `members` maps names of deployments to an ensemble member's trajectories. If `ensemble` is true, each
        curve has three columns: median, least and greatest value over the members. Otherwise the first member is shown.
        """
        tables = [self._columns(member) for member in members]
        columns = tables[0]
        if self.ensemble:
            place, *names = tables[0]
            columns = {place: tables[0][place]}
            for name in names:
                values = np.array([table[name] for table in tables])
                columns |= {name: np.median(values, axis=0)}
                columns |= {f"{name}_least": values.min(axis=0), f"{name}_greatest": values.max(axis=0)}
        digits = [[float(f"{x:.9g}") for x in column] for column in columns.values()]
        return [dict(zip(columns, cells, strict=True)) for cells in zip(*digits, strict=True)]

    @abstractmethod
    def _columns(self, member: Member) -> dict[str, Array]:
        """Return the table columns of one ensemble member; the first column is the abscissa."""


class CaseFigure(DeploymentFigure):
    """A figure of one deployment, or of two with different contact stiffness.

    The second has stiffness by the paper's Eq 40, a Hertzian formula. Its columns in the table begin with "eq_40_".
    """

    def _columns(self, member: Member) -> dict[str, Array]:
        first, *others = (self._of(member[case]) for case in self.cases)
        return first | {EQ_40 + name: column for other in others for name, column in list(other.items())[1:]}

    @abstractmethod
    def _of(self, motion: Trajectory) -> dict[str, Array]:
        """Return the table columns of one deployment; the first column is the abscissa."""


def _by_joint(name: str, values: Array) -> dict[str, Array]:
    return {name.format(joint): values[:, joint - 1] for joint in JOINT_NUMBERS}


def _finish_time(axis: Axes, table: Table, label: str) -> None:
    axis.set(xlabel="time [s]", ylabel=label, xlim=(0.0, float(table.column("time_s").max())))
    axis.label_outer()


def _draw_median(axis: Axes, table: Table, place: str, name: str, colour: str, **look: Any) -> None:
    """Plot column `name` (medians) against column `place`, and shade the range from least to greatest value."""
    places = table.column(place)
    axis.plot(places, table.column(name), color=colour, **look)
    least, greatest = (table.column(f"{name}_{end}") for end in ("least", "greatest"))
    axis.fill_between(places, least, greatest, color=colour, alpha=0.25, linewidth=0.0)


def _frame(axis: Axes, top: float) -> None:
    axis.axhline(top, color=FAINT, linestyle="--", label="end of the paper's axis")


class Angles(CaseFigure):
    """A figure of the joint angles over time; its conclusion states the angles' ranges in the last 10 s."""

    ensemble = True

    def _of(self, motion: Trajectory) -> dict[str, Array]:
        return {"time_s": motion.time, **_by_joint("angle_{}_rad", motion.angles)}

    def _draw(self, figure: Figure, table: Table) -> None:
        figure.set_size_inches(5.0, 3.0)
        axis = figure.subplots()
        for joint in JOINT_NUMBERS:
            _draw_median(axis, table, "time_s", f"angle_{joint}_rad", COLOURS[joint - 1], label=f"joint {joint}")
        _finish_time(axis, table, "joint angle [rad]")
        axis.legend()

    def _conclude(self, table: Table) -> str:
        late = table.column("time_s") > table.column("time_s")[-1] - 10.0
        swings = [np.ptp(table.column(f"angle_{joint}_rad")[late]) for joint in JOINT_NUMBERS]
        return f"in the last 10 s they still swing over {swings[0]:.2g} and {swings[1]:.2g} rad"


@dataclass(frozen=True)
class JournalPath(CaseFigure):
    """Five plots of the journal of `joint` (0, 1): path in impacts, in deployment, after latching; x and y in time."""

    joint: int

    def _of(self, motion: Trajectory) -> dict[str, Array]:
        x, y = 1e6 * motion.eccentricity[:, self.joint].T
        clearance = np.full(len(x), 1e6 * motion.clearance[self.joint])
        phase = phase_of(motion, self.joint).astype(float)
        return {"time_s": motion.time, "phase": phase, "x_um": x, "y_um": y, "clearance_um": clearance}

    def _draw(self, figure: Figure, table: Table) -> None:
        figure.set_size_inches(9.0, 6.0)
        axes = figure.subplot_mosaic([list(PHASES), ["x"] * 3, ["y"] * 3], height_ratios=(3.0, 1.0, 1.0))
        time, phase, x, y = (table.column(name) for name in ("time_s", "phase", "x_um", "y_um"))
        clearance = float(table.column("clearance_um")[0])
        around = np.linspace(0.0, 2.0 * np.pi, 361)
        for number, name in enumerate(PHASES, start=1):
            axis, then = axes[name], phase == number
            axis.plot(clearance * np.cos(around), clearance * np.sin(around), color=STEEL)
            axis.plot(x[then], y[then], color=COLOURS[number - 1], linewidth=1.5 if number == 2 else 0.4)
            axis.set(aspect="equal", title=name, xlabel="x [µm]", ylabel="y [µm]")
        for name, values in (("x", x), ("y", y)):
            axes[name].plot(time, values, color=COLOURS[0], linewidth=0.5)
            _finish_time(axes[name], table, f"{name} [µm]")
            for start in time[1:][np.diff(phase) > 0.0]:
                axes[name].axvline(start, color=FAINT, linestyle=":")

    def _conclude(self, table: Table) -> str:
        time, phase = table.column("time_s"), table.column("phase")
        return f"impacts to {time[phase > 1][0]:.2f} s, then along the wall to {time[phase > 2][0]:.2f} s, then across"


class ContactForces(CaseFigure):
    """A figure of each joint's greatest contact force in 0.01 s windows; each of two deployments has its own plots."""

    column, label, unit = "force_{}_N", "contact force [N]", "N"

    def _of(self, motion: Trajectory) -> dict[str, Array]:
        edges = np.linspace(0.0, float(motion.time[-1]), round(float(motion.time[-1]) / FORCE_WINDOW) + 1)
        forces = np.stack([greatest_force(motion, joint, edges) for joint in JOINTS], axis=1)
        return {"time_s": 0.5 * (edges[1:] + edges[:-1]), **_by_joint(self.column, forces)}

    def _draw(self, figure: Figure, table: Table) -> None:
        pair = len(self.cases) > 1
        figure.set_size_inches(9.0 if pair else 6.0, 4.0)
        columns = figure.subplots(2, len(self.cases), sharex=True, sharey=pair, squeeze=False).T
        for column, (prefix, stiffness) in zip(columns, STIFFNESSES, strict=False):
            for joint, axis in zip(JOINT_NUMBERS, column, strict=True):
                values = table.column(prefix + self.column.format(joint))
                axis.plot(table.column("time_s"), values, color=COLOURS[joint - 1], linewidth=0.6)
                _finish_time(axis, table, f"joint {joint}\n{self.label}")
                if pair:
                    _frame(axis, PAPER_FORCE)
            if pair:
                column[0].set_title(stiffness)

    def _conclude(self, table: Table) -> str:
        words = []
        for prefix, _ in STIFFNESSES[: len(self.cases)]:
            first, second = (np.abs(table.column(prefix + self.column.format(joint))).max() for joint in JOINT_NUMBERS)
            words.append(f"at most {first:.3g} {self.unit} at joint 1, {second:.3g} {self.unit} at joint 2")
        return " (by Eq 40 ".join(words) + ")" * (len(words) - 1)


@dataclass(frozen=True)
class Torques(ContactForces):
    """A figure of one torque of each joint over time; `quantity` names the attribute of the trajectory."""

    quantity: str

    column, label, unit = "torque_{}_Nm", "torque [N m]", "N m"

    def _of(self, motion: Trajectory) -> dict[str, Array]:
        return {"time_s": motion.time, **_by_joint(self.column, getattr(motion, self.quantity))}


class Wear(CaseFigure):
    """A figure of the wear depth round bearings and journals, with a plot for each of two contact stiffnesses.

    The first stiffness stands in the paper's Table 1; the second follows by the paper's Eq 40, a Hertzian formula.
    """

    ensemble = True

    def _of(self, motion: Trajectory) -> dict[str, Array]:
        bins = motion.wear_bearing.shape[1]
        angles = (np.arange(bins) + 0.5) * 360.0 / bins
        bearings, journals = (_by_joint(f"{name}_{{}}_m", getattr(motion, f"wear_{name}").T) for name in SURFACES)
        return {"angle_deg": angles, **bearings, **journals}

    def _draw(self, figure: Figure, table: Table) -> None:
        figure.set_size_inches(9.0, 3.6)
        axes = figure.subplots(1, 2, sharey=True)
        for axis, (prefix, stiffness) in zip(axes, STIFFNESSES, strict=True):
            for joint, surface in itertools.product(JOINT_NUMBERS, SURFACES):
                look = {"label": f"joint {joint}, {surface}", "linestyle": SURFACES[surface], "linewidth": 0.8}
                name = f"{prefix}{surface}_{joint}_m"
                _draw_median(axis, table, "angle_deg", name, COLOURS[joint - 1], **look)
            _frame(axis, PAPER_WEAR)
            axis.set(xlabel="angle round the bearing, or the journal [deg]", xlim=(0.0, 360.0), title=stiffness)
        axes[0].set_ylabel("wear depth [m]")
        axes[0].legend()

    def _conclude(self, table: Table) -> str:
        words = []
        for prefix, _ in STIFFNESSES:
            depth, joint, surface = max(
                (table.column(f"{prefix}{surface}_{joint}_m").max(), joint, surface)
                for joint, surface in itertools.product(JOINT_NUMBERS, SURFACES)
            )
            words.append(f"{surface} of joint {joint}, {depth:.1e} m")
        return f"deepest in the {words[0]} (by Eq 40 in the {words[1]})"


@dataclass(frozen=True)
class Models(DeploymentFigure):
    """A figure of a joint quantity in four models: rigid or flexible panels, ideal joints or joints with clearance.

    It also shows differences from the first model in three periods: initial impacts, later deployment, after latching.
    """

    quantity: str
    unit: str

    def _columns(self, member: Member) -> dict[str, Array]:
        reference = member["rigid-clearance"]
        columns = {"time_s": reference.time, "phase": phase_of(reference, 0).astype(float)}
        for model in MODELS:
            columns |= _by_joint(self._column(model), getattr(member[model], self.quantity))
        return columns

    def _column(self, model: str) -> str:
        return f"{model}_{self.quantity}_{{}}_{self.unit.replace('/', '_')}"

    def _draw(self, figure: Figure, table: Table) -> None:
        figure.set_size_inches(13.0, 5.0)
        time, phase = table.column("time_s"), table.column("phase")
        for joint, row in zip(JOINT_NUMBERS, figure.subplots(2, 4, sharex="col"), strict=True):
            reference = table.column(self._column(MODELS[0]).format(joint))
            for colour, model in zip(COLOURS, MODELS, strict=False):
                values = table.column(self._column(model).format(joint))
                row[0].plot(time, values, color=colour, label=model, linewidth=0.8)
                for number, axis in enumerate(row[1:], start=1):
                    then = phase == number
                    axis.plot(time[then], (values - reference)[then], color=colour, linewidth=0.6)
            row[0].set_ylabel(f"joint {joint}\n{self.quantity} [{self.unit}]")
            row[1].set_ylabel(f"difference from {MODELS[0]}")
        for axis, name in zip(figure.axes, (self.quantity, *PHASES), strict=False):
            axis.set_title(name)
        for axis in figure.axes[4:]:
            axis.set_xlabel("time [s]")
        figure.axes[0].legend()

    def _conclude(self, table: Table) -> str:
        late = table.column("phase") == 3

        def values(model: str) -> Array:
            return np.stack([table.column(self._column(model).format(joint))[late] for joint in JOINT_NUMBERS])

        apart = {model: np.abs(values(model) - values(MODELS[0])).max() for model in MODELS[1:]}
        furthest = max(apart, key=lambda model: apart[model])
        return f"after latching {furthest} differs most from {MODELS[0]}, by {apart[furthest]:.2g} {self.unit}"
