"""Choice of a kernel by the type of a named tuple, resolved at compile time.

Kernels take no functions as arguments, and a choice at run time would compile every branch for every run.
"""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from numba.extending import overload

Row = TypeVar("Row")


def chosen_by_type(table: Mapping[type, Row], pick: Callable[[Row], Any]) -> Callable[[Any], Any]:
    """Return a function that maps a named tuple to `pick(table[its type])`, usable in kernels and in Python."""

    def find(value: Any) -> Any:
        return pick(table[type(value)])

    @overload(find, inline="always")
    def find_compiled(value):
        found = pick(table[value.instance_class])
        return lambda value: found

    return find
