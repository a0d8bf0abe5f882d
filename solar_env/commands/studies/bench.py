"""`solar-env bench`: environment steps per second, and what they cost."""

from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console

from solar_env.array import MODELS, check_model
from solar_env.commands.arguments import QuietOption
from solar_env.support.files import make_folder, write_text
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES, Section
from solar_env.support.terminal import print_markdown

FILE = "bench.md"
SECTION = Section(STUDIES / "throughput" / "README.md", "bench", "solar-env bench --readme")


@dataclass
class Args(QuietOption):
    """Measure environment steps per second, and what they cost."""

    models: list[str] = field(default_factory=lambda: list(MODELS))
    """models of the array"""
    quick: bool = False
    """leave out what compiles the kernels anew, which takes two minutes"""
    out: Path | None = None
    """folder to write the tables to"""
    readme: bool = False
    """tables into the page of the study"""


def run_command(args: Args) -> int:
    """Measure and print."""
    from solar_env.studies.throughput.rate_tables import tables
    from solar_env.studies.throughput.step_rates import measurements

    for model in args.models:
        check_model(model)
    if args.out is not None:
        make_folder(args.out)
    if args.readme:
        SECTION.read()  # refuses a page without a place before everything is measured
    console = Console(stderr=True, quiet=args.quiet)
    plan = measurements(args.models, cold=not args.quick)
    results = {}
    with counting_bar(console) as bar:
        task = bar.add_task("", total=len(plan))
        for key, measure in plan.items():
            bar.update(task, description=" ".join(map(str, key)))
            results[key] = measure()
            bar.advance(task)
    text = tables(results)
    print_markdown(text)
    if args.out is not None:
        write_text(args.out / FILE, text + "\n")
    if args.readme:
        SECTION.write(text)
    return 0
