"""The present version of the task: what its drive does, what an episode is, and what it costs."""

from __future__ import annotations

import math
import warnings

import gymnasium
import numpy as np
import pytest
from episodes import assert_same, deploy
from gymnasium.utils.env_checker import check_env
from stable_baselines3.common.env_checker import check_env as check_env_of_sb3

from solar_env.environment.registration import DEPLOY, DEPLOY_RANDOMISED
from solar_env.environment.task.reward import Reward
from solar_env.mechanics.arrays.columns import RATE

CRUISE, REACH, LAG = math.pi / 2 / 16, 4.5, 5.0
IDEAL = {"model": "rigid-ideal"}


def make(env_id=DEPLOY, **keywords):
    return gymnasium.make(env_id, **keywords).unwrapped


def held(action, seconds, env):
    """Rate of the driven joint [rad/s] after an action has been held for some time."""
    env.reset(seed=0)
    for _ in range(round(seconds / env.task.control_period)):
        observation, *_ = env.step([action])
    return env.simulation.joint_loads()[env.task.driven_joint, RATE], observation


def test_the_logarithm_of_the_setpoint_follows_the_action_with_a_lag_and_is_observed():
    env = make(**IDEAL)
    _, observation = held(-0.5, 4.0, env)
    assert observation[-1] == pytest.approx(-0.5 * (1.0 - math.exp(-4.0 / LAG)), rel=1e-6)


@pytest.mark.parametrize("joint", [0, 1])
def test_the_drive_holds_the_rate_that_it_is_asked_for_against_the_springs(joint):
    """A loop that does not know them gives way, at several times the rate."""
    rate, _ = held(-0.4, 25.0, make(driven_joint=joint, **IDEAL))
    assert rate == pytest.approx((1 + joint) * CRUISE * math.exp(-0.4 * REACH), rel=0.03)
    ignorant = make(driven_joint=joint, hardware={"load_compensation": False}, **IDEAL)
    given_way, _ = held(-1.0, 15.0, ignorant)
    assert given_way > 3.0 * (1 + joint) * CRUISE * math.exp(-REACH)


@pytest.mark.parametrize(
    "keywords",
    [
        {"model": "rigid-clearance"},
        {"model": "flexible-clearance"},
        {**IDEAL, "parameters": {"panel_count": 1}},
        {**IDEAL, "parameters": {"panel_count": 4}, "hardware": {"rate_loop_gain": 100.0}},
        {**IDEAL, "driven_joint": 1},
        {**IDEAL, "env_id": DEPLOY_RANDOMISED},
    ],
    ids=str,
)
def test_an_action_of_nothing_deploys_in_time_and_the_drive_alone_brings_the_array_to_rest(keywords):
    env = make(**keywords)
    _, steps, info = deploy(env)
    last = max(info["deployment"]["latch_times_s"])
    assert 16.0 < last < 20.0
    assert steps == math.ceil(last / 0.5)
    assert info["time_s"] == pytest.approx(last + 10.0)
    assert abs(env.simulation.joint_loads()[0, RATE]) < 0.02
    assert env.task.torque_limit > abs(env.simulation.state.joints["motor_torque"]).max()


def test_a_deployment_costs_decades_of_force_and_work_and_its_time_and_earns_the_way():
    for policy in (lambda o: [0.0], lambda o: [-0.15]):
        total, _, info = deploy(make(), policy)
        figures = info["deployment"]
        force, work = sum(figures["peak_postlock_force_N"]), sum(figures["sliding_work_J"])
        last = max(figures["latch_times_s"])
        price = math.log10(1.0 + force) + 2.0 * math.log10(1.0 + 1e3 * work) + 0.01 * last + 2.0 * max(last - 19.5, 0.0)
        assert total == pytest.approx(3.2 - price, abs=1e-3)
        late = 25.0 * (last > 20.0)
        assert figures["v1_return"] == pytest.approx(-force / 500.0 - work / 0.1 - late, rel=1e-12)


def test_whoever_never_latches_waits_for_twice_the_deadline_and_pays_more_than_any_deployment_costs():
    total, steps, info = deploy(make(**IDEAL), lambda observation: [-1.0])
    assert (steps, info["time_s"], info["deployment"]["latched"]) == (80, 40.0, False)
    prices = Reward().prices
    worst = prices["peak_impact"].greatest + prices["wear"].greatest + 0.4 + 41.0 - 3.2
    assert -total > worst > 45.0


@pytest.mark.parametrize(
    "keywords", [{}, {"env_id": DEPLOY_RANDOMISED}, {"model": "flexible-clearance"}, {"action": "torque"}], ids=str
)
def test_a_lane_of_a_vector_is_the_single_environment_bit_for_bit(keywords):
    keywords = {"parameters": {"spring_stiffness": 1.0}, "deadline": 6.0, "settling_window": 1.0, **keywords}
    rng, env_id = np.random.default_rng(0), keywords.pop("env_id", DEPLOY)
    actions = rng.uniform(-0.5, 1.0, (30, 2, 1)).astype(np.float32)
    envs, single = gymnasium.make_vec(env_id, 2, **keywords), make(env_id, **keywords)
    together, _ = envs.reset(seed=7)
    alone, _ = single.reset(seed=8)
    assert_same(together[1], alone)
    for action in actions:
        together, rewards, ended, _, _ = envs.step(action)
        alone, reward, over, _, _ = single.step(action[1])
        assert_same(together[1], alone)
        assert (rewards[1], ended[1]) == (reward, over)
        if over:
            break
    assert over


def test_a_saved_episode_goes_on_with_the_memory_of_its_drive():
    envs = gymnasium.make_vec(DEPLOY_RANDOMISED, 2, **IDEAL)
    envs.reset(seed=0)
    for _ in range(5):
        envs.step(np.array([[-0.6], [0.3]], np.float32))
    envs.unwrapped.lane(1).restore_episode(envs.unwrapped.lane(0).save_episode())
    for _ in range(5):
        observed, *_ = envs.step(np.full((2, 1), 0.4, np.float32))
    assert_same(observed[0], observed[1])


@pytest.mark.parametrize("env_id", [DEPLOY, DEPLOY_RANDOMISED])
@pytest.mark.parametrize("action", ["log_rate", "torque"])
def test_both_checkers_have_nothing_to_warn_of(env_id, action):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(env_id, action=action, **IDEAL).unwrapped, skip_render_check=True)
        check_env_of_sb3(gymnasium.make(env_id, action=action, **IDEAL))


def test_a_step_cut_off_for_its_number_of_integration_steps_goes_on_to_the_same_bits(monkeypatch):
    """Also in the last step, in which the drive settles the array."""
    whole = deploy(make())
    monkeypatch.setattr("solar_env.mechanics.running.batch.STEPS_PER_CALL", 7)
    monkeypatch.setattr("solar_env.mechanics.running.batch._FEWEST_STEPS_PER_CALL", 7)
    pieces = deploy(make())
    assert whole[:2] == pieces[:2]
    assert_same(whole[2], pieces[2])
