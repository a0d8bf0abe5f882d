"""`solar-env study precision`: measured speed and accuracy of integrators and panel models, as tables and figures."""

from solar_env.commands.study import Args
from solar_env.support.readme import STUDIES, Section

OPTIONS = ("only", "quick", "draw", "out", "readme")
FOLDER = STUDIES / "precision"
# Text file that a part of the study writes -> section of the page for that text.
SECTIONS = {
    f"{name.replace(' ', '_')}.md": Section(FOLDER / "README.md", name, "solar-env study precision --readme")
    for name in ("work precision", "convergence", "side by side")
}


def run(args: Args) -> int:
    """Measure speed and accuracy of integrators and panel models, and of Exudyn for comparison, one run at a time.

    The parts are "work-precision" (integrators), "convergence" (panels) and "side-by-side" (with the program Exudyn).
    """
    from solar_env.studies.precision import charts

    names = args.parts(charts.STUDIES)
    if args.readme:
        for section in SECTIONS.values():
            section.read()  # refuses a page without this section before measuring
    tables, figures = args.folders("precision", FOLDER / "data", FOLDER / "figures")
    if not args.draw:
        charts.measure_charts(names, args.quick, tables, args.console)
    for path in charts.draw(names, tables, figures):
        print(path)
        if args.readme and path.suffix == ".md":
            SECTIONS[path.name].write(path.read_text(encoding="utf-8").strip())
            path.unlink()
    return 0
