"""Vectors of four or eight doubles as values inside kernels, which keep them in the processor's registers.

Numba adds up in strict order and must assume that arrays overlap, so that it seldom vectorizes short loops. Loops over
the stages of a step use vectors instead, with one lane per stage: `x = load8(row, 0) * 2.0 + splat8(y)`. Without the
compiler the same expressions act on NumPy arrays.
"""

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin, models, register_model, type_callable

_INDEX = ir.IntType(32)


class Vector(types.Type):
    """Numba type of a vector of four or eight doubles."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"Vector({width})")


@register_model(Vector)
class VectorModel(models.PrimitiveModel):
    """Numba's data model of a `Vector`: LLVM's vector type."""

    def __init__(self, manager: Any, kind: Vector) -> None:
        super().__init__(manager, kind, ir.VectorType(ir.DoubleType(), kind.width))


VECTORS = {width: Vector(width) for width in (4, 8)}


def _widened(builder: Any, kind: Any, value: Any, width: int) -> Any:
    """Return `value`, whose Numba type is `kind`, if it is a vector; return a number as a vector of `width` copies."""
    if isinstance(kind, Vector):
        return value
    if isinstance(kind, types.Integer):
        value = builder.sitofp(value, ir.DoubleType())
    undefined = ir.Constant(ir.VectorType(ir.DoubleType(), width), ir.Undefined)
    one = builder.insert_element(undefined, value, ir.Constant(_INDEX, 0))
    return builder.shuffle_vector(one, undefined, ir.Constant(ir.VectorType(_INDEX, width), [0] * width))


def _typed(function: Callable[..., Any], result: Callable[..., Any]) -> None:
    """Register with Numba the type of a function's result; `result` computes it from the types of the arguments."""
    type_callable(function)(lambda context: result)


def _place(context: Any, builder: Any, kind: Any, array: Any, first: Any, width: int) -> Any:
    """Return a pointer to `width` numbers from index `first` of a contiguous array, whose Numba type is `kind`."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [first]), ir.VectorType(ir.DoubleType(), width).as_pointer())


def _width(width: int) -> tuple[Callable[..., Any], Callable[..., Any], Callable[..., Any]]:
    """Make the functions `load`, `store` and `splat` for vectors with `width` lanes."""

    def load(array: Any, first: int) -> Any:
        return array[first : first + width].copy()

    def store(array: Any, first: int, vector: Any) -> None:
        array[first : first + width] = vector

    def splat(number: float) -> Any:
        return np.full(width, float(number))

    # The array must be contiguous; the array's type does not always tell whether it is.
    _typed(load, lambda array, first: VECTORS[width])
    _typed(store, lambda array, first, vector: types.none)
    _typed(splat, lambda number: VECTORS[width])

    @lower_builtin(load, types.Array, types.Integer)
    def lower_load(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.load(_place(context, builder, sig.args[0], args[0], args[1], width), align=8)

    @lower_builtin(store, types.Array, types.Integer, Vector)
    def lower_store(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _place(context, builder, sig.args[0], args[0], args[1], width), align=8)
        return context.get_dummy_value()

    @lower_builtin(splat, types.Float)
    def lower_splat(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _widened(builder, sig.args[0], args[0], width)

    return load, store, splat


load4, store4, splat4 = _width(4)
load8, store8, splat8 = _width(8)


def lane(vector: Any, number: int) -> Any:
    """Return the element of a vector of four or eight doubles at index `number`."""
    return vector[number]


_typed(lane, lambda vector, number: types.float64)


@lower_builtin(lane, Vector, types.Integer)
def _lane(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.extract_element(args[0], builder.trunc(args[1], _INDEX))


def sum_lanes(vector: Any) -> Any:
    """Return the sum of a vector's lanes; return a number unchanged."""
    return np.sum(vector)


_typed(sum_lanes, lambda vector: types.float64)


@lower_builtin(sum_lanes, Vector)
@lower_builtin(sum_lanes, types.Float)
def _sum_lanes(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    total = args[0]
    if isinstance(sig.args[0], Vector):
        lanes = [builder.extract_element(total, ir.Constant(_INDEX, k)) for k in range(sig.args[0].width)]
        while len(lanes) > 1:
            pairs = zip(lanes[::2], lanes[1::2], strict=True)
            lanes = [builder.fadd(one, other) for one, other in pairs]
        total = lanes[0]
    return total


def third_repeated(vector: Any) -> Any:
    """Return a vector of eight lanes with the fourth replaced by the third, and the eighth by the seventh."""
    return vector[[0, 1, 2, 2, 4, 5, 6, 6]]


_typed(third_repeated, lambda vector: vector)


@lower_builtin(third_repeated, Vector)
def _third_repeated(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    lanes = ir.Constant(ir.VectorType(_INDEX, 8), [0, 1, 2, 2, 4, 5, 6, 6])
    return builder.shuffle_vector(args[0], args[0], lanes)


def lower_half(vector: Any) -> Any:
    """Return the first four lanes of a vector of eight."""
    return vector[:4].copy()


def upper_half(vector: Any) -> Any:
    """Return the last four lanes of a vector of eight."""
    return vector[4:].copy()


for _half, _first in ((lower_half, 0), (upper_half, 4)):
    _typed(_half, lambda vector: VECTORS[4])

    @lower_builtin(_half, Vector)
    def _lower_half(context: Any, builder: Any, sig: Any, args: Any, first: int = _first) -> Any:
        lanes = ir.Constant(ir.VectorType(_INDEX, 4), [first + k for k in range(4)])
        return builder.shuffle_vector(args[0], args[0], lanes)


def joined(lower: Any, upper: Any) -> Any:
    """Return one vector of eight lanes, joined from two vectors of four."""
    return np.concatenate([lower, upper])


_typed(joined, lambda lower, upper: VECTORS[8])


@lower_builtin(joined, Vector, Vector)
def _joined(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.shuffle_vector(*args, ir.Constant(ir.VectorType(_INDEX, 8), list(range(8))))


def _call(builder: Any, name: str, result: Any, args: Any) -> Any:
    """Call LLVM's function `name` on numbers, or on vectors lane by lane; `result` is the result's Numba type."""
    kinds = [value.type for value in args]
    suffix = f"v{result.width}f64" if isinstance(result, Vector) else "f64"
    function = ir.FunctionType(kinds[0], kinds)
    return builder.call(cgutils.get_or_insert_function(builder.module, function, f"llvm.{name}.{suffix}"), args)


def square_roots(vector: Any) -> Any:
    """Return the square root of a number, or of every lane of a vector."""
    return np.sqrt(vector)


_typed(square_roots, lambda number: number)


@lower_builtin(square_roots, Vector)
@lower_builtin(square_roots, types.Float)
def _square_roots(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return _call(builder, "sqrt", sig.return_type, args)


def cube_roots(vector: Any) -> Any:
    """Return the cube root of every lane of a vector, whose lanes must not be negative."""
    return np.cbrt(vector)


_typed(cube_roots, lambda vector: vector)
# The high half of a double's bits divided by three, plus this number, is its cube root's high half to 5 % (W. Kahan and
# K. C. Ng's approximation, in the C library of FreeBSD: s_cbrt.c).
_THIRD_OF_BIAS = 715094163


@lower_builtin(cube_roots, Vector)
def _cube_roots(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    width, vector = sig.return_type.width, args[0]
    halves, wholes = ir.VectorType(ir.IntType(32), width), ir.VectorType(ir.IntType(64), width)

    def repeated(kind: Any, number: int) -> Any:
        return ir.Constant(kind, [number] * width)

    high = builder.lshr(builder.bitcast(vector, wholes), repeated(wholes, 32))
    third = builder.udiv(builder.trunc(high, halves), repeated(halves, 3))
    near = builder.zext(builder.add(third, repeated(halves, _THIRD_OF_BIAS)), wholes)
    root = builder.bitcast(builder.shl(near, repeated(wholes, 32)), vector.type)
    # E. Halley's iteration: each pass leaves less than the cube of the error.
    for _ in range(3):
        cube = builder.fmul(root, builder.fmul(root, root))
        above = builder.fadd(cube, builder.fadd(vector, vector))
        root = builder.fmul(root, builder.fdiv(above, builder.fadd(builder.fadd(cube, cube), vector)))
    return root


def where_less(one: Any, other: Any, chosen: Any, otherwise: Any) -> Any:
    """Return `chosen` where `one` is less than `other`, and `otherwise` elsewhere, for numbers or lane by lane."""
    return np.where(one < other, chosen, otherwise)


def _wider(*kinds: Any) -> Any:
    """Return the result type of an operation: the vector type if one operand is a vector, else a double."""
    return next((kind for kind in kinds if isinstance(kind, Vector)), types.float64)


_typed(where_less, lambda one, other, chosen, otherwise: _wider(one, other, chosen, otherwise))


@lower_builtin(where_less, types.Any, types.Any, types.Any, types.Any)
def _where_less(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    if isinstance(sig.return_type, Vector):
        args = [_widened(builder, *pair, sig.return_type.width) for pair in zip(sig.args, args, strict=True)]
    return builder.select(builder.fcmp_ordered("<", args[0], args[1]), args[2], args[3])


@infer_global(operator.pow)
class _Power(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        return signature(args[0], args[0], types.float64) if isinstance(args[0], Vector) else None


@lower_builtin(operator.pow, Vector, types.Float)
def _raised(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    # Not LLVM's own function: LLVM takes that to be cheap and would raise to powers on both sides of a branch.
    number = ir.DoubleType()
    function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(number, [number] * 2), "pow")
    vector = args[0]
    for k in range(sig.return_type.width):
        place = ir.Constant(_INDEX, k)
        raised = builder.call(function, [builder.extract_element(vector, place), args[1]])
        vector = builder.insert_element(vector, raised, place)
    return vector


@infer_global(abs)
@infer_global(operator.neg)
class _OfOneVector(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        return signature(args[0], args[0]) if isinstance(args[0], Vector) else None


@lower_builtin(operator.neg, Vector)
def _negated(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.fneg(args[0])


@lower_builtin(abs, Vector)
def _magnitude(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return _call(builder, "fabs", sig.return_type, args)


def _arithmetic(operation: Callable[..., Any], instruction: str) -> None:
    """Let kernels apply `operation` to two vectors, or vector and number, by an LLVM `instruction` such as "fadd"."""

    @infer_global(operation)
    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            vector = _wider(*args)
            if isinstance(vector, Vector) and all(
                isinstance(kind, (Vector, types.Float, types.Integer)) for kind in args
            ):
                return signature(vector, *(kind if isinstance(kind, Vector) else types.float64 for kind in args))
            return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        width = sig.return_type.width
        vectors = [_widened(builder, kind, value, width) for kind, value in zip(sig.args, args, strict=True)]
        return getattr(builder, instruction)(*vectors, flags=("contract",))

    for kinds in ((Vector, Vector), (Vector, types.Float), (types.Float, Vector)):
        lower_builtin(operation, *kinds)(lower)


for _operation, _instruction in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _arithmetic(_operation, _instruction)
