"""Features are the documented functions of what the sensors show, imperfect as they are; single and in a vector."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest

from solar_env import Hardware
from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.task.features import FEATURES
from solar_env.environment.task.observations import observation_entries
from solar_env.environment.task.sensors import Sensors

LOCK_ANGLES, DEADLINE = (math.pi / 2, math.pi), 20.0
ALL = [row.name for row in FEATURES]
MEASURED = ["theta", "rate", "latched", "time_to_deadline"]
each = pytest.mark.parametrize("row", FEATURES, ids=ALL)


def shown(theta, rate, latched, left, observation=ALL):
    """Readings of sensors without errors at a moment: name -> value."""
    entries = observation_entries(2, observation)
    sensors = Sensors(1, LOCK_ANGLES, entries, Hardware(), DEADLINE)
    sensors.exact[0] = [*theta, *rate, *latched, left]
    sensors.begin(np.arange(1), [np.random.default_rng(0)])
    return dict(zip([entry.name for entry in entries], sensors.observed[0].astype(float), strict=True))


def logarithm(value, unit):
    return math.copysign(math.log(1.0 + abs(value) / unit), value)


def test_features_are_logarithms_of_distance_rate_lead_deceleration_and_the_time_that_is_needed():
    """At 0.95 of the opening in the mean, joint 1 ahead, and after the last latch."""
    seen = shown((0.97, 0.93), (0.06, 0.1), (0, 0), 0.4)
    d, r = 0.05, 0.5 * (0.06 / LOCK_ANGLES[0] + 0.1 / LOCK_ANGLES[1])
    expected = {
        "opening": 2.0 * (0.2 - d),
        "distance": (logarithm(d, 2e-4) - 4.0) / 2.0,
        "rate": logarithm(r, 3e-4) - 5.0,
        "lead": logarithm(0.04, 2e-4) / 2.0,
        "lead_rate": logarithm(0.06 / LOCK_ANGLES[0] - 0.1 / LOCK_ANGLES[1], 3e-4) / 3.0,
        "deceleration": (logarithm(r**2 / (2.0 * d), 1e-4) - 4.0) / 2.0,
        "time_needed": math.log(d / r / 8.0),
    }
    assert {name: seen[f"near_{name}"] for name in expected} == pytest.approx(expected, abs=1e-4)
    assert not any(value for name, value in seen.items() if name.startswith(("far", "settling", "start")))
    after = shown((0.97, 1.01), (-0.06, 0.1), (1, 1), 0.4)
    assert after["settling_rate_1"] == pytest.approx(-logarithm(0.06 / LOCK_ANGLES[0], 3e-4) / 4.0, abs=1e-4)
    assert after["settling_distance_2"] == pytest.approx(-logarithm(0.01, 2e-4) / 3.0, abs=1e-4)
    assert not any(value for name, value in after.items() if name.startswith(("far", "near", "start")))


@pytest.mark.parametrize(("opening", "near"), [(0.0, 0.0), (0.7, 0.0), (0.75, 0.25), (0.9, 1.0), (1.001, 1.0)])
def test_features_of_the_way_there_fade_out_as_those_of_the_landing_fade_in(opening, near):
    seen = shown((opening, opening), (0.1, 0.2), (0, 0), 0.4)
    assert (seen["far"], seen["near"]) == pytest.approx((1.0 - near, near), abs=1e-6)
    whole = logarithm(0.05 * (1.0 / LOCK_ANGLES[0] + 2.0 / LOCK_ANGLES[1]), 3e-4) - 5.0
    assert (seen["far_rate"], seen["near_rate"]) == pytest.approx(((1.0 - near) * whole, near * whole), abs=1e-5)
    for quantity in ("opening", "distance", "rate", "lead", "lead_rate", "deceleration", "time_needed"):
        far_share, near_share = near * seen[f"far_{quantity}"], (1.0 - near) * seen[f"near_{quantity}"]
        assert far_share == pytest.approx(near_share, abs=1e-5), "the same quantity, in two shares"


@pytest.mark.parametrize(("time", "start"), [(0.0, 16.0), (0.1, 8.0), (0.2, 0.0), (3.0, 0.0), (20.0, 0.0)])
def test_the_start_fades_out_within_two_periods_of_the_release(time, start):
    seen = shown((0.0, 0.0), (0.0, 0.0), (0, 0), (DEADLINE - time) / DEADLINE)
    assert seen["start"] == pytest.approx(start, abs=1e-4)


@each
def test_a_feature_is_made_of_what_noisy_late_sensors_show(row):
    """It is the feature of the measured entries that are observed beside it."""
    keywords = {"scenario": "randomised", "model": "rigid-ideal", "control_period": 1e-3}
    env = gymnasium.make(DEPLOY_V1, observation=[*MEASURED, row.name], **keywords).unwrapped
    env.reset(seed=1)
    for _ in range(3):
        observed = env.step([0.3])[0]
    theta, rate, latched, left, feature = np.split(observed.astype(float), [2, 4, 6, 7])
    expected = shown(theta, rate, latched, *left, [row.name])
    assert feature == pytest.approx(list(expected.values()), rel=1e-6)
