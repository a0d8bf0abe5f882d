"""`solar-env loads`: how hard hinges and hub are hit, and how sure that is."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.markup import escape
from rich.table import Table

from solar_env.array import build
from solar_env.array.ladder import QUESTIONS
from solar_env.commands.arguments import ArrayOption, CommandRecord, WorkerOptions
from solar_env.support.files import check_target
from solar_env.support.terminal import wide_console


@dataclass
class Args(ArrayOption, WorkerOptions, CommandRecord):
    """Say how hard hinges and hub are hit, and how sure that is.

    An ensemble, released slightly differently and drawn from the tolerances of the file, is simulated at the cheapest
    level of the model that answers a question to a tolerance, and at the next finer one.
    """

    question: Annotated[str, tyro.conf.arg(help=f"what must be right: {', '.join(QUESTIONS)}")] = "peak-force"
    tolerance: float = 0.15
    """greatest error of that which the level may have, as a share"""
    runs: int = 16
    """deployments at each of the two levels"""
    window: float = 10.0
    """time simulated after the last latching [s]"""
    deadline: float = 60.0
    """time by which all joints must have latched [s]"""
    wear_limit: float = 1e-6
    """depth of wear to which deployments are counted [m]"""
    html: Path | None = None
    """write a page with everything, which needs no network"""
    hub: Path | None = None
    """write force and torque on the hub over time, as .csv"""
    out: Path = Path("loads")
    """folder of the runs, with which an interrupted ensemble goes on"""


def run_command(args: Args) -> int:
    """Run the ensemble, print the answer and the tables, write what was asked for."""
    from solar_env.studies.loads.ensemble import LoadsPlan, measure_loads, nominal_deployment
    from solar_env.studies.loads.hub import write_hub_loads
    from solar_env.studies.loads.report import answer, tables
    from solar_env.support.versions import versions

    if not args.wear_limit > 0.0:
        raise ValueError(f"wear limit = {args.wear_limit!r} m must be positive")
    array = args.parameter_file
    plan, workers = LoadsPlan(array, args.question, args.tolerance, args.runs, args.window, args.deadline), args.workers
    for level in plan.levels:
        build(array.parameters, level.model)  # refuses before anything is compiled
    for path, suffix in ((args.html, ".html"), (args.hub, ".csv")):
        if path is not None:
            check_target(path, (suffix,))
    from solar_env.array.methods import default_integrator
    from solar_env.commands.warmup import warm_up

    kernels = [(level.model, default_integrator(level.model).name) for level in plan.levels]
    for model, method in dict.fromkeys(kernels):
        warm_up(args.console, model, method)
    loads = measure_loads(plan, args.out, workers, args.console)
    if args.html or args.hub:
        nominal = nominal_deployment(plan)
    if args.html:
        from solar_env.pictures.page.document import write_page
        from solar_env.studies.loads.page import loads_page

        notes = [f"Made by: {args.command}", ", ".join(f"{name} {value}" for name, value in versions().items())]
        write_page(loads_page(loads, nominal, args.wear_limit, notes), args.html)
    if args.hub:
        write_hub_loads(plan.array.parameters, nominal.trajectory.time, nominal.hub_loads, args.hub)
    printed = wide_console()
    for line in answer(loads, args.wear_limit):
        printed.print(line, highlight=False)
    for table in tables(loads):
        shown = Table(*table.columns, title=table.title)
        for row in table.rows:
            shown.add_row(*map(escape, row))
        printed.print(shown)
    return 0
