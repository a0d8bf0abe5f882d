"""Controllers of every kind are found by name, and a name that is none says so."""

import pytest
from training import write_run

from agents.comparison.controllers import parse_controller
from agents.comparison.evaluation import episode_cell, evaluate
from agents.environments import make_env
from agents.laws.baselines import load_parameters
from agents.laws.servo import ServoParameters
from agents.laws.table import LAWS, TUNABLE
from agents.learning import runs
from solar_env.environment.registration import DEPLOY, DEPLOY_V1


@pytest.fixture
def env():
    return make_env(DEPLOY_V1, {"model": "rigid-clearance"})


@pytest.fixture
def policy(tmp_path, monkeypatch):
    """A policy of the package whose action is always minus a third."""
    monkeypatch.setattr(runs, "SHIPPED", tmp_path)
    return write_run(tmp_path / "third", bias=-1.0 / 3.0, env_kwargs={"model": "rigid-clearance"})


def test_a_policy_of_the_package_is_a_controller_by_its_name(policy):
    env = make_env(DEPLOY, {"model": "rigid-clearance"})
    observation, _ = env.reset(seed=0)
    third = parse_controller("third")
    assert third.load(env).predict(observation)[0] == pytest.approx([-1.0 / 3.0])
    assert third.training() == policy
    assert third.interface() == {}
    assert [path.name for path in third.files()] == ["config.json", "best_model.zip"]


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


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"deadline": 15.0}, r"deadline is 15\.0; the policy was trained with 20\.0"),
        ({"control_period": 0.1}, r"control_period is 0\.1; the policy was trained with 0\.5"),
        ({"settling_window": 5.0}, r"settling_window is 5\.0; the policy was trained with 10\.0"),
        ({"observation": "history"}, r"names is .*theta_1_1_ago"),
        ({"action": "torque"}, "action is torque; the policy was trained with log_rate"),
    ],
)
def test_a_run_is_not_used_where_its_actions_or_observations_mean_something_else(policy, keywords, message):
    with pytest.raises(ValueError, match=message):
        parse_controller("third").load(make_env(DEPLOY, {"model": "rigid-clearance", **keywords}))


def test_a_policy_that_has_changed_is_read_again(policy, tmp_path):
    def motor_work():
        return evaluate(["third"], 1, 0, DEPLOY, policy.env_kwargs, progress=False)[0]["motor_work_J"]

    first = motor_work()
    assert motor_work() == first
    write_run(tmp_path / "third", bias=-0.2, env_kwargs=policy.env_kwargs)
    assert motor_work() != first


def test_a_policy_of_the_package_stays_itself_beside_a_folder_of_its_name(policy, tmp_path, monkeypatch):
    (tmp_path / "elsewhere" / "third").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert episode_cell(parse_controller("third"), policy.env_id, policy.env_kwargs, seed=0)["spec"] == "third"
    assert parse_controller("runs/one").resolved == str(tmp_path / "elsewhere" / "runs" / "one")
