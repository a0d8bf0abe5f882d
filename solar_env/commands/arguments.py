"""Command-line parsing into documented dataclasses by tyro, and options that several commands share."""

import ast
import contextlib
import dataclasses
import io
import re
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, TypeVar, get_type_hints

import tyro
from rich.console import Console

from solar_env.array import ParameterFile, read_parameters
from solar_env.array.parameters.file import named_array
from solar_env.support.files import make_folder

Arguments = TypeVar("Arguments")


@dataclasses.dataclass
class QuietOption:
    """Option that hides a command's progress."""

    quiet: bool = False
    """no progress bars"""

    @property
    def console(self) -> Console:
        """Console for a command's progress: standard error, or nowhere if `quiet`."""
        return Console(stderr=True, quiet=self.quiet)


@dataclasses.dataclass
class CommandRecord:
    """The command line as typed, which a command records in the files that it writes."""

    command: Annotated[str, tyro.conf.Suppress] = ""


@dataclasses.dataclass
class WorkerOptions(QuietOption):
    """Options for the number of processes of a command, and for its progress bars."""

    jobs: int | None = None
    """processes; by default one for each processor"""

    @property
    def workers(self) -> int:
        """Number of processes: `jobs`, or -1 (one per processor) if None. A `jobs` below 1 raises a ValueError."""
        if self.jobs is not None and self.jobs < 1:
            raise ValueError(f"jobs = {self.jobs!r} must be at least 1")
        return self.jobs or -1


@dataclasses.dataclass
class ArrayOption:
    """Option that selects the solar array for a command: a preset's name, or the path of a parameter file."""

    array: Annotated[str, tyro.conf.Positional] = "default"
    """default or paper: the array of Li, Wang and Huang (2019), with our choices or the paper's; cubesat-6u, apple (two
    wings, each of a yoke and a panel) or tape-spring, from published data; or a file of parameters (TOML), see
    solar-env parameters"""

    @property
    def parameter_file(self) -> ParameterFile:
        """Parameters and ranges of the array: read from the file `array` if it has a suffix, otherwise found by name.

        Raises:
            ValueError, OSError: no array has this name, or the file cannot be read or has refused content.
        """
        return read_parameters(self.array) if Path(self.array).suffix else named_array(self.array)


@dataclasses.dataclass
class FolderOptions:
    """Folders in which a study writes its tables and figures."""

    out: Path | None = None
    """folder of all files; by default a folder named after the study, in the working directory"""
    readme: bool = False
    """write into the study's page in the package instead"""
    draw: bool = False
    """measure nothing, draw the figures from the tables again"""

    def folders(self, name: str, tables: Path | None = None, figures: Path | None = None) -> tuple[Path, Path]:
        """Make and return a study's folders (tables, figures). Both are the option `out`, by default the path `name`.

        If the option `readme` is set, they are instead the arguments `tables` and `figures`, folders in the package; an
        argument None is replaced by the path `name`. With the option `draw` the folder of tables must already exist.

        Raises:
            ValueError: if both `out` and `readme` are given.
            FileNotFoundError: if `draw` is set and the folder of tables does not exist.
        """
        if self.readme and self.out is not None:
            raise ValueError("--readme writes into the page of the study: leave out --out, or --readme")
        out = self.out or Path(name)
        found = (tables or out, figures or out) if self.readme else (out, out)
        if self.draw and not found[0].is_dir():
            raise FileNotFoundError(f"there is no folder {found[0]} to draw from; measure first, without --draw")
        for folder in found:
            make_folder(folder)
        return found


def parse_assignments(pairs: Sequence[str]) -> dict[str, object]:
    """Turn `key=value` or `key:value` strings into a dictionary.

    Values are Python literals (`ast.literal_eval`), or true, false and null as in JSON; another bare word such as
    `rigid-ideal` is a string.

    Raises:
        ValueError: a pair has no key or no value, repeats a key, or has a value that is neither literal nor word.
    """
    result: dict[str, object] = {}
    for pair in pairs:
        match = re.fullmatch(r"\s*(\w+)\s*[=:]\s*(.+?)\s*", pair, re.DOTALL)
        if match is None:
            raise ValueError(f"cannot read {pair!r}; write key=value, for example torque_limit=0.3")
        key, text = match.groups()
        if key in result:
            raise ValueError(f"{key!r} is given twice; give it once")
        try:
            result[key] = ast.literal_eval(text)
        except (ValueError, SyntaxError):
            if not re.fullmatch(r"[A-Za-z][\w./-]*", text):
                raise ValueError(
                    f"the value of {key!r}, {text!r}, is neither a Python literal nor a plain word; "
                    "quote the pair for the shell, for example \"randomize={'clearance': (1e-4, 2e-4)}\""
                ) from None
            result[key] = {"true": True, "false": False, "null": None}.get(text, text)
    return result


_PAIRS: tyro.constructors.PrimitiveConstructorSpec[dict[str, object]] = tyro.constructors.PrimitiveConstructorSpec(
    nargs="*",
    metavar="[KEY=VALUE ...]",
    instance_from_str=parse_assignments,
    is_instance=lambda value: isinstance(value, dict),
    str_from_instance=lambda value: [f"{key}={item}" for key, item in value.items()],
)
Assignments = Annotated[dict[str, object], _PAIRS]
"""Type of a field that takes `key=value` pairs."""


def parse_arguments(cls: type[Arguments], argv: Sequence[str], prog: str | None = None) -> Arguments:
    """Parse `argv`, the words after the command `prog`, into the dataclass `cls`.

    A field `env_id` becomes `--env-id`, with the string below the field as help. A bool becomes a flag, a list takes
    any number of values, `Assignments` take `key=value` pairs. Wrong input prints one sentence and exits with status 2.
    """
    report = io.StringIO(_senseless(cls, argv))
    try:
        if report.getvalue():
            raise SystemExit(2)
        with contextlib.redirect_stderr(report):
            config = (tyro.conf.DisallowNone, tyro.conf.FlagCreatePairsOff)
            read = tyro.cli(cls, args=argv, prog=prog, config=config)
    except SystemExit as end:
        if end.code:
            print(f"error: {_first_sentence(report.getvalue())}; see --help", file=sys.stderr)
        raise
    if isinstance(read, CommandRecord):
        read.command = shlex.join([*(prog or "").split(), *argv])
    return read


def _senseless(cls: type, argv: Sequence[str]) -> str:
    """Return an error message for an empty value or repeated `key=value` option of `cls` (tyro accepts both), or ""."""
    hints = get_type_hints(cls, include_extras=True)
    pairs = {f"--{name.replace('_', '-')}" for name, kind in hints.items() if kind == Assignments}
    options = [word.partition("=")[0] for word in argv if word.startswith("--")]
    twice = [option for option in options if option in pairs and options.count(option) > 1]
    if "" in argv or any(f"{option}=" in argv for option in options):
        return "\na value is empty; give one, or leave it out"
    return f"\n{twice[0]} is given twice; give it once" if twice else ""


def _first_sentence(report: str) -> str:
    """Return the first paragraph of tyro's error report, without the title and the box (of Unicode or ASCII lines)."""
    lines = [line.strip("│╭╮╰╯ ") for line in report.splitlines()[1:]]
    text = "\n".join("" if set(line) <= set("─-") else line for line in lines)
    return " ".join(text.strip().split("\n\n")[0].split()).rstrip(".")
