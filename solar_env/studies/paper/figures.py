"""Reproduced figures of results in Y. Li et al., Mech. Syst. Signal Process. 117 (2019) 188, by number in `FIGURES`."""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from solar_env.array import MODELS
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.pictures.style import COLOURS
from solar_env.studies.common.tables import Row, Table
from solar_env.studies.paper.cases import (
    EQ_40_CASE,
    FOUR_BAR_RATE,
    FOUR_BAR_TURNS,
    JOINTS,
    SAMPLES_PER_TURN,
    Member,
    simulate_four_bar,
)
from solar_env.studies.paper.kinds import (
    Angles,
    Array,
    ContactForces,
    JournalPath,
    Models,
    PaperFigure,
    Torques,
    Wear,
)

PAPER_TURN = (2.00, 2.08)  # s; beginning and end of the time axis of the paper's Fig 5
_TURN = 2.0 * math.pi / FOUR_BAR_RATE  # s; duration of a crank turn


class FourBar(PaperFigure):
    """Figure of the four-bar linkage: crank moment and rocker speed in the last turn, and wear by number of turns."""

    def table(self, members: Sequence[Member]) -> list[Row]:
        """Return a row (quantity, turns, place, value) for each point of each curve; `members` is not used.

        "turns" counts simulated crank turns, 0 for ideal joints. "place" is a time [s], or for wear an angle [deg].
        """
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

    def _draw(self, figure: Figure, table: Table) -> None:
        figure.set_size_inches(12.0, 3.4)
        for axis, quantity in zip(figure.subplots(1, 3), table.values("quantity"), strict=True):
            for colour, turns in zip(COLOURS, table.where(quantity=quantity).values("turns"), strict=False):
                curve = table.where(quantity=quantity, turns=turns)
                label = f"turn {turns}" if turns else "ideal joint"
                axis.plot(curve.column("place"), curve.column("value"), color=colour, label=label, linewidth=0.7)
            axis.set(ylabel=quantity)
            axis.legend()
        for axis in figure.axes[:2]:
            axis.set(xlabel="time [s]", xlim=PAPER_TURN)
        figure.axes[2].set(xlabel="angle round the journal [deg]", xlim=(0.0, 360.0))

    def _conclude(self, table: Table) -> str:
        moment = table.where(quantity="crank moment [N m]")
        ideal, loose = (np.abs(moment.where(turns=turns).column("value")).max() for turns in (0, FOUR_BAR_TURNS[-1]))
        return f"the clearance makes the greatest moment {loose / ideal:.2g} times that of ideal joints"


def _curve(quantity: str, turns: int, places: Array, values: Array) -> list[Row]:
    """Return a row per point of a curve after `turns` crank turns (0 for ideal joints); `places` in [s] or [deg]."""
    pairs = zip(places.tolist(), values.tolist(), strict=True)
    return [{"quantity": quantity, "turns": turns, "place": place, "value": value} for place, value in pairs]


def _last_turn(motion: Trajectory) -> dict[str, Array]:
    """Return arrays of crank moment [N m] and rocker speed [rad/s] between the samples of the crank's last turn."""
    work = motion.energies["external_work"][-SAMPLES_PER_TURN - 1 :]
    speed = motion.rates[-SAMPLES_PER_TURN - 1 :, -1]
    return {
        "crank moment [N m]": np.diff(work) * SAMPLES_PER_TURN / (2.0 * math.pi),
        "rocker speed [rad/s]": 0.5 * (speed[1:] + speed[:-1]),
    }


def _all() -> Iterator[PaperFigure]:
    yield FourBar(5, "four-bar linkage with a clearance joint: crank moment, rocker speed and wear", ())
    for number, case in ((6, "rigid-ideal"), (7, "flexible-ideal")):
        yield Angles(number, f"joint angles, {case}", (case,))
    for first, case in ((8, "rigid-clearance"), (13, "flexible-clearance")):
        for joint in JOINTS:
            title = f"path of the journal of joint {joint + 1} in the three phases, {case}"
            yield JournalPath(first + joint, title, (case,), joint)
        yield ContactForces(first + 2, f"contact forces, {case}", (case,))
        yield Torques(first + 3, f"latch torques, {case}", (case,), "latch_torque")
        yield Torques(first + 4, f"cable torques, {case}", (case,), "cable_torque")
    for number, quantity, unit in ((18, "angles", "rad"), (19, "rates", "rad/s")):
        yield Models(number, f"joint {quantity} of the four models and their differences", MODELS, quantity, unit)
    for model, sizes in ((1, "0.1 and 0.2 mm"), (2, "0.2 and 0.1 mm")):
        pair = (f"distribution-{model}", f"distribution-{model}{EQ_40_CASE}")
        yield ContactForces(19 + model, f"contact forces, model {model} ({sizes})", pair)
        yield Wear(21 + model, f"wear depth, model {model} ({sizes})", pair)


FIGURES: Mapping[int, PaperFigure] = {figure.number: figure for figure in sorted(_all(), key=lambda f: f.number)}
