"""A million environment steps under actions that nobody would choose: all results are numbers, no lane fails.

`pytest -m slow tests/environment/test_a_million_steps.py` takes half an hour of a core.
"""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest

from solar_env.array import MODELS

RANDOMISED = "solar_env/DeployRandomised-v1"
LANES, STEPS = 50, 5000
# Actions hold for so many steps: white noise, and torques that drive the array into its stops.
HELD = np.array([1, 3, 30, 100, 400])


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
def test_every_step_under_random_torques_gives_numbers(model):
    env = gymnasium.make_vec(RANDOMISED, LANES, model=model, observation="privileged")
    rng = np.random.default_rng(0)
    held, actions, ended = HELD[np.arange(LANES) % HELD.size], np.zeros((LANES, 1), np.float32), 0
    env.reset(seed=0)
    for step in range(STEPS):
        renewed = step % held == 0
        actions[renewed] = rng.choice([-1.0, 0.0, 1.0, rng.uniform(-1.0, 1.0)], (renewed.sum(), 1))
        observations, rewards, terminations, truncations, infos = env.step(actions)
        assert "failure" not in infos, infos["failure"]
        assert np.isfinite(observations).all()
        assert np.isfinite(rewards).all()
        assert (rewards <= 0.0).all()
        ended += (terminations | truncations).sum()
    assert ended > LANES
