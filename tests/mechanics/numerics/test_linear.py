"""Small numerical kernels."""

import math

import numpy as np
import pytest

from solar_env.mechanics.numerics.linear import greater, greatest


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
