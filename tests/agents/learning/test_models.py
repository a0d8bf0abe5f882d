"""Agents learn as their configuration says: at which rate, with which noise, and from which beginning."""

import numpy as np
import pytest
from stable_baselines3.common.logger import Logger
from training import last_model

from agents.comparison.evaluation import SUITES
from agents.learning import learn, runs
from solar_env.environment.registration import DEPLOY_V1

pytestmark = pytest.mark.usefixtures("few_validation_episodes")


@pytest.mark.parametrize("algo", ["ppo", "sac", "td3"])
def test_agents_begin_with_a_constant_rate_that_arrives_and_act_at_their_own_period(algo):
    config = runs.complete(algo, DEPLOY_V1, {"model": "rigid-clearance"}, seed=0)
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
        ("sac", {}, {"policy_kwargs": {"net_arch": {"pi": [8], "qf": [8]}}}, False),
    ],
)
def test_the_first_weights_are_of_the_same_entries_of_a_linear_policy_or_of_none(algo, keywords, hyperparameters, fit):
    keywords = {"model": "rigid-clearance", **keywords}
    config = runs.complete(algo, DEPLOY_V1, keywords, 0, 8, hyperparameters=hyperparameters)
    assert ("first_weights" in config.hyperparameters) == fit
    venv = learn.make_training_env(config, threads=1)
    actions = learn.make_model(config, venv).predict(venv.reset(), deterministic=True)[0]
    if fit:
        assert actions == pytest.approx(0.84, abs=0.02), "the rate that arrives"
    elif algo in runs.SEARCHES:
        assert not actions.any()


def test_the_learning_rate_of_ppo_falls_from_update_to_update_and_none_is_without_effect():
    rollouts = {"n_steps": 50, "batch_size": 50, "learning_rate": 1e-3}
    quick = {"model": "rigid-ideal"}
    config = runs.complete("ppo", DEPLOY_V1, quick, 0, 2, 400, rollouts)
    model = learn.make_model(config, learn.make_training_env(config, threads=1))
    used = []
    update = model.train
    model.train = lambda: (update(), used.append(model.policy.optimizer.param_groups[0]["lr"]))
    model.learn(config.timesteps)
    assert used == pytest.approx([1e-3, 0.75e-3, 0.5e-3, 0.25e-3])


def test_the_noise_and_the_steps_of_ars_fall_to_nothing():
    config = runs.complete("ars", DEPLOY_V1, {"model": "rigid-ideal"}, 0, n_envs=1)
    venv = learn.make_training_env(config, threads=1)
    model = learn.make_model(config, venv)
    for left in (1.0, 0.5, 0.0):
        assert model.delta_std_schedule(left) == config.hyperparameters["delta_std"] * left
        assert model.lr_schedule(left) == config.hyperparameters["learning_rate"] * left


def test_agents_with_a_replay_buffer_learn_from_returns_over_many_periods_and_ever_more_slowly(tmp_path):
    small = {"batch_size": 32, "buffer_size": 2000, "learning_rate": 1e-3, "n_steps": 7}
    small |= {"train_freq": 20, "gradient_steps": 2}
    config = runs.complete("sac", DEPLOY_V1, {}, 0, 1, 40, small)
    learn.train(learn.Training(config, tmp_path, progress=False))
    resumed = last_model(tmp_path)
    assert (resumed.replay_buffer.n_steps, resumed.replay_buffer.gamma) == (7, config.hyperparameters["gamma"])
    assert [resumed.lr_schedule(left) for left in (1.0, 0.5, 0.0)] == pytest.approx([1e-3, 0.5e-3, 0.0])


def test_the_actor_learns_at_a_rate_of_its_own_in_a_resumed_run_too(tmp_path):
    small = {"batch_size": 32, "buffer_size": 2000, "learning_starts": 0, "learning_rate": 1e-2}
    small |= {"train_freq": 100, "gradient_steps": 1, "actor_learning_rate": 1e-4}
    small |= {"policy_delay": 1}
    made = DEPLOY_V1, {"model": "rigid-ideal"}, 0, 1
    config = runs.complete("td3", *made, 200, small)
    learn.train(learn.Training(config, tmp_path, progress=False))
    resumed = last_model(tmp_path)
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


@pytest.mark.parametrize("algo", sorted(runs.ALGORITHMS))
def test_there_is_a_model_for_every_configuration_of_the_randomised_scenario(algo):
    config = runs.complete(algo, SUITES["robust"], {"model": "rigid-clearance"}, seed=0)
    venv = learn.make_training_env(config, threads=1)
    model = learn.make_model(config, venv)
    assert np.isfinite(model.predict(venv.reset(), deterministic=True)[0]).all()
