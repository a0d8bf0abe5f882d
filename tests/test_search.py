"""The search for hyperparameters stays within its ranges, keeps the best, and does not train twice."""

import json
import shutil

import numpy as np
import pytest
from stable_baselines3.common.utils import set_random_seed

from agents import configurations, learn, search
from agents.baselines import CONFIGS
from agents.environments import DEFAULT_ENV_ID


@pytest.mark.parametrize("whole", [False, True], ids=["added", "whole"])
@pytest.mark.parametrize("algo", search.SPACES)
def test_the_point_of_a_configuration_gives_that_configuration_back(algo, whole):
    entry = configurations.entry(algo, DEFAULT_ENV_ID, whole)
    config = search.trial(search.Args(algo=algo, whole=whole), {}, search.start(algo, DEFAULT_ENV_ID, whole))
    scale = config.residual["scale"] if config.residual else 0.0
    assert scale == pytest.approx(0.0 if whole else entry["residual"], rel=1e-2)
    found, expected = dict(config.hyperparameters), dict(entry["hyperparameters"])
    inner, outer = found.pop("policy_kwargs"), expected.pop("policy_kwargs")
    assert inner["net_arch"] == outer["net_arch"]
    assert inner.get("log_std_init") == pytest.approx(outer.get("log_std_init"), abs=0.02)
    assert {k: v for k, v in found.items() if k not in search.SPACES[algo]} == {
        k: v for k, v in expected.items() if k not in search.SPACES[algo]
    }
    for name in set(expected) & set(search.SPACES[algo]):
        assert found[name] == pytest.approx(expected[name], rel=1e-2)


@pytest.mark.parametrize("whole", [False, True], ids=["added", "whole"])
@pytest.mark.parametrize("algo", search.SPACES)
def test_points_stay_within_the_ranges(algo, whole):
    for name, r in search.space(algo, whole).items():
        values = [r.value(unit) for unit in np.linspace(0.0, 1.0, 11)]
        assert (values[0], values[-1]) == (r.low, r.high), name
        assert values == sorted(values)
        assert [r.value(r.share(value)) for value in values] == values


def test_the_best_trial_is_kept_and_none_is_trained_twice(tmp_path, monkeypatch):
    """The training is replaced by one whose return is highest at a residual of 0.1."""
    (tmp_path / "ppo.json").write_text((CONFIGS / "ppo.json").read_text())
    monkeypatch.setattr(search, "CONFIGS", tmp_path)
    trained = []

    def pretend(wanted, command, device, workers, progress):
        for folder, config in wanted.items():
            if not folder.exists():
                set_random_seed(0)  # as every training does
                trained.append(folder)
                folder.mkdir(parents=True)
                value = -abs(np.log(config.residual["scale"] / 0.1))
                np.savez(folder / "evaluations.npz", results=np.array([[value - 1.0], [value]]))

    monkeypatch.setattr(learn, "train_missing", pretend)
    options = ["--trials", "24", "--out", str(tmp_path / "search"), "--quiet"]
    search.main(options)
    entry = json.loads((tmp_path / "ppo.json").read_text())[DEFAULT_ENV_ID]
    assert entry["residual"] == pytest.approx(0.1, rel=0.3)
    assert entry["search"]["validation_return"] >= entry["search"]["validation_return_before"]
    assert entry["search"]["trials"] == len(trained) <= 25
    count = len(trained)
    (tmp_path / "ppo.json").write_text((CONFIGS / "ppo.json").read_text())
    shutil.rmtree(trained[-1])
    search.main(options)
    assert trained[count:] == trained[count - 1 : count], "what is missing is trained, the rest is not"
    assert json.loads((tmp_path / "ppo.json").read_text())[DEFAULT_ENV_ID] == entry


def test_agents_of_the_whole_torque_are_searched_on_rigid_panels_and_kept_apart(tmp_path, monkeypatch):
    """The training is replaced by one whose return is highest at a learning rate of 0.001."""
    (tmp_path / "sac.json").write_text((CONFIGS / "sac.json").read_text())
    before = configurations.entry("sac", DEFAULT_ENV_ID)
    monkeypatch.setattr(search, "CONFIGS", tmp_path)

    def pretend(wanted, command, device, workers, progress):
        for folder, config in wanted.items():
            assert config.residual is None
            assert config.env_kwargs["model"] == "rigid-clearance"
            folder.mkdir(parents=True, exist_ok=True)
            value = -abs(np.log(config.hyperparameters["learning_rate"] / 0.001))
            np.savez(folder / "evaluations.npz", results=np.array([[value]]))

    monkeypatch.setattr(learn, "train_missing", pretend)
    search.main(["--algo", "sac", "--whole", "--trials", "24", "--out", str(tmp_path / "search"), "--quiet"])
    after = json.loads((tmp_path / "sac.json").read_text())[DEFAULT_ENV_ID]
    found = after.pop("whole_torque")
    assert abs(np.log(found["hyperparameters"]["learning_rate"] / 0.001)) < 1.0
    assert found["search"]["validation_return"] > -1.0
    assert found["timesteps"] == before.pop("whole_torque")["timesteps"]
    assert after == before


def test_what_cannot_be_searched_is_refused():
    with pytest.raises(ValueError, match="nothing to search for 'dqn'; choose from ppo, sac, td3"):
        search.main(["--algo", "dqn"])


def test_a_run_is_scored_by_the_last_third_of_its_validations(tmp_path):
    np.savez(tmp_path / "evaluations.npz", results=-np.repeat([9.0, 1.0, 7.0, 4.0, 3.0], 2).reshape(5, 2))
    assert search.score(tmp_path) == -3.5
