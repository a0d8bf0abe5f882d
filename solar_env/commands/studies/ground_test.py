"""`solar-env ground-test`: deployments repeated with the worn clearance fed back."""

from dataclasses import dataclass, replace

from rich.console import Console

from solar_env.array import ArrayParameters
from solar_env.commands.arguments import FolderOptions, WorkerOptions
from solar_env.support.files import make_folder
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES


@dataclass
class Args(FolderOptions, WorkerOptions):
    """Repeat deployments with the worn clearance fed back.

    With --readme the picture goes into the page of the study, the table into ./ground_test.
    """

    preset: str = "default"
    """parameter set: default or paper"""
    deployments: int = 100
    """of the campaign"""
    wear_coefficient: float = 1e-6
    """Archard's k [m2/N]; ten deployments at 1e-6 wear like 1e9 at 1e-14, the array's"""
    growth: float = 0.05
    """share of a clearance that may be worn before the next deployment is simulated"""
    members: int = 4
    """runs that stand for a deployment"""
    check: int | None = None
    """simulate so many directly, too; by default 10, or all"""


def run_command(args: Args) -> int:
    """Simulate the campaign, extrapolated and for a while directly, write the table and draw it."""
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.design.ground_test import FILE, Deployment, as_rows, clearances_after, wear_campaign
    from solar_env.studies.design.ground_test_plot import draw_ground_test

    out = args.folder("ground_test")
    check = min(10, args.deployments) if args.check is None else args.check
    if not 0 <= check <= args.deployments:
        raise ValueError(f"check = {check} must lie between 0 and the {args.deployments} deployments")
    parameters = replace(ArrayParameters.preset(args.preset), wear_coefficient=args.wear_coefficient)
    make_folder(out)
    pictures = make_folder(STUDIES / "design" / "figures" if args.readme else out)
    workers = args.workers
    campaigns: dict[str, list[Deployment]] = {}
    plans = {"extrapolated": (args.deployments, args.growth)} | ({"direct": (check, 0.0)} if check else {})
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
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
    write_table(out / FILE, rows, made_by)
    print(out / FILE)
    print(draw_ground_test(read_table(out / FILE), pictures))
    for kind, campaign in campaigns.items():
        after = check or args.deployments
        clearance, error = clearances_after(campaign, after)
        listed = ", ".join(f"{1e6 * c:.3f} +- {1e6 * e:.3f}" for c, e in zip(clearance, error, strict=True))
        print(f"clearances after {after} deployments, {kind}, {len(campaign)} of them simulated [µm]: {listed}")
    return 0
