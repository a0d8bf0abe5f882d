"""The friction laws: every row of the table alike, then what is each one's own."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solar_env.array import ArrayParameters
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.friction.brown_mcphee import BrownMcPhee
from solar_env.mechanics.joints.friction.friction_share import friction_share
from solar_env.mechanics.joints.friction.laws import FRICTION_LAWS, FrictionLaw
from solar_env.mechanics.joints.friction.ramp import RampedCoulomb
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.mechanism.textbook import bouncing_block

LAWS = [law(1e-4, 1e-3, 1.0) for law in FRICTION_LAWS.values()]
EVERY_LAW = pytest.mark.parametrize("law", [*LAWS, BrownMcPhee(1e-3, 1.5)], ids=repr)
SPEEDS = np.linspace(-2e-3, 2e-3, 4001)


def shares(law: FrictionLaw, speeds: np.ndarray) -> np.ndarray:
    return np.array([law.share(law.parameters(), speed)[0] for speed in speeds])


@EVERY_LAW
def test_the_compiled_share_is_that_of_the_law(law: FrictionLaw) -> None:
    joint = compile_mechanism(bouncing_block(Bearing(1e-3, 0.01, PowerLaw(1e9), friction=law)))[0].joints[0]
    for speed in (-1.0, -5e-4, 0.0, 1e-5, 3e-4, 2e-3):
        assert friction_share(joint, speed) == pytest.approx(law.share(law.parameters(), speed), rel=1e-13)
    joint["friction_law"] = 99
    assert np.isnan(friction_share(joint, 1e-3)).all()


@EVERY_LAW
def test_friction_opposes_the_sliding_and_is_coulombs_at_high_speeds(law: FrictionLaw) -> None:
    found = shares(law, SPEEDS)
    assert np.array_equal(found, -shares(law, -SPEEDS))
    assert (found * SPEEDS >= 0.0).all()
    assert law.share(law.parameters(), 0.0)[0] == 0.0
    assert law.share(law.parameters(), 1e3)[0] == pytest.approx(1.0, rel=1e-6)


@EVERY_LAW
def test_the_slope_is_that_of_the_share(law: FrictionLaw) -> None:
    for speed in (-2e-3, -5.1e-4, -5e-5, 0.0, 5e-5, 2e-4, 9e-4, 5e-3):
        h = 1e-4 * max(abs(speed), 1e-6)
        low, high = shares(law, np.array([speed - h, speed + h]))
        slope = law.share(law.parameters(), speed)[1]
        # Truncation of the smooth law (h / v)^2 of the slope's scale; rounding eps / h.
        assert slope == pytest.approx((high - low) / (2 * h), abs=1e-3, rel=1e-6)


def test_the_smooth_law_peaks_at_its_transition_speed_with_static_friction() -> None:
    law = BrownMcPhee(1e-3, 1.5)
    found = shares(law, SPEEDS)
    # tanh(4) = 0.99933 is left of Coulomb's step there; the bump itself is greatest.
    assert found.max() == pytest.approx(1.5, abs=1e-3)
    assert abs(SPEEDS[found.argmax()]) == pytest.approx(1e-3, rel=1e-2)
    assert law.share(law.parameters(), 1e-3)[0] == pytest.approx(math.tanh(4.0) + 0.5, rel=1e-14)
    assert law.share(law.parameters(), 0.0)[1] == pytest.approx((4.0 + 0.5 / 0.75**2) / 1e-3, rel=1e-14)


@pytest.mark.parametrize(
    ("changes", "message"),
    [((0.0, 1.0), "transition_speed = 0.0: must be positive"), ((1e-3, 0.9), "static_ratio = 0.9: must be at least 1")],
)
def test_a_smooth_law_without_sense_is_refused(changes: tuple[float, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        BrownMcPhee(*changes)


def test_the_ramp_sets_in_at_one_speed_and_is_full_at_the_other() -> None:
    assert shares(RampedCoulomb(1e-4, 1e-3), np.array([0.0, 1e-4, 1e-3, 1.0])).tolist() == [0.0, 0.0, 1.0, 1.0]
    changes = np.diff(shares(RampedCoulomb(1e-4, 1e-3), SPEEDS))
    # Continuous and monotone: no change exceeds the ramp's slope times the distance of the speeds.
    assert changes.min() >= 0.0
    assert changes.max() <= np.diff(SPEEDS).max() / 9e-4 * (1 + 1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_ramp_is_flat_up_to_and_from_its_corners_on(sign: float) -> None:
    law = RampedCoulomb(1e-4, 1e-3)
    assert law.share(law.parameters(), sign * 1e-4) == (0.0, 0.0)
    assert law.share(law.parameters(), sign * 5.5e-4) == pytest.approx((sign * 0.5, 1.0 / 9e-4), rel=1e-12)
    assert law.share(law.parameters(), sign * 1e-3) == (sign, 0.0)


def test_the_ramp_may_set_in_at_rest() -> None:
    law = RampedCoulomb(0.0, 1e-3)
    assert law.share(law.parameters(), 0.0) == (0.0, 0.0)
    assert law.share(law.parameters(), 2.5e-4) == pytest.approx((0.25, 1e3), rel=1e-14)


def test_laws_without_parameters_set_in_at_the_speeds_of_the_array() -> None:
    array = ArrayParameters()
    speeds = (array.friction_speed_zero, array.friction_speed_full, 1.0)
    assert [RampedCoulomb(), BrownMcPhee()] == [FRICTION_LAWS[name](*speeds) for name in ("ramp", "brown-mcphee")]


@pytest.mark.parametrize("speeds", [(1e-3, 1e-3), (2e-3, 1e-3), (-1e-3, 1e-3), (0.0, math.inf), (math.nan, 1e-3)])
def test_friction_speeds_must_rise_from_zero(speeds: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="must satisfy 0 <= first < second"):
        RampedCoulomb(*speeds)
