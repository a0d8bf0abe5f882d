"""Parameter files in TOML: reading a file, and writing a complete file that explains each parameter.

Values stand at the top of the file, with the names and units of `ArrayParameters`. Two tables are for values that are
not known exactly: `tolerance` gives half-widths about the values; `randomize` gives low and high ends, like the keyword
of the environments. Values are sampled uniformly. A parameter with a tolerance is sampled separately for each joint, if
it may differ between joints.
"""

import codecs
import json
import math
import re
import textwrap
import tomllib
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from solar_env.array.parameters.checks import row_of
from solar_env.array.parameters.parameters import PRESETS, ArrayParameters
from solar_env.array.parameters.ranges import Ranges, checked_ranges
from solar_env.support.docstrings import docstring
from solar_env.support.plain_arrays import read_at_most
from solar_env.support.values import check_name, is_number

TOLERANCE, RANDOMIZE = "tolerance", "randomize"
# Text for the value None in a file, since TOML lacks a null value.
NONE = "none"
# Parameter files of arrays from published data, by name of the array.
WINGS = {path.stem: path for path in sorted((Path(__file__).parents[1] / "data" / "wings").glob("*.toml"))}
_MOST_BYTES = 2**20
_WIDTH = 100  # characters per line of an explanation


class ParameterFile(NamedTuple):
    """Content of a parameter file: the array's parameters, and the ranges of parameters that every run samples anew.

    `gymnasium.make("solar_env/Deploy-v2", **solar_env.read_parameters("my_array.toml")._asdict())` makes an environment
    from a file.
    """

    parameters: ArrayParameters
    randomize: Ranges


def named_array(name: str) -> ParameterFile:
    """Return parameters and ranges of a preset or a packaged file in `WINGS`; an unknown name raises a ValueError."""
    check_name("array", name, [*PRESETS, *WINGS])
    if name in WINGS:
        return read_parameters(WINGS[name])
    return ParameterFile(ArrayParameters.preset(name), {})


def read_parameters(path: str | Path) -> ParameterFile:
    """Read a parameter file; return its parameters, with defaults for missing ones, and the ranges of uncertain ones.

    Raises:
        ValueError: if the file is no TOML, or has an unknown name or a refused value.
        OSError: if the file cannot be read.
    """
    path = Path(path)
    encoded = read_at_most(path, _MOST_BYTES)
    try:
        # Windows editors begin files with a byte order mark; the Windows shell writes output as UTF-16 with a mark.
        marked_16 = encoded.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
        values: dict[str, Any] = tomllib.loads(encoded.decode("utf-16" if marked_16 else "utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise ValueError(
            f"{path} is no TOML: {error}; put words in quotation marks, as solar-env parameters prints them"
        ) from error
    try:
        return _parameter_file(values)
    except ValueError as error:
        raise ValueError(f"{path}: {_explained(error)}") from error


def _parameter_file(values: dict[str, Any]) -> ParameterFile:
    tables = {name: values.pop(name, {}) for name in (TOLERANCE, RANDOMIZE)}
    for name, table in tables.items():
        if not isinstance(table, dict):
            raise ValueError(f"{name} must be a table: write [{name}] and the parameters below it")
    rows = {item.name: row_of(item) for item in fields(ArrayParameters)}
    for name in values:
        check_name("parameter", name, [*rows, *tables])
    changes = {name: None if rows[name].optional and value == NONE else value for name, value in values.items()}
    parameters, ranges = ArrayParameters().with_changes(changes), dict(tables[RANDOMIZE])
    for name, half_width in tables[TOLERANCE].items():
        if name in ranges:
            raise ValueError(f"{name} stands in both {TOLERANCE} and {RANDOMIZE}; keep one")
        ranges[name] = _about(parameters, name, half_width)
        try:
            checked_ranges(parameters, {name: ranges[name]})
        except ValueError as error:
            raise ValueError(f"tolerance of {name} = {half_width!r} is refused: {error}") from error
    return ParameterFile(parameters, checked_ranges(parameters, ranges))


def _about(parameters: ArrayParameters, name: str, half_width: Any) -> tuple[Any, Any]:
    """Return (low, high): a parameter's value minus and plus `half_width`; two lists by joint if joints may differ."""
    if name not in ArrayParameters.CONTINUOUS:
        return half_width, half_width  # `checked_ranges` refuses the parameter by name
    told, by_joint = f"tolerance of {name} = {half_width!r}", name in ArrayParameters.BY_JOINT
    widths = half_width if isinstance(half_width, list) else [half_width]
    if not widths or not all(is_number(width) and 0.0 <= width < math.inf for width in widths):
        raise ValueError(f"{told} must be a finite number, not negative")
    joints = len(parameters.joints) if by_joint else 1
    if len(widths) > joints:
        raise ValueError(f"{told} must be a single number" if joints == 1 else f"{told} has more entries than panels")
    if getattr(parameters, name) is None:
        raise ValueError(f"{name} has no value to which a tolerance belongs; give it one")
    values = parameters.for_each_joint(name) if by_joint else parameters.entries(name)
    widths += widths[-1:] * (joints - len(widths))
    low, high = ([v + sign * w for v, w in zip(values, widths, strict=True)] for sign in (-1.0, 1.0))
    return (low, high) if by_joint else (low[0], high[0])


def _explained(error: ValueError) -> str:
    """Return an error's text; if the text begins with a parameter's name, append that parameter's explanation."""
    name, texts = str(error).split(" ", 1)[0], explanations()
    return f"{error}; {name} is: {texts[name]}" if name in texts else str(error)


@cache
def explanations() -> dict[str, str]:
    """Return the explanation of each parameter by name, with unit and source, from `ArrayParameters`' docstring."""
    document = docstring(ArrayParameters.__module__, ArrayParameters.__name__).split("Attributes:\n")[1]
    texts: dict[str, str] = {}
    for names, text in re.findall(r"^ {4}(\w[\w, ]*):((?:.|\n {8})*)", document, re.MULTILINE):
        texts |= dict.fromkeys(names.split(", "), " ".join(text.split()).rstrip("."))
    return texts


def units() -> dict[str, str]:
    """Return the unit of each parameter by name: the first text in square brackets in its explanation, or ""."""
    found = {name: re.search(r"\[([^\]]+)\]", text) for name, text in explanations().items()}
    return {name: unit[1] if unit and not name.endswith("poisson") else "" for name, unit in found.items()}


_HEAD = """\
# Parameters of a solar array in SI units. A parameter that is left out has its default. By joint: one number for all,
# or a list whose last entry also holds for all further joints. None is written as a word in quotation marks.
"""
_TABLES = f"""
# An uncertain parameter is drawn anew for every run of an ensemble, uniformly: half-widths about the values above
# in the one table, low and high ends in the other.
[{TOLERANCE}]
# clearance = 2e-5

[{RANDOMIZE}]
# friction_coefficient = [0.05, 0.3]
"""


def parameter_text(parameters: ArrayParameters) -> str:
    """Return the text of a complete parameter file with explanations; `read_parameters` can read the file."""
    lines, before = [_HEAD.rstrip()], ""
    for name, text in explanations().items():
        if text != before:
            lines += ["", *textwrap.wrap(text, _WIDTH, initial_indent="# ", subsequent_indent="# ")]
        before = text
        lines.append(f"{name} = {_toml(getattr(parameters, name))}")
    return "\n".join([*lines, _TABLES])


def _toml(value: object) -> str:
    """Return a parameter's value as TOML text, equal to JSON text, except that None becomes `NONE` in quotes."""
    return f'"{NONE}"' if value is None else json.dumps(value)
