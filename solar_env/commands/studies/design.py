"""`solar-env design`: peak force and wear over clearances and over latch and cable stiffness."""

from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from solar_env.commands.arguments import WorkerOptions, check_measured
from solar_env.support.files import make_folder
from solar_env.support.readme import STUDIES


@dataclass
class Args(WorkerOptions):
    """Map peak force and wear over clearances, and over stiffnesses of latch and cable."""

    preset: str = "default"
    """parameter set: default or paper"""
    members: int = 8
    """runs of the ensemble in each cell"""
    draw: bool = False
    """measure nothing, draw the picture from the table again"""
    out: Path = Path("design")
    """folder of the table and of the finished cells, with which an interrupted run goes on"""
    readme: bool = False
    """picture into solar_env/studies/design/figures"""


def run_command(args: Args) -> int:
    """Measure what is missing, write the table and draw the maps."""
    from solar_env.studies.common.tables import read_table
    from solar_env.studies.design.design_map import FILE, measure_design
    from solar_env.studies.design.design_plot import draw_design

    if args.members < 1:
        raise ValueError(f"members = {args.members} must be at least 1")
    if args.draw:
        check_measured(args.out)
    pictures = make_folder(STUDIES / "design" / "figures" if args.readme else args.out)
    if not args.draw:
        workers = args.workers
        print(measure_design(args.preset, args.members, workers, args.out, Console(stderr=True, quiet=args.quiet)))
    print(draw_design(read_table(args.out / FILE), pictures))
    return 0
