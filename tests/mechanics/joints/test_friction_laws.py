"""Friction, ramped in between two sliding speeds."""

from __future__ import annotations

import numpy as np
import pytest

from solar_env.array import ArrayParameters
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.joints.contact import friction_share
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.mechanism.textbook import bouncing_block


def row(*speeds: float) -> np.record:
    """Row of the model for a joint with friction between two speeds."""
    bearing = Bearing(1e-3, 0.01, PowerLaw(1e9), friction_speeds=speeds or (1e-4, 1e-3))
    return compile_mechanism(bouncing_block(bearing))[0].joints[0]


def test_the_ramp_sets_in_at_one_speed_and_is_full_at_the_other() -> None:
    joint, speeds = row(), np.linspace(-2e-3, 2e-3, 4001)
    assert [friction_share(joint, speed)[0] for speed in (0.0, 1e-4, 1e-3, 1.0)] == [0.0, 0.0, 1.0, 1.0]
    found = np.array([friction_share(joint, speed)[0] for speed in speeds])
    assert np.array_equal(found, [-friction_share(joint, -speed)[0] for speed in speeds])
    # Continuous and monotone: no change exceeds the ramp's slope times the distance of the speeds.
    assert np.diff(found).min() >= 0.0
    assert np.diff(found).max() <= np.diff(speeds).max() / 9e-4 * (1 + 1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_ramp_is_flat_up_to_and_from_its_corners_on(sign: float) -> None:
    assert friction_share(row(), sign * 1e-4) == (0.0, 0.0)
    assert friction_share(row(), sign * 5.5e-4) == pytest.approx((sign * 0.5, 1.0 / 9e-4), rel=1e-12)
    assert friction_share(row(), sign * 1e-3) == (sign, 0.0)


def test_the_ramp_may_set_in_at_rest() -> None:
    assert friction_share(row(0.0, 1e-3), 0.0) == (0.0, 0.0)
    assert friction_share(row(0.0, 1e-3), 2.5e-4) == pytest.approx((0.25, 1e3), rel=1e-14)


def test_a_bearing_by_itself_has_the_speeds_of_the_array() -> None:
    array = ArrayParameters()
    speeds = (array.friction_speed_zero, array.friction_speed_full)
    assert Bearing(1e-3, 0.01, PowerLaw(1e9)).friction_speeds == array.bearing(0).friction_speeds == speeds
