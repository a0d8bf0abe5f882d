"""`solar-env verify`: run the cases with known answers."""

import itertools
from dataclasses import dataclass
from pathlib import Path

from solar_env.array.methods import compilation_note
from solar_env.commands.arguments import QuietOption
from solar_env.mechanics.integrators.settings import INTEGRATORS
from solar_env.support.files import check_target, write_text
from solar_env.support.progress import counting_bar
from solar_env.support.terminal import wide_console
from solar_env.verification.report import make_table, to_json


@dataclass
class Args(QuietOption):
    """Run the cases with known answers."""

    only: str | None = None
    """run one case; a name that is none lists them"""
    json: Path | None = None
    """write the rows; - for standard output"""


def run_command(args: Args) -> int:
    """Run, print the table, write what was asked for; 1 if a row fails, else 0."""
    from solar_env.verification.suite import run, select

    names = select(args.only)
    to_standard_output = str(args.json) == "-"
    if args.json and not to_standard_output:
        check_target(args.json)
    begun, compiling = itertools.count(), compilation_note(INTEGRATORS)
    with counting_bar(args.console) as progress:
        task = progress.add_task("", total=len(names))

        def announce(name: str) -> None:
            done = next(begun)
            progress.update(task, completed=done, description=name if done else name + compiling)

        rows = run(args.only, announce)
    if to_standard_output:
        print(to_json(rows))
    else:
        wide_console().print(make_table(rows))
        if args.json:
            write_text(args.json, to_json(rows) + "\n")
    return 0 if all(row.passed for row in rows) else 1
