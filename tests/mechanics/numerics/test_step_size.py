"""The controller of step sizes, on methods whose error is a power of the step."""

import math

import pytest

from solar_env.mechanics.numerics.step_size import StepController, growth, shortened

BOTH = pytest.mark.parametrize("integral", [0.0, 0.4], ids=["proportional", "and integral"])
ORDERS = pytest.mark.parametrize("order", [2.0, 4.0, 8.0])


@BOTH
@ORDERS
@pytest.mark.parametrize("scale", [1e-6, 1e-2, 1.0])
def test_steps_settle_where_the_error_is_the_tolerance_but_for_the_safety(order, integral, scale):
    control = StepController(order, 1.0 - 0.7 * integral, integral, most_growth=4.0)
    h, last = scale, 1.0
    for _ in range(300):
        error = (h / 0.01) ** order
        if error <= 1.0:
            h, last = h * growth(control, error, last), max(error, 1e-4)
        else:
            h = shortened(control, h, error)
    # There 0.9 times the error to the powers that both exponents leave is one.
    share = (control.proportional - integral) / order
    assert error == pytest.approx(0.9 ** (1.0 / share), rel=1e-6)


@ORDERS
def test_a_step_is_tried_again_where_its_error_would_be_below_the_tolerance(order):
    control = StepController(order)
    for error in (1.5, 10.0, 0.9 * 9.0**order):
        assert error * (shortened(control, 1.0, error)) ** order == pytest.approx(0.9**order)


@pytest.mark.parametrize("error", [1e300, math.inf, math.nan])
def test_no_step_shrinks_faster_than_the_controller_allows(error):
    assert shortened(StepController(2.0, least_share=0.2), 3.0, error) == pytest.approx(0.6)


@pytest.mark.parametrize("error", [0.0, 1e-300, 1e-9])
def test_no_step_grows_faster_than_the_controller_allows(error):
    assert growth(StepController(4.0, most_growth=4.0), error, 1.0) == 4.0
