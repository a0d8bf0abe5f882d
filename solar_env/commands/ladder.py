"""`solar-env ladder`: the cheapest model level that answers a question, measured."""

from dataclasses import dataclass

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from solar_env.array.ladder import PACKAGED_TABLE, QUESTIONS, Answer, read_answers, steps
from solar_env.commands.arguments import FolderOptions, QuietOption
from solar_env.support.files import make_folder
from solar_env.support.readme import STUDIES


@dataclass
class Args(FolderOptions, QuietOption):
    """Measure which level of the model answers which question, and at what cost.

    With --readme the table goes into solar_env/array/data, where simulate --question, loads and model='auto' look it
    up, the figure into the page of the study.
    """

    quick: bool = False
    """few runs of few levels: under two minutes"""
    draw: bool = False
    """measure nothing, draw the figure from the table again"""


def run_command(args: Args) -> int:
    """Measure, write the table, draw the figure, and print the cheapest level by question and tolerance."""
    from solar_env.studies.ladder.campaign import FILE, measure_ladder
    from solar_env.studies.ladder.plot import draw_ladder

    out = args.folder("ladder")
    tables, figures = (PACKAGED_TABLE.parent, STUDIES / "ladder" / "figures") if args.readme else (out, out)
    for folder in (tables, figures):
        make_folder(folder)
    if not args.draw:
        measure_ladder(args.quick, tables, Console(stderr=True, quiet=args.quiet))
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
