"""Mechanisms of one structure side by side: every array has a leading axis of lanes, one row for each of them."""

from collections.abc import Iterator
from typing import Any, TypeVar

import numpy as np
from llvmlite import ir
from numba import types
from numba.core.typing.templates import Signature
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import Constraints, Elements, Model, State
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import Elimination

Arrays = TypeVar("Arrays", Model, State)


def with_lane_axis(arrays: Arrays) -> Arrays:
    """The arrays of one mechanism as those of a single lane; they share their memory, numbers are copied."""
    return _mapped(lambda entry: np.asarray(entry)[np.newaxis], arrays)


def allocate_lanes(arrays: Arrays, lanes: int) -> Arrays:
    """Arrays for `lanes` mechanisms like the one whose arrays these are, uninitialised."""

    def allocate(entry: Any) -> NDArray[Any]:
        one: NDArray[Any] = np.asarray(entry)
        return np.empty((lanes, *one.shape), one.dtype)

    return _mapped(allocate, arrays)


def lane_view(lanes: Arrays, lane: int) -> Arrays:
    """The arrays of one lane; they share their memory with those of all."""
    return _mapped(lambda entry: entry[lane], lanes)


def copied(arrays: Arrays) -> Arrays:
    """Independent copies."""
    return _mapped(np.copy, arrays)


def check_structure(lanes: Arrays, arrays: Arrays) -> None:
    """Check that a mechanism's arrays have the shapes of those in the lanes.

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
    """Name, array of all lanes and array of a mechanism for every entry of two named tuples, and of those in them."""
    for name, target, source in zip(lanes._fields, lanes, arrays, strict=True):
        if isinstance(target, tuple):
            yield from _pairs(target, source)
        else:
            yield name, target, source


def _mapped(function: Any, arrays: Any) -> Any:
    """`function` of every array or number of a named tuple of these and of such tuples."""
    if isinstance(arrays, tuple):
        return type(arrays)(*(_mapped(function, entry) for entry in arrays))
    return function(arrays)


@kernel(inlined=True)
def lane_model(models, lane):
    """The model of a lane."""
    constraints, elements, elimination = models.constraints, models.cable_elements, models.elimination
    return Model(
        models.bodies[lane],
        models.markers[lane],
        models.joints[lane],
        models.cables[lane],
        models.drives[lane],
        models.loads[lane],
        models.constant_force[lane],
        Constraints(
            constraints.size[lane],
            constraints.coordinate[lane],
            constraints.value[lane],
            constraints.target[lane],
            constraints.bodies[lane],
            constraints.driven[lane],
        ),
        Elements(elements.offset[lane], elements.inverse_length[lane], elements.constants[lane], elements.filled[lane]),
        models.body_constants[lane],
        Elimination(
            elimination.position[lane], elimination.empty[lane], elimination.first[lane], elimination.base[lane]
        ),
        models.error_weight[lane],
        models.length_scale[lane],
        models.stable_step[lane],
        models.flexible[lane],
    )


@kernel(inlined=True)
def lane_state(states, lane):
    """The state of a lane."""
    return State(
        states.q[lane],
        states.v[lane],
        states.a[lane],
        states.algorithmic_a[lane],
        states.multipliers[lane],
        states.integrals[lane],
        states.power[lane],
        states.joints[lane],
        states.wear_journal[lane],
        states.wear_bearing[lane],
        states.clock[lane],
    )


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
