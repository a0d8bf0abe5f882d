"""`solar-env design`: peak force and wear over clearances and stiffnesses, and over repeated ground tests."""

from dataclasses import dataclass
from typing import Annotated

import tyro

from solar_env.commands.arguments import FolderOptions, WorkerOptions
from solar_env.support.readme import STUDIES


@dataclass
class Args(FolderOptions, WorkerOptions):
    """Map peak force and wear over clearances and stiffnesses.

    Stiffnesses are those of latch and cable.
    With --readme the picture goes into the page of the study, the table into ./design.
    """

    preset: Annotated[str, tyro.conf.Positional] = "default"
    """parameter set: default or paper"""
    members: int = 8
    """runs of the ensemble in each cell"""
    ground_tests: int = 0
    """instead of the maps, repeat so many deployments with the worn clearance fed back"""


def run_command(args: Args) -> int:
    """Measure what is missing, write the table and draw it."""
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.design import design_map, ground_test, plots

    if args.members < 1 or args.ground_tests < 0:
        raise ValueError(f"members = {args.members} must be at least 1, ground tests = {args.ground_tests} at least 0")
    workers = args.workers
    tables, pictures = args.folders("design", None, STUDIES / "design" / "figures")
    path = tables / (ground_test.FILE if args.ground_tests else design_map.FILE)
    if not args.draw:
        if args.ground_tests:
            rows = ground_test.measure_ground_tests(args.preset, args.ground_tests, workers, args.console)
        else:
            rows = design_map.measure_design(args.preset, args.members, workers, tables, args.console)
        settings = {name: getattr(args, name) for name in ("preset", "members", "ground_tests")}
        write_table(path, rows, provenance("solar-env design", **settings))
        print(path)
    draw = plots.draw_ground_test if args.ground_tests else plots.draw_design
    print(draw(read_table(path), pictures))
    return 0
