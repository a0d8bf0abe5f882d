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
import warnings
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, NamedTuple

from solar_env.array.names import unknown_name
from solar_env.array.parameters.checks import OPTIONAL
from solar_env.array.parameters.parameters import ArrayParameters
from solar_env.array.parameters.plausibility import located
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


@dataclass(frozen=True)
class _Text:
    """A file's name and lines, to say where a value stands."""

    path: Path
    lines: list[str]

    def place(self, table: str, name: str) -> str:
        """The file and, where it can be found, the line of a key, as a sentence begins."""
        line = self._line((table, name) if table else (name,))
        return f"{self.path}, line {line}: " if line else f"{self.path}: "

    def refusal(self, table: str, name: str, why: object) -> ValueError:
        """An error that names the file and the line of a key."""
        return ValueError(f"{self.place(table, name)}{why}")

    def _line(self, wanted: tuple[str, ...]) -> int:
        """Line of a key, counted from 1, or else of the table that holds it; 0 if neither is found."""
        inside: tuple[str, ...] = ()
        holder = 0
        for number, line in enumerate(self.lines, start=1):
            if header := _HEADER.match(line):
                inside = path = _parts(header[1])
            elif assignment := _ASSIGNMENT.match(line):
                path = (*inside, *_parts(assignment[1]))
            else:
                continue
            if path[: len(wanted)] == wanted:
                return number
            if path == wanted[:-1]:
                holder = number
        return holder


_PART = r"""(?:[\w-]+|"[^"]*"|'[^']*')"""
_KEY = rf"({_PART}(?:\s*\.\s*{_PART})*)"
_HEADER, _ASSIGNMENT = re.compile(rf"\s*\[{{1,2}}\s*{_KEY}\s*\]"), re.compile(rf"\s*{_KEY}\s*=")


def _parts(key: str) -> tuple[str, ...]:
    """A dotted key as its names."""
    return tuple(part.strip("\"'") for part in re.findall(_PART, key))


def read_parameters(path: str | Path) -> ParameterFile:
    """Read a file of parameters; what it does not name has its default.

    Raises:
        ValueError: if the file is no TOML, or has an unknown name or a refused value; the message says which, on which
            line, and the rule.
        OSError: if it cannot be read.
    """
    path = Path(path)
    encoded = read_at_most(path, _MOST_BYTES)
    try:
        content = encoded.decode("utf-8")
        values: dict[str, Any] = tomllib.loads(content)
    except UnicodeDecodeError as error:
        raise ValueError(f"{path} is no text in UTF-8: {error}") from error
    except ValueError as error:
        raise ValueError(f"{path} is no TOML: {error}; solar-env parameters prints a file") from error
    except RecursionError as error:
        raise ValueError(f"{path} is nested too deeply; solar-env parameters prints a file") from error
    text = _Text(path, content.splitlines())
    tables = {name: values.pop(name, {}) for name in (TOLERANCE, RANDOMIZE)}
    for name, table in tables.items():
        if not isinstance(table, dict):
            raise text.refusal("", name, f"{name} must be a table: write [{name}] and the parameters below it")
    parameters = ArrayParameters()
    known = [item.name for item in fields(ArrayParameters)]
    for name in values:
        if name not in known:
            raise text.refusal("", name, unknown_name("parameter", name, [*known, *tables]))
    changes = {name: None if name in OPTIONAL and value == NONE else value for name, value in values.items()}
    try:
        with located(lambda name: text.place("", name)):
            parameters = parameters.with_changes(changes)
    except ValueError as error:
        named, fault = _at_fault(error, changes, parameters.with_changes)
        raise text.refusal("", fault, _explained(named, error)) from error
    return ParameterFile(parameters, _ranges(parameters, tables, text))


def _at_fault(error: ValueError, given: dict[str, Any], check: Callable[[dict[str, Any]], object]) -> tuple[str, str]:
    """The name that an error begins with, and the key of the file that it is about.

    A value may be fine by itself and contradict another: the error's first word names one of them. Where that one has
    its default, it is the key with which the error sets in.
    """
    named = str(error).split(" ", 1)[0]
    if named in given:
        return named, named
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for count, name in enumerate(given, start=1):
            try:
                check(dict(list(given.items())[:count]))
            except ValueError as found:
                if str(found) == str(error):
                    return named, name
    return named, named


def _ranges(parameters: ArrayParameters, tables: dict[str, dict[str, Any]], text: _Text) -> Ranges:
    """The ranges of both tables, each checked by itself, so that an error finds its line, then all together."""
    ranges: dict[str, Any] = {}
    for table, entries in tables.items():
        for name, entry in entries.items():
            if name in ranges:
                raise text.refusal(table, name, f"{name} stands in both {TOLERANCE} and {RANDOMIZE}; keep one")
            try:
                bounds = _about(parameters, name, entry) if table == TOLERANCE else entry
            except ValueError as error:
                raise text.refusal(table, name, _explained(name, error)) from error
            try:
                with located(lambda found, table=table: text.place(table, found)):  # type: ignore[misc]
                    ranges |= checked_ranges(parameters, {name: bounds})
            except ValueError as error:
                too_wide = _too_wide(parameters, tables, name)
                raise text.refusal(table, name, f"{too_wide}{_explained(name, error)}") from error
    try:
        return checked_ranges(parameters, ranges)
    except ValueError as error:
        named, fault = _at_fault(error, ranges, lambda some: checked_ranges(parameters, some))
        table = next((table for table, entries in tables.items() if fault in entries), "")
        too_wide = _too_wide(parameters, tables, fault)
        raise text.refusal(table, fault, f"{too_wide}{_explained(named, error)}") from error


def _too_wide(parameters: ArrayParameters, tables: dict[str, dict[str, Any]], name: str) -> str:
    """How an error of what a tolerance reaches begins, lest it tell of values that nobody wrote; else empty."""
    if name not in tables[TOLERANCE] or name not in ArrayParameters.CONTINUOUS:
        return ""
    value, half_width = getattr(parameters, name), tables[TOLERANCE][name]
    return f"tolerance of {name} = {half_width!r} is too wide about {value!r}, choose a smaller one: at its end "


def _about(parameters: ArrayParameters, name: str, half_width: Any) -> tuple[Any, Any]:
    """Low and high end of a parameter with a tolerance."""
    if name not in ArrayParameters.CONTINUOUS:
        return half_width, half_width  # whose refusal names the parameter
    entries = half_width if isinstance(half_width, list) else [half_width]
    if not entries or not all(is_number(entry) and 0.0 <= entry < math.inf for entry in entries):
        raise ValueError(f"tolerance of {name} = {half_width!r} must be a finite number, not negative")
    value = getattr(parameters, name)
    if value is None:
        raise ValueError(f"{name} has no value to which a tolerance belongs; give it one")
    if name not in ArrayParameters.BY_JOINT and isinstance(half_width, list):
        raise ValueError(f"tolerance of {name} = {half_width!r} must be a single number")
    if name not in ArrayParameters.BY_JOINT:
        return value - half_width, value + half_width
    widths = [entries[min(joint, len(entries) - 1)] for joint in range(len(parameters.joints))]
    values = parameters.for_each_joint(name)
    if len(entries) > len(parameters.joints):
        raise ValueError(f"tolerance of {name} = {half_width!r} has more entries than panels")
    ends = [tuple(v + sign * w for v, w in zip(values, widths, strict=True)) for sign in (-1, 1)]
    return ends[0], ends[1]


def _explained(name: str, error: ValueError) -> str:
    """An error with what the parameter is, and in which unit."""
    texts = explanations()
    return f"{error}; {name} is: {texts[name]}" if name in texts and "unknown" not in str(error) else str(error)


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
