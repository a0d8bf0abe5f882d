"""Searches over weights find the best ones of a task with a known answer, and judge candidates by whole episodes."""

import gymnasium
import numpy as np
import pytest
import torch
from stable_baselines3.common.callbacks import CallbackList
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.logger import configure
from stable_baselines3.common.vec_env import DummyVecEnv, VecEnvWrapper

from agents.environments import DEFAULT_ENV_ID
from agents.learning.vec_env import FixedSeeds, NativeVecEnv
from agents.learning.weight_search import CMAES, WeightSearch

TARGET = np.array([0.6, -0.3, 0.2])
SEARCHES = {
    "ars": (WeightSearch, {"n_delta": 4, "learning_rate": 0.01, "delta_std": 0.02}),
    "cma-es": (CMAES, {"population": 8, "generations_between": 3, "finalists": 1}),
}
QUICK = {"model": "rigid-ideal", "control_period": 0.5, "settling_window": 2.0}
QUICK |= {"action": "rate", "observation": "landing"}

each = pytest.mark.parametrize("name", SEARCHES)


class OneByOne(gymnasium.Env):
    """Shows one entry after the other; an action costs the square of its distance from the entry's target."""

    observation_space = gymnasium.spaces.Box(0.0, 1.0, (3,))
    action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,))

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.index = 0
        return np.eye(3, dtype=np.float32)[0], {}

    def step(self, action):
        cost = float((action[0] - TARGET[self.index]) ** 2)
        self.index += 1
        return np.eye(3, dtype=np.float32)[self.index % 3], -cost, self.index == 3, False, {}


def made(name, env, **changes):
    cls, keywords = SEARCHES[name]
    return cls("LinearPolicy", env, seed=3, **{**keywords, **changes})


@each
@pytest.mark.parametrize("lanes", [3, 8])
def test_the_best_weights_of_a_known_task_are_found_whatever_the_number_of_environments(name, lanes):
    model = made(name, DummyVecEnv([OneByOne] * lanes), first_weights=0.5)
    assert model.weights.tolist() == [0.5, 0.0, 0.0]
    model.learn(6000)
    assert model.policy.action_net[0].weight.detach().numpy()[0] == pytest.approx(TARGET, abs=0.03)


def test_a_search_that_ends_before_its_next_choice_chooses_after_its_last_generation():
    model = made("cma-es", DummyVecEnv([OneByOne] * 8), generations_between=1000)
    model.learn(3000)
    assert model.policy.action_net[0].weight.detach().numpy()[0] == pytest.approx(TARGET, abs=0.1)
    judged = 2 * 8 * 3  # the mean and a finalist, an episode of three steps in every environment
    assert 3000 <= model.num_timesteps - judged < 3000 + 8 * 3
    assert model.rounds == 1


class Recorded(VecEnvWrapper):
    """Keeps the actions and whether an episode has ended in each lane."""

    def __init__(self, venv):
        super().__init__(venv)
        self.actions, self.ended = [], []

    def reset(self):
        return self.venv.reset()

    def step_async(self, actions):
        self.actions.append(actions.copy())
        super().step_async(actions)

    def step_wait(self):
        result = self.venv.step_wait()
        self.ended.append(result[2])
        return result


def test_candidates_have_the_returns_of_their_policies_and_who_has_ended_is_kept_folded():
    lanes = 3
    venv = Recorded(FixedSeeds(NativeVecEnv(lanes, DEFAULT_ENV_ID, QUICK), 5))
    model = made("cma-es", venv)
    model._logger = configure(None, [])
    candidates = torch.zeros(lanes, model.n_params)
    candidates[:, 0] = torch.tensor([0.2, 0.9, 0.95])
    callback = model._init_callback(CallbackList([]))
    together = model.evaluate_candidates(candidates, callback, None).numpy()
    assert model.num_timesteps < lanes * len(venv.ended), "lanes that have ended are not counted"
    assert len(set(together)) == lanes
    over = np.cumsum(venv.ended, axis=0)[:-1] > 0
    assert np.all(np.array(venv.actions)[1:, :, 0][over] == -1.0)
    assert over.any()
    for lane in range(lanes):
        model._use(candidates[lane].numpy())
        single = FixedSeeds(NativeVecEnv(1, DEFAULT_ENV_ID, QUICK), 5 + lane)
        alone, _ = evaluate_policy(model, single, 1, warn=False)
        assert alone == pytest.approx(together[lane], rel=1e-5)
