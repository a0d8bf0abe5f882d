"""Searches over weights find the best ones of a task with a known answer, and judge candidates by whole episodes."""

import gymnasium
import numpy as np
import pytest
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback, CallbackList
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.logger import configure
from stable_baselines3.common.vec_env import DummyVecEnv, VecEnvWrapper

from agents.learning.weight_search import CMAES
from solar_env.environment.registration import DEPLOY
from solar_env.environment.stable_baselines3 import NativeVecEnv

TARGET = np.array([0.6, -0.3, 0.2])
QUICK = {"model": "rigid-ideal"}


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


def made(env, **changes):
    return CMAES("MlpPolicy", env, seed=3, population=8, **changes)


@pytest.mark.parametrize("lanes", [3, 8])
def test_the_best_weights_of_a_known_task_are_found_whatever_the_number_of_environments(lanes):
    model = made(DummyVecEnv([OneByOne] * lanes))
    model.learn(9000)
    actions = model.predict(np.eye(3, dtype=np.float32), deterministic=True)[0][:, 0]
    assert actions == pytest.approx(TARGET, abs=0.03)


def test_a_search_that_ends_before_its_next_choice_chooses_after_its_last_generation():
    model = made(DummyVecEnv([OneByOne] * 8))
    model.learn(200)
    judged = 3 * 8 * 3  # the mean and two finalists, an episode of three steps in every environment
    assert 200 <= model.num_timesteps - judged < 200 + 8 * 3
    assert np.any(model.weights.numpy())


def test_a_search_around_a_trained_policy_changes_its_last_layer_alone_and_begins_with_its_actions(tmp_path):
    shown = np.eye(3, dtype=np.float32)
    trained = PPO("MlpPolicy", DummyVecEnv([OneByOne]), seed=1, device="cpu")
    trained.save(tmp_path / "model.zip")
    model = made(DummyVecEnv([OneByOne] * 8), start=str(tmp_path / "model.zip"), deviation=0.1)
    np.testing.assert_allclose(model.predict(shown)[0], trained.predict(shown, deterministic=True)[0], atol=1e-6)
    before = [value.clone() for value in model.policy.parameters()]
    model.learn(9000)
    changed = [not torch.equal(*pair) for pair in zip(before, model.policy.parameters(), strict=True)]
    assert changed == [False, False, False, False, True, True]
    assert model.predict(shown, deterministic=True)[0][:, 0] == pytest.approx(TARGET, abs=0.05)
    with pytest.raises(ValueError, match="start has 4481 weights, a policy of this environment 4801"):
        made(NativeVecEnv(1, DEPLOY, QUICK), start=str(tmp_path / "model.zip"))


class Validated(BaseCallback):
    """Keeps the policy's weights at every step."""

    def _on_step(self):
        self.weights = [*getattr(self, "weights", []), self.model.policy.parameters_to_vector()]
        return True


def test_callbacks_see_the_policy_and_no_candidate():
    validated = Validated()
    made(DummyVecEnv([OneByOne] * 8)).learn(200, validated)
    assert len(np.unique(validated.weights, axis=0)) <= 1 + 3, "the first, and those that had a round"


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


def test_candidates_have_the_returns_of_their_policies_and_who_has_ended_is_not_counted():
    lanes = 3
    venv = Recorded(NativeVecEnv(lanes, DEPLOY, QUICK))
    model = made(venv)
    model._logger = configure(None, [])
    model._begin()
    candidates = np.zeros((lanes, model.n_params))
    candidates[:, -1] = [-0.3, 0.0, 0.2]  # the bias
    tries = [(candidate, 5 + lane) for lane, candidate in enumerate(candidates)]
    together = model._returns(tries, model._init_callback(CallbackList([])))
    assert model.num_timesteps < lanes * len(venv.ended), "lanes that have ended are not counted"
    assert len(set(together)) == lanes
    for lane in range(lanes):
        model.policy.load_from_vector(candidates[lane])
        single = NativeVecEnv(1, DEPLOY, QUICK, 5 + lane)
        alone, _ = evaluate_policy(model, single, 1, warn=False)
        assert alone == pytest.approx(together[lane], rel=1e-5)
