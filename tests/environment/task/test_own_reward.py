"""A reward of one's own: a function of the figures and the time, in one environment and in a vector alike."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest

from solar_env.environment.registration import DEPLOY
from solar_env.environment.task.reward import Reward

IDEAL = {"model": "rigid-ideal"}
BRAKING = [0.0] * 25 + [-0.5] * 55  # lands after 20 s


def potential(told):
    """What the present version charges and pays, but for the way that a missed deadline takes beyond it."""
    force, work = math.log10(1.0 + told["peak_impact"]), math.log10(1.0 + told["wear"] / 1e-3)
    return 3.2 * told["opening"] - force - 2.0 * work - 0.01 * told["time"] - 2.0 * told["lateness"]


def growth(before, after):
    return potential(after) - potential(before)


def episode(env, actions=BRAKING):
    env.reset(seed=3)
    rewards = []
    for action in actions:
        _, reward, ended, _, info = env.step([action])
        rewards.append(reward)
        if ended:
            break
    return rewards, info


@pytest.mark.parametrize("model", ["rigid-ideal", "rigid-clearance"])
def test_a_function_that_charges_the_prices_of_the_version_gives_its_rewards(model):
    usual, info = episode(gymnasium.make(DEPLOY, model=model))
    own, told = episode(gymnasium.make(DEPLOY, model=model, reward=growth))
    assert info["deployment"]["latched"]
    assert own == pytest.approx(usual, rel=1e-9, abs=1e-12)
    assert told["reward_terms"] == {"own": own[-1]}
    assert told["deployment"] == info["deployment"]


def test_a_potential_shapes_the_steps_and_not_the_return():
    shaping = lambda before, after: growth(before, after) + after["opening"] - before["opening"]  # noqa: E731
    plain, _ = episode(gymnasium.make(DEPLOY, reward=growth, **IDEAL))
    shaped, _ = episode(gymnasium.make(DEPLOY, reward=shaping, **IDEAL))
    assert not np.allclose(shaped, plain, atol=1e-3)
    assert sum(shaped) == pytest.approx(sum(plain) + 1.0, abs=1e-9)  # the way, and nothing of how it is made


def test_a_vector_asks_the_function_in_each_lane():
    env = gymnasium.make(DEPLOY, reward=growth, **IDEAL)
    envs = gymnasium.make_vec(DEPLOY, num_envs=2, reward=growth, **IDEAL)
    envs.reset(seed=[3, 3])
    alone, _ = episode(env)
    for expected, action in zip(alone, BRAKING, strict=False):
        _, rewards, *_ = envs.step(np.array([[action], [0.0]]))
        assert rewards[0] == expected


def test_an_episode_that_is_gone_on_with_elsewhere_is_rewarded_for_the_same_growth():
    episodes = gymnasium.make_vec(DEPLOY, num_envs=2, reward=growth, **IDEAL)
    episodes.reset(seed=[3, 4])
    for _ in range(20):
        episodes.step(np.zeros((2, 1)))
    lanes = episodes.unwrapped.episodes
    lanes.restore(1, lanes.save(0))
    for _ in range(10):
        _, rewards, *_ = episodes.step(np.zeros((2, 1)))
        assert rewards[0] == rewards[1]


def test_a_function_that_returns_no_number_is_refused_with_the_moment():
    env = gymnasium.make(DEPLOY, reward=lambda before, after: math.nan, **IDEAL)
    env.reset(seed=0)
    with pytest.raises(ValueError, match=r"returned nan at 0\.5 s"):
        env.step([0.0])
    with pytest.raises(ValueError, match="or a function"):
        Reward(3.0)
