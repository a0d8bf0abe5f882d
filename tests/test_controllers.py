"""Controllers of every kind are found by name, and a name that is none says so."""

import numpy as np
import pytest

from agents import shipped
from agents.baselines import BASELINES, make_baseline
from agents.controllers import SEARCH, effort, load_controller, observation_of, policy_files, resolved, trained_on
from agents.environments import make_env
from agents.episodes import episode_cell
from agents.shipped import Description, Layer, PolicyNetwork, ShippedPolicy
from agents.torque_laws import Signals


@pytest.fixture
def env():
    return make_env(env_kwargs={"model": "rigid-clearance"})


@pytest.fixture
def policy(env, tmp_path, monkeypatch):
    """A shipped policy that pulls with a third of the limit."""
    signals = Signals.of(env)
    features = Layer(np.eye(len(signals.names)), np.zeros(len(signals.names)))
    gates = Layer(np.zeros_like(features.weights), np.ones_like(features.biases))
    layer = Layer(np.zeros((1, len(signals.names)), np.float32), np.full(1, -1.0 / 3.0, np.float32))
    description = Description(
        algorithm="ppo",
        feature_limit=1.0,
        activation="tanh",
        output="clip",
        mean_limit=None,
        training_steps=12_000,
        env_id="solar_env/Deploy-v0",
        env_kwargs={"model": "rigid-clearance", "observation": "drive"},
        observation_names=signals.names,
        torque_limit=signals.torque_limit,
        deadline=signals.deadline,
        control_period=signals.control_period,
        postlock_window=signals.postlock_window,
        residual=None,
    )
    (tmp_path / "third").mkdir()
    network = PolicyNetwork((features, layer), gates, 1.0, "tanh", "clip")
    shipped.save(tmp_path / "third", ShippedPolicy(network, description))
    monkeypatch.setattr(shipped, "SHIPPED", tmp_path)
    return description


def test_a_trained_controller_observes_what_it_did_in_training_and_any_other_what_it_is_given(policy):
    assert observation_of("third") == {"observation": "drive"}
    assert observation_of("servo") == {}


def test_a_shipped_policy_is_a_controller_by_its_name(env, policy):
    observation, _ = env.reset(seed=0)
    assert load_controller("third", env).predict(observation)[0] == pytest.approx([-1.0 / 3.0])
    assert trained_on("third") == policy.env_kwargs
    assert effort("third", policy.env_id, "rigid-clearance") == "12,000 steps"
    assert [path.name for path in policy_files("third")] == ["policy.npz", "policy.json"]


def test_a_shipped_policy_is_not_used_where_its_actions_mean_something_else(policy):
    with pytest.raises(ValueError, match=r"torque_limit is 0\.3; the policy was trained with 0\.5"):
        load_controller("third", make_env(env_kwargs={"torque_limit": 0.3}))


@pytest.mark.parametrize("name", [*BASELINES, SEARCH])
def test_what_was_not_trained_has_neither_files_nor_training_data(name):
    assert policy_files(name) == []
    assert trained_on(name) is None


def test_a_baseline_is_the_one_of_its_name(env):
    observation, _ = env.reset(seed=0)
    assert load_controller("servo", env).predict(observation) == make_baseline("servo", env).predict(observation)


def test_a_name_of_nothing_says_what_there_is(env):
    with pytest.raises(FileNotFoundError, match="runs/nothing is not a run folder"):
        load_controller("runs/nothing", env)


def test_a_shipped_policy_stays_itself_beside_a_folder_of_its_name(policy, tmp_path, monkeypatch):
    (tmp_path / "elsewhere" / "third").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert episode_cell("third", policy.env_id, policy.env_kwargs, seed=0)["spec"] == "third"
    assert resolved("runs/one") == str(tmp_path / "elsewhere" / "runs" / "one")
