"""`solar-env study paper`: figures of the paper by Li, Wang and Huang (2019) drawn again, and its claims judged."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from solar_env.commands.study import Args
from solar_env.support.campaigns import each_done
from solar_env.support.files import write_text
from solar_env.support.progress import counting_bar, print_markdown
from solar_env.support.readme import STUDIES, Section

OPTIONS = ("only", "out", "readme", "jobs")
FOLDER = STUDIES / "paper"
SECTION = Section(FOLDER / "README.md", "claims", "solar-env study paper --readme")


def run(args: Args) -> int:
    """Draw the figures of the paper, and judge its claims; --only: numbers of figures, without claims, or a set's name.

    The paper is by Li, Wang and Huang (2019). "--only 3" draws figure 3 and judges no claims. A set is a named choice
    of the parameter values that the paper leaves open; with its name, the claims are judged for these values. With
    --readme pictures and claims go into the page, tables into ./paper.
    """
    from solar_env.studies.paper.sets import found_sets

    sets = found_sets()
    if len(args.only) == 1 and args.only[0] in sets:
        return _judge_set(args, args.only[0], sets[args.only[0]])
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.paper.cases import CaseRun
    from solar_env.studies.paper.claims import CLAIMS
    from solar_env.studies.paper.figures import FIGURES
    from solar_env.studies.paper.survey import as_markdown, as_rows, judge, planned_runs, summary

    numbers = {str(number): figure for number, figure in FIGURES.items()}
    figures = [numbers[part] for part in args.parts([*numbers, *sets]) if part in numbers]
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


def _judge_set(args: Args, name: str, changes: Any) -> int:
    """Judge the paper's claims with the parameter values `changes` of the set `name`; write and print the result."""
    from solar_env.studies.common.tables import provenance, write_table
    from solar_env.studies.paper.claims import CLAIMS
    from solar_env.studies.paper.survey import as_markdown, as_rows, judge, planned_runs, summary

    if args.readme:
        raise ValueError(f"--only {name!r} has no place on the page; leave out --readme")
    # The stated reasons for differences from the claims hold for the preset alone.
    claims = [replace(claim, open_parameters=(), why="") for claim in CLAIMS]
    runs = [replace(run, changes=changes) for run in planned_runs(claims)]
    motions = {replace(run, changes=()): motion for run, motion in _simulate(args, runs).items()}
    findings = [judge(claim, motions) for claim in claims]
    out, _ = args.folders("paper")
    made_by = provenance(f"solar-env study paper --only '{name}'")
    write_table(out / f"claims-{name.replace(' ', '-')}.csv", as_rows(findings), made_by)
    print_markdown(f"{summary(findings)}\n\n{as_markdown(findings)}")
    return 0
