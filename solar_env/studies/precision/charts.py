"""Table of the studies of speed against accuracy, with their measurement and drawing."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import ModuleType

from rich.console import Console

from solar_env.array import compilation_note
from solar_env.mechanics.integrators.settings import INTEGRATORS
from solar_env.studies.common.plans import FULL, QUICK, ChartPlan
from solar_env.studies.common.tables import provenance, read_table, write_table
from solar_env.studies.common.timing import measure
from solar_env.studies.precision import convergence, side_by_side, work_precision
from solar_env.studies.precision.methods import METHODS, MISSING_PEER, peer_is_missing
from solar_env.support.progress import counting_bar

# A study has a table with its name. Its module has the functions `runs`, from a plan to jobs by key; `tabulate`, from a
# plan and the results by key to the table's rows; and `draw`, from a table and a folder to the files drawn.
STUDIES: dict[str, ModuleType] = {
    "work-precision": work_precision,
    "convergence": convergence,
    "side-by-side": side_by_side,
}


def table_file(study: str) -> str:
    """Return the name of the file that holds a study's table."""
    return f"{study.replace('-', '_')}.csv"


def measure_charts(names: Sequence[str], quick: bool, folder: Path, console: Console) -> None:
    """Measure studies run by run, in about an hour or `quick` in two minutes, and write their tables."""
    plan = QUICK if quick else FULL
    if peer_is_missing():
        console.print(MISSING_PEER, highlight=False, markup=False, soft_wrap=True)
    jobs = {name: STUDIES[name].runs(plan) for name in names}
    with counting_bar(console) as progress:
        total = sum(map(len, jobs.values()))
        task = progress.add_task(f"loading kernels{compilation_note(INTEGRATORS)}", total=total)
        warm_up(plan)
        for name in names:
            results = measure(jobs[name], lambda run: progress.update(task, advance=1, description=run))
            made_by = provenance(f"solar-env study precision --only {name}{' --quick' if quick else ''}")
            write_table(folder / table_file(name), STUDIES[name].tabulate(plan, results), made_by)


def warm_up(plan: ChartPlan) -> None:
    """Run a moment of every method and model, so that compiling and loading are not measured."""
    for method in METHODS.values():
        for model in plan.models:
            if method.available and model in method.settings:
                scene = replace(plan.deployment(model), duration=1e-3, sample_step=1e-3)
                method.solve(scene, method.settings[model][-1])


def draw(names: Sequence[str], tables: Path, figures: Path) -> list[Path]:
    """Draw studies from the tables in one folder into another folder; return the files."""
    drawn: list[Path] = []
    for name in names:
        path = tables / table_file(name)
        if not path.is_file():
            raise ValueError(f"{path} does not exist: measure first, without --draw")
        drawn += STUDIES[name].draw(read_table(path), figures)
    return drawn
