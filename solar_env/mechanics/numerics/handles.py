"""Handles: named tuples of arrays that cross from Python to a kernel as one address.

Python hands over array after array: those of a mechanism take as long as some tens of steps, and the code that takes
them seconds to compile.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types, typeof
from numba.core.datamodel import models
from numba.core.typing.templates import Signature
from numba.extending import NativeValue, intrinsic, overload, register_model, unbox


class Handle:
    """A named tuple of arrays, and of numbers and such tuples, for `arrays_of` in kernels.

    Attributes:
        arrays: the named tuple.
        address: of what the compiler knows of it.
    """

    def __init__(self, arrays: Any) -> None:
        self.arrays = arrays
        self._words = np.array(list(_words(arrays)), dtype=np.int64)
        self.address = self._words.ctypes.data
        self._numba_type_ = _HandleType(typeof(arrays))

    def __reduce__(self) -> tuple[Any, ...]:
        """For copies, whose arrays lie elsewhere."""
        return Handle, (self.arrays,)


def _words(entry: Any) -> Iterator[int]:
    """The members of Numba's structure of a named tuple, of an array without owner or of a number, 8 bytes each."""
    if isinstance(entry, tuple):
        for part in entry:
            yield from _words(part)
    elif isinstance(entry, np.ndarray):
        yield from (0, 0, entry.size, entry.itemsize, entry.ctypes.data, *entry.shape, *entry.strides)
    else:
        yield int(np.array(entry, dtype=type(entry)).view(np.int64))


def arrays_of(handle: Handle) -> Any:
    """The named tuple of a handle, in Python and in kernels."""
    return handle.arrays


class _HandleType(types.Type):
    def __init__(self, arrays: types.Type) -> None:
        super().__init__(f"Handle({arrays})")
        self.arrays = arrays


register_model(_HandleType)(models.OpaqueModel)


@unbox(_HandleType)
def _unbox(kind: _HandleType, handle: Any, c: Any) -> NativeValue:
    address = c.pyapi.object_getattr_string(handle, "address")
    pointer = c.pyapi.long_as_voidptr(address)
    c.pyapi.decref(address)
    return NativeValue(pointer)


@overload(arrays_of, inline="always")
def _compiled_arrays(handle):
    return lambda handle: _loaded(handle)


@intrinsic
def _loaded(typing_context: Any, handle: Any) -> tuple[Signature, Any]:
    def load(builder: ir.IRBuilder, pointer: ir.Value) -> ir.Value:
        """Load member by member, so that those that nobody uses vanish."""
        kind = pointer.type.pointee
        if not isinstance(kind, (ir.LiteralStructType, ir.ArrayType)):
            return builder.load(pointer)
        value, zero = ir.Constant(kind, ir.Undefined), ir.IntType(32)(0)
        for k in range(len(kind)):
            member = builder.gep(pointer, [zero, ir.IntType(32)(k)], inbounds=True)
            value = builder.insert_value(value, load(builder, member), k)
        return value

    def generate(context: Any, builder: ir.IRBuilder, signature: Signature, values: Any) -> ir.Value:
        kind = context.get_value_type(handle.arrays)
        return load(builder, builder.bitcast(values[0], kind.as_pointer()))

    return handle.arrays(handle), generate
