"""`solar-env study throughput`: environment steps per second, and the fraction of the time in compiled calls."""

from solar_env.array import MODELS
from solar_env.commands.study import Args
from solar_env.support.files import write_text
from solar_env.support.progress import counting_bar, print_markdown
from solar_env.support.readme import STUDIES, Section

OPTIONS = ("only", "out", "readme")
FILE = "throughput.md"
SECTION = Section(STUDIES / "throughput" / "README.md", "throughput", "solar-env study throughput --readme")


def run(args: Args) -> int:
    """Measure environment steps per second, by model."""
    from solar_env.studies.throughput.step_rates import as_markdown, measurements

    models = args.parts(MODELS)
    if args.readme:
        SECTION.read()  # refuses a page without this section before measuring
    else:
        folder, _ = args.folders("throughput")
    figures: dict[str, dict[str, float]] = {model: {} for model in models}
    plan = measurements(models)
    with counting_bar(args.console) as bar:
        for model, measure in bar.track(plan, description="step rates"):
            figures[model] |= measure()
    text = as_markdown(figures)
    print_markdown(text)
    if args.readme:
        SECTION.write(text)
    else:
        write_text(folder / FILE, text + "\n")
    return 0
