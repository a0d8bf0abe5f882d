"""Error and cost of every level of the model, question by question, measured into a table."""

import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from solar_env.array import ArrayParameters
from solar_env.array.ladder import QUESTIONS, Answer
from solar_env.array.methods import compilation_note
from solar_env.array.parameters.ranges import RELEASE_RATE
from solar_env.studies.common.levels import FINEST, Level
from solar_env.studies.common.motion import SETTING_SHARE
from solar_env.studies.common.tables import Row, provenance, write_table
from solar_env.studies.ladder.answers import mean_error, ranking_error
from solar_env.studies.ladder.runs import CONTROLLERS, SAMPLE_STEP, Outcome, Profile, control, deploy
from solar_env.support.progress import counting_bar

RANKING = "controller-ranking"
FILE = "ladder.csv"


@dataclass(frozen=True)
class LadderRun:
    """A member of the ensemble at a level, under a controller or, without one, on the springs alone."""

    level: Level
    member: int
    profile: Profile | None

    @property
    def name(self) -> str:
        """Level, number of the run and controller, in words."""
        return f"{self.level.name}, run {self.member + 1}" + (f", {self.profile.name}" if self.profile else "")


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

    def members_of(self, level: Level, most: int) -> int:
        """How many of at most so many members run at a level."""
        return most if level.panels.clearance else min(most, self.ideal_members)

    @property
    def runs(self) -> tuple[LadderRun, ...]:
        """Every run, member by member, so that what disturbs the machine meets all levels alike."""
        return tuple(
            LadderRun(level, member, profile)
            for most, profiles in ((self.members, (None,)), (self.controlled_members, CONTROLLERS))
            for member in range(most)
            for level in self.levels
            if member < self.members_of(level, most)
            for profile in profiles
        )


FULL = LadderPlan()
QUICK = LadderPlan(
    panels=("1 element", "2 elements", "8 modes"),
    duration=17.0,
    members=4,
    ideal_members=2,
    controlled_members=2,
    window=4.0,
)

Announce = Callable[[str], None]


def run_ladder(plan: LadderPlan, announce: Announce) -> list[Row]:
    """Make every run, announced before it starts.

    Returns a row for every question and level, with the columns of `solar_env.array.ladder.Answer`.
    """
    deployed: dict[Level, list[Outcome]] = {level: [] for level in plan.levels}
    controlled: dict[Level, list[Outcome]] = {level: [] for level in plan.levels}
    for run in plan.runs:
        announce(run.name)
        if run.profile is None:
            deployed[run.level].append(deploy(run.level, run.member, plan.duration))
        else:
            controlled[run.level].append(control(run.level, run.member, run.profile, plan.window))
    members = len(CONTROLLERS)
    joined = {
        level: [Outcome.of_all(own[k : k + members]) for k in range(0, len(own), members)]
        for level, own in controlled.items()
    }
    return rows_of(deployed, joined)


def rows_of(deployed: Mapping[Level, Sequence[Outcome]], controlled: Mapping[Level, Sequence[Outcome]]) -> list[Row]:
    """Rows of the table from the runs of all levels and, last, of the reference."""
    rows: list[Row] = []
    for question in QUESTIONS:
        *levels, (_, reference) = (controlled if question == RANKING else deployed).items()
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
        controllers="; ".join(f"{p.name} ({p.torque:g} N m from {p.start:g} s)" for p in CONTROLLERS),
    )
    path = folder / FILE
    write_table(path, rows, made_by)
    return path


def _warm_up(plan: LadderPlan) -> None:
    """Run a moment of every level, so that compiling and loading are not measured."""
    for level in plan.levels:
        level.deploy(ArrayParameters(), 0, SAMPLE_STEP, SAMPLE_STEP)
