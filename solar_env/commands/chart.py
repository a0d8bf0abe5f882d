"""`python -m solar_env chart`: speed against accuracy, measured into tables, drawn from the tables."""

import argparse
from pathlib import Path

from rich.console import Console

from solar_env.support.campaigns import Workers
from solar_env.support.readme import STUDIES as STUDY_FOLDER
from solar_env.support.readme import Section

FOLDER = STUDY_FOLDER / "precision"
# File that a study writes -> the section of the page that it goes into.
SECTIONS = {
    f"{name.replace(' ', '_')}.md": Section(FOLDER / "README.md", name, "python -m solar_env chart --readme")
    for name in ("side by side", "levels")
}
STUDIES = ("work-precision", "ensembles", "levels", "growth", "side-by-side")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs: under two minutes")
    parser.add_argument("--only", choices=STUDIES, help="one study instead of all")
    parser.add_argument("--draw", action="store_true", help="measure nothing, draw the figures from the tables again")
    parser.add_argument(
        "--jobs", type=int, default=1,
        help="processes for the ensembles (%(default)s); everything else is timed, run by run",
    )  # fmt: skip
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--out", type=Path, default=Path("chart"), help="folder of tables and figures (%(default)s)")
    where.add_argument(
        "--readme", action="store_true",
        help="tables, figures and their Markdown into the page of the study, solar_env/studies/precision",
    )  # fmt: skip


def run_command(args: argparse.Namespace) -> int:
    """Measure, write the tables, draw the figures."""
    from solar_env.studies.precision.charts import draw, measure_charts

    tables, figures = (FOLDER / "data", FOLDER / "figures") if args.readme else (args.out, args.out)
    names = (args.only,) if args.only else STUDIES
    if args.readme:
        for section in SECTIONS.values():
            section.read()  # refuses a page without a place before everything is measured
    if not args.draw:
        measure_charts(names, args.quick, tables, Console(stderr=True), Workers(args.jobs))
    for path in draw(names, tables, figures):
        print(path)
        if args.readme and path.suffix == ".md":
            SECTIONS[path.name].write(path.read_text(encoding="utf-8").strip())
            path.unlink()
    return 0
