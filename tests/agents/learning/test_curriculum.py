"""A reverse curriculum begins near the latches and ends with the starts of the environment, in a real training."""

import numpy as np
import pytest
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback, CallbackList

from agents.environments import DEFAULT_ENV_ID
from agents.learning.callbacks import ReverseCurriculum
from agents.learning.vec_env import NativeVecEnv

KEYWORDS = {
    "model": "rigid-ideal",
    "deadline": 10.0,
    "postlock_window": 0.2,
    "action": "rate",
    "starts": {"opening": (0.4, 0.9), "rate": (0.2, 0.25), "count": 8},
}


class Openings(BaseCallback):
    """Keeps the mean opening with which each episode begins, by rollout."""

    def __init__(self):
        super().__init__()
        self.rollouts = []

    def _on_rollout_start(self):
        self.rollouts.append([])

    def _on_step(self):
        begun = self.locals["new_obs"][self.locals["dones"]]
        self.rollouts[-1] += begun[:, :2].mean(axis=1).tolist()
        return True


def test_episodes_begin_near_the_latches_then_further_away_and_at_last_folded_too():
    venv = NativeVecEnv(4, DEFAULT_ENV_ID, KEYWORDS)
    openings = Openings()
    model = PPO("MlpPolicy", venv, n_steps=60, batch_size=60, n_epochs=1, seed=0)
    model.learn(60 * 4 * 12, CallbackList([ReverseCurriculum(first=0.85, folded=0.5, over=0.6), openings]))
    first, last = np.array(openings.rollouts[0]), np.concatenate(openings.rollouts[-3:])
    assert first.min() >= 0.8
    assert last.min() < 0.01
    assert np.mean(last < 0.01) == pytest.approx(0.5, abs=0.3)
