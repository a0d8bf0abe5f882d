"""Sparse direct solver for the linear equations of implicit steps, with block triangular factors in a matrix profile.

The unknowns are eliminated along the chain of bodies, node by node, every multiplier right after the last coordinate
that it acts on. In this order the profile (A. George and J. W. H. Liu, Computer Solution of Large Sparse Positive
Definite Systems, Prentice-Hall 1981, chapter 4) is narrow: work and storage grow linearly with the bodies and elements.
Pivots need no exchange: the positive definite matrix of a multiplier's bodies precedes it and makes its pivot negative.

Positions in the order come in blocks of four, the coordinates of a node: products of 4 x 4 blocks keep the processor's
vector registers filled. Empty positions, which have no unknown, fill up the blocks of multipliers.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.numerics.jit import kernel

BLOCK = 4
_ENTRIES = BLOCK * BLOCK
# Shift and mask that give a position's block, and its entry in the block, without a division.
_SHIFT, _REST = 2, 3


class Elimination(NamedTuple):
    """Elimination order of coordinates and constraint multipliers, and matrix profile (rows' first nonzero blocks)."""

    position: NDArray[np.int64]  # (unknowns,) position in the order; -1 for held unknowns
    empty: NDArray[np.int64]  # positions without an unknown
    first: NDArray[np.int64]  # (blocks,) first block in the profile of each row of blocks
    base: NDArray[np.int64]  # (blocks,) the number of block (row, column) is base[row] + column


class ProfileMatrix(NamedTuple):
    """A matrix with a symmetric profile, or its factors, in blocks of BLOCK x BLOCK entries."""

    lower: NDArray[np.float64]  # (.., 16) rows of blocks below the diagonal, in turn; each block column by column
    upper: NDArray[np.float64]  # (.., 16) columns of blocks above the diagonal, in turn; each block row by row
    diagonal: NDArray[np.float64]  # (blocks, 16) blocks on the diagonal, row by row


def make_elimination(position: NDArray[np.int64], couplings: list[tuple[int, int]]) -> Elimination:
    """Return the `Elimination` of matrices whose nonzero entries join the pairs of unknowns (indices) in `couplings`.

    `position` is each unknown's place in the elimination order, or -1 if it is not solved for; places may stay empty.
    """
    blocks = int(position.max()) // BLOCK + 1 if position.size else 0
    first = np.arange(blocks)
    places = np.sort(position[np.array(couplings, dtype=np.int64).reshape(-1, 2)], axis=1)
    low, high = places[places[:, 0] >= 0].T // BLOCK
    np.minimum.at(first, high, low)
    begin = np.concatenate(([0], np.cumsum(np.arange(blocks) - first)[:-1])) if blocks else np.zeros(0, dtype=np.int64)
    return Elimination(
        position.astype(np.int64),
        np.setdiff1d(np.arange(BLOCK * blocks), position).astype(np.int64),
        first.astype(np.int64),
        (begin - first).astype(np.int64),
    )


def make_profile_matrix(elimination: Elimination) -> ProfileMatrix:
    """Allocate a profile matrix, and initialize it by `clear`."""
    blocks = elimination.first.size
    size = int((np.arange(blocks) - elimination.first).sum())
    matrix = ProfileMatrix(np.zeros((size, _ENTRIES)), np.zeros((size, _ENTRIES)), np.zeros((blocks, _ENTRIES)))
    clear(elimination, matrix)
    return matrix


@kernel(inlined=False)
def clear(elimination, matrix):
    """Set a `ProfileMatrix` to zero, and its diagonal to one at `elimination.empty`, the positions without unknowns."""
    for array in (matrix.lower, matrix.upper, matrix.diagonal):
        for i in range(array.shape[0]):
            for k in range(_ENTRIES):
                array[i, k] = 0.0
    for place in elimination.empty:
        matrix.diagonal[place // BLOCK, (BLOCK + 1) * (place % BLOCK)] = 1.0


@kernel
def add_entry(elimination, matrix, i, j, value):
    """Add `value` to the entry of unknowns `i` (row), `j` (column); do nothing if one is held (not solved for)."""
    place, other = elimination.position[i], elimination.position[j]
    if place < 0 or other < 0:
        return
    row, column = place >> _SHIFT, other >> _SHIFT
    k, c = place & _REST, other & _REST
    if row > column:
        matrix.lower[elimination.base[row] + column, BLOCK * c + k] += value
    elif row < column:
        matrix.upper[elimination.base[column] + row, BLOCK * k + c] += value
    else:
        matrix.diagonal[row, BLOCK * k + c] += value


def dense(elimination: Elimination, matrix: ProfileMatrix) -> NDArray[np.float64]:
    """Return a profile matrix as a dense array in the order of unknowns' indices, zero for those not solved for."""
    unknowns, blocks = elimination.position.size, elimination.first.size
    lower, upper, diagonal = (array.reshape(-1, BLOCK, BLOCK) for array in matrix)
    ordered = np.zeros((blocks, blocks, BLOCK, BLOCK))
    for r in range(blocks):
        f, b = elimination.first[r], elimination.base[r]
        ordered[r, f:r] = lower[b + f : b + r].transpose(0, 2, 1)
        ordered[f:r, r] = upper[b + f : b + r]
        ordered[r, r] = diagonal[r]
    by_place = ordered.transpose(0, 2, 1, 3).reshape(BLOCK * blocks, BLOCK * blocks)
    result = np.zeros((unknowns, unknowns))
    free = np.flatnonzero(elimination.position >= 0)
    result[np.ix_(free, free)] = by_place[np.ix_(elimination.position[free], elimination.position[free])]
    return result


@kernel
def enter(x, place, value):
    """Set entry number `place` of a vector, stored in blocks as `x` (blocks, BLOCK), to `value`; -1 does nothing."""
    if place >= 0:
        x[place >> _SHIFT, place & _REST] = value


@kernel
def add_to(x, place, value):
    """Add `value` to entry `place` of a vector `x` (blocks, BLOCK); do nothing for -1 (unknown not solved for)."""
    if place >= 0:
        x[place >> _SHIFT, place & _REST] += value


@kernel
def taken(x, place):
    """Return entry `place` of the flattened vector `x` (blocks, BLOCK); zero for -1, an unknown not solved for."""
    return x[place >> _SHIFT, place & _REST] if place >= 0 else 0.0


# Blocks are passed as views: from the constant indices, the compiler knows that the entries do not overlap.


@kernel
def _subtract_product(out, left, right):
    """Subtract left^T right from the block `out`; all three blocks are stored row by row."""
    for i in range(BLOCK):
        a, b, c, d = left[i], left[4 + i], left[8 + i], left[12 + i]
        y0 = out[4 * i] - a * right[0] - b * right[4] - c * right[8] - d * right[12]
        y1 = out[4 * i + 1] - a * right[1] - b * right[5] - c * right[9] - d * right[13]
        y2 = out[4 * i + 2] - a * right[2] - b * right[6] - c * right[10] - d * right[14]
        y3 = out[4 * i + 3] - a * right[3] - b * right[7] - c * right[11] - d * right[15]
        out[4 * i], out[4 * i + 1], out[4 * i + 2], out[4 * i + 3] = y0, y1, y2, y3


@kernel
def _scale(block, inverse):
    """Replace a 4 x 4 matrix B, stored by columns in `block`, by B times the matrix `inverse`, stored by rows."""
    for i in range(BLOCK):
        b0, b1, b2, b3 = block[i], block[4 + i], block[8 + i], block[12 + i]
        y0 = b0 * inverse[0] + b1 * inverse[4] + b2 * inverse[8] + b3 * inverse[12]
        y1 = b0 * inverse[1] + b1 * inverse[5] + b2 * inverse[9] + b3 * inverse[13]
        y2 = b0 * inverse[2] + b1 * inverse[6] + b2 * inverse[10] + b3 * inverse[14]
        y3 = b0 * inverse[3] + b1 * inverse[7] + b2 * inverse[11] + b3 * inverse[15]
        block[i], block[4 + i], block[8 + i], block[12 + i] = y0, y1, y2, y3


@kernel
def _invert(block, s0, s1, s2, s3):
    """Invert a block in place without exchange of pivots.

    Return False if a pivot is not finite or has lost all digits, compared with its original entry (`s0` to `s3`).
    """
    sizes = (s0, s1, s2, s3)
    for p in range(BLOCK):
        pivot = block[5 * p]
        if not 1e-14 * abs(sizes[p]) < abs(pivot) < math.inf:
            return False
        inverse = 1.0 / pivot
        block[5 * p] = 1.0
        r0, r1 = block[4 * p] * inverse, block[4 * p + 1] * inverse
        r2, r3 = block[4 * p + 2] * inverse, block[4 * p + 3] * inverse
        for row in range(BLOCK):
            if row != p:
                factor = block[4 * row + p]
                block[4 * row + p] = 0.0
                block[4 * row] -= factor * r0
                block[4 * row + 1] -= factor * r1
                block[4 * row + 2] -= factor * r2
                block[4 * row + 3] -= factor * r3
        block[4 * p], block[4 * p + 1], block[4 * p + 2], block[4 * p + 3] = r0, r1, r2, r3
    return True


@kernel(inlined=False)
def profile_factor(elimination, matrix):
    """Factor a profile matrix, in the order `elimination`, in place into a unit lower and an upper block triangle.

    The diagonal blocks are replaced by their inverses. Return False if a pivot is not finite or has lost all digits.
    """
    first, base = elimination.first, elimination.base
    lower, upper, diagonal = matrix.lower, matrix.upper, matrix.diagonal
    for r in range(first.size):
        f, row = first[r], base[r]
        pivot = diagonal[r]
        s0, s1, s2, s3 = pivot[0], pivot[5], pivot[10], pivot[15]
        for c in range(f, r):
            above, left, right = base[c], lower[row + c], upper[row + c]
            for k in range(max(f, first[c]), c):
                _subtract_product(right, lower[above + k], upper[row + k])
                _subtract_product(left, upper[above + k], lower[row + k])
            _scale(left, diagonal[c])
            _subtract_product(pivot, left, right)
        if not _invert(pivot, s0, s1, s2, s3):
            return False
    return True


@kernel
def _times(block, x0, x1, x2, x3):
    """Return the product of a block, stored row by row, and the vector (x0, x1, x2, x3)."""
    return (
        block[0] * x0 + block[1] * x1 + block[2] * x2 + block[3] * x3,
        block[4] * x0 + block[5] * x1 + block[6] * x2 + block[7] * x3,
        block[8] * x0 + block[9] * x1 + block[10] * x2 + block[11] * x3,
        block[12] * x0 + block[13] * x1 + block[14] * x2 + block[15] * x3,
    )


@kernel
def _transposed_times(block, x):
    """Return the four entries of B x for the 4 x 4 matrix B, which `block` (16,) holds by columns, and `x` (4,)."""
    a, b, c, d = x[0], x[1], x[2], x[3]
    return (
        block[0] * a + block[4] * b + block[8] * c + block[12] * d,
        block[1] * a + block[5] * b + block[9] * c + block[13] * d,
        block[2] * a + block[6] * b + block[10] * c + block[14] * d,
        block[3] * a + block[7] * b + block[11] * c + block[15] * d,
    )


@kernel(inlined=False)
def profile_solve(elimination, matrix, b):
    """Replace `b` (blocks, BLOCK), in elimination order, by the solution, with factors from `profile_factor`."""
    first, base = elimination.first, elimination.base
    lower, upper, diagonal = matrix.lower, matrix.upper, matrix.diagonal
    for r in range(first.size):
        here = b[r]
        y0, y1, y2, y3 = here[0], here[1], here[2], here[3]
        for c in range(first[r], r):
            x0, x1, x2, x3 = _transposed_times(lower[base[r] + c], b[c])
            y0, y1, y2, y3 = y0 - x0, y1 - x1, y2 - x2, y3 - x3
        here[0], here[1], here[2], here[3] = y0, y1, y2, y3
    for r in range(first.size - 1, -1, -1):
        here = b[r]
        y0, y1, y2, y3 = _times(diagonal[r], here[0], here[1], here[2], here[3])
        here[0], here[1], here[2], here[3] = y0, y1, y2, y3
        for c in range(first[r], r):
            x0, x1, x2, x3 = _times(upper[base[r] + c], y0, y1, y2, y3)
            there = b[c]
            there[0] -= x0
            there[1] -= x1
            there[2] -= x2
            there[3] -= x3


@kernel(inlined=False)
def profile_product(elimination, matrix, x, out):
    """Write a `ProfileMatrix` times `x` to `out`; both vectors (blocks, BLOCK) are in the order of an `Elimination`."""
    first, base = elimination.first, elimination.base
    lower, upper, diagonal = matrix.lower, matrix.upper, matrix.diagonal
    for r in range(first.size):
        here = x[r]
        x0, x1, x2, x3 = here[0], here[1], here[2], here[3]
        y0, y1, y2, y3 = _times(diagonal[r], x0, x1, x2, x3)
        for c in range(first[r], r):
            z0, z1, z2, z3 = _transposed_times(lower[base[r] + c], x[c])
            y0, y1, y2, y3 = y0 + z0, y1 + z1, y2 + z2, y3 + z3
            z0, z1, z2, z3 = _times(upper[base[r] + c], x0, x1, x2, x3)
            there = out[c]
            there[0] += z0
            there[1] += z1
            there[2] += z2
            there[3] += z3
        result = out[r]
        result[0], result[1], result[2], result[3] = y0, y1, y2, y3
