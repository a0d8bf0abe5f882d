"""Contact and friction laws, and the parameters that go into them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from solar_env.mechanics.joints.contact import (
    HERTZ_DURATION,
    friction_ramp,
    friction_ramp_slope,
    impact_scales,
    normal_force,
    normal_force_slopes,
)
from solar_env.mechanics.joints.laws import damping_factor, hertz_stiffness

K = 7.39e10
LAWS = [("hertz", 1.0), ("lankarani-nikravesh", 0.9), ("flores", 0.5), ("flores", 0.1)]
STEEL, BRASS = (207e9, 0.3), (105e9, 0.34)


@pytest.fixture(params=LAWS, ids=lambda law: f"{law[0]} {law[1]}")
def factor(request: pytest.FixtureRequest) -> float:
    return damping_factor(*request.param)


def test_the_force_rises_from_zero_without_a_jump(factor: float) -> None:
    rate = speed = 0.01
    assert normal_force(0.0, rate, K, factor, speed) == (0.0, 0.0)
    assert normal_force(-1e-12, rate, K, factor, speed) == (0.0, 0.0)
    for depth in (1e-20, 1e-14, 1e-9):
        force, elastic = normal_force(depth, rate, K, factor, speed)
        assert elastic == pytest.approx(K * depth**1.5, rel=1e-14, abs=0.0)
        assert force == pytest.approx(elastic * (1.0 + factor), rel=1e-14, abs=0.0)


def test_the_force_never_attracts(factor: float) -> None:
    for depth in (1e-9, 1e-6, 1e-4):
        for rate in np.linspace(-50.0, 1.0, 103):
            force, elastic = normal_force(depth, rate, K, factor, 0.05)
            assert force >= 0.0
            assert elastic > 0.0


def test_the_elastic_part_is_the_force_at_rest(factor: float) -> None:
    force, elastic = normal_force(2e-6, 0.0, K, factor, 0.05)
    assert force == elastic == pytest.approx(K * 2e-6**1.5, rel=1e-14)


@pytest.mark.parametrize("depth", [1e-9, 1e-6, 1e-4])
@pytest.mark.parametrize("rate", [-0.02, 0.0, 0.05])
def test_the_slopes_are_those_of_the_force(factor: float, depth: float, rate: float) -> None:
    speed = 0.05
    by_depth, by_rate = normal_force_slopes(depth, rate, K, factor, speed)

    def force(x: float, y: float) -> float:
        return normal_force(x, y, K, factor, speed)[0]

    # Truncation (h / depth)^2 / 24 and rounding eps depth / h are both below 1e-10 with h = 1e-5 depth.
    h = 1e-5 * depth
    assert by_depth == pytest.approx((force(depth + h, rate) - force(depth - h, rate)) / (2 * h), rel=1e-9, abs=1e-9)
    # Linear in the rate: rounding alone.
    assert by_rate == pytest.approx(
        (force(depth, rate + 1e-3) - force(depth, rate - 1e-3)) / 2e-3, rel=1e-10, abs=1e-10 * force(depth, rate)
    )


def test_the_slopes_vanish_where_the_force_is_cut_off() -> None:
    assert normal_force_slopes(-1e-9, 1.0, K, 1.6, 0.05) == (0.0, 0.0)
    assert normal_force(1e-6, -1.0, K, 1.6, 0.05)[0] == 0.0
    assert normal_force_slopes(1e-6, -1.0, K, 1.6, 0.05) == (0.0, 0.0)


def test_an_impact_of_hertz_is_as_deep_as_its_energy_and_as_long_as_its_quadrature() -> None:
    inverse_mass, speed = 0.4, 0.03
    depth, duration = impact_scales(K, inverse_mass, speed)
    assert 0.4 * K * depth**2.5 == pytest.approx(0.5 * speed**2 / inverse_mass, rel=1e-13, abs=0.0)
    # Duration = 2 integral d(depth) / rate, with x = 1 - y^2 to take out the singularity at the turning point.
    integral, _ = quad(lambda y: 4.0 * y / math.sqrt(1.0 - (1.0 - y * y) ** 2.5), 0.0, 1.0)
    assert integral == pytest.approx(HERTZ_DURATION, rel=1e-7)
    assert duration == pytest.approx(HERTZ_DURATION * depth / speed, rel=1e-14, abs=0.0)


def test_friction_sets_in_at_one_speed_and_is_full_at_the_other() -> None:
    low, high = 1e-4, 1e-3
    assert [friction_ramp(s, low, high) for s in (0.0, low, high, 1.0)] == [0.0, 0.0, 1.0, 1.0]
    speeds = np.linspace(-2e-3, 2e-3, 4001)
    shares = np.array([friction_ramp(s, low, high) for s in speeds])
    assert np.array_equal(shares, [-friction_ramp(-s, low, high) for s in speeds])
    # Continuous and monotone: no change exceeds the ramp's slope times the distance of the speeds.
    changes = np.diff(shares)
    assert changes.min() >= 0.0
    assert changes.max() <= np.diff(speeds).max() / (high - low) * (1 + 1e-9)


def test_the_slope_of_friction_is_that_of_its_ramp() -> None:
    low, high, h = 1e-4, 1e-3, 1e-9
    for speed in (-2e-3, -5e-4, -5e-5, 0.0, 5e-5, 2e-4, 9e-4, 5e-3):
        difference = (friction_ramp(speed + h, low, high) - friction_ramp(speed - h, low, high)) / (2 * h)
        # Piecewise linear: rounding alone, eps / h.
        assert friction_ramp_slope(speed, low, high) == pytest.approx(difference, abs=1e-6)


def test_damping_factors_are_those_of_the_named_laws() -> None:
    assert damping_factor("hertz", 0.3) == 0.0
    assert damping_factor("lankarani-nikravesh", 0.9) == pytest.approx(0.75 * 0.19, rel=1e-14)
    assert damping_factor("flores", 0.5) == pytest.approx(8.0 * 0.5 / (5.0 * 0.5), rel=1e-14)
    for law in ("lankarani-nikravesh", "flores"):
        assert damping_factor(law, 1.0) == 0.0


def test_an_unknown_law_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="'dubowsky' is unknown; choose hertz, lankarani-nikravesh or flores"):
        damping_factor("dubowsky", 0.9)


@pytest.mark.parametrize("law", ["lankarani-nikravesh", "flores"])
@pytest.mark.parametrize("restitution", [0.0, -0.1, 1.0001, math.nan, math.inf])
def test_a_restitution_outside_its_range_is_refused_with_its_value(law: str, restitution: float) -> None:
    with pytest.raises(ValueError, match=f"restitution = {restitution!r}"):
        damping_factor(law, restitution)


def test_eq_40_gives_the_stiffness_of_steel_in_brass() -> None:
    # The figure is known to three digits.
    assert hertz_stiffness(0.0102, 0.0100, *BRASS, *STEEL) == pytest.approx(7.43e10, abs=0.005e10)


def test_eq_40_stiffens_as_the_clearance_shrinks() -> None:
    wide, narrow = (hertz_stiffness(0.01 + c, 0.01, *BRASS, *STEEL) for c in (2e-4, 5e-5))
    # Proportional to sqrt(R_b R_j / c).
    assert narrow / wide == pytest.approx(math.sqrt(4.0 * 0.01005 / 0.0102), rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.01, 0.01, *BRASS, *STEEL), "journal radius 0.01 must be positive and below the bearing's 0.01"),
        ((0.01, -0.01, *BRASS, *STEEL), "journal radius -0.01"),
        ((0.01, math.nan, *BRASS, *STEEL), "journal radius nan"),
        ((0.0102, 0.01, 0.0, 0.34, *STEEL), "moduli must be positive, got 0.0"),
        ((0.0102, 0.01, *BRASS, -1.0, 0.3), "moduli must be positive, got .* and -1.0"),
    ],
)
def test_a_journal_that_does_not_fit_or_a_modulus_without_sense_is_refused(
    arguments: tuple[float, ...], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        hertz_stiffness(*arguments)
