"""`python -m solar_env design`: peak force and wear over clearances and over latch and cable stiffness."""

import argparse
from pathlib import Path

from rich.console import Console

from solar_env.array import PRESETS
from solar_env.commands._workers import add_worker_arguments
from solar_env.support.campaigns import Workers
from solar_env.support.readme import STUDIES


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--preset", choices=sorted(PRESETS), default="default", help="parameters (%(default)s)")
    parser.add_argument("--members", type=int, default=8, help="runs of the ensemble in each cell (%(default)s)")
    add_worker_arguments(parser)
    parser.add_argument("--draw", action="store_true", help="measure nothing, draw the picture from the table again")
    parser.add_argument(
        "--out", type=Path, default=Path("design"),
        help="folder of the table and of the finished cells, with which an interrupted run goes on (%(default)s)",
    )  # fmt: skip
    parser.add_argument("--readme", action="store_true", help="picture into solar_env/studies/design/figures")


def run_command(args: argparse.Namespace) -> int:
    """Measure what is missing, write the table and draw the maps."""
    from solar_env.studies.common.tables import read_table
    from solar_env.studies.design.design_map import FILE, measure_design
    from solar_env.studies.design.design_plot import draw_design

    if args.members < 1:
        raise ValueError(f"members = {args.members} must be at least 1")
    if not args.draw:
        workers = Workers(args.jobs, args.cluster)
        print(measure_design(args.preset, args.members, workers, args.out, Console(stderr=True)))
    print(draw_design(read_table(args.out / FILE), STUDIES / "design" / "figures" if args.readme else args.out))
    return 0
