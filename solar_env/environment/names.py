"""Words for a name that is unknown."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def unknown_name(kind: str, name: object, known: Iterable[str]) -> str:
    """A sentence that says that a name is unknown, and which known ones come close, or else all of them."""
    names = list(known)
    close = difflib.get_close_matches(str(name), names, n=2)
    hint = f"did you mean {' or '.join(map(repr, close))}?" if close else f"choose from {', '.join(names)}"
    return f"{kind} {name!r} is unknown; {hint}"
