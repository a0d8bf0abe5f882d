"""`solar-env paper`: the paper, figure by figure and claim by claim."""

from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from rich.console import Console

from solar_env.commands.arguments import FolderOptions, WorkerOptions
from solar_env.support.campaigns import Campaign, each_done
from solar_env.support.files import make_folder, write_text
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES, Section
from solar_env.support.terminal import print_markdown

FOLDER = STUDIES / "paper"
SECTION = Section(FOLDER / "README.md", "claims", "solar-env paper --readme")
INDEX_SECTION = Section(FOLDER / "README.md", "index", "solar-env paper --readme")
IDENTIFY_SECTION = Section(FOLDER / "README.md", "identification", "solar-env paper --identify --readme")
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
    identify: bool = False
    """search what the paper leaves open for sets that meet all claims instead; an earlier run is gone on with"""
    json: bool = False
    """print the claims as JSON"""


def _run_levels(args: Args) -> int:
    """Measure the claims on flexible panels over mesh and damping."""
    from solar_env.studies.paper import levels

    out = args.folder("paper")
    if args.readme:
        LEVELS_SECTION.read()
    campaign = Campaign(levels.measure, list(levels.cells()), out / levels.STORE)
    _run(args, campaign, "deployments")
    return _tell(args, LEVELS_SECTION, out / "levels.md", levels.as_markdown(campaign.results()))


def _run(args: Args, campaign: Campaign, description: str) -> None:
    """Run what is missing of a campaign, with a progress bar."""
    left = len(campaign.missing)
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        list(bar.track(campaign.run(args.workers), left, description=description))


def _tell(args: Args, section: Section, path: Path, text: str) -> int:
    """Write a text into its section of the page, or without --readme to a file, and print it."""
    if args.readme:
        section.write(text)
    else:
        write_text(path, text + "\n")
    print_markdown(text)
    return 0


def _run_identification(args: Args) -> int:
    """Search what the paper leaves open, and draw what excludes what."""
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.paper.claims import CLAIMS
    from solar_env.studies.paper.identification import exclusions, report, search, stages
    from solar_env.studies.paper.identification.plot import draw_identification

    out = args.folder("paper")
    page = FOLDER if args.readme else out
    if args.readme:
        IDENTIFY_SECTION.read()

    found = stages.identify(out, partial(_run, args))
    met = search.met_matrix(found.rigid, search.RIGID_CLAIMS)
    best = [found.rigid[number] for number in exclusions.front(met)]
    tables = {
        "pairs": exclusions.pair_rows(met, search.RIGID_CLAIMS),
        "front": exclusions.set_rows(best, search.RIGID_CLAIMS),
        "shortlist": exclusions.set_rows(found.shortlist, CLAIMS, report.shortlist_names(found.shortlist)),
    }
    for name, rows in tables.items():
        write_table(page / f"identification-{name}.csv", rows, provenance("paper --identify", sets=len(met)))
    pairs, front = (read_table(page / f"identification-{name}.csv") for name in ("pairs", "front"))
    draw_identification(pairs, front, (FOLDER / "figures" if args.readme else out) / "identification.png")
    return _tell(args, IDENTIFY_SECTION, out / "identification.md", report.as_markdown(found))


def run_command(args: Args) -> int:
    """Simulate, write the tables, draw the figures, and judge the claims."""
    if ((args.levels or args.identify) and (args.figure or args.json)) or (args.levels and args.identify):
        raise ValueError("--levels and --identify stand alone; give neither --figure nor --json, and one of the two")
    if args.levels:
        return _run_levels(args)
    if args.identify:
        return _run_identification(args)
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.paper import index
    from solar_env.studies.paper.cases import CaseRun, simulate_run
    from solar_env.studies.paper.claims import CLAIMS
    from solar_env.studies.paper.drawings import draw_figure
    from solar_env.studies.paper.figures import FIGURES
    from solar_env.studies.paper.survey import as_json, as_markdown, judge, planned_runs, summary

    out = args.folder("paper")
    unknown = [number for number in args.figure if number not in FIGURES]
    if unknown:
        known = f"{min(FIGURES)} to {max(FIGURES)}"
        raise ValueError(f"the paper has no figure {unknown[0]} that is drawn here; choose from {known}")
    if args.figure and args.json:
        raise ValueError("--json prints the claims, which --figure leaves out; give one of the two")
    if args.readme:
        for section in (SECTION, INDEX_SECTION):  # refuse a page without a place before everything is simulated
            section.read()
    figures = [FIGURES[number] for number in args.figure or FIGURES]
    wanted = [] if args.figure else planned_runs()
    shown = (CaseRun(case, member) for figure in figures for case in figure.cases for member in figure.members)
    runs = dict.fromkeys([*wanted, *shown])
    pictures = FOLDER / "figures" if args.readme else out
    for folder in (pictures, out):
        make_folder(folder)
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        done = each_done(simulate_run, runs, args.workers)
        motions = dict(bar.track(done, len(runs), description="deployments"))
        for figure in bar.track(figures, description="figures"):
            members = [{case: motions[CaseRun(case, member)] for case in figure.cases} for member in figure.members]
            table = out / f"{figure.stem}.csv"
            write_table(table, figure.table(members), provenance("paper", figure=figure.number, title=figure.title))
            draw_figure(read_table(table), figure.kind, figure.heading, pictures / f"{figure.stem}.png")
    if args.figure:
        return 0
    findings = [judge(claim, motions) for claim in CLAIMS]
    text = as_json(findings)
    claims = FOLDER / "claims.json" if args.readme else out / "claims.json"
    write_text(claims, text + "\n")
    if args.readme:
        SECTION.write(as_markdown(findings))
        INDEX_SECTION.write(index.as_markdown())
    else:
        write_text(out / "claims.md", as_markdown(findings) + "\n")
    if args.json:
        print(text)
    else:
        print(f"{summary(findings)} Tables, pictures and claims in {out}.")
    return 0
