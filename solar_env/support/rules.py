"""Rules of the values that users or files give by name."""

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, NamedTuple

_LONGEST = 100


class Rule(NamedTuple):
    """A rule that the values of some names keep.

    Attributes:
        names: of the values.
        holds: whether a value keeps it.
        wanted: such a value in words, as in "give a number".
    """

    names: Collection[str]
    holds: Callable[[Any], bool]
    wanted: str


def check_values(values: Mapping[str, Any], rules: Iterable[Rule], kind: str = "") -> None:
    """Check those of `values` that a rule names.

    Args:
        values: Name -> value.
        rules: For them.
        kind: Word for what they are, before the name in errors.

    Raises:
        ValueError: A value breaks a rule; the error names it, and says what to give.
    """
    for rule in rules:
        for name in rule.names:
            if name in values and not rule.holds(values[name]):
                told = repr(values[name])
                told = told if len(told) <= _LONGEST else f"{told[:_LONGEST]} …"
                raise ValueError(f"{kind} {name} is {told}; give {rule.wanted}".lstrip())
