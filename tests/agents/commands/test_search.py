"""The search for hyperparameters stays within its ranges, keeps the best, and does not train twice."""

import json
import shutil
from dataclasses import asdict

import numpy as np
import pytest
from stable_baselines3.common.utils import set_random_seed
from training import write_history

from agents.commands import search
from agents.comparison.suites import SUITES
from agents.environments import DEFAULT_ENV_ID
from agents.laws.baselines import CONFIGS
from agents.learning import configurations, learn, runs
from solar_env.__main__ import execute


@pytest.mark.parametrize("env_id", SUITES.values(), ids=SUITES)
@pytest.mark.parametrize("algo", search.SPACES)
def test_the_point_of_a_configuration_gives_that_configuration_back(algo, env_id):
    entry = configurations.entry(algo, env_id)
    point = search.point(search.start(algo, env_id), algo)
    config = search.trial(search.Args(algo=algo, env_id=env_id), {}, point)
    found, expected = dict(config.hyperparameters), dict(entry["hyperparameters"])
    inner, outer = found.pop("policy_kwargs"), expected.pop("policy_kwargs")
    assert inner["net_arch"] == outer["net_arch"]
    assert inner.get("log_std_init") == pytest.approx(outer.get("log_std_init"), abs=0.02)
    assert {k: v for k, v in found.items() if k not in search.SPACES[algo]} == {
        k: v for k, v in expected.items() if k not in search.SPACES[algo]
    }
    for name in set(expected) & set(search.SPACES[algo]):
        assert found[name] == pytest.approx(expected[name], rel=1e-2)


@pytest.mark.parametrize("algo", search.SPACES)
def test_points_stay_within_the_ranges(algo):
    for name, r in search.SPACES[algo].items():
        values = [r.value(unit) for unit in np.linspace(0.0, 1.0, 11)]
        assert (values[0], values[-1]) == (r.low, r.high), name
        assert values == sorted(values)
        assert [r.value(r.share(value)) for value in values] == values


@pytest.fixture
def written(tmp_path, monkeypatch):
    """A copy of the configurations, which searches read and write."""
    folder = tmp_path / "configs"
    shutil.copytree(CONFIGS, folder)
    for module in (configurations, search):
        monkeypatch.setattr(module, "CONFIGS", folder)
    return folder


def train_best_at(monkeypatch, name, best):
    """Replace training by one whose return is highest at a value of a hyperparameter; returns what gets trained."""
    trained = []

    def pretend(training):
        set_random_seed(0)  # as every training does
        trained.append(training.folder.name)
        value = -abs(np.log(training.config.hyperparameters[name] / best))
        write_history(training.folder, [[value - 1.0], [value]])
        runs.write_config(training.folder, asdict(training.config))
        runs.write_json(training.folder / runs.TIMING, {})

    monkeypatch.setattr(learn, "train", pretend)
    monkeypatch.setattr(runs, "check_policy", lambda folder: None)  # there is none
    return trained


@pytest.mark.parametrize(
    ("algo", "name"), [("ppo", "learning_rate"), ("sac", "learning_rate"), ("td3", "exploration_noise")]
)
def test_a_search_finds_what_trains_best_and_writes_it_where_it_belongs(tmp_path, monkeypatch, written, algo, name):
    before = configurations.entry(algo, DEFAULT_ENV_ID)
    start = search.start(algo, DEFAULT_ENV_ID)
    best = 0.67 * start[name]
    train_best_at(monkeypatch, name, best)
    options = ["--algo", algo, "--trials", "24", "--out", str(tmp_path / "search"), "--jobs", "1", "--quiet"]
    execute("search", options)
    after, found = configurations.entry(algo, DEFAULT_ENV_ID), search.start(algo, DEFAULT_ENV_ID)
    record = after["search"]
    assert abs(np.log(found[name] / best)) < 0.2
    assert record["start"] == start
    assert record["validation_return"] == pytest.approx(-abs(np.log(found[name] / best)))
    assert record["validation_return_before"] == pytest.approx(np.log(0.67))
    kept = ("hyperparameters", "search")
    assert {k: v for k, v in after.items() if k not in kept} == {k: v for k, v in before.items() if k not in kept}


def test_no_trial_is_trained_twice_and_a_search_that_is_repeated_gives_the_same(tmp_path, monkeypatch, written):
    trained = train_best_at(monkeypatch, "learning_rate", 0.002)
    options = ["--trials", "24", "--out", str(tmp_path / "search"), "--jobs", "1", "--quiet"]
    execute("search", options)
    found = configurations.entry("ppo", DEFAULT_ENV_ID)
    assert len(trained) == found["search"]["trials"] == 22
    shutil.rmtree(tmp_path / "search" / "trial-20")
    execute("search", [*options, "--repeat"])
    assert trained[22:] == ["trial-20"], "what is missing is trained, the rest is not"
    repeated = configurations.entry("ppo", DEFAULT_ENV_ID)
    assert repeated["search"].pop("command") == found["search"].pop("command") + " --repeat"
    assert repeated == found
    with pytest.raises(ValueError, match="holds a run with another configuration"):
        execute("search", options)  # goes on from what was found


def test_there_must_be_a_search_to_repeat(written):
    entries = json.loads((written / "sac.json").read_text())
    entries[DEFAULT_ENV_ID].pop("search", None)
    (written / "sac.json").write_text(json.dumps(entries))
    with pytest.raises(ValueError, match=rf"sac\.json records no such search for '{DEFAULT_ENV_ID}'"):
        execute("search", ["--algo", "sac", "--repeat", "--out", str(written / "search")])
    assert not (written / "search").exists(), "a refusal leaves no folder"


def test_what_cannot_be_searched_is_refused():
    with pytest.raises(ValueError, match="nothing to search for 'dqn'; choose from ppo, sac, td3"):
        execute("search", ["--algo", "dqn"])


def test_a_run_is_scored_by_the_last_third_of_its_validations(tmp_path):
    write_history(tmp_path, -np.repeat([9.0, 1.0, 7.0, 4.0, 3.0], 2).reshape(5, 2))
    assert search.score(tmp_path) == -3.5
