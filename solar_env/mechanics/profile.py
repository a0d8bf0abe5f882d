"""Sparse direct solution of Newton's equations: block triangular factors within the profile of the matrix.

The unknowns are eliminated along the chain of bodies, node by node, every multiplier right after the last coordinate
that it acts on. In this order the profile (A. George and J. W. H. Liu, Computer Solution of Large Sparse Positive
Definite Systems, Prentice-Hall 1981, chapter 4) is narrow, so that work and storage grow linearly with the number of
elements and bodies, and no pivot needs to be exchanged: what precedes a multiplier is the positive definite matrix of
the bodies that it holds together, which makes its own pivot negative.

Places come in blocks of four, the coordinates of a node: products of 4 x 4 blocks keep the processor's vector registers
filled. Places without an unknown fill the blocks of multipliers up.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import njit, njit_allocating, njit_inlined, njit_inner_inlined

BLOCK = 4
_ENTRIES = BLOCK * BLOCK


class Elimination(NamedTuple):
    """Order of the unknowns (coordinates, multipliers of rows, multipliers of lengths) and the profile."""

    position: NDArray[np.int64]  # (unknowns,) place in the order; -1 for those that are held
    empty: NDArray[np.int64]  # places without an unknown
    first: NDArray[np.int64]  # (blocks,) first block in the profile of each row of blocks
    base: NDArray[np.int64]  # (blocks,) the number of block (row, column) is base[row] + column


class ProfileMatrix(NamedTuple):
    """A matrix with a symmetric profile, or its factors, in blocks of BLOCK x BLOCK entries."""

    lower: NDArray[np.float64]  # rows of blocks below the diagonal, one after the other; each block column by column
    upper: NDArray[np.float64]  # columns of blocks above the diagonal, one after the other; each block row by row
    diagonal: NDArray[np.float64]  # blocks on the diagonal, row by row


def make_elimination(position: NDArray[np.int64], couplings: list[tuple[int, int]]) -> Elimination:
    """Profile for an order of elimination, which may leave places empty, and the pairs of unknowns that are coupled."""
    blocks = int(position.max()) // BLOCK + 1 if position.size else 0
    first = np.arange(blocks)
    for i, j in couplings:
        low, high = sorted((int(position[i]), int(position[j])))
        if low >= 0:
            first[high // BLOCK] = min(first[high // BLOCK], low // BLOCK)
    begin = np.concatenate(([0], np.cumsum(np.arange(blocks) - first)[:-1])) if blocks else np.zeros(0, dtype=np.int64)
    return Elimination(
        position.astype(np.int64),
        np.setdiff1d(np.arange(BLOCK * blocks), position).astype(np.int64),
        first.astype(np.int64),
        (begin - first).astype(np.int64),
    )


@njit_allocating
def make_profile_matrix(elimination):
    """Allocate a matrix of zeros, see :func:`clear`."""
    blocks = elimination.first.size
    size = 0
    for r in range(blocks):
        size += r - elimination.first[r]
    matrix = ProfileMatrix(np.zeros(_ENTRIES * size), np.zeros(_ENTRIES * size), np.zeros(_ENTRIES * blocks))
    clear(elimination, matrix)
    return matrix


@njit
def clear(elimination, matrix):
    """Set all entries to zero, but those of empty places on the diagonal to one."""
    for array in (matrix.lower, matrix.upper, matrix.diagonal):
        for i in range(array.size):
            array[i] = 0.0
    for place in elimination.empty:
        matrix.diagonal[_ENTRIES * (place // BLOCK) + (BLOCK + 1) * (place % BLOCK)] = 1.0


@njit_inlined
def add_entry(elimination, matrix, i, j, value):
    """Add to the entry of the unknowns ``i`` (row) and ``j`` (column); nothing if one of them is held."""
    place, other = elimination.position[i], elimination.position[j]
    if place < 0 or other < 0:
        return
    row, column = place // BLOCK, other // BLOCK
    k, c = place % BLOCK, other % BLOCK
    if row > column:
        matrix.lower[_ENTRIES * (elimination.base[row] + column) + BLOCK * c + k] += value
    elif row < column:
        matrix.upper[_ENTRIES * (elimination.base[column] + row) + BLOCK * k + c] += value
    else:
        matrix.diagonal[_ENTRIES * row + BLOCK * k + c] += value


def dense(elimination: Elimination, matrix: ProfileMatrix) -> NDArray[np.float64]:
    """The matrix by unknowns, with zero rows and columns for those that are held."""
    unknowns, blocks = elimination.position.size, elimination.first.size
    lower, upper, diagonal = (array.reshape(-1, BLOCK, BLOCK) for array in matrix)
    ordered = np.zeros((blocks, blocks, BLOCK, BLOCK))
    for r in range(blocks):
        f, b = elimination.first[r], elimination.base[r]
        ordered[r, f:r] = lower[b + f : b + r].transpose(0, 2, 1)
        ordered[f:r, r] = upper[b + f : b + r]
        ordered[r, r] = diagonal[r]
    ordered = ordered.transpose(0, 2, 1, 3).reshape(BLOCK * blocks, BLOCK * blocks)
    result = np.zeros((unknowns, unknowns))
    free = np.flatnonzero(elimination.position >= 0)
    result[np.ix_(free, free)] = ordered[np.ix_(elimination.position[free], elimination.position[free])]
    return result


@njit_inner_inlined
def _subtract_rows(out, i, left, j, right, k):
    """Subtract a product of two blocks, left^T right, from the block that begins at ``out[i]``."""
    for row in range(BLOCK):
        a, b, c, d = left[j + row], left[j + 4 + row], left[j + 8 + row], left[j + 12 + row]
        x = i + BLOCK * row
        y0 = out[x] - a * right[k] - b * right[k + 4] - c * right[k + 8] - d * right[k + 12]
        y1 = out[x + 1] - a * right[k + 1] - b * right[k + 5] - c * right[k + 9] - d * right[k + 13]
        y2 = out[x + 2] - a * right[k + 2] - b * right[k + 6] - c * right[k + 10] - d * right[k + 14]
        y3 = out[x + 3] - a * right[k + 3] - b * right[k + 7] - c * right[k + 11] - d * right[k + 15]
        out[x], out[x + 1], out[x + 2], out[x + 3] = y0, y1, y2, y3


@njit_inner_inlined
def _scale(block, i, inverse, k):
    """Replace the block B that begins at ``block[i]``, column by column, by B times the one at ``inverse[k]``."""
    for row in range(BLOCK):
        b0, b1, b2, b3 = block[i + row], block[i + 4 + row], block[i + 8 + row], block[i + 12 + row]
        y0 = b0 * inverse[k] + b1 * inverse[k + 4] + b2 * inverse[k + 8] + b3 * inverse[k + 12]
        y1 = b0 * inverse[k + 1] + b1 * inverse[k + 5] + b2 * inverse[k + 9] + b3 * inverse[k + 13]
        y2 = b0 * inverse[k + 2] + b1 * inverse[k + 6] + b2 * inverse[k + 10] + b3 * inverse[k + 14]
        y3 = b0 * inverse[k + 3] + b1 * inverse[k + 7] + b2 * inverse[k + 11] + b3 * inverse[k + 15]
        block[i + row], block[i + 4 + row], block[i + 8 + row], block[i + 12 + row] = y0, y1, y2, y3


@njit_inner_inlined
def _invert(block, i, sizes):
    """Invert the block that begins at ``block[i]``, without exchange of pivots.

    False if a pivot is not finite, or has lost all its digits: it is tiny beside the entry in ``sizes`` that it was.
    """
    for p in range(BLOCK):
        x = i + BLOCK * p
        pivot = block[x + p]
        if not 1e-14 * abs(sizes[p]) < abs(pivot) < math.inf:
            return False
        inverse = 1.0 / pivot
        block[x + p] = 1.0
        for c in range(BLOCK):
            block[x + c] *= inverse
        for row in range(BLOCK):
            if row != p:
                factor = block[i + BLOCK * row + p]
                block[i + BLOCK * row + p] = 0.0
                for c in range(BLOCK):
                    block[i + BLOCK * row + c] -= factor * block[x + c]
    return True


@njit
def profile_factor(elimination, matrix):
    """Factor in place into a unit lower and an upper block triangle; False if a pivot vanishes or is not finite.

    The inverses of the blocks on the diagonal are kept there.
    """
    first, base = elimination.first, elimination.base
    lower, upper, diagonal = matrix.lower, matrix.upper, matrix.diagonal
    for r in range(first.size):
        f, row = first[r], base[r]
        for c in range(f, r):
            above, here = base[c], _ENTRIES * (row + c)
            for k in range(max(f, first[c]), c):
                _subtract_rows(upper, here, lower, _ENTRIES * (above + k), upper, _ENTRIES * (row + k))
                _subtract_rows(lower, here, upper, _ENTRIES * (above + k), lower, _ENTRIES * (row + k))
            _scale(lower, here, diagonal, _ENTRIES * c)
        here = _ENTRIES * r
        sizes = (diagonal[here], diagonal[here + 5], diagonal[here + 10], diagonal[here + 15])
        for c in range(f, r):
            _subtract_rows(diagonal, here, lower, _ENTRIES * (row + c), upper, _ENTRIES * (row + c))
        if not _invert(diagonal, here, sizes):
            return False
    return True


@njit
def profile_solve(elimination, matrix, b):
    """Solve in place for ``b`` (places,), in the order of elimination, with the factors of :func:`profile_factor`."""
    first, base = elimination.first, elimination.base
    lower, upper, diagonal = matrix.lower, matrix.upper, matrix.diagonal
    for r in range(first.size):
        x = BLOCK * r
        y0, y1, y2, y3 = b[x], b[x + 1], b[x + 2], b[x + 3]
        for c in range(first[r], r):
            k = _ENTRIES * (base[r] + c)
            for j in range(BLOCK):
                value = b[BLOCK * c + j]
                y0 -= lower[k + 4 * j] * value
                y1 -= lower[k + 4 * j + 1] * value
                y2 -= lower[k + 4 * j + 2] * value
                y3 -= lower[k + 4 * j + 3] * value
        b[x], b[x + 1], b[x + 2], b[x + 3] = y0, y1, y2, y3
    for r in range(first.size - 1, -1, -1):
        x, k = BLOCK * r, _ENTRIES * r
        b0, b1, b2, b3 = b[x], b[x + 1], b[x + 2], b[x + 3]
        y0 = diagonal[k] * b0 + diagonal[k + 1] * b1 + diagonal[k + 2] * b2 + diagonal[k + 3] * b3
        y1 = diagonal[k + 4] * b0 + diagonal[k + 5] * b1 + diagonal[k + 6] * b2 + diagonal[k + 7] * b3
        y2 = diagonal[k + 8] * b0 + diagonal[k + 9] * b1 + diagonal[k + 10] * b2 + diagonal[k + 11] * b3
        y3 = diagonal[k + 12] * b0 + diagonal[k + 13] * b1 + diagonal[k + 14] * b2 + diagonal[k + 15] * b3
        b[x], b[x + 1], b[x + 2], b[x + 3] = y0, y1, y2, y3
        for c in range(first[r], r):
            k = _ENTRIES * (base[r] + c)
            for i in range(BLOCK):
                j = k + BLOCK * i
                b[BLOCK * c + i] -= upper[j] * y0 + upper[j + 1] * y1 + upper[j + 2] * y2 + upper[j + 3] * y3


@njit
def profile_product(elimination, matrix, x, out):
    """Write the matrix times ``x`` to ``out``, both (places,) in the order of elimination."""
    first, base = elimination.first, elimination.base
    lower, upper, diagonal = matrix.lower, matrix.upper, matrix.diagonal
    for r in range(first.size):
        here, k = BLOCK * r, _ENTRIES * r
        x0, x1, x2, x3 = x[here], x[here + 1], x[here + 2], x[here + 3]
        y0 = diagonal[k] * x0 + diagonal[k + 1] * x1 + diagonal[k + 2] * x2 + diagonal[k + 3] * x3
        y1 = diagonal[k + 4] * x0 + diagonal[k + 5] * x1 + diagonal[k + 6] * x2 + diagonal[k + 7] * x3
        y2 = diagonal[k + 8] * x0 + diagonal[k + 9] * x1 + diagonal[k + 10] * x2 + diagonal[k + 11] * x3
        y3 = diagonal[k + 12] * x0 + diagonal[k + 13] * x1 + diagonal[k + 14] * x2 + diagonal[k + 15] * x3
        for c in range(first[r], r):
            k = _ENTRIES * (base[r] + c)
            for j in range(BLOCK):
                value = x[BLOCK * c + j]
                y0 += lower[k + 4 * j] * value
                y1 += lower[k + 4 * j + 1] * value
                y2 += lower[k + 4 * j + 2] * value
                y3 += lower[k + 4 * j + 3] * value
                i = k + BLOCK * j
                out[BLOCK * c + j] += upper[i] * x0 + upper[i + 1] * x1 + upper[i + 2] * x2 + upper[i + 3] * x3
        out[here], out[here + 1], out[here + 2], out[here + 3] = y0, y1, y2, y3
