"""`solar-env study`: repeat a study that a documentation page describes, and draw its figures.

A study is a module with a function `run(args) -> int` and with `OPTIONS`, which names the fields of `Args` that the
study takes beside `name` and `quiet`. `[project.entry-points."solar_env.studies"]` in pyproject.toml lists the studies.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Annotated

import tyro

from solar_env.commands import table
from solar_env.commands.arguments import CommandRecord, FolderOptions, WorkerOptions
from solar_env.support.values import check_name

_NAMES = "\n".join(f"{name}: {summary}" for name, summary in table.summaries(table.STUDIES, "run").items())


@dataclass
class Args(FolderOptions, WorkerOptions, CommandRecord):
    """Repeat a documentation page's study, and draw its figures."""

    name: Annotated[str, tyro.conf.Positional, tyro.conf.arg(help=_NAMES)] = ""
    only: list[str] = field(default_factory=list)
    """parts of the study to run; an unknown name lists all parts"""
    quick: bool = False
    """fewer and shorter runs"""

    def parts(self, known: Iterable[str]) -> list[str]:
        """Return the parts of the study that `--only` names, or all `known` parts without `--only`.

        Raises:
            ValueError: if a part is not known; the message names the closest known parts.
        """
        names = list(known)
        for part in self.only:
            check_name(f"part of the study {self.name}", part, names)
        return self.only or names


def run_command(args: Args) -> int:
    """Run the named study; an option that the study does not take raises a ValueError."""
    study = table.load(table.STUDIES, args.name)
    usual = Args(name=args.name, quiet=args.quiet, command=args.command)
    for option, value in vars(args).items():
        if option not in study.OPTIONS and value != getattr(usual, option):
            taken = ", ".join(f"--{name}" for name in study.OPTIONS)
            raise ValueError(f"study {args.name} takes no --{option}; it takes {taken}")
    status: int = study.run(args)
    return status
