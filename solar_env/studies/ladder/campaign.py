"""Error and cost of every level of the model, question by question, measured into a table."""

import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from solar_env.array import ArrayParameters, PanelModel
from solar_env.array.ladder import QUESTIONS, Answer
from solar_env.array.panels import ANCF, MODAL
from solar_env.studies.common.levels import Level
from solar_env.studies.common.motion import RELEASE_RATE, SETTING_SHARE
from solar_env.studies.common.tables import Row, provenance, write_table
from solar_env.studies.ladder.answers import mean_error, ranking_error
from solar_env.studies.ladder.runs import CONTROLLERS, SAMPLE_STEP, Outcome, control, deploy
from solar_env.support.progress import counting_bar

RANKING = "controller-ranking"
FILE = "ladder.csv"


_REFERENCE = Level("flexible-clearance", PanelModel(MODAL, 48), tighter=10.0)


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

    panels: tuple[PanelModel, ...] = (
        *(PanelModel(ANCF, elements) for elements in (1, 2, 4, 6, 12)),
        *(PanelModel(MODAL, modes) for modes in (8, 24)),
    )
    reference: Level = _REFERENCE
    duration: float = 22.5
    members: int = 16
    ideal_members: int = 3
    controlled_members: int = 8
    window: float = 10.0

    @property
    def levels(self) -> tuple[Level, ...]:
        """From rigid panels with ideal joints to the reference."""
        flexible = (Level(f"flexible-{joint}", panels) for joint in ("ideal", "clearance") for panels in self.panels)
        return (Level("rigid-ideal"), Level("rigid-clearance"), *flexible, self.reference)

    def deployments_of(self, level: Level) -> int:
        """How often a level is deployed on its springs alone."""
        return self.ideal_members if level.model.endswith("ideal") else self.members

    def controlled_runs_of(self, level: Level) -> int:
        """How often a level is deployed under each controller."""
        most = self.controlled_members
        return min(most, self.ideal_members) if level.model.endswith("ideal") else most


FULL = LadderPlan()
QUICK = LadderPlan(
    panels=(PanelModel(ANCF, 1), PanelModel(ANCF, 2), PanelModel(MODAL, 8)),
    duration=17.0,
    members=4,
    ideal_members=2,
    controlled_members=2,
    window=4.0,
)

Announce = Callable[[str], None]


def count_runs(plan: LadderPlan) -> int:
    """How many runs `run_ladder` announces."""
    return sum(plan.deployments_of(level) + len(CONTROLLERS) * plan.controlled_runs_of(level) for level in plan.levels)


def run_ladder(plan: LadderPlan, announce: Announce) -> list[Row]:
    """Run every level, member by member, so that what disturbs the machine meets all levels alike.

    Every run is announced before it starts. Returns a row for every question and level, with the columns of
    `solar_env.array.ladder.Answer`.
    """
    deployed: dict[Level, list[Outcome]] = {level: [] for level in plan.levels}
    controlled: dict[Level, list[Outcome]] = {level: [] for level in plan.levels}
    for member in range(max(plan.members, plan.ideal_members)):
        for level in plan.levels:
            if member < plan.deployments_of(level):
                announce(f"{level.name}, run {member + 1}")
                deployed[level].append(deploy(level, member, plan.duration))
    for member in range(plan.controlled_members):
        for level in plan.levels:
            if member < plan.controlled_runs_of(level):
                label = f"{level.name}, run {member + 1}"

                def say(name: str, label: str = label) -> None:
                    announce(f"{label}, {name}")

                controlled[level].append(control(level, member, plan.window, say))
    return rows_of(deployed, controlled)


def rows_of(deployed: Mapping[Level, Sequence[Outcome]], controlled: Mapping[Level, Sequence[Outcome]]) -> list[Row]:
    """Rows of the table from the runs of all levels and, last, of the reference."""
    rows: list[Row] = []
    for question in QUESTIONS:
        *levels, (_, reference) = (controlled if question == RANKING else deployed).items()
        for level, own in levels:
            error, half_width = error_of(question, own, reference)
            answer = Answer(
                question,
                level.model,
                level.panels.kind if level.panels else "",
                level.panels.count if level.panels else 0,
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
        scale = np.full(other.shape[1], parameters.panel_count * parameters.panel_length)
    return mean_error(level, other, scale)


def measure_ladder(quick: bool, folder: Path, console: Console) -> Path:
    """Measure the ladder, in a quarter of an hour or `quick` in two minutes, and write its table; returns the file."""
    plan = QUICK if quick else FULL
    with counting_bar(console) as progress:
        task = progress.add_task("loading kernels (the first time compiles them)", total=count_runs(plan))
        _warm_up(plan)
        rows = run_ladder(plan, lambda run: progress.update(task, advance=1, description=run))
    made_by = provenance(
        f"python -m solar_env ladder{' --quick' if quick else ''}",
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
