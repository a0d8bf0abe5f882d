"""A million environment steps under actions that nobody would choose: numbers, no failing lane, no leak.

`pytest -m slow tests/environment/test_a_million_steps.py` takes half an hour of a core.
"""

from __future__ import annotations

import gc
from pathlib import Path

import gymnasium
import numpy as np
import pytest

from solar_env.array import MODELS
from solar_env.environment.registration import DEPLOY_RANDOMISED_V1

LANES, STEPS = 50, 5000
# Actions hold for so many steps: white noise, and torques that drive the array into its stops.
HELD = np.array([1, 3, 30, 100, 400])


def used_memory():
    """Pages in memory."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1])


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
def test_every_step_under_random_torques_gives_numbers_and_leaks_nothing(model):
    env = gymnasium.make_vec(
        DEPLOY_RANDOMISED_V1, LANES, model=model, observation="privileged", autoreset_mode="SameStep"
    )
    rng = np.random.default_rng(0)
    held, actions, residuals = HELD[np.arange(LANES) % HELD.size], np.zeros((LANES, 1), np.float32), []
    memory = []
    env.reset(seed=0)
    for step in range(STEPS):
        renewed = step % held == 0
        actions[renewed] = rng.choice([-1.0, 0.0, 1.0, rng.uniform(-1.0, 1.0)], (renewed.sum(), 1))
        observations, rewards, terminations, _, infos = env.step(actions)
        assert "failure" not in infos.get("final_info", {}), infos["final_info"]["failure"]
        assert np.isfinite(observations).all()
        assert np.isfinite(rewards).all()
        assert (rewards <= 0.0).all()
        if terminations.any():
            residuals += infos["final_info"]["deployment"]["energy_residual_J"][terminations].tolist()
        if step % (STEPS // 8) == 0:
            memory.append(used_memory())
    assert len(residuals) > LANES
    # What rigid panels lose by the error of steps, of a joule turned over; bent ones are watched by `Simulation.check`.
    assert model.startswith("flexible") or np.abs(residuals).max() < 5e-4
    assert max(memory[3:]) < 1.05 * max(memory[:3])
