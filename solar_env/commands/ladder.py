"""`solar-env ladder`: the cheapest model level that answers a question, measured."""

import math
from dataclasses import dataclass

from solar_env.array.ladder import PACKAGED_TABLE, QUESTIONS, Answer, read_answers, steps
from solar_env.commands.arguments import FolderOptions, QuietOption
from solar_env.support.markdown import markdown_table
from solar_env.support.readme import STUDIES, Section
from solar_env.support.terminal import print_markdown

SECTION = Section(STUDIES / "ladder" / "README.md", "ladder", "solar-env ladder --readme")


@dataclass
class Args(FolderOptions, QuietOption):
    """Measure which level of the model answers which question.

    With --readme the table goes into solar_env/array/data, where simulate --question, loads and model='auto' look it
    up, the figure and the levels chosen into the page of the study.
    """

    quick: bool = False
    """few runs of few levels: under two minutes"""


def run_command(args: Args) -> int:
    """Measure, write the table, draw the figure, and print the cheapest level by question and tolerance."""
    from solar_env.studies.ladder.campaign import FILE, measure_ladder
    from solar_env.studies.ladder.plot import draw_ladder

    tables, figures = args.folders("ladder", PACKAGED_TABLE.parent, STUDIES / "ladder" / "figures")
    if not args.draw:
        measure_ladder(args.quick, tables, args.console)
    answers = read_answers(tables / FILE)
    table = choices(answers)
    print_markdown(table)
    if args.readme:
        SECTION.write(table)
    print(tables / FILE)
    print(draw_ladder(answers, figures))
    return 0


def choices(answers: tuple[Answer, ...]) -> str:
    """The cheapest level of every question from a tolerance on, as a table in Markdown.

    Tolerances are the errors of the levels, sampling included, rounded up to two digits. Levels whose error may be as
    large as the answer are left out.
    """
    rows = []
    for question in QUESTIONS:
        telling = [answer for answer in reversed(steps(answers, question)) if answer.bound < 1.0]
        for count, answer in enumerate(telling):
            level = f"`{answer.model}`" + (f", {answer.panel_model.size}" if answer.panels else "")
            rows.append(("" if count else question, _percent(answer.bound), level, f"{answer.cost_ratio:.2g}"))
    return markdown_table(("question", "tolerance", "cheapest level", "wall time over the reference's"), rows)


def _percent(tolerance: float) -> str:
    if tolerance == 0.0:
        return "0 %"
    step = 10.0 ** (math.floor(math.log10(tolerance)) - 1)
    return f"{100.0 * step * math.ceil(tolerance / step - 1e-9):.3g} %"
