"""Named tuples of arrays that a kernel takes from Python as one address.

Numba unpacks other arguments array by array. For a mechanism's arrays, unpacking in every call takes as long as some
integration steps, and the unpacking code takes seconds to compile.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import typeof, types
from numba.core.datamodel import models
from numba.core.typing.templates import Signature
from numba.extending import NativeValue, intrinsic, overload, register_model, unbox


class Handle:
    """Address through which kernels reach a nested named tuple of arrays and numbers; `arrays_of` returns the tuple.

    Attributes:
        arrays: the named tuple.
        address: memory address of a list of the tuple's numbers, and its arrays' data addresses, shapes and strides.
    """

    def __init__(self, arrays: Any) -> None:
        self.arrays = arrays
        words, form = list[int](), list[Any]()
        _describe(arrays, words, form)
        self._words = np.array(words, dtype=np.int64)
        self.address = self._words.ctypes.data
        self._numba_type_ = _TYPES.get(tuple(form)) or _TYPES.setdefault(tuple(form), _HandleType(typeof(arrays)))

    def __reduce__(self) -> tuple[Any, ...]:
        """Return the call that rebuilds the handle in a copy or pickle, whose arrays have other addresses."""
        return Handle, (self.arrays,)


def _describe(entry: Any, words: list[int], form: list[Any]) -> None:
    """Append to `words` a number, an array's descriptor or a tuple's members, in Numba's memory layout of 8-byte words.

    A descriptor is owner (zeros), size, item size, data address, shape and strides. Append to `form` all that the Numba
    type of a `Handle` depends on: types, lengths of tuples, numbers of dimensions and flags of arrays.
    """
    if isinstance(entry, tuple):
        form += (type(entry), len(entry))
        for part in entry:
            _describe(part, words, form)
    elif isinstance(entry, np.ndarray):
        form += (entry.dtype, entry.ndim, entry.flags.num)
        words += (0, 0, entry.size, entry.itemsize, entry.ctypes.data, *entry.shape, *entry.strides)
    else:
        form.append(type(entry))
        words.append(int(np.array(entry, dtype=type(entry)).view(np.int64)))


# Handle types by form: Numba's `typeof` reads all arrays and record fields, which takes as long as some steps.
_TYPES: dict[tuple[Any, ...], "_HandleType"] = {}


def arrays_of(handle: Handle) -> Any:
    """Return the named tuple of arrays and numbers to which a handle points; Python and kernels can call this."""
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


# LLVM inlines the function: Numba's own inlining would remove writes to the arrays as dead code.
@overload(arrays_of, jit_options={"forceinline": True, "_nrt": False})
def _compiled_arrays(handle):
    return lambda handle: _loaded(handle)


@intrinsic
def _loaded(typing_context: Any, handle: Any) -> tuple[Signature, Any]:
    def load(builder: ir.IRBuilder, pointer: ir.Value) -> ir.Value:
        """Load a structure member by member, so that the compiler can remove unused members."""
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
