"""Command lines from documented dataclasses, and key=value pairs parsed without evaluating code."""

import argparse
import ast
import dataclasses
import inspect
import itertools
import re
import sys
import textwrap
import typing
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from solar_env import SimulationError

Arguments = TypeVar("Arguments")


def parse_arguments(cls: type[Arguments], argv: Sequence[str] | None = None, prog: str | None = None) -> Arguments:
    """Fill the dataclass `cls` from `argv` (default: the process's arguments).

    Field ``env_id`` becomes ``--env-id``, its help is the string literal below it; a bool becomes a flag with
    its ``--no-`` form, a list takes any number of values, a dict takes ``key=value`` pairs, also when the option is
    repeated. Wrong input ends the process with argparse's message.
    """
    parser = argparse.ArgumentParser(
        prog=prog,
        description=inspect.getdoc(cls),
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    help_texts = field_documentation(cls)
    types = typing.get_type_hints(cls)
    pairs = []
    for field in dataclasses.fields(cls):  # type: ignore[arg-type]
        kind = types[field.name]
        make_default = field.default_factory
        default = field.default if make_default is dataclasses.MISSING else make_default()
        settings: dict[str, Any] = {"help": help_texts[field.name], "default": default}
        if kind is bool:
            settings["action"] = argparse.BooleanOptionalAction
        elif typing.get_origin(kind) is dict:
            pairs.append(field.name)
            settings |= {"action": "extend", "nargs": "+", "default": [], "metavar": "KEY=VALUE"}
        elif typing.get_origin(kind) is list:
            settings |= {"nargs": "+", "type": typing.get_args(kind)[0]}
        else:
            settings["type"] = next(t for t in (*typing.get_args(kind), kind) if t is not type(None))
        parser.add_argument("--" + field.name.replace("_", "-"), **settings)
    values = vars(parser.parse_args(argv))
    for name in pairs:
        try:
            values[name] = parse_assignments(values[name])
        except ValueError as error:
            parser.error(f"--{name.replace('_', '-')}: {error}")
    return cls(**values)


def run_command(main: Callable[[], object]) -> None:
    """Run `main`; what it refuses, and runs that fail, end the process with their message and status 2."""
    try:
        main()
    except (ValueError, OSError, SimulationError) as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)


def field_documentation(cls: type) -> dict[str, str]:
    """Field name -> the string literal that follows the field in the source of the dataclass `cls`."""
    body = ast.parse(textwrap.dedent(inspect.getsource(cls))).body[0].body  # type: ignore[attr-defined]
    return {
        ast.unparse(field.target): ast.literal_eval(text.value)
        for field, text in itertools.pairwise(body)
        if isinstance(field, ast.AnnAssign) and isinstance(text, ast.Expr)
    }


def parse_assignments(pairs: Sequence[str]) -> dict[str, Any]:
    """Turn ``key=value`` or ``key:value`` strings into a dictionary.

    Values are Python literals (``ast.literal_eval``); a bare word such as ``rigid-ideal`` is a string.

    Raises:
        ValueError: a pair has no key or no value, repeats a key, or has a value that is neither.
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
            result[key] = text
    return result
