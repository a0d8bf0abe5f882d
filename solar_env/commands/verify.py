"""`solar-env verify`: run the verification cases, whose answers are known."""

from dataclasses import dataclass
from pathlib import Path

from solar_env.array import compilation_note
from solar_env.commands.arguments import QuietOption
from solar_env.mechanics.integrators.settings import INTEGRATORS
from solar_env.support.files import check_target, write_text
from solar_env.support.progress import counting_bar, wide_console
from solar_env.verification.checks import make_table, to_json


@dataclass
class Args(QuietOption):
    """Run the cases with known answers."""

    only: str | None = None
    """case to run; an unknown name lists all cases"""
    json: Path | None = None
    """write the checks as JSON; - for standard output"""


def run_command(args: Args) -> int:
    """Run the cases, print the checks, and write them if requested; return 1 if a check fails, otherwise 0."""
    from solar_env.verification.suite import CASES, run

    names = [args.only] if args.only else list(CASES)
    to_standard_output = str(args.json) == "-"
    if args.json and not to_standard_output:
        check_target(args.json)
    checks, note = [], compilation_note(INTEGRATORS)
    with counting_bar(args.console) as progress:
        task = progress.add_task("", total=len(names))
        for number, name in enumerate(names):
            progress.update(task, completed=number, description=name if number else name + note)
            checks += run(name)
    if to_standard_output:
        print(to_json(checks))
    else:
        wide_console().print(make_table(checks))
        if args.json:
            write_text(args.json, to_json(checks) + "\n")
    return 0 if all(check.passed for check in checks) else 1
