"""`python -m solar_env bench`: environment steps per second, and what they cost."""

import argparse
from pathlib import Path

from rich.console import Console

from solar_env.array import MODELS
from solar_env.support.progress import counting_bar
from solar_env.support.readme import STUDIES, Section

FILE = "bench.md"
SECTION = Section(STUDIES / "throughput" / "README.md", "bench", "python -m solar_env bench --readme")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--models", nargs="+", choices=MODELS, default=list(MODELS), help="models (all)")
    parser.add_argument(
        "--quick", action="store_true", help="leave out what compiles the kernels anew, which takes two minutes"
    )
    parser.add_argument("--out", type=Path, help="folder to write the tables to")
    parser.add_argument("--readme", action="store_true", help="tables into the page of the study")


def run_command(args: argparse.Namespace) -> int:
    """Measure and print."""
    from solar_env.studies.throughput.rate_tables import tables
    from solar_env.studies.throughput.step_rates import measurements

    if args.readme:
        SECTION.read()  # refuses a page without a place before everything is measured
    console = Console(stderr=True)
    plan = measurements(args.models, cold=not args.quick)
    results = {}
    with counting_bar(console) as bar:
        task = bar.add_task("", total=len(plan))
        for key, measure in plan.items():
            bar.update(task, description=" ".join(map(str, key)))
            results[key] = measure()
            bar.advance(task)
    text = tables(results)
    print(text)
    if args.out is not None:
        args.out.mkdir(parents=True, exist_ok=True)
        (args.out / FILE).write_text(text + "\n", encoding="utf-8")
    if args.readme:
        SECTION.write(text)
    return 0
