"""Recorders and films show what has happened, whatever is restored, refused or begun beneath them."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from gymnasium.wrappers import Autoreset

from solar_env.environment.registration import DEPLOY
from solar_env.environment.showing.recording import RecordTrajectory


def test_reading_or_a_refused_step_forgets_nothing():
    env = RecordTrajectory(gymnasium.make(DEPLOY), 0.05)
    env.reset(seed=0)
    simulation = env.unwrapped.simulation
    states = []
    for _ in range(4):
        env.step([0.5])
        states.append(simulation.snapshot())
    whole = env.trajectory
    simulation.restore(states[1])
    assert env.trajectory.time[-1] == 1.0
    with pytest.raises(ValueError, match="finite"):
        env.step([np.nan])
    simulation.restore(states[3])
    np.testing.assert_array_equal(env.trajectory.angles, whole.angles)
    simulation.restore(states[1])
    env.step([-0.5])
    assert env.trajectory.time[-1] == 1.5
    simulation.restore(states[3])
    with pytest.raises(RuntimeError, match="nothing recorded has led to it"):
        env.trajectory  # noqa: B018


def test_an_episode_that_a_wrapper_beneath_begins_is_recorded_from_its_start():
    env = RecordTrajectory(Autoreset(gymnasium.make(DEPLOY, max_episode_steps=2)), 0.05)
    env.reset(seed=0)
    for _ in range(4):
        env.step([0.5])
    assert env.trajectory.time[[0, -1]].tolist() == [0.0, 0.5]
    with pytest.raises(ValueError, match="is no environment of a solar array"):
        RecordTrajectory(gymnasium.make("CartPole-v1"))


def test_a_film_forgets_the_future_of_a_state_that_is_restored():
    env = gymnasium.make(DEPLOY, render_mode="rgb_array", randomize={"initial_rate": (0.0, 0.01)})
    env.reset(seed=0)
    for _ in range(3):
        env.step([0.3])
    state, shown = env.unwrapped.simulation.snapshot(), env.render()
    for _ in range(3):
        env.step([1.0])
    env.unwrapped.simulation.restore(state)
    np.testing.assert_array_equal(env.render(), shown)


def test_a_refused_action_leaves_futures_as_they_are():
    env = gymnasium.make(DEPLOY)
    env.reset(seed=0)
    futures, lanes = env.unwrapped.futures(2), np.arange(2)
    with pytest.raises(ValueError, match="action of lane 1 is not finite"):
        futures.step(lanes, np.array([[0.0], [np.nan]]))
    futures.step(lanes, np.zeros((2, 1)))
    env.step([0.0])
    np.testing.assert_array_equal(futures.times, [env.unwrapped.simulation.time] * 2)
