"""Residual blocks of modal panels: what the pseudo-modes for the modes above those kept contribute, by their number."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from solar_env.array import PanelModel
from solar_env.array.panels import MODAL
from solar_env.mechanics.bodies.description import ModalPanel
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.studies.common.levels import Level
from solar_env.studies.common.motion import Scene, run_own
from solar_env.studies.common.plans import ChartPlan
from solar_env.studies.common.tables import Row, Table, number
from solar_env.studies.common.timing import Job, Measured
from solar_env.studies.precision.ensembles import member_job, member_rows
from solar_env.studies.precision.levels import Key as LevelKey
from solar_env.studies.precision.levels import ideal_errors, solve_member
from solar_env.studies.precision.levels_plot import ERRORS, MEANS, mean_and_error
from solar_env.support.files import write_text
from solar_env.support.markdown import markdown_table

BLOCKS = (0, 1, 2)


@dataclass(frozen=True)
class BlockLevel:
    """Modal panels of so many modes and residual blocks, see `ModalPanel`."""

    modes: int
    blocks: int


@dataclass(frozen=True, kw_only=True)
class BlockScene(Scene):
    """A deployment whose modal panels have another number of residual blocks than by default."""

    blocks: int

    def mechanism(self) -> Mechanism:
        """The array, its panels with so many blocks."""
        mechanism = super().mechanism()
        bodies = [
            replace(body, residual_blocks=self.blocks) if isinstance(body, ModalPanel) else body
            for body in mechanism.bodies
        ]
        return replace(mechanism, bodies=tuple(bodies))


# Number of the member of the ensemble with clearance; None for the run with ideal joints.
Key = tuple[BlockLevel, int | None]


def block_jobs(plan: ChartPlan) -> dict[Key, Job]:
    """A deployment with ideal joints, and an ensemble with clearance, for every number of modes and blocks."""
    chosen = [BlockLevel(modes, blocks) for blocks in BLOCKS for modes in plan.block_modes]
    members = (None, *range(plan.block_members))
    return {(own, member): _job(plan, own, member) for member in members for own in chosen}


def scene_of(plan: ChartPlan, own: BlockLevel, model: str) -> BlockScene:
    """The deployment of a model with panels of a level."""
    return BlockScene(
        model=model,
        parameters=plan.parameters,
        duration=plan.ensemble_duration.flexible,
        sample_step=plan.deployment(model).sample_step,
        panels=PanelModel(MODAL, own.modes),
        blocks=own.blocks,
    )


def _job(plan: ChartPlan, own: BlockLevel, member: int | None) -> Job:
    joint = "ideal" if member is None else "clearance"
    level = Level(f"flexible-{joint}", PanelModel(MODAL, own.modes))
    scene = scene_of(plan, own, level.model)
    name = f"residual blocks, {level.name}, {own.blocks} blocks"
    if member is None:
        return Job(name, partial(run_own, scene, level.integrator()))
    return member_job(name, scene, partial(solve_member, level), 1.0, member)


def block_rows(
    plan: ChartPlan, results: Mapping[Key, Measured], levels: Mapping[LevelKey, Measured]
) -> dict[str, list[Row]]:
    """Rows by table; the finest modal panels of `levels` are the reference.

    "residual_blocks": errors with ideal joints.
    "residual_blocks_clearance": for every joint of every run with clearance, see `ensembles.statistics_of`.
    """
    finest = [level for level in plan.levels if level.panels is not None and level.panels.kind == MODAL][-1]
    reference = levels[finest, None].motion
    words = Level("", finest.panels, finest.tighter).size
    rows: list[Row] = []
    members: list[Row] = []
    for (own, member), result in results.items():
        labels: Row = {
            "modes": own.modes,
            "residual_blocks": own.blocks,
            "duration_s": plan.ensemble_duration.flexible,
        }
        if member is not None:
            members += member_rows(labels, member, result)
        elif result.motion is not None:
            rows.append({**labels, "reference": words} | ideal_errors(result.motion, reference, plan))
    return {"residual_blocks": rows, "residual_blocks_clearance": members}


_COLUMNS = (
    "modes", "residual blocks", *ERRORS.values(), "runs with clearance", *(label for label, _ in MEANS.values()),
)  # fmt: skip


def write_blocks(rows: Table, members: Table, folder: Path) -> list[Path]:
    """Write the table in Markdown, from the measured tables alone; returns the file."""
    path = folder / "residual_blocks.md"
    write_text(path, page(rows, members))
    return [path]


def page(rows: Table, members: Table) -> str:
    """Errors with ideal joints and means with clearance in Markdown, a line for each number of modes and blocks."""
    reference = str(rows.rows[0]["reference"])
    lines = []
    for row in rows.rows:
        chosen = {name: row[name] for name in ("modes", "residual_blocks")}
        own = members.where(**chosen)
        by_joint = [own.where(joint=joint) for joint in own.values("joint")]
        lines.append(
            [
                *map(str, chosen.values()),
                *(f"{number(row, error):.1e}" for error in ERRORS),
                str(len(own.values("member"))),
                *(" / ".join(mean_and_error(of, statistic) for of in by_joint) for statistic in MEANS),
            ]
        )
    return (
        f"With ideal joints, errors against {reference} (2 blocks); with clearance, means of joints 1 / 2 ± their "
        f"standard errors:\n\n{markdown_table(_COLUMNS, lines)}\n"
    )
