"""Calls of compiled kernels by address, so that the callers of a long kernel do not compile it again."""

from typing import Any

import numba
from llvmlite import ir
from numba import typeof, types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.core.typing.templates import Signature
from numba.extending import intrinsic, overload


def address_of(kernel: Any, *arguments: Any) -> int:
    """Return the address in this process of a kernel's code for arguments of these types; 0 if compilation is disabled.

    The code is the same as for calls from Python. It is compiled or loaded if necessary.
    """
    if numba.config.DISABLE_JIT:
        return 0
    signature = tuple(map(typeof, arguments))
    kernel.from_python.compile(signature)
    found = kernel.from_python.overloads[signature]
    return int(found.library.get_pointer_to_function(found.fndesc.llvm_func_name))


def call_at(address: int, kernel: Any, *arguments: Any) -> Any:
    """Call a kernel's compiled code at the `address` that `address_of` has returned for arguments of the same types.

    A compiled caller takes only the result's type from `kernel`. A call from Python runs `kernel` without `address`.
    """
    return kernel(*arguments)


@overload(call_at)
def _compiled_call(address, kernel, *arguments):
    return lambda address, kernel, *arguments: _call(address, kernel, arguments)


@intrinsic
def _call(typing_context: Any, address: Any, kernel: Any, arguments: Any) -> tuple[Signature, Any]:
    kinds = tuple(arguments.types)
    found = kernel.dispatcher.from_python.overloads.get(kinds)
    if found is None:
        raise TypingError(f"{kernel.dispatcher.py_func.__name__} has no address for arguments of the types {kinds}")
    returned = found.signature.return_type

    def generate(context: Any, builder: ir.IRBuilder, signature: Signature, values: Any) -> ir.Value:
        convention = context.call_conv
        pointer = convention.get_function_type(returned, kinds).as_pointer()
        function, unpacked = builder.inttoptr(values[0], pointer), cgutils.unpack_tuple(builder, values[2])
        status, result = convention.call_function(builder, function, returned, kinds, unpacked)
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return result

    return returned(types.int64, kernel, arguments), generate
