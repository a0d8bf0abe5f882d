"""Response of one mode to a step: exact where it is resolved, the Radau IIA method's where it is not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from solar_env.mechanics.modal.tables import (
    COLUMNS,
    END_RATE,
    END_VALUE,
    FROM_LOAD,
    FROM_RATE,
    LANES,
    LAST,
    NODES,
    POLYNOMIAL,
    STAGES,
    answer_type,
    fill_answer,
)

EXACT = 16.0


def exact(frequency: float, damping_rate: float, h: float) -> NDArray[np.float64]:
    """The coefficients by the matrix exponential of the oscillator and a load that is quadratic in time."""
    system = np.zeros((5, 5))
    system[0, 1], system[1, 0], system[1, 1] = 1.0, -(frequency**2), -2.0 * damping_rate
    system[1, 2], system[2, 3], system[3, 4] = 1.0, 1.0, 1.0
    starts = [np.eye(5)[0], np.eye(5)[1]]
    starts += [np.array([0.0, 0.0, c, slope / h, 2.0 * curvature / h**2]) for c, slope, curvature in POLYNOMIAL]
    found = []
    for start in starts:
        motion = [(expm(system * h * NODES[min(s, LAST)]) @ start)[:2] for s in range(LANES)]
        found += [value for value, _ in motion] + [rate for _, rate in motion]
    return np.array(found)


def answer(frequency: float, damping_rate: float, h: float) -> np.record:
    filled = np.zeros(1, answer_type)
    fill_answer(frequency, damping_rate, EXACT, h, filled[0])
    return filled[0]


@pytest.mark.parametrize(
    ("frequency", "damping_rate", "h"),
    [(3.0, 0.2, 0.1), (300.0, 1.0, 0.006), (900.0, 300.0, 1e-3), (4000.0, 150.0, 1e-3), (9000.0, 900.0, 1e-3)],
)
def test_mode_that_the_step_resolves_is_exact(frequency: float, damping_rate: float, h: float) -> None:
    found = answer(frequency, damping_rate, h)
    assert found["coefficient"] == pytest.approx(exact(frequency, damping_rate, h), rel=1e-10)
    assert not found["defect"].any()


def test_defect_is_the_exact_free_motion_less_that_of_the_method() -> None:
    apart = exact(500.0, 3.0, 0.01) - answer(500.0, 3.0, 0.01)["coefficient"]
    expected = [apart[END_RATE], apart[FROM_RATE + END_RATE], 500.0 * apart[END_VALUE]]
    expected.append(500.0 * apart[FROM_RATE + END_VALUE])
    assert answer(500.0, 3.0, 0.01)["defect"] == pytest.approx(expected, rel=1e-9)


def test_mode_that_the_step_does_not_resolve_comes_to_rest_where_its_load_holds_it() -> None:
    found = answer(1e6, 0.0, 1e-3)["coefficient"]
    assert abs(found[END_VALUE]) < 1e-4
    loads = [found[FROM_LOAD + COLUMNS * k + END_VALUE] for k in range(STAGES)]
    assert sum(loads) == pytest.approx(1e-12, rel=1e-4)
