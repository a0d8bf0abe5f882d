"""Arrays that cross to kernels as one address, and kernels that are called by theirs."""

from __future__ import annotations

import copy
import pickle
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba import njit
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import record
from solar_env.mechanics.joints.wear import pressed_half_angle
from solar_env.mechanics.numerics.by_address import address_of, call_at
from solar_env.mechanics.numerics.handles import Handle, arrays_of

row_type = record([("count", np.int64), ("length", np.float64)])


class Inner(NamedTuple):
    rows: NDArray[np.void]
    factor: float


class Outer(NamedTuple):
    matrix: NDArray[np.float64]
    inner: Inner
    number: int
    empty: NDArray[np.float64]


@njit
def look(handle, row):
    """Sum of an entry of everything in `Outer`; raises the entry of the matrix by one."""
    arrays = arrays_of(handle)
    chosen = arrays.inner.rows[row]
    arrays.matrix[1, row] += 1.0
    return (
        arrays.matrix[1, row] + arrays.inner.factor * chosen.length + chosen.count + arrays.number + arrays.empty.size
    )


def arrays() -> Outer:
    rows = np.zeros(3, row_type)
    rows["count"], rows["length"] = (1, 2, 3), (0.5, 0.25, 0.125)
    return Outer(np.arange(6.0).reshape(2, 3), Inner(rows, 8.0), 100, np.zeros(0))


def test_a_handle_shows_kernels_all_that_its_tuple_holds_and_shares_its_memory() -> None:
    seen = arrays()
    handle = Handle(seen)
    assert look(handle, 2) == (5.0 + 1.0) + 8.0 * 0.125 + 3 + 100
    assert seen.matrix[1, 2] == 6.0
    seen.inner.rows["count"] = 50
    assert look(handle, 0) == (3.0 + 1.0) + 8.0 * 0.5 + 50 + 100


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda handle: pickle.loads(pickle.dumps(handle))])
def test_copies_of_handles_have_arrays_of_their_own(copied) -> None:
    handle = Handle(arrays())
    other = copied(handle)
    assert look(other, 1) == look(handle, 1)
    assert other.arrays.matrix[1, 1] == handle.arrays.matrix[1, 1] == 5.0
    look(other, 1)
    assert (other.arrays.matrix[1, 1], handle.arrays.matrix[1, 1]) == (6.0, 5.0)


def test_arrays_with_gaps_and_tuples_of_other_shapes_are_seen_right() -> None:
    whole = arrays()
    spread = np.zeros((2, 6))
    spread[:, ::2] = whole.matrix
    assert look(Handle(whole._replace(matrix=spread[:, ::2])), 2) == look(Handle(arrays()), 2)
    assert look(Handle(whole._replace(matrix=np.asfortranarray(whole.matrix))), 2) == look(Handle(arrays()), 2)


@njit
def twice(address, x, y):
    return 2.0 * call_at(address, pressed_half_angle, x, y)


def test_a_kernel_called_by_its_address_gives_what_it_gives_when_called() -> None:
    address = address_of(pressed_half_angle, 1e-4, 1e-4)
    assert twice(address, 1e-4, 3e-4) == 2.0 * pressed_half_angle(1e-4, 3e-4)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_call_with_arguments_of_other_types_than_the_address_is_for_is_refused() -> None:
    address = address_of(pressed_half_angle, 1e-4, 1e-4)
    with pytest.raises(numba.TypingError, match="pressed_half_angle has no address for arguments of the types"):
        twice(address, 1e-4, np.float32(3e-4))
