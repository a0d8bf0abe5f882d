"""`solar-env paper`: the paper, figure by figure and claim by claim."""

from dataclasses import dataclass, field

from rich.console import Console

from solar_env.commands.arguments import FolderOptions, WorkerOptions
from solar_env.support.campaigns import each_done
from solar_env.support.files import make_folder, write_text
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES, Section
from solar_env.support.terminal import print_markdown

FOLDER = STUDIES / "paper"
SECTION = Section(FOLDER / "README.md", "claims", "solar-env paper --readme")
INDEX_SECTION = Section(FOLDER / "README.md", "index", "solar-env paper --readme")
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
    json: bool = False
    """print the claims as JSON"""


def _run_levels(args: Args) -> int:
    """Measure the claims on flexible panels over mesh and damping."""
    from solar_env.studies.paper import levels
    from solar_env.support.campaigns import Campaign

    out = args.folder("paper")
    if args.readme:
        LEVELS_SECTION.read()
    campaign = Campaign(levels.measure, list(levels.cells()), out / levels.STORE)
    left = len(campaign.missing)
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        list(bar.track(campaign.run(args.workers), left, description="deployments"))
    text = levels.as_markdown(campaign.results())
    if args.readme:
        LEVELS_SECTION.write(text)
    else:
        write_text(out / "levels.md", text + "\n")
    print_markdown(text)
    return 0


def run_command(args: Args) -> int:
    """Simulate, write the tables, draw the figures, and judge the claims."""
    if args.levels:
        if args.figure or args.json:
            raise ValueError("--levels judges claims on flexible panels alone; give neither --figure nor --json")
        return _run_levels(args)
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.paper import index
    from solar_env.studies.paper.cases import Run, simulate_run
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
    runs = dict.fromkeys([*wanted, *(Run(case) for figure in figures for case in figure.cases)])
    pictures = FOLDER / "figures" if args.readme else out
    for folder in (pictures, out):
        make_folder(folder)
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        done = each_done(simulate_run, runs, args.workers)
        motions = dict(bar.track(done, len(runs), description="deployments"))
        first = {run.case: motion for run, motion in motions.items() if run.member == 0 and not run.parameter}
        for figure in bar.track(figures, description="figures"):
            table = out / f"{figure.stem}.csv"
            write_table(table, figure.rows(first), provenance("paper", figure=figure.number, title=figure.title))
            title = f"Fig. {figure.number}: {figure.title}"
            draw_figure(read_table(table), figure.kind, title, pictures / f"{figure.stem}.png")
    if args.figure:
        return 0
    findings = [judge(claim, motions) for claim in CLAIMS]
    text = as_json(findings)
    claims = FOLDER / "claims.json" if args.readme else out / "claims.json"
    write_text(claims, text + "\n")
    if args.readme:
        SECTION.write(as_markdown(findings).rstrip("\n"))
        INDEX_SECTION.write(index.as_markdown())
    else:
        write_text(out / "claims.md", as_markdown(findings))
    if args.json:
        print(text)
    else:
        print(f"{summary(findings)} Tables, pictures and claims in {out}.")
    return 0
