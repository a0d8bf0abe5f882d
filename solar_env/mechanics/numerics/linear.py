"""Small dense linear algebra without allocation, for matrices of a few dozen rows."""

import math

from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import load4, splat4, sum_lanes


@kernel
def greater(one, other):
    """Return the greater of two numbers, or NaN if one of them is NaN."""
    return one if one >= other or one != one else other


@kernel
def greatest(values):
    """Return the greatest number of a vector without negative numbers, or NaN if one of them is NaN."""
    worst = 0.0
    for i in range(values.size):
        if not values[i] <= worst:
            worst = values[i]
            # The test for NaN is in a branch that is seldom taken: a test of every number would take longer.
            if worst != worst:
                break
    return worst


@kernel
def all_finite(values):
    """Return whether all numbers of a vector are finite."""
    sums, whole = splat4(0.0), values.size - values.size % 4
    for k in range(0, whole, 4):
        sums = sums + 0.0 * load4(values, k)
    total = sum_lanes(sums)
    for k in range(whole, values.size):
        total += 0.0 * values[k]
    return total == 0.0


@kernel
def copy_into(target, source):
    """Copy a vector into `target`; in a hot loop the copy is several times cheaper than a slice assignment."""
    for i in range(target.size):
        target[i] = source[i]


@kernel
def cholesky_factor(a, n):
    """Factor the symmetric positive definite a[:n, :n] in place into its lower triangle; return False if singular.

    The factor's diagonal is stored inverted: divisions would take most of the time of small systems.
    """
    for i in range(n):
        for j in range(i):
            s = a[i, j]
            for k in range(j):
                s -= a[i, k] * a[j, k]
            a[i, j] = s * a[j, j]
        s = a[i, i]
        for k in range(i):
            s -= a[i, k] * a[i, k]
        # A pivot lost to cancellation means a redundant row.
        if not s > 1e-12 * a[i, i]:
            return False
        a[i, i] = 1.0 / math.sqrt(s)
    return True


@kernel
def cholesky_solve(a, n, b):
    """Replace `b` (n,) by the solution x of A x = b, with A's factor `a` from `cholesky_factor`."""
    for i in range(n):
        s = b[i]
        for k in range(i):
            s -= a[i, k] * b[k]
        b[i] = s * a[i, i]
    for i in range(n - 1, -1, -1):
        s = b[i]
        for k in range(i + 1, n):
            s -= a[k, i] * b[k]
        b[i] = s * a[i, i]


@kernel(inlined=False)
def lu_factor(a, n):
    """Factor a[:n, :n] in place without pivoting; its symmetric part must be positive definite, else return False.

    The diagonal is stored inverted. Two columns are eliminated at a time, which halves the reading and writing of rows.
    """
    for k in range(0, n, 2):
        if not a[k, k] > 0.0:
            return False
        inverse = 1.0 / a[k, k]
        a[k, k] = inverse
        if k + 1 == n:
            return True
        first, second = a[k], a[k + 1]
        factor = second[k] * inverse
        second[k] = factor
        for j in range(k + 1, n):
            second[j] -= factor * first[j]
        if not second[k + 1] > 0.0:
            return False
        next_inverse = 1.0 / second[k + 1]
        second[k + 1] = next_inverse
        for i in range(k + 2, n):
            row = a[i]
            factor = row[k] * inverse
            next_factor = (row[k + 1] - factor * first[k + 1]) * next_inverse
            row[k], row[k + 1] = factor, next_factor
            for j in range(k + 2, n):
                row[j] = row[j] - factor * first[j] - next_factor * second[j]
    return True


@kernel(inlined=False)
def lu_solve(a, n, b):
    """Replace `b` (n,) by the solution x of A x = b, with A's factors `a` from `lu_factor`."""
    for k in range(n):
        x = b[k]
        for i in range(k + 1, n):
            b[i] -= a[i, k] * x
    for k in range(n - 1, -1, -1):
        x = b[k] * a[k, k]
        b[k] = x
        for i in range(k):
            b[i] -= a[i, k] * x
