"""Error and cost of every level of the model, question by question, measured into a table."""

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from solar_env.array import ArrayParameters
from solar_env.array.compilation import compilation_note
from solar_env.array.ladder import QUESTIONS, Answer
from solar_env.array.parameters.ranges import RELEASE_RATE
from solar_env.studies.common.levels import FINEST, Level
from solar_env.studies.common.motion import SETTING_SHARE
from solar_env.studies.common.tables import Row, provenance, write_table
from solar_env.studies.ladder.answers import mean_error, ranking_error
from solar_env.studies.ladder.runs import CONTROLLERS, RANKING, SAMPLE_STEP, Outcome, control, deploy
from solar_env.support.progress import counting_bar

FILE = "ladder.csv"


@dataclass(frozen=True)
class LadderPlan:
    """How much is measured.

    Attributes:
        panels: of the flexible levels.
        reference: what all levels are compared with, finer than they are.
        duration: of deployments on the springs alone [s]; they latch at 12.3 s.
        members: runs of each level.
        ideal_members: runs of each level with ideal joints, which have no chaos to average over.
        controlled_members: runs of each level under each controller; not more with ideal joints than above.
        window: time simulated after the last latching under a controller [s].
    """

    panels: tuple[str, ...] = (
        *(f"{elements} elements" for elements in (1, 2, 4, 6, 12)),
        *(f"{modes} modes" for modes in (8, 32)),
    )
    reference: Level = FINEST
    duration: float = 22.5
    members: int = 16
    ideal_members: int = 3
    controlled_members: int = 8
    window: float = 10.0

    @property
    def levels(self) -> tuple[Level, ...]:
        """The levels, from rigid panels with ideal joints to the reference."""
        flexible = (Level(f"flexible-{joint}:{panels}") for joint in ("ideal", "clearance") for panels in self.panels)
        return (Level("rigid-ideal"), Level("rigid-clearance"), *flexible, self.reference)

    @property
    def runs(self) -> list[tuple[Level, int, bool]]:
        """Level, member, and whether controlled; member by member, so that disturbances meet all levels alike."""
        return [
            (level, member, controlled)
            for most, controlled in ((self.members, False), (self.controlled_members, True))
            for member in range(most)
            for level in self.levels
            if level.panels.clearance or member < self.ideal_members
        ]


FULL = LadderPlan()
QUICK = LadderPlan(
    panels=("1 element", "2 elements", "8 modes"),
    duration=17.0,
    members=4,
    ideal_members=2,
    controlled_members=2,
    window=4.0,
)


def run_ladder(plan: LadderPlan, announce: Callable[[str], None]) -> list[Row]:
    """Make every run, announced before it starts.

    Returns a row for every question and level, with the columns of `solar_env.array.ladder.Answer`.
    """
    done: dict[bool, dict[Level, list[Outcome]]] = {
        controlled: {level: [] for level in plan.levels} for controlled in (False, True)
    }
    for level, member, controlled in plan.runs:
        announce(f"{level.name}, run {member + 1}{', controllers' * controlled}")
        run = control(level, member, plan.window) if controlled else deploy(level, member, plan.duration)
        done[controlled][level].append(run)
    rows: list[Row] = []
    for question in QUESTIONS:
        *levels, (_, reference) = done[question == RANKING].items()
        for level, own in levels:
            error, half_width = error_of(question, own, reference)
            answer = Answer(
                question,
                str(level.panels),
                error,
                half_width,
                statistics.median(run.wall for run in own) / statistics.median(run.wall for run in reference),
                statistics.fmean(run.evaluations for run in own),
                len(own),
            )
            rows.append(dict(vars(answer)))
    return rows


def error_of(question: str, own: Sequence[Outcome], reference: Sequence[Outcome]) -> tuple[float, float]:
    """Error of a level's own runs against as many of the reference's, and the half-width of its sampling band."""
    level, other = (np.stack([run.answers[question] for run in runs]) for runs in (own, reference[: len(own)]))
    if question == RANKING:
        return ranking_error(level, other)
    scale = np.abs(other.mean(axis=0)).sum(axis=-1)
    if question == "tip-motion":
        parameters = ArrayParameters()
        scale = np.full(other.shape[1], len(parameters.joints) * parameters.panel_length)
    return mean_error(level, other, scale)


def measure_ladder(quick: bool, folder: Path, console: Console) -> Path:
    """Measure the ladder, in a quarter of an hour or `quick` in two minutes, and write its table; returns the file."""
    plan = QUICK if quick else FULL
    with counting_bar(console) as progress:
        methods = [level.integrator().name for level in plan.levels]
        task = progress.add_task(f"loading kernels{compilation_note(methods)}", total=len(plan.runs))
        _warm_up(plan)
        rows = run_ladder(plan, lambda run: progress.update(task, advance=1, description=run))
    made_by = provenance(
        f"solar-env ladder{' --quick' if quick else ''}",
        reference=plan.reference.name,
        parameters=f"the defaults of ArrayParameters; members released at rates within {RELEASE_RATE:g} rad/s",
        integrators=f"the default of each level; tolerances of members within {SETTING_SHARE:.1%}",
        duration_s=plan.duration,
        window_s=plan.window,
        controllers="; ".join(f"{name} ({torque:g} N m from {s:g} s)" for name, (torque, s) in CONTROLLERS.items()),
    )
    path = folder / FILE
    write_table(path, rows, made_by)
    return path


def _warm_up(plan: LadderPlan) -> None:
    """Run a moment of every level, so that compiling and loading are not measured."""
    for level in plan.levels:
        level.deploy(ArrayParameters(), 0, SAMPLE_STEP, SAMPLE_STEP)
