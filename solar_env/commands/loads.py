"""`python -m solar_env loads`: how hard hinges and hub are hit, and how sure that is."""

import argparse
import shlex
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

from solar_env.array import read_parameters
from solar_env.array.ladder import QUESTIONS
from solar_env.array.parameter_file import ParameterFile
from solar_env.array.parameters import ArrayParameters
from solar_env.commands._workers import add_worker_arguments
from solar_env.support.campaigns import Workers
from solar_env.support.files import check_target

WEAR_LIMIT = 1e-6  # m; chosen: a hundredth of usual clearances


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("array", type=Path, nargs="?", help="file of parameters (TOML); the default array without it")
    parser.add_argument(
        "--question", choices=list(QUESTIONS), default="peak-force", help="what must be right (%(default)s)"
    )
    parser.add_argument("--tolerance", type=float, default=0.1, metavar="X", help="to which share (%(default)s)")
    parser.add_argument("--runs", type=int, default=16, metavar="N", help="of each of two levels (%(default)s)")
    parser.add_argument("--window", type=float, default=10.0, metavar="S", help="time after latching [s] (%(default)s)")
    parser.add_argument("--deadline", type=float, default=60.0, metavar="S", help="to latch by [s] (%(default)s)")
    parser.add_argument(
        "--wear-limit",
        type=float,
        default=WEAR_LIMIT,
        metavar="M",
        help="depth to count deployments to [m] (%(default)s)",
    )
    parser.add_argument(
        "--html", type=Path, metavar="FILE", help="write a page with everything, which needs no network"
    )
    parser.add_argument("--data", type=Path, metavar="FILE", help="write the nominal deployment (csv or npz)")
    parser.add_argument("--hub", type=Path, metavar="FILE", help="write force and torque on the hub over time (csv)")
    parser.add_argument(
        "--out", type=Path, default=Path("loads"), metavar="DIR",
        help="folder of the runs, with which an interrupted ensemble goes on (%(default)s)",
    )  # fmt: skip
    add_worker_arguments(parser)


def run_command(args: argparse.Namespace) -> int:
    """Run the ensemble, print the answer and the tables, write what was asked for."""
    from solar_env.array.data_files import check_data_file, write_data
    from solar_env.studies.common.tables import versions
    from solar_env.studies.loads.ensemble import Plan, measure_loads, nominal_deployment
    from solar_env.studies.loads.hub import write_hub_loads
    from solar_env.studies.loads.report import answer, tables

    if not args.wear_limit > 0.0:
        raise ValueError(f"wear limit = {args.wear_limit!r} m must be positive")
    array = read_parameters(args.array) if args.array else ParameterFile(ArrayParameters(), {})
    plan = Plan(array, args.question, args.tolerance, args.runs, args.window, args.deadline)
    if args.data is not None:
        check_data_file(args.data)
    for path, suffix in ((args.html, ".html"), (args.hub, ".csv")):
        if path is not None:
            if path.suffix.lower() != suffix:
                raise ValueError(f"the suffix {path.suffix!r} of {path} is unknown; choose {suffix}")
            check_target(path)
    from solar_env.array.methods import default_integrator
    from solar_env.commands.warmup import warm_up

    console = Console(stderr=True)
    for level in plan.levels:
        warm_up(console, level.model, default_integrator(level.model, level.panels).name)
    loads = measure_loads(plan, args.out, Workers(args.jobs, args.cluster), console)
    printed = Console()
    for line in answer(loads, args.wear_limit):
        printed.print(line, highlight=False)
    for table in tables(loads):
        shown = Table(*table.columns, title=table.title)
        for row in table.rows:
            shown.add_row(*row)
        printed.print(shown)
    if args.html or args.data or args.hub:
        nominal = nominal_deployment(plan)
    if args.html:
        from solar_env.pictures.page.document import write_page
        from solar_env.studies.loads.page import loads_page

        notes = [
            f"Made by: solar-env loads {shlex.join(sys.argv[2:])}",
            ", ".join(f"{k} {v}" for k, v in versions().items()),
        ]
        write_page(loads_page(loads, nominal, args.wear_limit, notes), args.html)
    if args.data:
        write_data(nominal.trajectory, args.data)
    if args.hub:
        write_hub_loads(nominal.trajectory.time, nominal.hub_loads, args.hub)
    return 0
