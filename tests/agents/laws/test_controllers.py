"""Controllers of every kind are found by name, and a name that is none says so."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from trained import QUICK
from training import write_policy

from agents.comparison import evaluation
from agents.comparison.controllers import parse_controller
from agents.comparison.evaluation import episode_cell, evaluate
from agents.configs import CONFIGS
from agents.environments import make_env
from agents.laws.baselines import load_parameters
from agents.laws.servo import ServoParameters
from agents.laws.table import LAWS, TUNABLE
from agents.policies import shipped
from agents.policies.shipped import UNITS, Layer, ShippedPolicy
from agents.torque_laws import Signals
from solar_env.environment.registration import DEPLOY_V1


@pytest.fixture
def env():
    return make_env(DEPLOY_V1, {"model": "rigid-clearance"})


@pytest.fixture
def policy(env, tmp_path, monkeypatch):
    """A shipped policy that pulls with a third of the limit."""
    signals = Signals.of(env)
    described = {name: getattr(signals, name) for name in UNITS}
    keywords = {"model": "rigid-clearance", "observation": "drive"}
    described |= {"observation_names": signals.names, "env_kwargs": keywords, "training_steps": 12_000}
    layer = Layer(np.zeros((1, len(signals.names)), np.float32), np.full(1, -1.0 / 3.0, np.float32))
    description = write_policy(tmp_path / "third", layer, **described)
    monkeypatch.setattr(shipped, "SHIPPED", tmp_path)
    return description


def test_a_shipped_policy_is_a_controller_by_its_name(env, policy):
    observation, _ = env.reset(seed=0)
    third = parse_controller("third")
    assert third.load(env).predict(observation)[0] == pytest.approx([-1.0 / 3.0])
    assert third.training().env_kwargs == policy.env_kwargs
    assert third.interface() == {"observation": "drive"}
    assert [path.name for path in third.files()] == ["policy.npz", "policy.json"]


@pytest.mark.parametrize("name", LAWS)
def test_a_law_is_that_of_its_row_and_has_neither_files_nor_training_data(env, name):
    controller = parse_controller(name)
    assert (controller.name, controller.spec, controller.resolved) == (name, name, name)
    assert not controller.files()
    assert not controller.training()
    assert controller.interface() == {"observation": "drive", "action": "torque", "control_period": 0.1}
    law = controller.load(env)
    assert type(law) is LAWS[name]
    if name in TUNABLE:
        assert law.parameters == load_parameters(name, DEPLOY_V1, "rigid-clearance")
    elif name == "servo-untuned":
        assert law.parameters == ServoParameters()


def test_a_run_or_what_is_exported_of_it_is_not_used_where_its_actions_mean_something_else(finished):
    for folder in finished["ppo"]:
        with pytest.raises(ValueError, match=r"torque_limit is 0\.3; the policy was trained with 0\.5"):
            parse_controller(str(folder)).load(make_env(DEPLOY_V1, {**QUICK, "torque_limit": 0.3}))


def test_an_evaluation_goes_on_with_what_is_finished_but_not_with_a_policy_or_a_baseline_that_has_changed(
    policy, tmp_path, monkeypatch
):
    monkeypatch.setattr(evaluation, "CONFIGS", tmp_path)
    for name in TUNABLE:
        shutil.copy(CONFIGS / f"{name}.json", tmp_path)

    def motor_work(seed=0):
        evaluation._agents_digest.cache_clear()
        keywords, store = policy.env_kwargs, tmp_path / "store.jsonl"
        return evaluate(["third"], 1, seed, DEPLOY_V1, keywords, progress=False, store=store)[0]["motor_work_J"]

    first = motor_work()
    assert motor_work() == first
    third = shipped.load_shipped("third")
    (layer,) = third.network.layers
    stronger = replace(third.network, layers=(layer._replace(biases=2.0 * layer.biases),))
    shipped.write_policy(tmp_path / "third", ShippedPolicy(stronger, policy))
    assert motor_work() != first
    (tmp_path / "damper.json").write_text("{}")
    with pytest.raises(ValueError, match="was made by other code or with other settings"):
        motor_work(seed=1)


def test_a_shipped_policy_stays_itself_beside_a_folder_of_its_name(policy, tmp_path, monkeypatch):
    (tmp_path / "elsewhere" / "third").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert episode_cell(parse_controller("third"), policy.env_id, policy.env_kwargs, seed=0)["spec"] == "third"
    assert parse_controller("runs/one").resolved == str(tmp_path / "elsewhere" / "runs" / "one")
