"""`solar-env ladder`: errors and costs of model levels, and the cheapest level that computes a result accurately."""

import math
from dataclasses import dataclass
from typing import Annotated

import tyro

from solar_env.array.ladder import PACKAGED_TABLE, QUESTIONS, Answer, cheapest, read_answers, steps
from solar_env.commands.arguments import FolderOptions, QuietOption
from solar_env.support.markdown import markdown_table
from solar_env.support.progress import print_markdown
from solar_env.support.readme import STUDIES, Section

SECTION = Section(STUDIES / "ladder" / "README.md", "ladder", "solar-env ladder --readme")


@dataclass
class Args(FolderOptions, QuietOption):
    """Name the cheapest accurate model level, or measure all levels.

    A level has rigid or flexible panels (of modes or elements), and ideal joints or clearances. With --readme the table
    of errors and costs goes into solar_env/array/data, where --ask and solar_env.cheapest_level look it up. The figure
    and a table of the best levels go into the study's page, solar_env/studies/ladder/README.md.
    """

    ask: Annotated[str | None, tyro.conf.arg(help=f"name the cheapest level for one of: {', '.join(QUESTIONS)}")] = None
    tolerance: float = 0.2
    """greatest error of that quantity, as a fraction"""


def run_command(args: Args) -> int:
    """Print the cheapest model level (fidelity) that computes the result `args.ask` to within `args.tolerance`.

    Without `args.ask`, measure the errors and costs of all levels, unless `args.draw` is set; tabulate and draw them.
    """
    if args.ask is not None:
        answer = cheapest(read_answers(), args.ask, args.tolerance)
        print(answer.level)
        args.console.print(
            f"measured with the default parameters: error {answer.error:.2g}, sampling {answer.half_width:.2g}, "
            f"{answer.cost_ratio:.2g} times the reference's cost"
        )
        return 0
    from solar_env.studies.ladder.campaign import FILE, FULL, measure_ladder
    from solar_env.studies.ladder.plot import draw_ladder

    tables, figures = args.folders("ladder", PACKAGED_TABLE.parent, STUDIES / "ladder" / "figures")
    if not args.draw:
        measure_ladder(FULL, tables / FILE, args.console)
    answers = read_answers(tables / FILE)
    table = choices(answers)
    print_markdown(table)
    if args.readme:
        SECTION.write(table)
    print(tables / FILE)
    print(draw_ladder(answers, figures))
    return 0


def choices(answers: tuple[Answer, ...]) -> str:
    """Return a Markdown table of model levels, cheapest first, with their relative wall times and errors.

    Each result that QUESTIONS names, such as "peak-force", has a column of errors; an `Answer` is about one level and
    result. Errors include the sampling error, and are rounded up to two digits. An entry is empty where another level
    is as accurate at no greater cost, and where the error may reach 100 %. Levels without any entry are left out.
    """
    told: dict[str, dict[str, Answer]] = {}
    for question in QUESTIONS:
        for answer in steps(answers, question):
            if answer.bound < 1.0:
                told.setdefault(answer.level, {})[question] = answer
    rows = []
    for level, found in sorted(told.items(), key=lambda item: max(answer.cost_ratio for answer in item[1].values())):
        cells = (_percent(found[question].bound) if question in found else "" for question in QUESTIONS)
        rows.append((f"`{level}`", f"{next(iter(found.values())).cost_ratio:.2g}", *cells))
    return markdown_table(("level", "wall time / reference's", *QUESTIONS), rows)


def _percent(tolerance: float) -> str:
    if tolerance == 0.0:
        return "0 %"
    step = 10.0 ** (math.floor(math.log10(tolerance)) - 1)
    return f"{100.0 * step * math.ceil(tolerance / step - 1e-9):.3g} %"
