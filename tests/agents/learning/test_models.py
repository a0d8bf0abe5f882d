"""Agents learn as their configuration says: at which rate, with which noise, and from which beginning."""

import numpy as np
import pytest
import torch
from stable_baselines3.common.logger import Logger
from training import last_model

from agents.comparison.suites import SUITES
from agents.learning import checkpoints, configurations, learn, runs
from solar_env.environment.registration import DEPLOY

pytestmark = pytest.mark.usefixtures("few_validation_episodes")


@pytest.mark.parametrize("algo", ["ppo", "sac", "td3"])
def test_agents_begin_with_a_constant_rate_that_arrives_and_act_at_their_own_period(algo):
    config = configurations.complete(algo, DEPLOY, {"model": "rigid-clearance"}, seed=0)
    venv = learn.make_training_env(config, threads=1)
    model = learn.make_model(config, venv)
    observed = dict(zip(venv.get_attr("observation_names", 0)[0], np.eye(16, dtype=np.float32), strict=True))
    expected = 0.85 if algo == "ppo" else np.tanh(1.25)  # the weight; the others squash it
    for approaching in ("far", "near"):
        assert model.predict(observed[approaching], deterministic=True)[0] == pytest.approx(expected)
    assert model.predict(observed["settling_rate_1"], deterministic=True)[0] == 0.0
    assert venv.get_attr("task", 0)[0].control_period == 0.5


@pytest.mark.parametrize(
    ("algo", "keywords", "hyperparameters", "fit"),
    [
        ("ppo", {}, {}, True),
        ("ppo", {"observation": "landing", "control_period": 0.1}, {}, True),
        ("cma-es", {"observation": ["landing", "start"]}, {"population": 8}, True),
        ("sac", {"observation": "drive"}, {}, False),
        ("ars", {"observation": ["near", "far"]}, {}, False),
        ("ars", {"action": "torque"}, {}, False),
        ("td3", {}, {"policy_kwargs": {"net_arch": [8]}}, False),
        ("sac", {}, {"policy_kwargs": {"net_arch": {"pi": [8], "qf": [8]}}}, False),
        ("cma-es", {}, {"first_weights": None}, False),
    ],
)
def test_the_first_weights_are_of_the_same_entries_of_a_linear_policy_or_of_none(algo, keywords, hyperparameters, fit):
    keywords = {"model": "rigid-clearance", **keywords}
    config = configurations.complete(algo, DEPLOY, keywords, 0, 8, hyperparameters=hyperparameters)
    assert ("first_weights" in config.hyperparameters) == fit
    venv = learn.make_training_env(config, threads=1)
    actions = learn.make_model(config, venv).predict(venv.reset(), deterministic=True)[0]
    if fit:
        assert actions == pytest.approx(0.84, abs=0.02), "the rate that arrives"
    elif algo in runs.SEARCHES:
        assert not actions.any()


def test_first_weights_that_are_asked_for_are_those_of_any_linear_policy():
    asked = {"first_weights": [0.5]}
    config = configurations.complete("ars", DEPLOY, {"observation": "drive"}, 0, 1, None, asked)
    assert config.hyperparameters["first_weights"] == [0.5]


def test_the_learning_rate_of_ppo_falls_from_update_to_update_and_none_is_without_effect():
    rollouts = {"n_steps": 50, "batch_size": 50, "learning_rate": 1e-3}
    quick = {"model": "rigid-ideal"}
    config = configurations.complete("ppo", DEPLOY, quick, 0, 2, 400, rollouts)
    model = learn.make_model(config, learn.make_training_env(config, threads=1))
    used = []
    update = model.train
    model.train = lambda: (update(), used.append(model.policy.optimizer.param_groups[0]["lr"]))
    model.learn(config.timesteps)
    assert used == pytest.approx([1e-3, 0.75e-3, 0.5e-3, 0.25e-3])


def test_the_noise_and_the_steps_of_ars_fall_to_nothing():
    config = configurations.complete("ars", DEPLOY, {"model": "rigid-ideal"}, 0, n_envs=1)
    venv = learn.make_training_env(config, threads=1)
    model = learn.make_model(config, venv)
    for left in (1.0, 0.5, 0.0):
        assert model.delta_std_schedule(left) == config.hyperparameters["delta_std"] * left
        assert model.lr_schedule(left) == config.hyperparameters["learning_rate"] * left


@pytest.mark.parametrize("algo", ["sac", "td3"])
def test_agents_with_a_replay_buffer_learn_from_returns_over_many_periods_and_ever_more_slowly(algo, tmp_path):
    small = {"batch_size": 32, "buffer_size": 2000, "learning_rate": 1e-3, "n_steps": 7}
    small |= {"train_freq": 20, "gradient_steps": 2}
    config = configurations.complete(algo, DEPLOY, {}, 0, 1, 40, small)
    learn.train(learn.Training(config, tmp_path, progress=False))
    resumed = checkpoints.read(tmp_path).restore(config, learn.make_training_env(config, threads=1))
    assert (resumed.replay_buffer.n_steps, resumed.replay_buffer.gamma) == (7, config.hyperparameters["gamma"])
    assert [resumed.lr_schedule(left) for left in (1.0, 0.5, 0.0)] == pytest.approx([1e-3, 0.5e-3, 0.0])


@pytest.mark.parametrize("algo", ["sac", "td3"])
def test_the_actor_learns_at_a_rate_of_its_own_in_a_resumed_run_too(algo, tmp_path):
    small = {"batch_size": 32, "buffer_size": 2000, "learning_starts": 0, "learning_rate": 1e-2}
    small |= {"train_freq": 100, "gradient_steps": 1, "actor_learning_rate": 1e-4}
    small |= {"policy_delay": 1} if algo == "td3" else {}
    made = DEPLOY, {"model": "rigid-ideal"}, 0, 1
    config = configurations.complete(algo, *made, 200, small)
    learn.train(learn.Training(config, tmp_path, progress=False))
    resumed = checkpoints.read(tmp_path).restore(config, learn.make_training_env(config, threads=1))
    networks = resumed.policy.actor.mu, resumed.policy.critic
    before = [[weights.clone() for weights in network.parameters()] for network in networks]
    resumed.lr_schedule = lambda left: 1e-2
    resumed.set_logger(Logger(None, []))
    resumed.train(1, 32)
    actor, critic = (
        max(float((new - old).detach().abs().max()) for new, old in zip(network.parameters(), weights, strict=True))
        for network, weights in zip(networks, before, strict=True)
    )
    assert 1e-5 < actor < 2e-4
    assert 1e-3 < critic < 2e-2


def test_one_rollout_trains_too(ppo_run):
    config = runs.stored_configuration(ppo_run)
    venv = learn.make_training_env(config, threads=1)
    fresh = learn.make_model(config, venv)
    trained = last_model(ppo_run)
    assert not torch.equal(fresh.policy.action_net.weight, trained.policy.action_net.weight)


def test_the_target_actor_of_a_fresh_td3_agent_is_its_actor():
    small = {"buffer_size": 100}
    config = configurations.complete("td3", DEPLOY, {}, 0, n_envs=1, hyperparameters=small)
    venv = learn.make_training_env(config, threads=1)
    policy = learn.make_model(config, venv).policy
    actor, target = (part.state_dict() for part in (policy.actor, policy.actor_target))
    assert all(torch.equal(actor[name], target[name]) for name in actor)


@pytest.mark.parametrize("algo", sorted(runs.ALGORITHMS))
def test_there_is_a_model_for_every_configuration_of_the_randomised_scenario(algo):
    config = configurations.complete(algo, SUITES["robust"], {"model": "rigid-clearance"}, seed=0)
    venv = learn.make_training_env(config, threads=1)
    model = learn.make_model(config, venv)
    assert np.isfinite(model.predict(venv.reset(), deterministic=True)[0]).all()
