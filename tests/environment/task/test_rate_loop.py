"""The drive's own rate loop: its torque by formula, its filter, its samples, its noise, and what it cannot do."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest

from solar_env.environment.registration import DEPLOY, DEPLOY_V1
from solar_env.environment.task.drive import CRUISE, HASTE, LAG, REACH
from solar_env.mechanics.arrays.columns import RATE
from solar_env.mechanics.arrays.model import SLIDING_WORK, joint_integrals

RATE_LOOP = {"model": "rigid-ideal", "action": "log_rate"}
GAIN = 12.0
# A loop that is as slow as the actions, and does not filter its torque.
SLOW = {"rate_loop_frequency": 10.0, "rate_loop_lag": 0.0}


def make(hardware=None, **keywords):
    env = gymnasium.make(DEPLOY_V1, hardware={**SLOW, **(hardware or {})}, **RATE_LOOP, **keywords).unwrapped
    env.reset(seed=0)
    return env


class Asked:
    """The setpoint [rad/s] of a loop that takes ten samples a second, sample by sample."""

    def __init__(self, lock_angle):
        self.u, self.cruise = 0.0, lock_angle / (CRUISE * 20.0)

    def __call__(self, action):
        self.u += (1.0 - math.exp(-0.1 / LAG)) * (REACH * action - self.u)
        return self.cruise * (math.exp(self.u) if self.u < 0.0 else 1.0 + HASTE * self.u)


def rate(env, joint=0):
    return env.simulation.joint_loads()[joint, RATE]


@pytest.mark.parametrize(("driven", "lag"), [(0, 0.0), (1, 0.0), (0, 0.25)])
def test_the_torque_is_the_gain_times_the_error_of_the_rate_filtered_and_held_for_a_sample(driven, lag):
    env = make({"rate_loop_lag": lag}, driven_joint=driven)
    asked = Asked((1 + driven) * math.pi / 2.0)
    torque, share = 0.0, 1.0 - math.exp(-0.1 / lag) if lag else 1.0
    for action in (0.3, 0.45, -0.2, 0.0, 0.4, 0.9):
        torque += share * (np.clip(GAIN * (asked(action) - rate(env, driven)), -0.5, 0.5) - torque)
        env.step([action])
        assert env.simulation.state.joints["motor_torque"][driven] == pytest.approx(torque, rel=1e-9)


def test_without_the_filter_a_fast_loop_shakes_flexible_panels():
    """By what it is charged for wear in the first two seconds."""
    wear = []
    for lag in (0.0, 0.1):
        env = gymnasium.make(DEPLOY_V1, model="flexible-clearance", action="log_rate", hardware={"rate_loop_lag": lag})
        env.reset(seed=0)
        wear.append(-sum(env.step([0.0])[-1]["reward_terms"]["wear"] for _ in range(20)))
    assert wear[0] > 10.0 * wear[1]


def test_a_light_yoke_is_driven_without_shaking_and_beside_other_arrays_to_the_same_bits(monkeypatch):
    yoke = {"panel_length": (0.3, 1.5), "panel_area_mass": (8.0, 3.0)}
    task = {"model": "rigid-clearance", "hardware": {"rate_noise": 1e-3}}
    vector = gymnasium.make_vec(DEPLOY, 2, parameters=[{}, yoke], **task)
    singles = [gymnasium.make(DEPLOY, parameters=parameters, **task) for parameters in ({}, yoke)]
    vector.reset(seed=[3, 4])
    for seed, env in enumerate(singles, 3):
        env.reset(seed=seed)
    for _ in range(8):
        many = vector.step(np.zeros((2, 1), np.float32))[0]
        for env, observed in zip(singles, many, strict=True):
            assert env.step(np.zeros(1, np.float32))[0].tobytes() == observed.tobytes()

    def wear():
        env = gymnasium.make(DEPLOY, parameters=yoke, model="rigid-clearance").unwrapped
        env.reset(seed=0)
        for _ in range(8):
            env.step([0.0])
        return joint_integrals(env.simulation.state.integrals)[:, SLIDING_WORK].sum()

    steady = wear()
    monkeypatch.setattr("solar_env.environment.task.drive.GENTLE", math.inf)
    assert wear() > 10.0 * steady


def test_the_filter_goes_with_an_episode_that_is_saved():
    envs = gymnasium.make_vec(DEPLOY_V1, 2, hardware={"rate_loop_lag": 0.4}, **RATE_LOOP)
    envs.reset(seed=0)
    for _ in range(3):
        envs.step(np.full((2, 1), 0.6, np.float32))
    envs.unwrapped.lane(1).restore_episode(envs.unwrapped.lane(0).save_episode())
    copies = envs.unwrapped.episodes.futures(0, 1)
    observed = envs.step(np.full((2, 1), 0.4, np.float32))[0]
    copies.step(np.zeros(1, dtype=np.int64), np.array([[0.4]], np.float32).astype(float))
    torques = [batch.states.joints["motor_torque"][:, 0] for batch in (envs.unwrapped.episodes.batch, copies.batch)]
    assert observed[0].tobytes() == observed[1].tobytes()
    assert torques[0][0] == torques[0][1] == torques[1][0] != 0.0


def test_a_faster_loop_is_the_same_as_as_many_slow_control_periods():
    fast = make(hardware={"rate_loop_frequency": 50.0})
    slow = make(hardware={"rate_loop_frequency": 50.0}, control_period=0.02)
    for action in (0.8, 0.5, -0.3):
        *_, info = fast.step([action])
        for _ in range(5):
            *_, told = slow.step([action])
        assert info["time_s"] == pytest.approx(told["time_s"], abs=1e-12)
        assert fast.simulation.state.q == pytest.approx(slow.simulation.state.q, abs=1e-12)


def test_the_torque_stays_within_the_limit_and_follows_the_motors_lag_and_rate_limit():
    env = make()
    env.step([1.0])
    assert env.simulation.state.joints["motor_torque"][0] == 0.5
    slow = make(hardware={"motor_lag": 0.1, "torque_rate_limit": 0.2, "rate_loop_frequency": 20.0})
    slow.step([1.0])
    assert slow.simulation.state.joints["motor_torque"][0] == pytest.approx(0.02, rel=1e-12), "0.2 N m/s for 0.1 s"


def test_the_loop_measures_its_rate_with_the_noise_of_the_hardware_and_the_same_in_a_vector():
    noisy, strong, asked = {"rate_noise": 1e-3}, {"torque_limit": 5.0, **RATE_LOOP}, Asked(math.pi / 2.0)
    single = make(hardware=noisy, torque_limit=5.0)
    vector = gymnasium.make_vec(DEPLOY_V1, 2, hardware={**SLOW, **noisy}, **strong)
    vector.reset(seed=0)
    errors = []
    for _ in range(50):
        before = rate(single)
        one, many = single.step([0.0])[0], vector.step(np.zeros((2, 1), np.float32))[0]
        assert one.tobytes() == many[0].tobytes()
        errors.append(asked(0.0) - single.simulation.state.joints["motor_torque"][0] / GAIN - before)
    assert np.std(errors) == pytest.approx(1e-3, rel=0.3)


def test_a_loop_that_cannot_be_is_refused_by_name():
    for keywords, words in (
        ({"action": "speed"}, "speed.*torque"),
        ({"action": "log_rate", "hardware": {"rate_loop_frequency": 15.0}}, "15.0 Hz.*1.5 samples.*whole number"),
        ({"action": "log_rate", "control_period": 0.001}, "rate_loop_frequency.*0.1 samples"),
        ({"hardware": {"rate_loop_lag": -0.1}}, "rate_loop_lag.*-0.1.*not negative"),
        ({"hardware": {"rate_loop_gain": 0.0}}, "rate_loop_gain.*0.0.*positive"),
    ):
        with pytest.raises(ValueError, match=words):
            gymnasium.make(DEPLOY_V1, **keywords)
