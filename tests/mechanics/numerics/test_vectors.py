"""Vectors as values of kernels: what they do is what NumPy does with as many numbers."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from solar_env.mechanics.numerics import vectors

ROW = np.array([4.0, -1.0, 9.0, 0.25, 16.0, 2.0, 3.0, 1.0])


@njit
def arithmetic(row, out):
    """Fill `out` (8,) with sums, products, quotients and differences of vectors and numbers."""
    whole = vectors.load8(row, 0)
    vectors.store8(out, 0, (2.0 * whole + vectors.splat8(0.5)) / (whole * whole) - 3 + -whole)


@njit
def halves(row, out):
    """Fill `out` (8,) with the halves of `row` the other way round, and return a lane."""
    whole = vectors.load8(row, 0)
    other = vectors.joined(vectors.upper_half(whole), vectors.lower_half(whole))
    vectors.store8(out, 0, other)
    return vectors.lane(other, 1)


@njit
def roots(row, out):
    """Fill `out` (4,) with the roots of the positive ones of the first four numbers, and zeros."""
    part, nothing = vectors.load4(row, 0), vectors.splat4(0.0)
    vectors.store4(out, 0, vectors.where_less(nothing, part, vectors.square_roots(part), nothing))


@njit
def sums_and_powers(row, out):
    """Fill `out` (8,) with cube roots and powers of the last four numbers, and return the sum of the first four."""
    part = vectors.load4(row, 4)
    vectors.store8(out, 0, vectors.joined(vectors.cube_roots(part), part**1.7))
    return vectors.sum_lanes(vectors.load4(row, 0))


@njit
def root_or_zero(number):
    """The same for one number."""
    return vectors.where_less(0.0, number, vectors.square_roots(number), 0.0)


def test_arithmetic_acts_lane_by_lane() -> None:
    out = np.zeros(8)
    arithmetic(ROW, out)
    assert out == pytest.approx((2.0 * ROW + 0.5) / (ROW * ROW) - 3 - ROW, rel=1e-14)


def test_halves_join_to_a_whole() -> None:
    out = np.zeros(8)
    assert halves(ROW, out) == ROW[5]
    assert out.tolist() == [*ROW[4:], *ROW[:4]]


@pytest.mark.filterwarnings("ignore:invalid value encountered in sqrt")
def test_choices_and_roots_are_the_same_for_numbers_and_lanes() -> None:
    out = np.zeros(4)
    roots(ROW, out)
    assert out.tolist() == [2.0, 0.0, 3.0, 0.5] == [float(root_or_zero(x)) for x in ROW[:4]]


def test_powers_and_sums_are_those_of_numbers() -> None:
    out = np.zeros(8)
    assert sums_and_powers(ROW, out) == ROW[:4].sum() == vectors.sum_lanes(ROW[:4])
    assert out == pytest.approx([*np.cbrt(ROW[4:]), *ROW[4:] ** 1.7], rel=1e-14)
    scales = np.logspace(-300, 300, 8)
    sums_and_powers(scales, out)
    assert out[:4] == pytest.approx(np.cbrt(scales[4:]), rel=1e-14)
    assert vectors.third_repeated(ROW).tolist() == ROW[[0, 1, 2, 2, 4, 5, 6, 6]].tolist()
