"""`solar-env design`: peak force and wear over clearances and stiffnesses, and over repeated ground tests."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import tyro

from solar_env.array import ArrayParameters
from solar_env.commands.arguments import FolderOptions, WorkerOptions
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES

# Archard's k [m2/N] of ground tests: ten deployments wear like 1e9 at 1e-14, the array's.
WEAR_COEFFICIENT = 1e-6
GROWTH = 0.05  # share of a clearance that may be worn before the next deployment is simulated
MEMBERS = 4  # runs that stand for a deployment
CHECKED = 10  # deployments that are simulated directly, too


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
    if args.ground_tests:
        return _ground_tests(args)
    from solar_env.studies.common.tables import read_table
    from solar_env.studies.design.design_map import FILE, measure_design
    from solar_env.studies.design.design_plot import draw_design

    if args.members < 1:
        raise ValueError(f"members = {args.members} must be at least 1")
    workers = args.workers
    tables, pictures = _folders(args)
    if not args.draw:
        print(measure_design(args.preset, args.members, workers, tables, args.console))
    print(draw_design(read_table(tables / FILE), pictures))
    return 0


def _folders(args: Args) -> tuple[Path, Path]:
    return args.folders("design", None, STUDIES / "design" / "figures")


def _ground_tests(args: Args) -> int:
    """Simulate the campaign, extrapolated and for a while directly, write the table and draw it."""
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.design.ground_test import FILE, Deployment, as_rows, clearances_after, wear_campaign
    from solar_env.studies.design.ground_test_plot import draw_ground_test

    parameters = replace(ArrayParameters.preset(args.preset), wear_coefficient=WEAR_COEFFICIENT)
    workers = args.workers
    tables, pictures = _folders(args)
    if not args.draw:
        checked = min(CHECKED, args.ground_tests)
        campaigns: dict[str, list[Deployment]] = {}
        with counting_bar(args.console) as bar:
            for kind, deployments, growth in (("extrapolated", args.ground_tests, GROWTH), ("direct", checked, 0.0)):
                task = bar.add_task(f"{kind} deployments", total=deployments)
                campaigns[kind] = []
                for deployment in wear_campaign(parameters, deployments, growth, MEMBERS, workers):
                    campaigns[kind].append(deployment)
                    bar.advance(task, deployment.repeated)
        rows = [row for kind, campaign in campaigns.items() for row in as_rows(campaign, kind)]
        made_by = provenance("design", preset=args.preset, ground_tests=args.ground_tests)
        write_table(tables / FILE, rows, made_by)
        print(tables / FILE)
        for kind, campaign in campaigns.items():
            clearance, error = clearances_after(campaign, checked)
            listed = ", ".join(f"{1e6 * c:.3f} +- {1e6 * e:.3f}" for c, e in zip(clearance, error, strict=True))
            print(f"clearances after {checked} deployments, {kind}, {len(campaign)} of them simulated [µm]: {listed}")
    print(draw_ground_test(read_table(tables / FILE), pictures))
    return 0
