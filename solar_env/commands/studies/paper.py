"""`solar-env study paper`: figures of the paper by Li, Wang and Huang (2019) drawn again, and its claims judged."""

from collections.abc import Iterable
from typing import Any

from solar_env.commands.study import Args
from solar_env.support.campaigns import each_done
from solar_env.support.files import write_text
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES, Section

OPTIONS = ("only", "out", "readme", "jobs")
FOLDER = STUDIES / "paper"
SECTION = Section(FOLDER / "README.md", "claims", "solar-env study paper --readme")


def run(args: Args) -> int:
    """Draw the figures of Li, Wang and Huang's paper (2019), judge its claims; --only: figure numbers.

    "--only 3" draws figure 3 and judges no claims. With --readme pictures and claims go into the study's folder with
    its page README.md, and tables into ./paper.
    """
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.paper.cases import CaseRun
    from solar_env.studies.paper.claims import CLAIMS
    from solar_env.studies.paper.figures import FIGURES
    from solar_env.studies.paper.survey import as_markdown, as_rows, judge, planned_runs, summary

    numbers = {str(number): figure for number, figure in FIGURES.items()}
    figures = [numbers[part] for part in args.parts(numbers)]
    if args.readme:
        SECTION.read()  # refuse a page without this section before simulating
    out, pictures = args.folders("paper", None, FOLDER / "figures")
    wanted = [] if args.only else planned_runs()
    shown = (CaseRun(case, member) for figure in figures for case in figure.cases for member in figure.members)
    motions = _simulate(args, (*wanted, *shown))
    with counting_bar(args.console) as bar:
        for figure in bar.track(figures, description="figures"):
            members = [{case: motions[CaseRun(case, member)] for case in figure.cases} for member in figure.members]
            table = out / f"{figure.stem}.csv"
            write_table(table, figure.table(members), provenance("paper", figure=figure.number, title=figure.title))
            figure.draw(read_table(table), pictures / f"{figure.stem}.png")
    if args.only:
        return 0
    findings = [judge(claim, motions) for claim in CLAIMS]
    claims = (FOLDER if args.readme else out) / "claims.csv"
    write_table(claims, as_rows(findings), provenance("solar-env study paper"))
    if args.readme:
        SECTION.write(as_markdown(findings))
    else:
        write_text(out / "claims.md", as_markdown(findings) + "\n")
    print(f"{summary(findings)} Tables, pictures and claims in {out}.")
    return 0


def _simulate(args: Args, runs: Iterable[Any]) -> dict[Any, Any]:
    """Simulate `runs`, a `CaseRun` for each deployment, under a progress bar; return each run's trajectory."""
    from solar_env.studies.paper.cases import simulate_run

    each = dict.fromkeys(runs)
    with counting_bar(args.console) as bar:
        return dict(bar.track(each_done(simulate_run, each, args.workers), len(each), description="deployments"))
