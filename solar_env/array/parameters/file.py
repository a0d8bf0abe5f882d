"""Files of parameters in TOML: reading one, and writing a complete one that explains each parameter.

Values stand at the top of the file, under the names and in the units of `ArrayParameters`. Two tables say what is not
known exactly: `tolerance` gives half-widths about the values, `randomize` low and high ends, as the keyword of the
environments does. Both are drawn uniformly, by joint where the parameter is.
"""

import inspect
import math
import re
import textwrap
import tomllib
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

from solar_env.array.names import unknown_name
from solar_env.array.parameters.checks import OPTIONAL
from solar_env.array.parameters.parameters import ArrayParameters
from solar_env.array.parameters.ranges import Ranges, checked_ranges
from solar_env.support.numbers import is_number
from solar_env.support.plain_arrays import read_at_most

TOLERANCE, RANDOMIZE = "tolerance", "randomize"
# How a file says None, for which TOML has no word.
NONE = "none"
_MOST_BYTES = 2**20
_WIDTH = 100  # characters of an explanation's line


class ParameterFile(NamedTuple):
    """Content of a file: the array, and the parameters that are drawn anew for every run.

    `gymnasium.make("solar_env/Deploy-v1", **solar_env.read_parameters("my_array.toml")._asdict())` makes an environment
    of it.

    Attributes:
        parameters: of the array.
        randomize: parameter -> (low, high).
    """

    parameters: ArrayParameters
    randomize: Ranges


def read_parameters(path: str | Path) -> ParameterFile:
    """Read a file of parameters; what it does not name has its default.

    Raises:
        ValueError: if the file is no TOML, or has an unknown name or a refused value; the message says which, and the
            rule.
        OSError: if it cannot be read.
    """
    path = Path(path)
    encoded = read_at_most(path, _MOST_BYTES)
    try:
        values: dict[str, Any] = tomllib.loads(encoded.decode("utf-8"))
    except UnicodeDecodeError as error:
        raise ValueError(f"{path} is no text in UTF-8: {error}") from error
    except ValueError as error:
        raise ValueError(f"{path} is no TOML: {error}; solar-env parameters prints a file") from error
    except RecursionError as error:
        raise ValueError(f"{path} is nested too deeply; solar-env parameters prints a file") from error
    try:
        return _parameter_file(values)
    except ValueError as error:
        raise ValueError(f"{path}: {_explained(error)}") from error


def _parameter_file(values: dict[str, Any]) -> ParameterFile:
    tables = {name: values.pop(name, {}) for name in (TOLERANCE, RANDOMIZE)}
    for name, table in tables.items():
        if not isinstance(table, dict):
            raise ValueError(f"{name} must be a table: write [{name}] and the parameters below it")
    known = [item.name for item in fields(ArrayParameters)]
    for name in values:
        if name not in known:
            raise ValueError(unknown_name("parameter", name, [*known, *tables]))
    changes = {name: None if name in OPTIONAL and value == NONE else value for name, value in values.items()}
    parameters = ArrayParameters().with_changes(changes)
    tolerances, ranges = tables[TOLERANCE], dict(tables[RANDOMIZE])
    for name, half_width in tolerances.items():
        if name in ranges:
            raise ValueError(f"{name} stands in both {TOLERANCE} and {RANDOMIZE}; keep one")
        ranges[name] = _about(parameters, name, half_width)
    return ParameterFile(parameters, checked_ranges(parameters, ranges))


def _about(parameters: ArrayParameters, name: str, half_width: Any) -> tuple[Any, Any]:
    """Low and high end of a parameter with a tolerance, at which it must be acceptable."""
    if name not in ArrayParameters.CONTINUOUS:
        return half_width, half_width  # whose refusal names the parameter
    told = f"tolerance of {name} = {half_width!r}"
    entries = half_width if isinstance(half_width, list) else [half_width]
    if not entries or not all(is_number(entry) and 0.0 <= entry < math.inf for entry in entries):
        raise ValueError(f"{told} must be a finite number, not negative")
    value, by_joint = getattr(parameters, name), name in ArrayParameters.BY_JOINT
    if value is None:
        raise ValueError(f"{name} has no value to which a tolerance belongs; give it one")
    if isinstance(half_width, list) and not by_joint:
        raise ValueError(f"{told} must be a single number")
    joints = len(parameters.joints) if by_joint else 1
    if len(entries) > joints:
        raise ValueError(f"{told} has more entries than panels")
    widths = [entries[min(joint, len(entries) - 1)] for joint in range(joints)]
    values = parameters.for_each_joint(name) if by_joint else (value,)
    low, high = (tuple(v + sign * w for v, w in zip(values, widths, strict=True)) for sign in (-1, 1))
    bounds = (low, high) if by_joint else (low[0], high[0])
    try:
        checked_ranges(parameters, {name: bounds})
    except ValueError as error:
        raise ValueError(f"{told} is too wide about {value!r}, choose a smaller one: at its end {error}") from error
    return bounds


def _explained(error: ValueError) -> str:
    """An error with what the parameter that it begins with is, and in which unit."""
    name, texts = str(error).split(" ", 1)[0], explanations()
    return f"{error}; {name} is: {texts[name]}" if name in texts else str(error)


def explanations() -> dict[str, str]:
    """Explain each parameter, with its unit and source: the docstring of `ArrayParameters`, by name."""
    document = inspect.cleandoc(ArrayParameters.__doc__ or "").split("Attributes:\n")[1]
    texts: dict[str, str] = {}
    for entry in re.split(r"\n {4}(?=\S)", "\n" + document.rstrip()):
        names, _, text = entry.partition(":")
        for name in names.split(","):
            if name.strip():
                texts[name.strip()] = " ".join(text.split()).rstrip(".")
    return texts


def units() -> dict[str, str]:
    """Unit of each parameter, by name; empty for what has none: the first in its explanation."""
    found = {name: re.search(r"\[([^\]]+)\]", text) for name, text in explanations().items()}
    return {name: unit[1] if unit and not name.endswith("poisson") else "" for name, unit in found.items()}


def parameter_text(parameters: ArrayParameters) -> str:
    """A complete file of parameters, each with its explanation; `read_parameters` reads it back."""
    lines = [
        "# Parameters of a solar array in SI units. What is left out has its default; by joint: one number for all, or",
        "# a list whose last entry also holds for all further joints. None is written as a word in quotation marks.",
    ]
    texts, before = explanations(), ""
    for item in fields(ArrayParameters):
        if texts[item.name] != before:
            lines += ["", *textwrap.wrap(texts[item.name], _WIDTH, initial_indent="# ", subsequent_indent="# ")]
        before = texts[item.name]
        lines.append(f"{item.name} = {_toml(getattr(parameters, item.name))}")
    lines += [
        "",
        "# What is not known exactly is drawn anew for every run of an ensemble, uniformly: within a tolerance of the",
        "# value above, or between a low and a high end.",
        f"[{TOLERANCE}]",
        "# clearance = 2e-5",
        "",
        f"[{RANDOMIZE}]",
        "# friction_coefficient = [0.05, 0.3]",
        "",
    ]
    return "\n".join(lines)


def _toml(value: Any) -> str:
    """A value as TOML has it."""
    if value is None:
        return f'"{NONE}"'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(_toml(entry) for entry in value)}]"
    return f'"{value}"' if isinstance(value, str) else repr(value)
