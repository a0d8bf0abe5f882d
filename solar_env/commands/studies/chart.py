"""`solar-env chart`: speed against accuracy, measured into tables, drawn from the tables."""

from dataclasses import dataclass

from rich.console import Console

from solar_env.commands.arguments import FolderOptions, QuietOption, check_choice, check_measured
from solar_env.support.campaigns import Workers
from solar_env.support.files import make_folder
from solar_env.support.readme import STUDIES as STUDY_FOLDER
from solar_env.support.readme import Section

FOLDER = STUDY_FOLDER / "precision"
# File that a study writes -> the section of the page that it goes into.
SECTIONS = {
    f"{name.replace(' ', '_')}.md": Section(FOLDER / "README.md", name, "solar-env chart --readme")
    for name in ("side by side", "levels")
}
STUDIES = ("work-precision", "ensembles", "levels", "growth", "side-by-side")


@dataclass
class Args(FolderOptions, QuietOption):
    """Measure speed against accuracy, write tables, and draw the figures from the tables."""

    quick: bool = False
    """fewer and shorter runs: under two minutes"""
    only: str | None = None
    """one study instead of all: work-precision, ensembles, levels, growth or side-by-side"""
    draw: bool = False
    """measure nothing, draw the figures from the tables again"""
    jobs: int = 1
    """processes for the ensembles; everything else is timed, run by run"""


def run_command(args: Args) -> int:
    """Measure, write the tables, draw the figures."""
    from solar_env.studies.precision.charts import draw, measure_charts

    out = args.folder("chart")
    tables, figures = (FOLDER / "data", FOLDER / "figures") if args.readme else (out, out)
    names = (check_choice("study", args.only, STUDIES),) if args.only else STUDIES
    if args.readme:
        for section in SECTIONS.values():
            section.read()  # refuses a page without a place before everything is measured
    if args.draw:
        check_measured(tables)
    for folder in (tables, figures):
        make_folder(folder)
    if not args.draw:
        measure_charts(names, args.quick, tables, Console(stderr=True, quiet=args.quiet), Workers(args.jobs))
    for path in draw(names, tables, figures):
        print(path)
        if args.readme and path.suffix == ".md":
            SECTIONS[path.name].write(path.read_text(encoding="utf-8").strip())
            path.unlink()
    return 0
