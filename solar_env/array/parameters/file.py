"""Files of parameters in TOML: reading one, and writing a complete one that explains each parameter.

Values stand at the top of the file, under the names and in the units of `ArrayParameters`. The table `randomize` gives
low and high ends of what is not known exactly, as the keyword of the environments does.
"""

import inspect
import json
import re
import textwrap
import tomllib
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

from solar_env.array.names import unknown_name
from solar_env.array.parameters.checks import row_of
from solar_env.array.parameters.parameters import ArrayParameters
from solar_env.array.parameters.ranges import Ranges, checked_ranges
from solar_env.support.plain_arrays import read_at_most

RANDOMIZE = "randomize"
# How a file says None, for which TOML has no word.
NONE = "none"
_MOST_BYTES = 2**20
_WIDTH = 100  # characters of an explanation's line


class ParameterFile(NamedTuple):
    """Content of a file: the array, and the parameters that are drawn anew for every run.

    `gymnasium.make("solar_env/Deploy-v1", **solar_env.read_parameters("my_array.toml")._asdict())` makes an environment
    of it.
    """

    parameters: ArrayParameters
    randomize: Ranges


def read_parameters(path: str | Path) -> ParameterFile:
    """Read a file of parameters; what it does not name has its default.

    Raises:
        ValueError: if the file is no TOML, or has an unknown name or a refused value.
        OSError: if it cannot be read.
    """
    path = Path(path)
    encoded = read_at_most(path, _MOST_BYTES)
    try:
        values: dict[str, Any] = tomllib.loads(encoded.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path} is no TOML: {error}; solar-env parameters prints a file") from error
    try:
        return _parameter_file(values)
    except ValueError as error:
        raise ValueError(f"{path}: {_explained(error)}") from error


def _parameter_file(values: dict[str, Any]) -> ParameterFile:
    ranges = values.pop(RANDOMIZE, {})
    if not isinstance(ranges, dict):
        raise ValueError(f"{RANDOMIZE} must be a table: write [{RANDOMIZE}] and the parameters below it")
    rows = {item.name: row_of(item) for item in fields(ArrayParameters)}
    for name in values:
        if name not in rows:
            raise ValueError(unknown_name("parameter", name, [*rows, RANDOMIZE]))
    changes = {name: None if rows[name].optional and value == NONE else value for name, value in values.items()}
    parameters = ArrayParameters().with_changes(changes)
    return ParameterFile(parameters, checked_ranges(parameters, ranges))


def _explained(error: ValueError) -> str:
    """An error with what the parameter that it begins with is, and in which unit."""
    name, texts = str(error).split(" ", 1)[0], explanations()
    return f"{error}; {name} is: {texts[name]}" if name in texts else str(error)


def explanations() -> dict[str, str]:
    """Explain each parameter, with its unit and source: the docstring of `ArrayParameters`, by name."""
    document = inspect.cleandoc(ArrayParameters.__doc__ or "").split("Attributes:\n")[1]
    texts: dict[str, str] = {}
    for names, text in re.findall(r"^ {4}(\w[\w, ]*):((?:.|\n {8})*)", document, re.MULTILINE):
        texts |= dict.fromkeys(names.split(", "), " ".join(text.split()).rstrip("."))
    return texts


def units() -> dict[str, str]:
    """Unit of each parameter, by name; empty for what has none: the first in its explanation."""
    found = {name: re.search(r"\[([^\]]+)\]", text) for name, text in explanations().items()}
    return {name: unit[1] if unit and not name.endswith("poisson") else "" for name, unit in found.items()}


_HEAD = """\
# Parameters of a solar array in SI units. What is left out has its default; by joint: one number for all, or
# a list whose last entry also holds for all further joints. None is written as a word in quotation marks.
"""
_TABLES = f"""
# What is not known exactly is drawn anew for every run of an ensemble, uniformly between a low and a high end.
[{RANDOMIZE}]
# friction_coefficient = [0.05, 0.3]
"""


def parameter_text(parameters: ArrayParameters) -> str:
    """A complete file of parameters, each with its explanation; `read_parameters` reads it back."""
    lines, before = [_HEAD.rstrip()], ""
    for name, text in explanations().items():
        if text != before:
            lines += ["", *textwrap.wrap(text, _WIDTH, initial_indent="# ", subsequent_indent="# ")]
        before = text
        lines.append(f"{name} = {_toml(getattr(parameters, name))}")
    return "\n".join([*lines, _TABLES])


def _toml(value: Any) -> str:
    """A value as TOML has it: JSON's, but for None."""
    return f'"{NONE}"' if value is None else json.dumps(value)
