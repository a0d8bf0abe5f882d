"""Named tuples of arrays that a kernel takes from Python as one address.

Of other arguments Numba unpacks array after array. For those of a mechanism that takes as long as some steps in every
call, and the code that does it takes seconds to compile.
"""

from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba import typeof, types
from numba.core.datamodel import models
from numba.core.typing.templates import Signature
from numba.extending import NativeValue, intrinsic, overload, register_model, unbox


class Handle:
    """A named tuple of arrays, of numbers and of such tuples, as kernels take it; they look into it by `arrays_of`.

    Attributes:
        arrays: the named tuple.
        address: of its description in memory.
    """

    def __init__(self, arrays: Any) -> None:
        self.arrays = arrays
        self._words = np.array(list(_words(arrays)), dtype=np.int64)
        self.address = self._words.ctypes.data
        self._numba_type_ = _HandleType(_kind(arrays))

    def __reduce__(self) -> tuple[Any, ...]:
        """For copies and pickles, whose arrays lie elsewhere."""
        return Handle, (self.arrays,)


def _kind(entry: Any) -> types.Type:
    """Numba's type of a named tuple; `typeof` would look at every array for long."""
    if isinstance(entry, tuple):
        return types.BaseTuple.from_types(tuple(map(_kind, entry)), type(entry))
    usual = isinstance(entry, np.ndarray) and entry.flags.carray
    return _kind_of_array(entry.dtype, entry.ndim) if usual else typeof(entry)


@cache
def _kind_of_array(dtype: np.dtype[Any], dimensions: int) -> types.Type:
    return typeof(np.empty((1,) * dimensions, dtype))


def _words(entry: Any) -> Iterator[int]:
    """The members of Numba's structure of an entry, 8 bytes each; an array has no owner there."""
    if isinstance(entry, tuple):
        for part in entry:
            yield from _words(part)
    elif isinstance(entry, np.ndarray):
        address = entry.__array_interface__["data"][0]
        yield from (0, 0, entry.size, entry.itemsize, address, *entry.shape, *entry.strides)
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


# Not inlined by Numba, which would take what is written to the arrays for dead.
@overload(arrays_of, jit_options={"forceinline": True, "_nrt": False})
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
