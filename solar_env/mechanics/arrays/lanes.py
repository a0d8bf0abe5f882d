"""Arrays for batches of mechanisms with equal structure; each mechanism is a lane, an index of the leading axis."""

from collections.abc import Iterator
from typing import Any, TypeVar

import numpy as np
from llvmlite import ir
from numba import types
from numba.core.typing.templates import Signature
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

# A nested named tuple whose entries are arrays, numbers or such tuples.
Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


def with_lane_axis(arrays: Arrays) -> Arrays:
    """Return a mechanism's arrays with a new lane axis of length one in front: views of arrays, copies of numbers."""
    return _mapped(lambda entry: np.asarray(entry)[np.newaxis], arrays)


def allocate_lanes(arrays: Arrays, lanes: int) -> Arrays:
    """Return uninitialised arrays with a leading axis of `lanes` mechanisms, each with the structure of `arrays`."""

    def allocate(entry: Any) -> NDArray[Any]:
        one: NDArray[Any] = np.asarray(entry)
        return np.empty((lanes, *one.shape), one.dtype)

    return _mapped(allocate, arrays)


def lane_view(lanes: Arrays, lane: int) -> Arrays:
    """Return the arrays of mechanism number `lane`: views that share memory with a batch's arrays `lanes`."""
    return _mapped(lambda entry: entry[lane], lanes)


def copied(arrays: Arrays) -> Arrays:
    """Return a nested named tuple with independent copies of all arrays."""
    return _mapped(np.copy, arrays)


def check_structure(lanes: Arrays, arrays: Arrays) -> None:
    """Raise a ValueError that names the array if a mechanism's `arrays` lack the shapes of one lane of `lanes`."""
    for name, target, source in _pairs(lanes, arrays):
        shape = np.shape(source)
        if target.shape[1:] != shape:
            raise ValueError(
                f"the mechanism has {name} of shape {shape}, the others of the batch {target.shape[1:]}: parameters "
                "that change the structure must be the same in all lanes"
            )


def fill_lane(lanes: Arrays, lane: int, arrays: Arrays) -> None:
    """Copy a mechanism's `arrays` to lane number `lane` of the batch arrays `lanes`; the structures must be equal."""
    for _, target, source in _pairs(lanes, arrays):
        target[lane] = source


def _pairs(lanes: Any, arrays: Any) -> Iterator[tuple[str, NDArray[Any], Any]]:
    """Yield (name, batch array, one mechanism's array) of all entries in nested named tuples `lanes` and `arrays`."""
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
    """Return a function, generated for Numba, that takes row `lane` of every array in the nested tuple `lanes`."""
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
    """Return `counter[0]` and increase it by one. The compiled call is atomic: no two threads get the same number."""
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
