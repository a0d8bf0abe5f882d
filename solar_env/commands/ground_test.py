"""`python -m solar_env ground-test`: deployments repeated with the worn clearance fed back."""

import argparse
from dataclasses import replace
from pathlib import Path

from rich.console import Console

from solar_env.array import PRESETS, ArrayParameters
from solar_env.commands._workers import add_worker_arguments
from solar_env.support.campaigns import Workers
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--preset", choices=sorted(PRESETS), default="default", help="parameters (%(default)s)")
    parser.add_argument("--deployments", type=int, default=100, help="of the campaign (%(default)s)")
    parser.add_argument(
        "--wear-coefficient", type=float, default=1e-6,
        help="Archard's k [m2/N]; ten deployments at 1e-6 wear like 1e9 at 1e-14, the array's (%(default)g)",
    )  # fmt: skip
    parser.add_argument(
        "--growth", type=float, default=0.05,
        help="share of a clearance that may be worn before the next deployment is simulated (%(default)s)",
    )  # fmt: skip
    parser.add_argument("--members", type=int, default=4, help="runs that stand for a deployment (%(default)s)")
    parser.add_argument("--check", type=int, help="simulate so many directly, too (10, or all)")
    add_worker_arguments(parser)
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--out", type=Path, default=Path("ground_test"), help="folder of all files (%(default)s)")
    where.add_argument(
        "--readme",
        action="store_true",
        help="picture into the page of the study, solar_env/studies/design, table into ./ground_test",
    )


def run_command(args: argparse.Namespace) -> int:
    """Simulate the campaign, extrapolated and for a while directly, write the table and draw it."""
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.design.ground_test import FILE, Deployment, as_rows, clearances_after, wear_campaign
    from solar_env.studies.design.ground_test_plot import draw_ground_test

    check = min(10, args.deployments) if args.check is None else args.check
    if not 0 <= check <= args.deployments:
        raise ValueError(f"check = {check} must lie between 0 and the {args.deployments} deployments")
    parameters = replace(ArrayParameters.preset(args.preset), wear_coefficient=args.wear_coefficient)
    workers = Workers(args.jobs, args.cluster)
    campaigns: dict[str, list[Deployment]] = {}
    plans = {"extrapolated": (args.deployments, args.growth)} | ({"direct": (check, 0.0)} if check else {})
    with counting_bar(Console(stderr=True)) as bar:
        for kind, (deployments, growth) in plans.items():
            task = bar.add_task(f"{kind} deployments", total=deployments)
            campaigns[kind] = []
            for deployment in wear_campaign(parameters, deployments, growth, args.members, workers):
                campaigns[kind].append(deployment)
                bar.advance(task, deployment.repeated)
    rows = [row for kind, campaign in campaigns.items() for row in as_rows(campaign, kind)]
    made_by = provenance(
        "ground-test", preset=args.preset, wear_coefficient=args.wear_coefficient, deployments=args.deployments,
        growth=args.growth, members=args.members, check=check,
    )  # fmt: skip
    write_table(args.out / FILE, rows, made_by)
    print(args.out / FILE)
    print(draw_ground_test(read_table(args.out / FILE), STUDIES / "design" / "figures" if args.readme else args.out))
    for kind, campaign in campaigns.items():
        after = check or args.deployments
        clearance, error = clearances_after(campaign, after)
        listed = ", ".join(f"{1e6 * c:.3f} +- {1e6 * e:.3f}" for c, e in zip(clearance, error, strict=True))
        print(f"clearances after {after} deployments, {kind}, {len(campaign)} of them simulated [µm]: {listed}")
    return 0
