"""Modes of a free uniform beam as frequencies and end values, with the exact flexibility of all omitted modes.

A slender beam without supports bends in modes of the wave numbers x_k / L, with cos x_k cosh x_k = 1, and stretches in
modes of the wave numbers k pi / L (S. Timoshenko, D. H. Young and W. Weaver, Vibration Problems in Engineering,
4th ed., Wiley 1974, chapter 5). If loads act only at the ends, a frequency and the end values describe a mode fully.

The omitted higher modes respond to slow loads as springs, and to faster loads with terms in powers of the squared
frequency. A few pseudo-modes represent both. They are orthogonalized Krylov vectors omega^-2p v, where v are end values
of omitted modes (for p = 1: R. H. MacNeal, Comput. Struct. 1 (1971) 581, doi:10.1016/0045-7949(71)90031-9). They depend
only on sums of v v^T omega^-2p, which are Hurwitz zeta functions: x_k equals (k + 1/2) pi in all digits from some k on.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import mpmath
import numpy as np
from numpy.typing import NDArray

# The Gram matrices of the Krylov vectors are nearly singular: double precision would not suffice.
_CONTEXT = mpmath.MPContext()
_CONTEXT.dps = 50
# Mode number beyond which cos x_k = 1 / cosh x_k is zero in all digits.
_ASYMPTOTIC = 40

Real = Any  # a number of mpmath


class EndModes(NamedTuple):
    """Mass-normalized bending or axial modes, described by their frequencies and end values.

    Attributes:
        frequencies: (modes,) angular frequencies [rad/s]; last come pseudo-modes, which represent all higher modes.
        rows: (end values, modes) per unit modal amplitude: displacements [1/sqrt(kg)] and slopes [1/(m sqrt(kg))].
            Bending: deflection and slope of the first end, then of the second; axial: displacements of both ends.
    """

    frequencies: NDArray[np.float64]
    rows: NDArray[np.float64]


@lru_cache(maxsize=256)
def wave_number(k: int) -> Real:
    """Return the `k`-th positive solution (k >= 1) of cos x cosh x = 1: wave number times length of a free beam."""
    start = (k + _CONTEXT.mpf(1) / 2) * _CONTEXT.pi
    if k > _ASYMPTOTIC:
        return start
    return _CONTEXT.findroot(lambda x: _CONTEXT.cos(x) - 1 / _CONTEXT.cosh(x), start)


def slope_factor(x: Real) -> Real:
    """Return sigma in a free beam's mode shape cosh(x s) + cos(x s) - sigma (sinh(x s) + sin(x s)), s from 0 to 1."""
    return (_CONTEXT.cosh(x) - _CONTEXT.cos(x)) / (_CONTEXT.sinh(x) - _CONTEXT.sin(x))


def bending_modes(length: float, mass: float, stiffness: float, kept: int, blocks: int) -> EndModes:
    """Return the `kept` lowest bending modes of a free beam, then 4 * `blocks` pseudo-modes for all higher modes.

    `stiffness` is E I [N m2]. `blocks` is the number of blocks of Krylov vectors: 0 omits the higher modes, 1 keeps
    their static flexibility, and 2 also keeps the first change of this flexibility with the squared frequency.
    """
    numbers, rows = _unit_bending_modes(kept, blocks)
    return EndModes(
        numbers * math.sqrt(stiffness / mass / length**3),
        rows / np.array([[1.0], [length], [1.0], [length]]) / math.sqrt(mass),
    )


@lru_cache(maxsize=64)
def _unit_bending_modes(kept: int, blocks: int) -> EndModes:
    """Return modes of a free unit beam: `kept` bending ones, then 4 * `blocks` modes that represent all higher ones."""
    exact = [_end_values(wave_number(k)) for k in range(1, kept + 1)]
    squares = [wave_number(k) ** 2 for k in range(1, kept + 1)]
    signs = [1 if k % 2 else -1 for k in range(1, kept + 1)]
    for first, sign in ((_next_of_parity(kept, 1), 1), (_next_of_parity(kept, 0), -1)) if blocks else ():
        moments = [_bending_moment(first, power) for power in range(1, 2 * blocks + 1)]
        found, rows = _pseudo_modes(moments, blocks)
        squares += found
        exact += rows
        signs += [sign] * len(found)
    # Slopes change sign from one end to the other exactly if deflections do not.
    rows = [(w, s, sign * w, -sign * s) for (w, s), sign in zip(exact, signs, strict=True)]
    return _end_modes(squares, rows)


def axial_modes(length: float, mass: float, stiffness: float, kept: int, blocks: int) -> EndModes:
    """Return the `kept` lowest axial modes of a free bar, then 2 * `blocks` pseudo-modes for all higher modes.

    `stiffness` is E A [N]. `blocks` is the number of blocks of Krylov vectors: 0 omits the higher modes, 1 keeps their
    static flexibility, and 2 also keeps the first change of this flexibility with the squared frequency.
    """
    numbers, rows = _unit_axial_modes(kept, blocks)
    return EndModes(numbers * math.sqrt(stiffness / mass / length), rows / math.sqrt(mass))


@lru_cache(maxsize=64)
def _unit_axial_modes(kept: int, blocks: int) -> EndModes:
    """Return modes of a free unit bar: `kept` axial ones, then 2 * `blocks` modes that represent all higher ones."""
    numbers = [k * _CONTEXT.pi for k in range(1, kept + 1)]
    rows = [(_CONTEXT.sqrt(2), (-1) ** k * _CONTEXT.sqrt(2)) for k in range(1, kept + 1)]
    for first, sign in ((_next_of_parity(kept, 1), -1), (_next_of_parity(kept, 0), 1)) if blocks else ():
        moments = [_CONTEXT.matrix([[2 * _sum_over_others(2 * power, first)]]) for power in range(1, 2 * blocks + 1)]
        found, ends = _pseudo_modes(moments, blocks)
        numbers += found
        rows += [(u, sign * u) for (u,) in ends]
    return _end_modes(numbers, rows)


def _end_modes(numbers: Sequence[Real], rows: Sequence[Sequence[Real]]) -> EndModes:
    frequencies = np.array([float(number) for number in numbers])
    return EndModes(frequencies, np.array([[float(value) for value in row] for row in rows]).T)


def _end_values(x: Real) -> tuple[Real, Real]:
    """Return deflection and slope at an end of a free unit beam, in its mass-normalized mode with wave number `x`."""
    return _CONTEXT.mpf(2), -2 * slope_factor(x) * x


def _next_of_parity(kept: int, parity: int) -> int:
    """Return the lowest mode number above `kept` that is even (`parity` 0) or odd (`parity` 1)."""
    return kept + 1 + (kept + 1 + parity) % 2


def _sum_over_others(power: int, first: Real) -> Real:
    """Return the sum of (k pi)^-power for k = first, first + 2, ..."""
    return _CONTEXT.zeta(power, first / _CONTEXT.mpf(2)) * (2 * _CONTEXT.pi) ** -power


def _bending_moment(first: int, power: int) -> Any:
    """Return the moment (2, 2), v v^T omega^(-2 `power`) summed over all bending modes `first`, `first` + 2, ...

    A free beam's mode, for unit length, mass and stiffness, has frequency omega, and deflection and slope v at an end.
    """
    moment = _CONTEXT.matrix(2, 2)
    k = first
    while k <= _ASYMPTOTIC:
        x = wave_number(k)
        v = _end_values(x)
        for i in range(2):
            for j in range(2):
                moment[i, j] += v[i] * v[j] * x ** (-4 * power)
        k += 2
    for i in range(2):
        for j in range(2):
            moment[i, j] += 4 * (-1) ** (i + j) * _sum_over_others(4 * power - i - j, k + _CONTEXT.mpf(1) / 2)
    return moment


def _pseudo_modes(moments: Sequence[Any], blocks: int) -> tuple[list[Real], list[tuple[Real, ...]]]:
    """Return the frequencies omega and end values v of pseudo-modes that represent omitted modes.

    `blocks`: number of blocks of Krylov vectors. `moments[p - 1]`: sum of v v^T omega^-2p over the omitted modes.
    """
    values = moments[0].rows
    size = values * blocks
    stiffness, gram = _CONTEXT.matrix(size, size), _CONTEXT.matrix(size, size)
    for row in range(size):
        for column in range(size):
            power, i, j = row // values + column // values, row % values, column % values
            stiffness[row, column], gram[row, column] = moments[power][i, j], moments[power + 1][i, j]
    inverse = _CONTEXT.cholesky(gram) ** -1
    squares, vectors = _CONTEXT.eigsy(inverse * stiffness * inverse.T)
    # The first block of the stiffness is the product of the end values with the Krylov vectors.
    rows = stiffness[:values, :] * inverse.T * vectors
    return [_CONTEXT.sqrt(square) for square in squares], [
        tuple(rows[i, k] for i in range(values)) for k in range(size)
    ]
