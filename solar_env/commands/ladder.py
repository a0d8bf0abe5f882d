"""`python -m solar_env ladder`: the cheapest model level that answers a question, measured."""

import argparse
from pathlib import Path

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from solar_env.array.ladder import PACKAGED_TABLE, QUESTIONS, Answer, read_answers, steps
from solar_env.support.readme import STUDIES


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--quick", action="store_true", help="few runs of few levels: under two minutes")
    parser.add_argument("--draw", action="store_true", help="measure nothing, draw the figure from the table again")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--out", type=Path, default=Path("ladder"), help="folder of table and figure (%(default)s)")
    where.add_argument(
        "--readme", action="store_true",
        help="table into solar_env/array/data, where simulate --question and model='auto' look it up, figure into "
        "the page of the study, solar_env/studies/ladder",
    )  # fmt: skip


def run_command(args: argparse.Namespace) -> int:
    """Measure, write the table, draw the figure, and print the cheapest level by question and tolerance."""
    from solar_env.studies.ladder.campaign import FILE, measure_ladder
    from solar_env.studies.ladder.plot import draw_ladder

    tables, figures = (PACKAGED_TABLE.parent, STUDIES / "ladder" / "figures") if args.readme else (args.out, args.out)
    if not args.draw:
        measure_ladder(args.quick, tables, Console(stderr=True))
    answers = read_answers(tables / FILE)
    _print_choices(answers)
    print(tables / FILE)
    print(draw_ladder(answers, figures))
    return 0


def _print_choices(answers: tuple[Answer, ...]) -> None:
    table = Table("question", "from", "level", "cost", box=SIMPLE)
    table.title = "the cheapest level from a tolerance on; cost over the reference's"
    for question in QUESTIONS:
        for answer in steps(answers, question):
            table.add_row(question, f"{answer.bound:.2g}", answer.level, f"{answer.cost_ratio:.2g}")
        table.add_section()
    Console().print(table)
