"""`solar-env paper`: the paper, figure by figure and claim by claim."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from rich.console import Console

from solar_env.commands.arguments import FolderOptions, WorkerOptions
from solar_env.support.campaigns import Campaign, each_done
from solar_env.support.files import make_folder, write_text
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES, Section
from solar_env.support.terminal import print_markdown

FOLDER = STUDIES / "paper"
SECTION = Section(FOLDER / "README.md", "claims", "solar-env paper --readme")
LEVELS_SECTION = Section(FOLDER / "README.md", "levels", "solar-env paper --levels --readme")


@dataclass
class Args(FolderOptions, WorkerOptions):
    """Draw the figures of the paper, and judge what it says.

    With --readme pictures and claims go into the page of the study, tables into ./paper.
    """

    figure: list[int] = field(default_factory=list)
    """these figures of the paper (5 to 23), without the claims"""
    levels: bool = False
    """judge the claims on flexible panels over mesh and damping instead; what is there of an earlier run is kept"""
    set: str | None = None
    """judge the claims for another set of what the paper leaves open instead; a name that is none lists them"""


def run_command(args: Args) -> int:
    """Simulate, write the tables, draw the figures, and judge the claims."""
    if (args.levels + (args.set is not None) + bool(args.figure)) > 1:
        raise ValueError("--figure, --levels and --set exclude each other; give one of them")
    if args.levels:
        return _judge_levels(args)
    if args.set is not None:
        return _judge_set(args, args.set)
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.paper.cases import CaseRun
    from solar_env.studies.paper.claims import CLAIMS
    from solar_env.studies.paper.drawings import draw_figure
    from solar_env.studies.paper.figures import FIGURES
    from solar_env.studies.paper.survey import as_json, as_markdown, judge, planned_runs, summary

    out = args.folder("paper")
    unknown = [number for number in args.figure if number not in FIGURES]
    if unknown:
        known = f"{min(FIGURES)} to {max(FIGURES)}"
        raise ValueError(f"the paper has no figure {unknown[0]} that is drawn here; choose from {known}")
    if args.readme:
        SECTION.read()  # refuse a page without a place before everything is simulated
    figures = [FIGURES[number] for number in args.figure or FIGURES]
    wanted = [] if args.figure else planned_runs()
    pictures = FOLDER / "figures" if args.readme else out
    for folder in (pictures, out):
        make_folder(folder)
    shown = (CaseRun(case, member) for figure in figures for case in figure.cases for member in figure.members)
    motions = _simulate(args, (*wanted, *shown))
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        for figure in bar.track(figures, description="figures"):
            members = [{case: motions[CaseRun(case, member)] for case in figure.cases} for member in figure.members]
            table = out / f"{figure.stem}.csv"
            write_table(table, figure.table(members), provenance("paper", figure=figure.number, title=figure.title))
            draw_figure(read_table(table), figure.kind, figure.heading, pictures / f"{figure.stem}.png")
    if args.figure:
        return 0
    findings = [judge(claim, motions) for claim in CLAIMS]
    write_text((FOLDER if args.readme else out) / "claims.json", as_json(findings) + "\n")
    if args.readme:
        SECTION.write(as_markdown(findings))
    else:
        write_text(out / "claims.md", as_markdown(findings) + "\n")
    print(f"{summary(findings)} Tables, pictures and claims in {out}.")
    return 0


def _simulate(args: Args, runs: Iterable[Any]) -> dict[Any, Any]:
    """Motions of the runs of cases, with a progress bar."""
    from solar_env.studies.paper.cases import simulate_run

    each = dict.fromkeys(runs)
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        return dict(bar.track(each_done(simulate_run, each, args.workers), len(each), description="deployments"))


def _judge_set(args: Args, name: str) -> int:
    """Judge the claims for a set of what the paper leaves open."""
    from solar_env.studies.paper.claims import CLAIMS
    from solar_env.studies.paper.sets import found_set
    from solar_env.studies.paper.survey import as_json, as_markdown, judge, planned_runs

    if args.readme:
        raise ValueError("--set NAME has no place on the page; leave out --readme")
    changes = found_set(name)
    # Reasons for what differs are those of the preset.
    claims = [replace(claim, open_parameters=(), why="") for claim in CLAIMS]
    runs = [replace(run, changes=changes) for run in planned_runs(claims)]
    motions = {replace(run, changes=()): motion for run, motion in _simulate(args, runs).items()}
    findings = [judge(claim, motions) for claim in claims]
    out = args.folder("paper")
    make_folder(out)
    write_text(out / f"claims-{name.replace(' ', '-')}.json", as_json(findings) + "\n")
    print_markdown(as_markdown(findings))
    return 0


def _judge_levels(args: Args) -> int:
    """Judge the claims on flexible panels over mesh and damping."""
    from solar_env.studies.paper import levels

    out = args.folder("paper")
    if args.readme:
        LEVELS_SECTION.read()
    campaign = Campaign(levels.measure, list(levels.cells()), out / levels.STORE)
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        list(bar.track(campaign.run(args.workers), len(campaign.missing), description="deployments"))
    text = levels.as_markdown(campaign.results())
    if args.readme:
        LEVELS_SECTION.write(text)
    else:
        write_text(out / "levels.md", text + "\n")
    print_markdown(text)
    return 0
