"""Response of one mode to a step: exact where it is resolved, the Radau IIA method's where it is not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from solar_env.mechanics.modal.tables import answer_type, fill_answer

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


def answer(frequency: float, damping_rate: float, h: float) -> np.record:
    filled = np.zeros(1, answer_type)
    fill_answer(frequency, damping_rate, h, filled[0])
    return filled[0]


@pytest.mark.parametrize(
    ("frequency", "damping_rate", "h"), [(3.0, 0.2, 0.1), (300.0, 1.0, 0.006), (900.0, 300.0, 1e-3)]
)
def test_mode_that_the_step_resolves_is_exact(frequency: float, damping_rate: float, h: float) -> None:
    found = answer(frequency, damping_rate, h)
    assert found["coefficient"] == pytest.approx(exact(frequency, damping_rate, h), rel=1e-11)
    assert found["defect"].tolist() == [0.0, 0.0]


def test_defect_is_the_exact_free_rate_less_that_of_the_method() -> None:
    found, truth = answer(500.0, 3.0, 0.01), exact(500.0, 3.0, 0.01)
    assert found["defect"] == pytest.approx((truth - found["coefficient"])[[3, 7]], rel=1e-9)


def test_mode_that_the_step_does_not_resolve_comes_to_rest_where_its_load_holds_it() -> None:
    found = answer(1e6, 0.0, 1e-3)["coefficient"]
    assert abs(found[2]) < 1e-4
    assert found[10] + found[14] == pytest.approx(1e-12, rel=1e-4)
