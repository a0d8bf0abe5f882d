"""Checks of names and values from users or files, and conversion of values to plain Python types."""

import difflib
import math
from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from types import UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

Values = TypeVar("Values", bound=Any)
_WANTED = {
    str: "a text",
    int: "a whole number, not negative",
    float: "a finite number",
    dict: "a mapping",
    tuple: "a list of names of letters, digits and underscores",
    type(None): "null",
}


def is_number(value: Any) -> bool:
    """Return whether a value is a Python int or float, as NumPy's float64 is; a bool does not count as a number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_whole_number(value: object, least: int) -> bool:
    """Return whether a value is a Python int of at least `least`; a bool does not count as an int."""
    return isinstance(value, int) and not isinstance(value, bool) and value >= least


def plain(value: object) -> Any:
    """Return a value with Python types instead of NumPy types, and with tuples instead of lists."""
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    return tuple(plain(entry) for entry in value) if isinstance(value, (list, tuple)) else value


def check_types(record: Any) -> None:
    """Check that the fields of a dataclass hold values of their annotated types.

    Ints must not be negative, floats must be finite, tuples must hold Python identifiers; mappings may hold anything.

    Raises:
        ValueError: a field holds another value; the message names the field, its value and the expected type.
    """
    for name, annotation in get_type_hints(type(record)).items():
        kinds = get_args(annotation) if isinstance(annotation, UnionType) else (annotation,)
        kinds = tuple(get_origin(kind) or kind for kind in kinds)
        value = getattr(record, name)
        if not any(_is_a(kind, value) for kind in kinds):
            wanted = " or ".join(_WANTED[kind] for kind in kinds)
            raise ValueError(f"{name} is {repr(value)[:100]}; give {wanted}")


def _is_a(kind: type, value: Any) -> bool:
    if kind is int:
        return is_whole_number(value, 0)
    if kind is float:
        return is_number(value) and abs(value) < math.inf
    if kind is tuple:
        return isinstance(value, tuple) and all(isinstance(entry, str) and entry.isidentifier() for entry in value)
    return isinstance(value, kind)


def check_positive(name: str, value: Any, unit: str = "") -> None:
    """Raise a ValueError, with `name` and `unit`, unless a value is a positive finite number."""
    if not (is_number(value) and 0.0 < value < math.inf):
        raise ValueError(f"{name} = {value!r}{unit} must be positive and finite")


def check_name(kind: str, name: object, known: Iterable[str]) -> None:
    """Raise a ValueError unless `name` is a known name; `kind` says in the message what the name stands for."""
    if not isinstance(name, str) or name not in known:
        raise ValueError(unknown_name(kind, name, known))


def unknown_name(kind: str, name: object, known: Iterable[str]) -> str:
    """Return an error sentence for an unknown name of this `kind`, with similar known names, or with all of them."""
    names = list(known)
    close = difflib.get_close_matches(str(name), names, n=2)
    hint = f"did you mean {' or '.join(map(repr, close))}?" if close else f"choose from {', '.join(names)}"
    return f"{kind} {name!r} is unknown; {hint}"


def changed(kind: str, values: Values, changes: Mapping[str, object]) -> Values:
    """Return a copy of the dataclass `values` with the fields in `changes` changed; its own checks refuse bad values.

    Raises:
        ValueError: if the changes are no mapping, a value is refused, or a name is unknown; the message says `kind`.
    """
    if not isinstance(changes, Mapping):
        raise ValueError(f"{kind}: {changes!r} must be a mapping of names to values")
    known = [item.name for item in fields(values)]
    for name in changes:
        check_name(kind, name, known)
    return replace(values, **{name: plain(value) for name, value in changes.items()})
