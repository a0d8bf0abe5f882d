"""Mechanisms of one structure side by side: every array has a leading axis of lanes, one row for each of them."""

from collections.abc import Iterator
from typing import Any, TypeVar

import numpy as np
from llvmlite import ir
from numba import types
from numba.core.typing.templates import Signature
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

# A named tuple of arrays, of numbers and of such tuples.
Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


def with_lane_axis(arrays: Arrays) -> Arrays:
    """Return the arrays of one mechanism as a single lane; arrays share their memory, numbers are copied."""
    return _mapped(lambda entry: np.asarray(entry)[np.newaxis], arrays)


def allocate_lanes(arrays: Arrays, lanes: int) -> Arrays:
    """Allocate uninitialised arrays for `lanes` mechanisms of the same structure as `arrays`."""

    def allocate(entry: Any) -> NDArray[Any]:
        one: NDArray[Any] = np.asarray(entry)
        return np.empty((lanes, *one.shape), one.dtype)

    return _mapped(allocate, arrays)


def lane_view(lanes: Arrays, lane: int) -> Arrays:
    """Return the arrays of one lane, in Python and in kernels; they share memory with the arrays of all lanes."""
    return _mapped(lambda entry: entry[lane], lanes)


def copied(arrays: Arrays) -> Arrays:
    """Return independent copies of the arrays."""
    return _mapped(np.copy, arrays)


def check_structure(lanes: Arrays, arrays: Arrays) -> None:
    """Check that a mechanism's arrays have the shapes of the lanes' arrays.

    Raises:
        ValueError: if the mechanism has another structure; names the array.
    """
    for name, target, source in _pairs(lanes, arrays):
        shape = np.shape(source)
        if target.shape[1:] != shape:
            raise ValueError(
                f"the mechanism has {name} of shape {shape}, the others of the batch {target.shape[1:]}: parameters "
                "that change the structure must be the same in all lanes"
            )


def fill_lane(lanes: Arrays, lane: int, arrays: Arrays) -> None:
    """Copy the arrays of a mechanism of the lanes' structure into a lane."""
    for _, target, source in _pairs(lanes, arrays):
        target[lane] = source


def _pairs(lanes: Any, arrays: Any) -> Iterator[tuple[str, NDArray[Any], Any]]:
    """Yield name, array of all lanes and array of one mechanism for every entry of two nested named tuples."""
    for name, target, source in zip(lanes._fields, lanes, arrays, strict=True):
        if isinstance(target, tuple):
            yield from _pairs(target, source)
        else:
            yield name, target, source


def _mapped(function: Any, arrays: Any) -> Any:
    """Return a nested named tuple with `function` applied to every array or number in it."""
    if isinstance(arrays, tuple):
        return type(arrays)(*(_mapped(function, entry) for entry in arrays))
    return function(arrays)


@overload(lane_view, inline="always")
def _compiled_lane_view(lanes, lane):
    """Compile `lane_view` as a call of the named tuple's class, which Numba cannot derive from a loop."""
    classes: dict[str, Any] = {}

    def construction(kind: types.BaseNamedTuple, path: str) -> str:
        name = f"class_{len(classes)}"
        classes[name] = kind.instance_class
        parts = (
            construction(entry, f"{path}.{field}")
            if isinstance(entry, types.BaseNamedTuple)
            else f"{path}.{field}[lane]"
            for field, entry in zip(kind.fields, kind.types, strict=True)
        )
        return f"{name}({', '.join(parts)})"

    exec(f"def view(lanes, lane):\n    return {construction(lanes, 'lanes')}", classes)
    return classes["view"]


def take_ticket(counter: NDArray[np.int64]) -> int:
    """Return `counter[0]` and raise it by one. Compiled, this is atomic: no two threads get the same number."""
    ticket = int(counter[0])
    counter[0] += 1
    return ticket


@overload(take_ticket, inline="always")
def _compiled_ticket(counter):
    def take(counter):
        return _fetch_and_add_one(counter)

    return take


@intrinsic
def _fetch_and_add_one(typing_context: Any, counter: types.Array) -> tuple[Signature, Any]:
    def generate(context: Any, builder: ir.IRBuilder, signature: Signature, arguments: Any) -> ir.Instruction:
        array = context.make_array(counter)(context, builder, arguments[0])
        return builder.atomic_rmw("add", array.data, context.get_constant(types.int64, 1), "monotonic")

    return types.int64(counter), generate
