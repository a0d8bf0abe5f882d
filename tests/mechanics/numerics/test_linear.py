"""Small numerical kernels."""

import math

import numpy as np
import pytest

from solar_env.mechanics.numerics.linear import cholesky_factor, cholesky_solve, greater, greatest


@pytest.mark.parametrize(("one", "other"), [(0.0, 2.0), (2.0, 0.0), (1.0, 1.0), (0.0, math.inf)])
def test_the_greater_of_two_numbers(one: float, other: float) -> None:
    assert greater(one, other) == max(one, other)


@pytest.mark.parametrize("values", [(math.nan, 1.0, 0.5), (1.0, math.nan, 2.0), (1.0, 2.0, math.nan)])
def test_an_error_that_is_not_a_number_is_never_lost_among_others(values: tuple[float, ...]) -> None:
    worst = 0.0
    for value in values:
        worst = greater(worst, value)
    assert math.isnan(worst)
    assert math.isnan(greatest(np.array(values)))


def test_the_greatest_of_many_numbers() -> None:
    values = np.random.default_rng(0).uniform(0.0, 5.0, 60)
    assert greatest(values) == values.max()
    assert greatest(np.zeros(3)) == 0.0


@pytest.mark.parametrize("size", [1, 3, 8])
def test_cholesky_solves(size: int) -> None:
    rng = np.random.default_rng(size)
    root, solution = rng.normal(size=(size, size)), rng.normal(size=size)
    matrix = root @ root.T + np.eye(size)
    factor, right = matrix.copy(), matrix @ solution
    assert cholesky_factor(factor, size)
    cholesky_solve(factor, size, right)
    assert right == pytest.approx(solution, abs=1e-14 * size * np.linalg.cond(matrix))


@pytest.mark.parametrize("pivot", [1.0, 0.9, math.nan])
def test_cholesky_refuses_a_matrix_that_is_not_positive_definite(pivot: float) -> None:
    assert not cholesky_factor(np.array([[1.0, 1.0], [1.0, pivot]]), 2)
