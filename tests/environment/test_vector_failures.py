"""Lanes of a vector environment that cannot go on, and the others beside them."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from episodes import assert_same, make_vector
from gymnasium.vector import AutoresetMode

from solar_env.environment.registration import DEPLOY_V1
from solar_env.mechanics.running.errors import SimulationError


def with_a_broken_lane(**keywords):
    env = make_vector(3, model="rigid-ideal", **keywords)
    env.reset(seed=0)
    env.step(np.zeros((3, 1)))
    broken = env.unwrapped.episodes.batch.simulations[1]
    broken.state.v[:] = np.nan
    broken.state.clock["acceleration_current"] = 0
    return env


@pytest.mark.parametrize("mode", AutoresetMode)
def test_a_lane_that_cannot_go_on_is_truncated_with_the_error_and_the_others_go_on(mode):
    whole = make_vector(3, model="rigid-ideal", autoreset_mode=mode)
    whole.reset(seed=0)
    before, *_ = whole.step(np.zeros((3, 1)))
    expected = whole.step(np.zeros((3, 1)))
    env = with_a_broken_lane(autoreset_mode=mode)
    observations, rewards, terminations, truncations, infos = env.step(np.zeros((3, 1)))
    assert truncations.tolist() == [False, True, False]
    assert not terminations.any()
    assert np.isfinite(observations).all()
    assert rewards[1] == 0.0
    for lane in (0, 2):
        assert_same(observations[lane], expected[0][lane])
        assert rewards[lane] == expected[1][lane]
    last = infos["final_info"] if mode is AutoresetMode.SAME_STEP else infos
    assert last["_failure"].tolist() == [False, True, False]
    assert last["failure"][1].startswith("at t = 0.1 s ")
    if mode is AutoresetMode.SAME_STEP:
        assert_same(infos["final_obs"][1], before[1])
    else:
        assert_same(observations[1], before[1])
    if mode is AutoresetMode.DISABLED:
        env.reset(options={"reset_mask": truncations})
    _, _, _, truncations, infos = env.step(np.zeros((3, 1)))
    assert not truncations.any()
    assert "failure" not in infos


def test_a_period_that_needs_too_many_steps_ends_the_lane_and_says_so():
    env = make_vector(2, max_steps=3)
    env.reset(seed=0)
    *_, truncations, infos = env.step(np.zeros((2, 1)))
    assert truncations.all()
    assert "3 steps were taken in one call without reaching its end" in infos["failure"][0]
    single = gymnasium.make(DEPLOY_V1, max_steps=3)
    single.reset(seed=0)
    with pytest.raises(SimulationError, match="raise max_steps"):
        single.step(np.zeros(1))
    for value in (0, 2.5):
        with pytest.raises(ValueError, match=r"max_steps = .* must be a whole number"):
            gymnasium.make(DEPLOY_V1, max_steps=value)


def test_several_threads_in_one_environment_are_refused():
    env, vector = gymnasium.make(DEPLOY_V1), make_vector(2)
    for each, episodes, action in (
        (env, env.unwrapped._episodes, np.zeros(1)),
        (vector, vector.unwrapped.episodes, np.zeros((2, 1))),
    ):
        each.reset(seed=0)
        with episodes.alone(), pytest.raises(RuntimeError, match="in another call just now"):
            each.step(action)
        each.step(action)
