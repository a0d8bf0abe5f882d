"""List of the studies of speed against accuracy, and functions that measure and draw them."""

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

# Study name -> module with three functions: `runs` makes a plan's jobs by key, `tabulate` turns a plan and the results
# by key into table rows, and `draw` draws a table into a folder and returns the files.
STUDIES: dict[str, ModuleType] = {
    "work-precision": work_precision,
    "convergence": convergence,
    "side-by-side": side_by_side,
}


def table_file(study: str) -> str:
    """Return the name of the file that holds a study's table."""
    return f"{study.replace('-', '_')}.csv"


def measure_charts(names: Sequence[str], quick: bool, folder: Path, console: Console) -> None:
    """Measure the named studies, and write their tables to `folder`; takes about an hour, or two minutes if `quick`."""
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
    """Simulate 1 ms with every method and model, so that timings exclude compiling and loading."""
    for method in METHODS.values():
        for model in plan.models:
            if method.available and model in method.settings:
                scene = replace(plan.deployment(model), duration=1e-3, sample_step=1e-3)
                method.solve(scene, method.settings[model][-1])


def draw(names: Sequence[str], tables: Path, figures: Path) -> list[Path]:
    """Draw the named studies from their tables in `tables` into the folder `figures`; return the files drawn."""
    drawn: list[Path] = []
    for name in names:
        path = tables / table_file(name)
        if not path.is_file():
            raise ValueError(f"{path} does not exist: measure first, without --draw")
        drawn += STUDIES[name].draw(read_table(path), figures)
    return drawn
