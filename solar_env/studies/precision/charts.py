"""Table of the charts of speed against accuracy; measuring them into tables, drawing from tables."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.console import Console

from solar_env.array.compilation import compilation_note
from solar_env.mechanics.integrators.settings import INTEGRATORS
from solar_env.studies.common.plans import FULL, QUICK, ChartPlan
from solar_env.studies.common.tables import Row, provenance, read_table, write_table
from solar_env.studies.common.timing import Job, Measured, measure
from solar_env.studies.precision.ensembles import draw_ensembles, ensemble_jobs, ensemble_rows
from solar_env.studies.precision.growth import draw_growth, growth_jobs, growth_rows
from solar_env.studies.precision.levels import level_jobs, level_rows
from solar_env.studies.precision.levels_plot import draw_levels
from solar_env.studies.precision.methods import METHODS, MISSING_PEER, peer_is_missing
from solar_env.studies.precision.side_by_side import side_by_side_jobs, side_by_side_rows, write_side_by_side
from solar_env.studies.precision.work_precision import work_precision_jobs, work_precision_rows
from solar_env.studies.precision.work_precision_plot import draw_work_precision
from solar_env.support.campaigns import ONE, Workers
from solar_env.support.progress import counting_bar


@dataclass(frozen=True)
class Study:
    """One part of the charts.

    Attributes:
        jobs: plan to the runs by key.
        rows: plan and what came of each run, by key, to rows by table.
        tables: names of the tables.
        draw: tables, as many as they are, and folder to the files drawn.
        timed: whether wall times matter, so that runs follow each other in this process.
    """

    jobs: Callable[[ChartPlan], dict[Any, Job]]
    rows: Callable[[ChartPlan, dict[Any, Measured]], dict[str, list[Row]]]
    tables: tuple[str, ...]
    draw: Callable[..., list[Path]]
    timed: bool = True


STUDIES = {
    "work-precision": Study(
        work_precision_jobs, work_precision_rows, ("work_precision", "work_precision_floors"), draw_work_precision
    ),
    "ensembles": Study(ensemble_jobs, ensemble_rows, ("ensembles",), draw_ensembles, timed=False),
    "levels": Study(level_jobs, level_rows, ("levels", "levels_clearance"), draw_levels),
    "growth": Study(growth_jobs, growth_rows, ("growth",), draw_growth),
    "side-by-side": Study(side_by_side_jobs, side_by_side_rows, ("side_by_side",), write_side_by_side),
}


def measure_charts(names: Sequence[str], quick: bool, folder: Path, console: Console, workers: Workers = ONE) -> None:
    """Measure studies, in about an hour or `quick` in two minutes, and write their tables.

    Ensembles run where the workers are; everything else is timed and runs here, one after the other.
    """
    plan = QUICK if quick else FULL
    if peer_is_missing():
        console.print(MISSING_PEER, highlight=False, markup=False, soft_wrap=True)
    jobs = {name: STUDIES[name].jobs(plan) for name in names}
    with counting_bar(console) as progress:
        total = sum(map(len, jobs.values()))
        task = progress.add_task(f"loading kernels{compilation_note(INTEGRATORS)}", total=total)
        warm_up(plan)
        for name in names:
            study = STUDIES[name]
            results = measure(
                jobs[name],
                lambda run: progress.update(task, advance=1, description=run),
                ONE if study.timed else workers,
            )
            rows = study.rows(plan, results)
            for table, measured in rows.items():
                made_by = provenance(f"solar-env chart --only {name}{' --quick' if quick else ''}")
                write_table(folder / f"{table}.csv", measured, made_by)


def warm_up(plan: ChartPlan) -> None:
    """Run a moment of every method and model, so that compiling and loading are not measured."""
    for model in plan.models:
        for method in METHODS:
            settings = method.deployments.get(model, ()) or method.impacts.get(model, ())
            if method.available and settings:
                method.solve(replace(plan.deployment(model), duration=1e-3, sample_step=1e-3), settings[-1])


def draw(names: Sequence[str], tables: Path, figures: Path) -> list[Path]:
    """Draw studies from the tables in one folder into another; returns the files.

    Raises:
        ValueError: if a table does not exist.
    """
    drawn: list[Path] = []
    for name in names:
        study = STUDIES[name]
        paths = [tables / f"{table}.csv" for table in study.tables]
        for path in paths:
            if not path.is_file():
                raise ValueError(f"{path} does not exist: measure first, without --draw")
        drawn += study.draw(*map(read_table, paths), figures)
    return drawn
