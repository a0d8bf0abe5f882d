"""Sparse direct solution of Newton's equations: triangular factors within the profile of the matrix.

The unknowns are eliminated along the chain of bodies, node by node, every multiplier right after the last coordinate
that it acts on. In this order the profile (A. George and J. W. H. Liu, Computer Solution of Large Sparse Positive
Definite Systems, Prentice-Hall 1981, chapter 4) is narrow, so that work and storage grow linearly with the number of
elements and bodies, and no pivot needs to be exchanged: what precedes a multiplier is the positive definite matrix of
the bodies that it holds together, which makes its own pivot negative.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import njit, njit_allocating, njit_inlined


class Elimination(NamedTuple):
    """Order of the unknowns (coordinates, multipliers of rows, multipliers of lengths) and the profile."""

    position: NDArray[np.int64]  # (unknowns,) place in the order; -1 for those that are held
    first: NDArray[np.int64]  # (places,) first place in the profile of each row
    base: NDArray[np.int64]  # (places,) index of entry (row, column) is base[row] + column


class ProfileMatrix(NamedTuple):
    """A matrix with a symmetric profile, or its factors."""

    lower: NDArray[np.float64]  # rows below the diagonal, one after the other
    upper: NDArray[np.float64]  # columns above the diagonal, one after the other
    diagonal: NDArray[np.float64]


def make_elimination(position: NDArray[np.int64], couplings: list[tuple[int, int]]) -> Elimination:
    """Profile for an order of elimination and the pairs of unknowns that are coupled."""
    places = int(position.max()) + 1 if position.size else 0
    first = np.arange(places)
    for i, j in couplings:
        low, high = sorted((int(position[i]), int(position[j])))
        if low >= 0:
            first[high] = min(first[high], low)
    begin = np.concatenate(([0], np.cumsum(np.arange(places) - first)[:-1])) if places else np.zeros(0, dtype=np.int64)
    return Elimination(position.astype(np.int64), first.astype(np.int64), (begin - first).astype(np.int64))


@njit_allocating
def make_profile_matrix(elimination):
    """Allocate a matrix of zeros."""
    places = elimination.first.size
    size = 0
    for r in range(places):
        size += r - elimination.first[r]
    return ProfileMatrix(np.zeros(size), np.zeros(size), np.zeros(places))


@njit
def clear(matrix):
    """Set all entries to zero."""
    for array in (matrix.lower, matrix.upper, matrix.diagonal):
        for i in range(array.size):
            array[i] = 0.0


@njit_inlined
def add_entry(elimination, matrix, i, j, value):
    """Add to the entry of the unknowns ``i`` (row) and ``j`` (column); nothing if one of them is held."""
    row, column = elimination.position[i], elimination.position[j]
    if row < 0 or column < 0:
        return
    if row > column:
        matrix.lower[elimination.base[row] + column] += value
    elif row < column:
        matrix.upper[elimination.base[column] + row] += value
    else:
        matrix.diagonal[row] += value


def dense(elimination: Elimination, matrix: ProfileMatrix) -> NDArray[np.float64]:
    """The matrix by unknowns, with zero rows and columns for those that are held."""
    unknowns, places = elimination.position.size, elimination.first.size
    ordered = np.diag(matrix.diagonal)
    for r in range(places):
        f, b = elimination.first[r], elimination.base[r]
        ordered[r, f:r] = matrix.lower[b + f : b + r]
        ordered[f:r, r] = matrix.upper[b + f : b + r]
    result = np.zeros((unknowns, unknowns))
    free = np.flatnonzero(elimination.position >= 0)
    result[np.ix_(free, free)] = ordered[np.ix_(elimination.position[free], elimination.position[free])]
    return result


@njit
def profile_factor(elimination, matrix):
    """Factor in place into a unit lower and an upper triangle; False if a pivot vanishes or is not finite."""
    first, base = elimination.first, elimination.base
    lower, upper, diagonal = matrix.lower, matrix.upper, matrix.diagonal
    for r in range(first.size):
        f, br = first[r], base[r]
        for c in range(f, r):
            bc = base[c]
            above, left = upper[br + c], lower[br + c]
            for k in range(max(f, first[c]), c):
                above -= lower[bc + k] * upper[br + k]
                left -= lower[br + k] * upper[bc + k]
            upper[br + c] = above
            lower[br + c] = left * diagonal[c]
        pivot = diagonal[r]
        size = abs(pivot)
        for k in range(f, r):
            pivot -= lower[br + k] * upper[br + k]
        # A pivot lost to cancellation would leave no digits.
        if not 1e-14 * size < abs(pivot) < math.inf:
            return False
        # Kept inverted.
        diagonal[r] = 1.0 / pivot
    return True


@njit
def profile_solve(elimination, matrix, b):
    """Solve in place for ``b`` (places,), in the order of elimination, with the factors of :func:`profile_factor`."""
    first, base = elimination.first, elimination.base
    lower, upper, diagonal = matrix.lower, matrix.upper, matrix.diagonal
    for r in range(first.size):
        br = base[r]
        total = b[r]
        for k in range(first[r], r):
            total -= lower[br + k] * b[k]
        b[r] = total
    for r in range(first.size - 1, -1, -1):
        br = base[r]
        value = b[r] * diagonal[r]
        b[r] = value
        for k in range(first[r], r):
            b[k] -= upper[br + k] * value
