"""Gaussian elimination of Newton's matrix, whose rows are unknowns with the stages in lanes.

Columns are loads at a stage: column STAGES * c + k of load c at stage k. No pivots are sought: the symmetric part of
the matrix is positive definite.
"""

import numpy as np

from solar_env.mechanics.modal.tables import LANES, STAGES
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import load4, store4

# One in the lanes behind a stage, and in those before it.
_BEHIND = np.array([[float(s > k) for s in range(LANES)] for k in range(STAGES)])
_BEFORE = np.array([[float(s < k) for s in range(LANES)] for k in range(STAGES)])


@kernel
def eliminate(matrix, pivots, first, end):
    """Factor the block of unknowns `first` to `end` of the matrix in place; False if it is not positive definite.

    Args:
        matrix: (STAGES R, R, LANES), by column.
        pivots: (STAGES R,) inverses of the diagonal's; written.
        first, end: of the block.
    """
    for q in range(first, end):
        for k in range(STAGES):
            number = STAGES * q + k
            column = matrix[number]
            pivot = column[q, k]
            if not pivot > 0.0:
                return False
            inverse = 1.0 / pivot
            pivots[number] = inverse
            behind, before, whole = load4(_BEHIND[k], 0), load4(_BEFORE[k], 0), load4(column[q], 0)
            factor = behind * inverse * whole
            store4(column[q], 0, before * whole + factor)
            for i in range(q + 1, end):
                store4(column[i], 0, inverse * load4(column[i], 0))
            for later in range(number + 1, STAGES * end):
                other = matrix[later]
                share = other[q, k]
                store4(other[q], 0, load4(other[q], 0) - factor * share)
                for i in range(q + 1, end):
                    store4(other[i], 0, load4(other[i], 0) - load4(column[i], 0) * share)
    return True


@kernel
def substitute(matrix, pivots, first, end, residual, correction):
    """Solve for the `correction` (R, LANES) of a block by its factors; the `residual` (R, LANES) is overwritten."""
    for q in range(first, end):
        for k in range(STAGES):
            column, share = matrix[STAGES * q + k], residual[q, k]
            store4(residual[q], 0, load4(residual[q], 0) - load4(_BEHIND[k], 0) * load4(column[q], 0) * share)
            for i in range(q + 1, end):
                store4(residual[i], 0, load4(residual[i], 0) - load4(column[i], 0) * share)
    for up in range(end - first):
        q = end - 1 - up
        for back in range(STAGES):
            k = STAGES - 1 - back
            column, solved = matrix[STAGES * q + k], residual[q, k] * pivots[STAGES * q + k]
            correction[q, k] = solved
            store4(residual[q], 0, load4(residual[q], 0) - load4(_BEFORE[k], 0) * load4(column[q], 0) * solved)
            for i in range(first, q):
                store4(residual[i], 0, load4(residual[i], 0) - load4(column[i], 0) * solved)
        for s in range(STAGES, LANES):
            correction[q, s] = correction[q, STAGES - 1]
