"""Features are the documented functions of what the sensors show, imperfect as they are; single and in a vector."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest

from solar_env import Hardware
from solar_env.environment.registration import DEPLOY
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


@each
@pytest.mark.parametrize("latched", [(0, 0), (1, 1)])
def test_the_formula_that_a_feature_is_described_by_is_what_it_computes(row, latched):
    rng = np.random.default_rng(0)
    for _ in range(20):
        theta, rate, left = rng.uniform(-0.1, 1.1, 2), rng.normal(0.0, 0.1, 2), rng.uniform(0.0, 1.0)
        seen = shown(theta, rate, latched, left, [row.name])
        d, r = 1.0 - theta, rate / LOCK_ANGLES
        words = {"approach": 1.0 - all(latched), "d": d.mean(), "r": r.mean(), "left": 20.0 * left, "deadline": 20.0}
        words["near"] = words["approach"] * min(max((0.3 - d.mean()) / 0.2, 0.0), 1.0)
        words["far"] = words["approach"] - words["near"]
        words |= {
            "ahead_d": d[0] - d[1],
            "ahead_r": r[0] - r[1],
            "L": logarithm,
            "ln": math.log,
            "max": max,
            "min": min,
        }
        for joint, value in enumerate(seen.values()):
            expected = eval(row.formula, words | {"d_j": d[joint], "r_j": r[joint]})
            assert value == pytest.approx(min(max(expected, row.low), row.high), abs=1e-4)


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
    env = gymnasium.make(DEPLOY, observation=[*MEASURED, row.name], **keywords).unwrapped
    env.reset(seed=1)
    for _ in range(3):
        observed = env.step([0.3])[0]
    theta, rate, latched, left, feature = np.split(observed.astype(float), [2, 4, 6, 7])
    expected = shown(theta, rate, latched, *left, [row.name])
    assert feature == pytest.approx(list(expected.values()), rel=1e-6)
