"""Refusal of names that are not known."""

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from typing import Any, TypeVar

Values = TypeVar("Values", bound=Any)


def unknown_name(kind: str, name: object, known: Iterable[str]) -> str:
    """A sentence that says that a name is unknown, and which known ones come close, or else all of them."""
    names = list(known)
    close = difflib.get_close_matches(str(name), names, n=2)
    hint = f"did you mean {' or '.join(map(repr, close))}?" if close else f"choose from {', '.join(names)}"
    return f"{kind} {name!r} is unknown; {hint}"


def changed(kind: str, values: Values, changes: Mapping[str, object]) -> Values:
    """A copy of a dataclass with some fields changed; the dataclass's checks refuse bad values.

    Raises:
        ValueError: if they are no mapping, a name is unknown, said of this kind of value, or a value is refused.
    """
    if not isinstance(changes, Mapping):
        raise ValueError(f"{kind}: {changes!r} must be a mapping of names to values")
    known = [item.name for item in fields(values)]
    for name in changes:
        if name not in known:
            raise ValueError(unknown_name(kind, name, known))
    return replace(values, **changes)
