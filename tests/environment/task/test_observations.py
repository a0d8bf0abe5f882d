"""Every observable keeps to its row of the table: bounds, sensors, names; single and in a vector. Quick uncompiled."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest

import solar_env
from solar_env import Hardware
from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.task.features import FEATURES
from solar_env.environment.task.observations import LOCK_ANGLE, OBSERVABLES, OBSERVATIONS, observation_entries
from solar_env.environment.task.sensors import Sensors

LOCK_ANGLES = (math.pi / 2, math.pi)
EVERYTHING = [row.name for row in OBSERVABLES]
# Beyond the bounds of most observables, after a step that is short uncompiled, too.
WILD = {
    "model": "rigid-ideal",
    "control_period": 1e-3,
    "parameters": {"initial_spin": 3.0, "initial_rate": 7.0},
}

each = pytest.mark.parametrize("row", OBSERVABLES, ids=EVERYTHING)
feature_too = pytest.mark.parametrize("row", [*OBSERVABLES, *FEATURES], ids=lambda row: row.name)


def names(joints, observation):
    return [entry.name for entry in observation_entries(joints, observation)]


def sensors(row, hardware, lanes=1):
    """Sensors of one observable of two joints, which see a quarter of its range from below."""
    made = Sensors(lanes, LOCK_ANGLES, observation_entries(2, [row.name]), hardware)
    made.exact[:] = row.low + 0.25 * (row.high - row.low)
    made.begin(np.arange(lanes), [np.random.default_rng(lane) for lane in range(lanes)])
    return made


def unit(row):
    """(entries,) size of the row's unit in SI units, of angles and rates."""
    return np.array(LOCK_ANGLES if row.unit == LOCK_ANGLE else [1.0] * (2 if row.by_joint else 1))


@feature_too
def test_a_row_stays_in_its_bounds_and_is_the_same_in_a_vector_bit_for_bit(row):
    keywords = {**WILD, "observation": [row.name, f"{row.name}_2_ago"]}
    single, vector = gymnasium.make(DEPLOY_V1, **keywords).unwrapped, gymnasium.make_vec(DEPLOY_V1, 2, **keywords)
    entries = len(names(2, [row.name]))
    assert single.observation_names == tuple(names(2, keywords["observation"]))
    assert single.observation_space.low.tolist() == [np.float32(row.low)] * 2 * entries
    assert single.observation_space.high.tolist() == [np.float32(row.high)] * 2 * entries
    seen, together = [single.reset(seed=0)[0]], vector.reset(seed=0)[0]
    for action in (0.5, -2.0, 0.1):
        assert single.observation_space.contains(seen[-1])
        assert seen[-1].tobytes() == together[0].tobytes() == together[1].tobytes()
        seen.append(single.step([action])[0])
        together = vector.step(np.full((2, 1), action, np.float32))[0]
    assert np.array_equal(seen[3][entries:], seen[1][:entries])


@feature_too
def test_the_documentation_lists_the_row_with_its_bounds_and_unit(row):
    starts = f"| `{row.name}` |", f"| `{row.name}_i` |"
    told, _ = solar_env.SolarArrayEnv.__doc__.split("## Rewards")
    (line,) = [line for line in told.splitlines() if line.strip().startswith(starts)]
    assert f"| {row.low:.4g} | {row.high:.4g} | {row.unit} |" in line
    noise = getattr(row, "noise", None)
    assert noise is None or f"`{noise}`" in line


@each
def test_noise_is_what_the_row_and_the_hardware_say(row):
    noises = {"angle_noise": 1e-3, "rate_noise": 2e-3, "attitude_noise": 3e-3}
    made = sensors(row, Hardware(**noises), lanes=2000)
    error = (made.observed.astype(float) - made.exact) * unit(row)
    if row.noise is None:
        assert np.all(error == 0.0)
    else:
        assert np.std(error, axis=0) == pytest.approx(noises[row.noise], rel=0.07)
        assert np.abs(np.mean(error, axis=0)) == pytest.approx(0.0, abs=4.0 * noises[row.noise] / math.sqrt(2000))


@each
def test_steps_are_those_of_an_encoder_where_the_row_says_so(row):
    made = sensors(row, Hardware(encoder_resolution=0.3))
    shown, exact = made.observed[0] * unit(row), made.exact[0] * unit(row)
    assert np.array_equal(shown, exact) != row.encoder
    if row.encoder:
        assert shown / 0.3 == pytest.approx(np.rint(exact / 0.3), abs=1e-5)


@each
def test_a_measurement_is_shown_late_where_the_row_says_so(row):
    made = sensors(row, Hardware(sensor_delay=2))
    first, later = made.exact[0, 0].copy(), np.float32(row.high)
    made.exact[:] = later
    shown = []
    for _ in range(3):
        made.measure(np.arange(1))
        shown.append(made.observed[0, 0])
    assert shown == ([first, first, later] if row.delayed else [later] * 3)


def test_the_observations_list_what_is_documented_in_that_order():
    drive = ["theta_1", "theta_2", "theta_3", "rate_1", "rate_2", "rate_3", "latched_1", "latched_2", "latched_3"]
    drive += ["motor_torque", "time_to_deadline", "time_since_latch"]
    remembered = [*drive[:6], "motor_torque"]
    journals = [f"{name}_{k}" for k in (1, 2, 3) for name in ("eccentricity_x", "eccentricity_y", "in_contact")]
    assert set(OBSERVATIONS) == {"scaled", "drive", "history", "privileged"}
    distances, speeds, switches = ([f"{name}_{k}" for k in (1, 2, 3)] for name in ("distance", "speed", "latched"))
    assert names(3, "scaled") == [*distances, *speeds, *switches, "time", "log_setpoint"]
    assert names(3, "drive") == drive
    assert names(3, "history") == drive + [f"{name}_{back}_ago" for back in (1, 2, 3) for name in remembered]
    assert names(3, "privileged") == [*drive, *journals, "main_body_spin"]


def test_the_angle_of_the_main_body_is_the_integral_of_its_spin():
    env = gymnasium.make(
        DEPLOY_V1,
        model="rigid-ideal",
        control_period=1e-3,
        parameters={"initial_spin": 0.5},
        observation=["main_body_angle", "main_body_spin"],
    ).unwrapped
    seen = [env.reset(seed=0)[0], *(env.step([1.0])[0] for _ in range(20))]
    angle, spin = np.array(seen, dtype=float).T
    assert angle[0] == 0.0
    assert np.diff(angle) == pytest.approx(0.5e-3 * (spin[1:] + spin[:-1]), abs=1e-8)
    assert angle[-1] > 5e-3


def test_the_peak_force_is_the_greatest_of_the_last_period_alone():
    env = gymnasium.make(
        DEPLOY_V1, model="rigid-ideal", control_period=1e-3, observation=["recent_peak_force"]
    ).unwrapped
    first, _ = env.reset(seed=0)
    pushed, quiet = (env.step([action])[0] for action in (1.0, 0.0))
    assert np.all(first == 0.0)
    assert pushed == pytest.approx(1e-3 * env.simulation.state.joints["peak_force"], rel=0.2)
    assert np.all(quiet < pushed)


def test_an_observation_in_a_list_stands_for_all_that_it_has():
    listed = names(2, ["time", "drive", "main_body_spin"])
    assert listed == ["time", *names(2, "drive"), "main_body_spin"]


def test_a_feature_is_of_order_one_from_the_release_to_the_last_hundredth_of_a_degree_and_of_what_noisy_sensors_show():
    """By its formula, of the measured entries that are observed beside it."""
    keywords = {"scenario": "randomised", "model": "rigid-ideal", "control_period": 1e-3}
    env = gymnasium.make(DEPLOY_V1, observation=["theta", "rate", "distance", "speed"], **keywords).unwrapped
    env.reset(seed=1)
    for _ in range(3):
        theta, rate, distance, speed = np.split(env.step([0.3])[0].astype(float), 4)
        assert distance == pytest.approx(np.arcsinh((1.0 - theta) / 0.01) / 2.0 - 1.0, rel=1e-6)
        assert speed == pytest.approx(np.arcsinh(rate / LOCK_ANGLES / 0.002) / 2.0 - 1.0, rel=1e-6)
    far, near = (FEATURES[0].function(np.array([1.0 - to_go]), 1.0)[0] for to_go in (1.0, 1e-4))
    assert (far, near) == pytest.approx((1.65, -1.0), abs=0.01)


def test_an_observation_that_is_none_is_refused_by_name():
    for observation, words in (
        ("drives", "drives.*drive"),
        (["drive", "theta"], "drive.*only once"),
        (["theta", "rates"], "rates.*rate"),
        (["theta", "theta_0_ago"], "theta_0_ago"),
        (["theta_101_ago"], "theta_101_ago.*at most 100"),
        (["rate_2"], "rate_2.*leave out the number, 'rate' observes all joints"),
        ([], "at least one"),
        ([3], "3.*theta"),
    ):
        with pytest.raises(ValueError, match=words):
            solar_env.SolarArrayEnv(observation=observation)
