"""Comparisons: the same episodes for every controller, and tables that say what was measured."""

import csv
import json
from dataclasses import asdict

import numpy as np
import pytest
from helpers import numbers
from PIL import Image
from training import write_run

from agents.comparison import evaluation
from agents.comparison.controllers import parse_controller, parse_controllers
from agents.comparison.evaluation import common_environment, evaluate
from agents.comparison.report import reference, summarize, tabulate
from agents.environments import DEFAULT_ENV_ID, OF_LAWS, episode_seeds, make_env, with_sampling
from agents.laws.baselines import make_baseline
from agents.learning import runs
from agents.rollout import run_episode
from solar_env.__main__ import execute
from solar_env.environment.registration import DEPLOY_RANDOMISED
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.errors import SimulationError
from solar_env.support.values import plain

ALONE = ["--quiet", "--jobs", "1"]


@pytest.fixture(scope="module")
def rows():
    return evaluate(["passive", "again=passive", "servo-untuned"], episodes=3, seed=5, progress=False)


def column(rows, controller, figure):
    return [row[figure] for row in rows if row["controller"] == controller]


def test_the_same_seeds_give_the_same_episodes_for_every_controller(rows):
    seeds = episode_seeds("evaluation", 5, 3)
    env = make_env(DEFAULT_ENV_ID, with_sampling(OF_LAWS))
    for controller, law in (("passive", "passive"), ("again", "passive"), ("servo-untuned", "servo-untuned")):
        assert column(rows, controller, "seed") == seeds
        alone = [run_episode(env, make_baseline(law, env), seed)["return"] for seed in seeds]
        assert column(rows, controller, "return") == alone
    assert len(set(column(rows, "passive", "peak_postlock_force_N"))) == 3


def test_an_episode_that_fails_is_named_and_left_out_for_all_and_many_are_refused(monkeypatch):
    def fails(env, controller, seed):
        if seed in failing:
            raise SimulationError("at t = 1 s the state is no longer finite", 1.0, "not_finite")
        return {"seed": seed, "return": 0.0}

    monkeypatch.setattr(evaluation, "run_episode", fails)
    seeds = episode_seeds("evaluation", 0, 12)
    failing = seeds[3:4]
    with pytest.warns(SimulationWarning, match=rf"2 of 24 runs failed .*passive, episode 3, seed {seeds[3]}: at t = 1"):
        rows = evaluate(["passive", "again=passive"], 12, 0, progress=False)
    assert [row["episode"] for row in rows] == [k for k in range(12) if k != 3] * 2
    failing = seeds[3:6]
    with pytest.raises(ValueError, match="6 of 24 runs failed, more than the 10% that may be left out"):
        evaluate(["passive", "again=passive"], 12, 0, progress=False)


def test_controllers_are_compared_with_the_best_law(rows):
    assert reference(rows) == "servo-untuned"
    learned = [
        {**row, "controller": "learned", "spec": "runs/learned", "return": row["return"] + 0.1}
        for row in rows
        if row["controller"] == "servo-untuned"
    ]
    assert reference([*rows, *learned]) == "servo-untuned", "the best of those that do not learn"
    entry = summarize([*rows, *learned])["learned"]
    assert entry["above"].mean == pytest.approx(0.1)
    assert entry["better"].mean == 1.0
    assert "return above servo-untuned" in tabulate([*rows, *learned])


def test_the_command_writes_what_it_prints(tmp_path, capsys):
    words = ["--controllers", "passive", "damper", "--episodes", "2", *ALONE]
    execute("evaluate", [*words, "--out", str(tmp_path)])
    text = (tmp_path / "comparison.md").read_text()
    assert numbers(text) <= numbers(capsys.readouterr().out)
    with Image.open(tmp_path / "comparison.png") as figure:
        assert min(figure.size) > 100
    with (tmp_path / "episodes.csv").open() as file:
        written = list(csv.DictReader(file))
    assert [row["controller"] for row in written] == ["passive", "passive", "damper", "damper"]
    metrics = json.loads((tmp_path / "metrics.json").read_text())
    assert plain(metrics["settings"]["env_kwargs"]["randomize"]["initial_rate"]) == ((-5e-4, -5e-4), (5e-4, 5e-4))
    forces = [float(row["peak_postlock_force_N"]) for row in written if row["controller"] == "passive"]
    summary = metrics["controllers"]["passive"]["peak_postlock_force_N"]
    assert summary["mean"] == pytest.approx(np.mean(forces))
    assert summary["maximum"] == max(forces)


QUICK = ["deadline=0.5", "settling_window=0.5"]


def evaluated_on(folder, *arguments):
    """The environment keywords that the command records."""
    execute("evaluate", [*arguments, "--episodes", "1", *ALONE, "--out", str(folder)])
    return json.loads((folder / "metrics.json").read_text())["settings"]["env_kwargs"]


@pytest.mark.parametrize("model", ["rigid-ideal", "flexible-clearance:1 element"])
def test_the_command_compares_on_the_model_asked_for(tmp_path, model):
    options = ["--controllers", "passive", "--model", model, "--env-kwargs", *QUICK]
    used = evaluated_on(tmp_path, *options)
    assert (used["model"], used["deadline"]) == (model, 0.5)


def test_a_scenario_as_a_keyword_is_refused_since_nothing_is_tuned_by_it(tmp_path):
    with pytest.raises(ValueError, match=r"choose --env-id, one of .*DeployRandomised-v1"):
        evaluated_on(tmp_path, "--controllers", "servo", "--env-kwargs", "scenario=randomised")


def test_the_model_of_run_folders_holds_unless_another_is_asked_for(tmp_path):
    for name, model in (("a", "flexible-ideal:1 element"), ("b", "flexible-clearance:1 element")):
        write_run(tmp_path / name, env_kwargs={"model": model, "deadline": 0.5})
    first, second = str(tmp_path / "a"), str(tmp_path / "b")
    assert common_environment([first])[1]["model"] == "flexible-ideal:1 element"
    with pytest.raises(ValueError, match="say with --env-kwargs"):
        common_environment([first, second])
    assert common_environment([first, second], given=["model"])[1] == {"deadline": 0.5}


def test_an_array_is_the_one_asked_for_whatever_a_run_was_trained_on(tmp_path):
    """Draws about the usual rates of release in training become draws about the rates asked for."""
    write_run(tmp_path, env_kwargs=with_sampling({"model": "rigid-ideal"}))
    kept = common_environment([str(tmp_path)], given=["parameters"])[1]
    assert kept == {"model": "rigid-ideal"}
    low, high = with_sampling({**kept, "parameters": {"initial_rate": 0.01}})["randomize"]["initial_rate"]
    assert (np.array(low) + high) / 2 == pytest.approx([0.01, 0.01])


def test_what_was_drawn_in_training_does_not_replace_the_draws_of_another_scenario(tmp_path):
    drawn = {"model": "rigid-ideal", "randomize": {"hinge_x": [0.499, 0.501]}}
    write_run(tmp_path, env_kwargs=drawn)
    assert common_environment([str(tmp_path)]) == (DEFAULT_ENV_ID, runs.jsonable(drawn))
    assert common_environment([str(tmp_path)], DEPLOY_RANDOMISED)[1] == {"model": "rigid-ideal"}


@pytest.mark.parametrize(
    ("controllers", "message"),
    [
        (["passive", "servo", "servo"], "servo is given 2 times; its episodes would count as many times"),
        (["a=ppo/seed-0", "a=ppo/seed-0"], "a is given 2 times"),
        (["a=ppo/seed-0", "a=ppo/seed-0/"], "a is given 2 times"),
        (["ppo/seed-0", "sac/seed-0"], "are both called seed-0; name them"),
        (["servo", "servo=ppo/seed-0"], "are both called servo; name them"),
    ],
)
def test_nothing_counts_twice_and_nothing_is_taken_for_a_seed_of_a_baseline(controllers, message):
    with pytest.raises(ValueError, match=message):
        parse_controllers(controllers)
    parse_controllers(["passive", "agent=ppo/seed-0", "agent=sac/seed-0"])


def test_trained_controllers_are_compared_on_the_scenario_they_were_trained_on(tmp_path):
    for name, env_id in (("a", DEPLOY_RANDOMISED), ("b", DEFAULT_ENV_ID)):
        write_run(tmp_path / name, env_id=env_id)
    first, second = str(tmp_path / "a"), str(tmp_path / "b")
    assert common_environment(["passive", f"agent={first}"])[0] == DEPLOY_RANDOMISED
    assert common_environment(["passive"]) == (DEFAULT_ENV_ID, {})
    with pytest.raises(ValueError, match=r"trained on different environments, .*; say with --env-id which"):
        common_environment([first, second])


def named(text):
    controller = parse_controller(text)
    return controller.name, controller.spec


def test_a_controller_may_be_given_a_name_and_a_folder_is_one_whatever_signs_are_in_its_name(tmp_path, monkeypatch):
    assert named("ppo=runs/a") == ("ppo", "runs/a")
    assert named("runs/a") == ("a", "runs/a")
    (tmp_path / "lr=0.1").mkdir()
    monkeypatch.chdir(tmp_path)
    assert named("lr=0.1") == ("lr=0.1", "lr=0.1")
    assert named("ppo=lr=0.1") == ("ppo", "lr=0.1")
    assert named(".") == (tmp_path.name, ".")
    (tmp_path / "best").symlink_to("lr=0.1")
    assert named("best") == ("best", "best")


def test_something_that_is_neither_baseline_nor_run_is_refused(tmp_path):
    with pytest.raises(
        FileNotFoundError,
        match=r"it is no run folder of train\.py, .* and none of passive, .*",
    ):
        evaluate([str(tmp_path)], episodes=1, seed=0, progress=False)


def test_a_run_without_policy_says_so(tmp_path):
    config = runs.Configuration("ppo", DEFAULT_ENV_ID, {}, 0, 1, 9, {})
    runs.write_json(tmp_path / runs.CONFIG, asdict(config))
    with pytest.raises(FileNotFoundError, match="has no policy; the run ended before its first validation"):
        evaluate([str(tmp_path)], episodes=1, seed=0, progress=False)


@pytest.mark.parametrize(
    ("keywords", "fit"),
    [
        ({}, ["passive", "pd", "servo"]),
        ({"parameters": {"panel_count": 1}}, ["passive", "pd"]),
        ({"driven_joint": (0, 1)}, ["passive"]),
    ],
)
def test_laws_fit_what_shows_them_what_they_read_and_the_springs_alone_fit_any_number_of_motors(keywords, fit):
    keywords = {"model": "rigid-ideal", **keywords}
    assert evaluation.fitting(["passive", "pd", "servo"], DEFAULT_ENV_ID, keywords) == fit
    env = make_env(DEFAULT_ENV_ID, {**keywords, **OF_LAWS})
    action, _ = make_baseline("passive", env).predict(env.reset(seed=0)[0])
    assert action.shape == env.action_space.shape
    assert not action.any()
