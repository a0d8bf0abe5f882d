"""Choice of a kernel by the type of a named tuple, resolved in compiling.

Kernels take no functions as arguments, and a choice at run time would have every branch compiled for every run.
"""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from numba.extending import overload

Row = TypeVar("Row")


def chosen_by_type(table: Mapping[type, Row], pick: Callable[[Row], Any]) -> Callable[[Any], Any]:
    """Return a function of a named tuple, in kernels and Python, that gives `pick` of its class's row in `table`."""

    def find(value: Any) -> Any:
        return pick(table[type(value)])

    @overload(find, inline="always")
    def find_compiled(value):
        found = pick(table[value.instance_class])
        return lambda value: found

    return find
