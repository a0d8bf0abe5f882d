"""Command lines from documented dataclasses, by tyro."""

import ast
import contextlib
import dataclasses
import io
import re
import shlex
import sys
from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_origin, get_type_hints

import tyro

from solar_env.array.names import unknown_name
from solar_env.support.campaigns import Workers

Arguments = TypeVar("Arguments")


@dataclasses.dataclass
class QuietOption:
    """Whether a command shows what it is at."""

    quiet: bool = False
    """no progress bars"""


@dataclasses.dataclass
class CommandRecord:
    """The command as it was typed, for the record of what it writes."""

    command: Annotated[str, tyro.conf.Suppress] = ""


def parse_assignments(pairs: Sequence[str]) -> dict[str, Any]:
    """Turn `key=value` or `key:value` strings into a dictionary.

    Values are Python literals (`ast.literal_eval`), or true, false and null as in files; another bare word such as
    `rigid-ideal` is a string.

    Raises:
        ValueError: A pair has no key or no value, repeats a key, or has a value that is neither.
    """
    result: dict[str, Any] = {}
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


_PAIRS: tyro.constructors.PrimitiveConstructorSpec[dict[str, Any]] = tyro.constructors.PrimitiveConstructorSpec(
    nargs="*",
    metavar="[KEY=VALUE ...]",
    instance_from_str=parse_assignments,
    is_instance=lambda value: isinstance(value, dict),
    str_from_instance=lambda value: [f"{key}={item}" for key, item in value.items()],
)
Assignments = Annotated[dict[str, Any], _PAIRS]
"""Type of a field that takes `key=value` pairs, also when its option is repeated."""


@dataclasses.dataclass
class WorkerOptions(QuietOption):
    """Processes that a command runs on, and its progress bars."""

    jobs: int | None = None
    """processes; by default one for each processor"""

    @property
    def workers(self) -> Workers:
        """The processes.

        Raises:
            ValueError: Their number is not positive.
        """
        return Workers(self.jobs)


def parse_arguments(cls: type[Arguments], argv: Sequence[str], prog: str | None = None) -> Arguments:
    """Fill the dataclass `cls` from `argv`, the words behind the command `prog`.

    Field `env_id` becomes `--env-id`, its help is the string literal below it; a bool becomes a flag, a list takes any
    number of values, `Assignments` take `key=value` pairs. Wrong input ends the process with one sentence and status 2.
    """
    fields = dataclasses.fields(cls)  # type: ignore[arg-type]
    repeatable = {f"--{field.name.replace('_', '-')}" for field in fields if field.type is Assignments}
    _refuse_empty_words(argv)
    _refuse_empty_lists(cls, argv)
    words = _gathered(argv, repeatable)
    report = io.StringIO()
    try:
        with contextlib.redirect_stderr(report):
            config = (tyro.conf.DisallowNone, tyro.conf.FlagCreatePairsOff)
            read = tyro.cli(_with_plain_defaults(cls), args=words, prog=prog, config=config)
        values = {field.name: getattr(read, field.name) for field in fields}
        if issubclass(cls, CommandRecord):
            values["command"] = shlex.join([*(prog or "").split(), *argv])
        return cls(**values)
    except SystemExit as end:
        if end.code:
            print(f"error: {_first_sentence(report.getvalue())}; see --help", file=sys.stderr)
        raise


def _refuse_empty_words(argv: Sequence[str]) -> None:
    """End the process where a value is empty, as of a variable of the shell that is not set."""
    of = ""
    for word in argv:
        if word.startswith("--"):
            of = f" of {word.partition('=')[0]}"
        if not word or re.fullmatch(r"--[\w-]+=", word):
            print(f"error: a value{of} is empty; give one, or leave it out", file=sys.stderr)
            raise SystemExit(2)


def _refuse_empty_lists(cls: type[Any], argv: Sequence[str]) -> None:
    """End the process where the option of a list is given without a value, which would be nothing to do."""
    lists = {f"--{name.replace('_', '-')}" for name, kind in get_type_hints(cls).items() if get_origin(kind) is list}
    for word, following in pairwise([*argv, "--"]):
        if word in lists and "--help" not in argv and following.startswith("--"):
            print(
                f"error: {word} is given without a value; give at least one, or leave it out; see --help",
                file=sys.stderr,
            )
            raise SystemExit(2)


def _with_plain_defaults(cls: type[Any]) -> type[Any]:
    """A dataclass like `cls` whose help shows defaults in parentheses, and none where there is none."""
    body: dict[str, Any] = {"__doc__": cls.__doc__, "__module__": cls.__module__, "__annotations__": {}}
    hints = get_type_hints(cls, include_extras=True)
    for field in dataclasses.fields(cls):
        kind: Any = hints[field.name]
        marks: list[Any] = [tyro.conf.arg(help_behavior_hint=_default_in_words)]
        for mark in getattr(kind, "__metadata__", ()):
            if isinstance(mark, type(marks[0])):
                marks[0] = dataclasses.replace(mark, help_behavior_hint=_default_in_words)
            else:
                marks.append(mark)
        body["__annotations__"][field.name] = Annotated[
            (kind.__origin__ if hasattr(kind, "__metadata__") else kind, *marks)
        ]
        if field.default is not dataclasses.MISSING:
            body[field.name] = field.default
        elif field.default_factory is not dataclasses.MISSING:
            body[field.name] = dataclasses.field(default_factory=field.default_factory)
    return dataclasses.dataclass(type(cls.__name__, (cls,), body))


def _default_in_words(default: str) -> str:
    return "" if default in ("None", "False", "") else f"({default})"


def _gathered(argv: Sequence[str], repeatable: set[str]) -> list[str]:
    """`argv` with all pairs of a `repeatable` option behind one mention of it: tyro keeps those of the last alone."""
    others: list[str] = []
    pairs: dict[str, list[str]] = {}
    place = others
    for word in argv:
        option, equals, value = word.partition("=")
        if option in repeatable:
            place = pairs.setdefault(option, [option])
            place += [value] if equals else []
        else:
            place = others if word.startswith("--") else place
            place.append(word)
    return [*others, *(word for of_option in pairs.values() for word in of_option)]


def _first_sentence(report: str) -> str:
    """Return the first paragraph of tyro's report, without title and box, which is of ASCII for some terminals."""
    lines = [line.strip("│╭╮╰╯ ") for line in report.splitlines()[1:]]
    text = "\n".join("" if set(line) <= set("─-") else line for line in lines)
    return " ".join(text.strip().split("\n\n")[0].split()).rstrip(".")


def check_choice(kind: str, name: str, known: Iterable[str]) -> str:
    """The name, if it is known.

    Raises:
        ValueError: otherwise; the message names the closest ones.
    """
    names = list(known)
    if name not in names:
        raise ValueError(unknown_name(kind, name, names))
    return name


def check_measured(folder: Path) -> Path:
    """Return a folder that figures are to be drawn from again.

    Raises:
        FileNotFoundError: It is not there.
    """
    if not folder.is_dir():
        raise FileNotFoundError(f"there is no folder {folder} to draw from; measure first, without --draw")
    return folder


@dataclasses.dataclass
class FolderOptions:
    """Where a study writes its tables and figures."""

    out: Path | None = None
    """folder of all files; by default one of the command's name here"""
    readme: bool = False
    """write into the page of the study instead"""

    def folder(self, default: str) -> Path:
        """The folder asked for.

        Raises:
            ValueError: if both it and the page are asked for.
        """
        if self.readme and self.out is not None:
            raise ValueError("--readme writes into the page of the study: leave out --out, or --readme")
        return Path(default) if self.out is None else self.out
