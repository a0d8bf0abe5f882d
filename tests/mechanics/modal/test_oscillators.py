"""Response of one mode to a step: exact where it is resolved, the Radau IIA method's where it is not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from solar_env.mechanics.modal.panel.oscillators import (
    COEFFICIENTS,
    free_rate_defects,
    mode_coefficients,
    rational_coefficients,
)

CASES = ([1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.5, -1.5], [0.0, 0.0, -0.5, 1.5])


def exact(frequency: float, damping_rate: float, h: float) -> NDArray[np.float64]:
    """The coefficients by the matrix exponential of the oscillator and a load that is linear in time."""
    system = np.zeros((4, 4))
    system[0, 1], system[1, 0], system[1, 1] = 1.0, -(frequency**2), -2.0 * damping_rate
    system[1, 2], system[2, 3] = 1.0, 1.0
    found = []
    for value, rate, load, slope in CASES:
        start = np.array([value, rate, load, slope / h])
        for time in (h / 3.0, h):
            found += list((expm(system * time) @ start)[:2])
    return np.array(found)


@pytest.mark.parametrize(
    ("frequency", "damping_rate", "h"), [(3.0, 0.2, 0.1), (300.0, 1.0, 0.006), (900.0, 300.0, 1e-3)]
)
def test_mode_that_the_step_resolves_is_exact(frequency: float, damping_rate: float, h: float) -> None:
    found = np.zeros(COEFFICIENTS)
    mode_coefficients(frequency, damping_rate, h, found)
    assert found == pytest.approx(exact(frequency, damping_rate, h), rel=1e-11)


def test_method_is_of_third_order_at_the_end_of_a_step() -> None:
    errors = []
    for h in (0.02, 0.01, 0.005):
        found = np.zeros(COEFFICIENTS)
        rational_coefficients(7.0, 0.4, h, found)
        # Value by start value and rate by start rate, at the end of the step.
        errors.append(np.abs(found - exact(7.0, 0.4, h))[[2, 7]])
    # Local errors of a method of third order.
    assert errors[0] / errors[1] == pytest.approx([16.0, 16.0], rel=0.06)
    assert errors[1] / errors[2] == pytest.approx([16.0, 16.0], rel=0.03)


def test_mode_that_the_step_does_not_resolve_comes_to_rest_where_its_load_holds_it() -> None:
    found = np.zeros(COEFFICIENTS)
    mode_coefficients(1e6, 0.0, 1e-3, found)
    assert abs(found[2]) < 1e-4
    assert found[10] + found[14] == pytest.approx(1e-12, rel=1e-4)


def test_defect_is_the_exact_free_rate_less_that_of_the_method() -> None:
    found = np.zeros(COEFFICIENTS)
    mode_coefficients(500.0, 3.0, 0.01, found)
    by_value, by_rate = free_rate_defects(500.0, 3.0, 0.01, found)
    truth = exact(500.0, 3.0, 0.01)
    assert by_value == pytest.approx(truth[3] - found[3], rel=1e-9)
    assert by_rate == pytest.approx(truth[7] - found[7], rel=1e-9)
