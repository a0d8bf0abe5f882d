"""One function per figure of the paper: from trajectories to the rows of its table.

The paper's figures are drawn from these tables alone (`drawings.py`). Angles are in radians, those round a bearing in
degrees and paths in micrometres, as on its axes.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from solar_env.array import MODELS
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.common.tables import Row
from solar_env.studies.paper.cases import (
    EQ_40,
    EQ_40_CASE,
    FOUR_BAR_RATE,
    FOUR_BAR_TURNS,
    JOINTS,
    MEMBERS,
    SAMPLES_PER_TURN,
    Member,
    simulate_four_bar,
)
from solar_env.studies.paper.phases import greatest_force, phase_of

Array = NDArray[np.float64]

# s; forces are the greatest of windows of this length, for samples would miss impacts.
FORCE_WINDOW = 0.01
_TURN = 2.0 * math.pi / FOUR_BAR_RATE  # s


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper.

    Attributes:
        number: in the paper.
        title: what it shows.
        kind: how it is drawn, a key of `drawings.DRAWERS`.
        cases: names of the deployments that it needs.
        rows: its table from these deployments.
        ensemble: whether it shows the median and the range of an ensemble; else the nominal run, as where impacts
            strike at other times in every member.
    """

    number: int
    title: str
    kind: str
    cases: tuple[str, ...]
    rows: Callable[[Member], list[Row]]
    ensemble: bool = False

    @property
    def stem(self) -> str:
        """Name of its files, without the suffix."""
        return f"figure-{self.number:02d}"

    @property
    def heading(self) -> str:
        """Number and title, and which runs it shows."""
        shown = f"median and range of {MEMBERS} runs" if self.ensemble else "nominal run"
        return f"Fig. {self.number}: {self.title}" + (f"; {shown}" if self.cases else "")

    @property
    def members(self) -> range:
        """The members of the ensemble that it shows."""
        return range(MEMBERS if self.ensemble else 1)

    def table(self, members: Sequence[Member]) -> list[Row]:
        """Its table: of an ensemble the medians, and beside them columns `_least` and `_greatest`."""
        tables = [self.rows(member) for member in members]
        if not self.ensemble:
            return tables[0]
        place, *names = tables[0][0]
        columns = {place: np.array([row[place] for row in tables[0]])}
        for name in names:
            values = np.array([[row[name] for row in rows] for rows in tables])
            columns |= {name: np.median(values, axis=0)}
            columns |= {f"{name}_least": values.min(axis=0), f"{name}_greatest": values.max(axis=0)}
        return _rows(columns)


def _rows(columns: Mapping[str, Array]) -> list[Row]:
    """Rows of a table from its columns, with nine digits."""
    names = list(columns)
    digits = [[float(f"{x:.9g}") for x in column] for column in columns.values()]
    return [dict(zip(names, cells, strict=True)) for cells in zip(*digits, strict=True)]


def _angles(case: str, member: Member) -> list[Row]:
    motion = member[case]
    return _rows({"time_s": motion.time, **_by_joint("angle", "rad", motion.angles)})


def _by_joint(name: str, unit: str, values: Array) -> dict[str, Array]:
    return {f"{name}_{joint + 1}_{unit}": values[:, joint] for joint in JOINTS}


def _path(case: str, joint: int, member: Member) -> list[Row]:
    motion = member[case]
    x, y = 1e6 * motion.eccentricity[:, joint].T
    clearance = np.full(len(x), 1e6 * motion.clearance[joint])
    phase = phase_of(motion, joint).astype(float)
    return _rows({"time_s": motion.time, "phase": phase, "x_um": x, "y_um": y, "clearance_um": clearance})


def _contact_forces(case: str, member: Member) -> list[Row]:
    motion = member[case]
    edges = np.linspace(0.0, float(motion.time[-1]), round(float(motion.time[-1]) / FORCE_WINDOW) + 1)
    forces = np.stack([greatest_force(motion, joint, edges) for joint in JOINTS], axis=1)
    return _rows({"time_s": 0.5 * (edges[1:] + edges[:-1]), **_by_joint("force", "N", forces)})


def _torques(case: str, quantity: str, member: Member) -> list[Row]:
    motion = member[case]
    return _rows({"time_s": motion.time, **_by_joint("torque", "Nm", getattr(motion, quantity))})


def _four_models(quantity: str, unit: str, member: Member) -> list[Row]:
    reference = member["rigid-clearance"]
    columns = {"time_s": reference.time, "phase": phase_of(reference, 0).astype(float)}
    for model in MODELS:
        columns |= _by_joint(f"{model}_{quantity}", unit, getattr(member[model], quantity))
    return _rows(columns)


def _wear(case: str, member: Member) -> list[Row]:
    motion = member[case]
    bins = motion.wear_bearing.shape[1]
    columns = {"angle_deg": (np.arange(bins) + 0.5) * 360.0 / bins}
    for joint in JOINTS:
        columns[f"bearing_{joint + 1}_m"] = motion.wear_bearing[joint]
        columns[f"journal_{joint + 1}_m"] = motion.wear_journal[joint]
    return _rows(columns)


def _with_eq_40(rows: Callable[[str, Member], list[Row]], case: str, member: Member) -> list[Row]:
    """A table of a case, with columns of the same with the contact stiffness of Eq 40."""
    tables = zip(rows(case, member), rows(case + EQ_40_CASE, member), strict=True)
    return [own | {EQ_40 + name: other[name] for name in list(own)[1:]} for own, other in tables]


def _four_bar(member: Member) -> list[Row]:
    """Crank moment and rocker speed in the last of 26 turns, of the ideal linkage (0 turns) too; wear by then."""
    motions = {0: simulate_four_bar(1, with_clearance=False)}
    motions |= {turns: simulate_four_bar(turns, with_clearance=True) for turns in FOUR_BAR_TURNS}
    rows: list[Row] = []
    for turns in (0, FOUR_BAR_TURNS[-1]):
        for quantity, values in _last_turn(motions[turns]).items():
            times = (FOUR_BAR_TURNS[-1] - 1 + (np.arange(len(values)) + 0.5) / len(values)) * _TURN
            rows += _curve(quantity, turns, times, values)
    for turns in FOUR_BAR_TURNS:
        depths = motions[turns].wear_journal.max(axis=0)
        angles = (np.arange(len(depths)) + 0.5) * 360.0 / len(depths)
        rows += _curve("wear depth of the journal [m]", turns, angles, depths)
    return rows


def _curve(quantity: str, turns: int, places: Array, values: Array) -> list[Row]:
    """A curve over time [s] or an angle [deg]."""
    pairs = zip(places.tolist(), values.tolist(), strict=True)
    return [{"quantity": quantity, "turns": turns, "place": place, "value": value} for place, value in pairs]


def _last_turn(motion: Trajectory) -> dict[str, Array]:
    """The drive's mean moment [N m] over each sample of the last turn, and the rocker's speed in its middle [rad/s]."""
    work = motion.energies["external_work"][-SAMPLES_PER_TURN - 1 :]
    speed = motion.rates[-SAMPLES_PER_TURN - 1 :, -1]
    return {
        "crank moment [N m]": np.diff(work) * SAMPLES_PER_TURN / (2.0 * math.pi),
        "rocker speed [rad/s]": 0.5 * (speed[1:] + speed[:-1]),
    }


def _of_model(first: int, case: str) -> Iterator[PaperFigure]:
    """The five figures that the paper gives each model with clearance: two paths, forces, latch and cable torques."""
    for joint in JOINTS:
        title = f"path of the journal of joint {joint + 1} in the three phases, {case}"
        yield PaperFigure(first + joint, title, "path", (case,), partial(_path, case, joint))
    yield PaperFigure(first + 2, f"contact forces, {case}", "forces", (case,), partial(_contact_forces, case))
    for number, quantity in ((first + 3, "latch_torque"), (first + 4, "cable_torque")):
        title = f"{quantity.replace('_', ' ')}s, {case}"
        yield PaperFigure(number, title, "torques", (case,), partial(_torques, case, quantity))


def _all() -> Iterator[PaperFigure]:
    yield PaperFigure(
        5, "four-bar linkage with a clearance joint: crank moment, rocker speed and wear", "four-bar", (), _four_bar
    )
    for number, case in ((6, "rigid-ideal"), (7, "flexible-ideal")):
        yield PaperFigure(number, f"joint angles, {case}", "angles", (case,), partial(_angles, case), True)
    yield from _of_model(8, "rigid-clearance")
    yield from _of_model(13, "flexible-clearance")
    for number, quantity, unit in ((18, "angles", "rad"), (19, "rates", "rad_s")):
        title = f"joint {quantity} of the four models and their differences"
        yield PaperFigure(number, title, "models", MODELS, partial(_four_models, quantity, unit))
    for model in (1, 2):
        pair = (f"distribution-{model}", f"distribution-{model}{EQ_40_CASE}")
        sizes = "0.1 and 0.2 mm" if model == 1 else "0.2 and 0.1 mm"
        for number, quantity, kind, rows in (
            (19 + model, "contact forces", "small-forces", _contact_forces),
            (21 + model, "wear depth", "wear", _wear),
        ):
            title = f"{quantity}, model {model} ({sizes})"
            yield PaperFigure(number, title, kind, pair, partial(_with_eq_40, rows, pair[0]), kind == "wear")


FIGURES: Mapping[int, PaperFigure] = {figure.number: figure for figure in sorted(_all(), key=lambda f: f.number)}
