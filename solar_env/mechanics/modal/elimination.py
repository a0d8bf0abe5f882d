"""Gaussian elimination of Newton's matrix in 3 x 3 blocks: each couples two unknown loads at a step's three stages.

Entry [3 c + k, r, s] of R loads' matrix (3 R, R, 4) is load c's coefficient at stage k in load r's equation at stage s;
a fourth s pads a SIMD vector. No pivots are needed: the matrix's symmetric part is positive definite.
"""

from solar_env.mechanics.modal.tables import STAGES
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import load4, store4

_SINGULAR = 1e-30  # least determinant of a diagonal block; rows are scaled to diagonals of about one: less is rounding


@kernel
def invert(matrix, q, inverse):
    """Write the inverse of load `q`'s diagonal block (3 stages) to `inverse[column, row]`; return False if singular."""
    first, second, third = matrix[STAGES * q, q], matrix[STAGES * q + 1, q], matrix[STAGES * q + 2, q]
    a1, a2, a3, b1, b2, b3 = first[0], first[1], first[2], second[0], second[1], second[2]
    c1, c2, c3 = third[0], third[1], third[2]
    # Rows of the inverse are cross products of two columns, divided by the determinant.
    x1, x2, x3 = b2 * c3 - b3 * c2, b3 * c1 - b1 * c3, b1 * c2 - b2 * c1
    determinant = a1 * x1 + a2 * x2 + a3 * x3
    if not determinant > _SINGULAR:
        return False
    share = 1.0 / determinant
    inverse[0, 0], inverse[1, 0], inverse[2, 0] = share * x1, share * x2, share * x3
    inverse[0, 1] = share * (c2 * a3 - c3 * a2)
    inverse[1, 1] = share * (c3 * a1 - c1 * a3)
    inverse[2, 1] = share * (c1 * a2 - c2 * a1)
    inverse[0, 2] = inverse[0, 3] = share * (a2 * b3 - a3 * b2)
    inverse[1, 2] = inverse[1, 3] = share * (a3 * b1 - a1 * b3)
    inverse[2, 2] = inverse[2, 3] = share * (a1 * b2 - a2 * b1)
    return True


@kernel
def eliminate(matrix, inverses, first, end):
    """Factor the equations of unknowns `first` to `end` - 1 in place; return False if a diagonal block is singular.

    Args:
        matrix: (STAGES R, R, LANES) of R unknown loads; [3 c + k, r, s] is the coefficient of load c at stage k in the
            equation of load r at stage s. LANES is 4: the stages s are 0 to 2, a fourth number fills a SIMD vector.
        inverses: (R, STAGES, LANES) inverses of the 3 x 3 diagonal blocks, by column; written.
        first, end: first unknown, and the unknown after the last.
    """
    for q in range(first, end):
        inverse, number = inverses[q], STAGES * q
        if not invert(matrix, q, inverse):
            return False
        for i in range(q + 1, end):
            one, two, three = (
                load4(matrix[number, i], 0),
                load4(matrix[number + 1, i], 0),
                load4(matrix[number + 2, i], 0),
            )
            for k in range(STAGES):
                column = inverse[k]
                store4(matrix[number + k, i], 0, one * column[0] + two * column[1] + three * column[2])
        for later in range(number + STAGES, STAGES * end):
            other = matrix[later]
            one, two, three = other[q, 0], other[q, 1], other[q, 2]
            for i in range(q + 1, end):
                shared = load4(matrix[number, i], 0) * one + load4(matrix[number + 1, i], 0) * two
                store4(other[i], 0, load4(other[i], 0) - shared - load4(matrix[number + 2, i], 0) * three)
    return True


@kernel
def substitute(matrix, inverses, first, end, residual, correction):
    """Solve the factored equations `first` to `end` - 1 for `correction`; the right side `residual` is overwritten.

    `eliminate` writes `matrix` and the diagonal blocks' `inverses`; `residual` and `correction` are (unknowns, LANES).
    """
    for q in range(first, end):
        for i in range(q + 1, end):
            subtract_product(matrix, q, i, residual[q], residual[i])
    for up in range(end - first):
        q = end - 1 - up
        inverse, rest = inverses[q], residual[q]
        solved = load4(inverse[0], 0) * rest[0] + load4(inverse[1], 0) * rest[1] + load4(inverse[2], 0) * rest[2]
        store4(correction[q], 0, solved)
        for i in range(first, q):
            subtract_product(matrix, q, i, correction[q], residual[i])


@kernel
def subtract_product(matrix, q, i, values, target):
    """Subtract `matrix`'s 3 x 3 block (equation `i`, load `q`) times the vector `values` from the vector `target`."""
    total = load4(target, 0)
    for k in range(STAGES):
        total = total - load4(matrix[STAGES * q + k, i], 0) * values[k]
    store4(target, 0, total)
