"""`solar-env study throughput`: environment steps per second, and what they cost."""

from solar_env.array import MODELS
from solar_env.commands.study import Args
from solar_env.support.files import write_text
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES, Section
from solar_env.support.terminal import print_markdown

OPTIONS = ("only", "quick", "out", "readme")
FILE = "throughput.md"
SECTION = Section(STUDIES / "throughput" / "README.md", "throughput", "solar-env study throughput --readme")


def run(args: Args) -> int:
    """Measure environment steps per second, by model; --quick compiles no kernels anew, which takes two minutes."""
    from solar_env.studies.throughput.rate_tables import tables
    from solar_env.studies.throughput.step_rates import measurements

    plan = measurements(args.parts(MODELS), cold=not args.quick)
    if args.readme:
        SECTION.read()  # refuses a page without a place before everything is measured
    else:
        folder, _ = args.folders("throughput")
    results = {}
    with counting_bar(args.console) as bar:
        task = bar.add_task("", total=len(plan))
        for key, measure in plan.items():
            bar.update(task, description=" ".join(map(str, key)))
            results[key] = measure()
            bar.advance(task)
    text = tables(results)
    print_markdown(text)
    if args.readme:
        SECTION.write(text)
    else:
        write_text(folder / FILE, text + "\n")
    return 0
