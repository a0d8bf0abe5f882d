"""Features are the documented functions of what the sensors show, imperfect as they are; single and in a vector."""

from __future__ import annotations

import copy
import math
import pickle

import gymnasium
import numpy as np
import pytest

import solar_env
from solar_env import Hardware
from solar_env.environment.task.features import FEATURES, signed_logarithm
from solar_env.environment.task.observations import observation_entries
from solar_env.environment.task.sensors import Sensors

ID = "solar_env/Deploy-v1"
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


@pytest.mark.parametrize(("theta", "share"), [((0.9, 0.94), "near"), ((0.2, 0.16), "far")])
def test_features_of_the_way_there_and_of_the_landing_are_those_of_the_mean_opening_and_of_the_lead(theta, share):
    seen = shown(theta, (0.11, 0.2), (0, 0), 0.4)
    distance, opening_rate = 1.0 - sum(theta) / 2, 0.5 * (0.11 / LOCK_ANGLES[0] + 0.2 / LOCK_ANGLES[1])
    assert (seen["near"], seen["far"]) == ((1.0, 0.0) if share == "near" else (0.0, 1.0))
    assert seen[f"{share}_opening"] == pytest.approx(2.0 * (0.2 - distance), abs=1e-6)
    assert seen[f"{share}_distance"] == pytest.approx(0.5 * (logarithm(distance, 2e-4) - 4.0), abs=1e-5)
    assert seen[f"{share}_rate"] == pytest.approx(logarithm(opening_rate, 3e-4) - 5.0, abs=1e-5)
    assert seen[f"{share}_lead"] == pytest.approx(0.5 * logarithm(theta[0] - theta[1], 2e-4), abs=1e-5)
    ahead = 0.11 / LOCK_ANGLES[0] - 0.2 / LOCK_ANGLES[1]
    assert seen[f"{share}_lead_rate"] == pytest.approx(logarithm(ahead, 3e-4) / 3.0, abs=1e-5)
    deceleration = opening_rate**2 / (2.0 * distance)
    assert seen[f"{share}_deceleration"] == pytest.approx(0.5 * (logarithm(deceleration, 1e-4) - 4.0), abs=1e-5)
    assert seen[f"{share}_time_needed"] == pytest.approx(math.log(distance / opening_rate / 8.0), abs=1e-5)
    other = "far" if share == "near" else "near"
    assert all(value == 0.0 for name, value in seen.items() if name.startswith(("settling", other)))


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


def test_after_the_last_latch_the_features_are_those_of_each_joint():
    seen = shown((1.002, 0.999), (-0.003, 0.01), (1, 1), 0.1)
    for k, (distance, rate) in enumerate([(-0.002, -0.003 / LOCK_ANGLES[0]), (0.001, 0.01 / LOCK_ANGLES[1])], start=1):
        assert seen[f"settling_distance_{k}"] == pytest.approx(logarithm(distance, 2e-4) / 3.0, abs=1e-3)
        assert seen[f"settling_rate_{k}"] == pytest.approx(logarithm(rate, 3e-4) / 4.0, abs=1e-5)
    assert all(value == 0.0 for name, value in seen.items() if name.startswith(("far", "near")))
    assert shown((1.0, 0.9), (0.0, 0.1), (1, 0), 0.1)["near"] == 1.0, "one joint is still open"


def test_a_signed_logarithm_is_proportional_where_values_are_small_and_odd():
    values = np.array([-3.0, -1e-6, 0.0, 1e-6, 3.0])
    assert signed_logarithm(values, 1e-3) == pytest.approx(-signed_logarithm(-values, 1e-3))
    assert signed_logarithm(values, 1e-3)[3] == pytest.approx(1e-3, rel=1e-3)


@each
def test_a_feature_stays_in_its_bounds_and_is_the_same_in_a_vector_bit_for_bit(row):
    keywords = {"model": "rigid-ideal", "control_period": 1e-3, "observation": [row.name, f"{row.name}_2_ago"]}
    keywords["parameters"] = {"initial_spin": 3.0, "initial_rate": 7.0}
    single, vector = gymnasium.make(ID, **keywords).unwrapped, gymnasium.make_vec(ID, 2, **keywords)
    seen, together = [single.reset(seed=0)[0]], vector.reset(seed=0)[0]
    for action in (0.5, -2.0, 0.1):
        assert single.observation_space.contains(seen[-1])
        assert seen[-1].tobytes() == together[0].tobytes() == together[1].tobytes()
        seen.append(single.step([action])[0])
        together = vector.step(np.full((2, 1), action, np.float32))[0]
    entries = len(seen[0]) // 2
    assert np.array_equal(seen[3][entries:], seen[1][:entries])


@each
def test_an_environment_that_shows_a_feature_can_be_copied_and_pickled_while_it_runs(row):
    env = gymnasium.make(ID, model="rigid-ideal", control_period=1e-3, observation=[row.name, f"{row.name}_2_ago"])
    env.reset(seed=0)
    env.step([0.3])
    copies = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    observed = env.step([0.5])[0].tobytes()
    assert [copied.step([0.5])[0].tobytes() for copied in copies] == [observed, observed]


@each
def test_a_feature_is_made_of_what_noisy_late_sensors_show(row):
    """It is the feature of the measured entries that are observed beside it."""
    keywords = {"scenario": "randomised", "model": "rigid-ideal", "control_period": 1e-3}
    env = gymnasium.make(ID, observation=[*MEASURED, row.name], **keywords).unwrapped
    env.reset(seed=1)
    for _ in range(3):
        observed = env.step([0.3])[0]
    theta, rate, latched, left, feature = np.split(observed.astype(float), [2, 4, 6, 7])
    expected = shown(theta, rate, latched, *left, [row.name])
    assert feature == pytest.approx(list(expected.values()), rel=1e-6)


@each
def test_the_documentation_lists_the_feature_with_its_bounds_and_unit(row):
    starts = f"| `{row.name}` |", f"| `{row.name}_i` |"
    (line,) = [line for line in solar_env.SolarArrayEnv.__doc__.splitlines() if line.strip().startswith(starts)]
    assert f"| {row.low:.4g} | {row.high:.4g} | {row.unit} |" in line
