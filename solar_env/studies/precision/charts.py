"""Table of the charts of speed against accuracy; measuring them into tables, drawing from tables."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from rich.console import Console

from solar_env.studies.common.plans import FULL, QUICK, Plan
from solar_env.studies.common.tables import Row, provenance, read_table, write_table
from solar_env.studies.precision.ensembles import count_ensembles, draw_ensembles, run_ensembles
from solar_env.studies.precision.growth import count_growth, draw_growth, run_growth
from solar_env.studies.precision.levels import count_levels, draw_levels, run_levels
from solar_env.studies.precision.methods import METHODS, MISSING_PEER, peer_is_missing
from solar_env.studies.precision.side_by_side import count_side_by_side, run_side_by_side, write_side_by_side
from solar_env.studies.precision.work_precision import count_work_precision, run_work_precision
from solar_env.studies.precision.work_precision_plot import draw_work_precision
from solar_env.support.campaigns import ONE, Workers
from solar_env.support.progress import counting_bar

Announce = Callable[[str], None]


@dataclass(frozen=True)
class Study:
    """One part of the charts.

    Attributes:
        run: measures; plan and a function that is told of each run before it, to rows by table.
        count: how often `run` will tell.
        tables: names of the tables.
        draw: tables, as many as they are, and folder to the files drawn.
    """

    run: Callable[[Plan, Announce], dict[str, list[Row]]]
    count: Callable[[Plan], int]
    tables: tuple[str, ...]
    draw: Callable[..., list[Path]]


STUDIES = {
    "work-precision": Study(
        run_work_precision, count_work_precision, ("work_precision", "work_precision_floors"), draw_work_precision
    ),
    "ensembles": Study(run_ensembles, count_ensembles, ("ensembles",), draw_ensembles),
    "levels": Study(run_levels, count_levels, ("levels", "levels_clearance"), draw_levels),
    "growth": Study(run_growth, count_growth, ("growth",), draw_growth),
    "side-by-side": Study(run_side_by_side, count_side_by_side, ("side_by_side",), write_side_by_side),
}


def measure_charts(names: Sequence[str], quick: bool, folder: Path, console: Console, workers: Workers = ONE) -> None:
    """Measure studies, in about an hour or `quick` in two minutes, and write their tables.

    Ensembles run where the workers are; everything else is timed and runs here, one after the other.
    """
    plan = QUICK if quick else FULL
    if peer_is_missing():
        console.print(MISSING_PEER, highlight=False, markup=False, soft_wrap=True)
    with counting_bar(console) as progress:
        total = sum(STUDIES[name].count(plan) for name in names)
        task = progress.add_task("loading kernels (the first time compiles them: up to two minutes)", total=total)
        warm_up(plan)
        for name in names:
            run = partial(run_ensembles, workers=workers) if name == "ensembles" else STUDIES[name].run
            rows = run(plan, lambda done: progress.update(task, advance=1, description=done))
            for table, measured in rows.items():
                made_by = provenance(f"python -m solar_env chart --only {name}{' --quick' if quick else ''}")
                write_table(folder / f"{table}.csv", measured, made_by)


def warm_up(plan: Plan) -> None:
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
