"""Learning curves are those of the runs, a run for every agent, scenario and seed, and nothing is trained twice."""

import csv
import itertools

import numpy as np
import pytest
from training import write_history

from agents.commands import curves
from agents.environments import DEFAULT_ENV_ID
from agents.learning import configurations, learn
from solar_env.__main__ import execute

QUICK = [
    *["--algos", "ppo", "--seeds", "3", "7", "--timesteps", "20", "--jobs", "1", "--quiet"],
    *["--model", "rigid-clearance"],
    *["--hyperparams", "n_steps=10", "batch_size=10", "--env-kwargs", "postlock_window=0.2", "control_period=0.1"],
]


def test_every_agent_has_a_curve_of_every_seed_in_every_scenario(tmp_path, monkeypatch):
    monkeypatch.setattr(learn, "VALIDATION_EPISODES", 2)
    options = [*QUICK, "--out", str(tmp_path)]
    execute("curves", options)
    with (tmp_path / curves.TABLE).open() as file:
        rows = list(csv.DictReader(file))
    scenarios = {"paper": "nominal", "robust": "randomised"}
    laws = {(row["task"], row["controller"]): float(row["validation return"]) for row in rows if not row["seed"]}
    rows = [row for row in rows if row["seed"]]
    for scenario in scenarios.values():
        assert laws[f"{scenario}, rigid-clearance", "servo"] > laws[f"{scenario}, rigid-clearance", "damper"]
    found = {(row["task"], row["controller"], row["seed"]) for row in rows}
    assert found == {(f"{scenario}, rigid-clearance", "ppo", seed) for scenario in scenarios.values() for seed in "37"}
    for suite, seed in itertools.product(scenarios, "37"):
        run = f"{suite}-ppo-{seed}"
        mine = [row for row in rows if (row["task"], row["seed"]) == (f"{scenarios[suite]}, rigid-clearance", seed)]
        with np.load(tmp_path / run / "evaluations.npz") as history:
            assert [float(row["simulated time [s]"]) for row in mine] == pytest.approx(0.1 * history["timesteps"])
            assert [float(row["validation return"]) for row in mine] == history["results"].mean(axis=1).tolist()
    assert (tmp_path / curves.FIGURE).stat().st_size > 0

    monkeypatch.setattr(learn, "train", lambda training: pytest.fail("trained again"))
    execute("curves", options)


def test_a_curve_is_the_mean_of_each_validation_over_the_time_that_was_simulated(tmp_path):
    config = configurations.complete("ppo", DEFAULT_ENV_ID, {"control_period": 0.5}, 0)
    write_history(tmp_path, [[1.0, 3.0], [1.0, 1.0]], [5, 10])
    times, returns = curves.curve(tmp_path, config)
    assert times.tolist() == [2.5, 5.0]
    assert returns.tolist() == [2.0, 1.0]


def test_a_seed_given_twice_is_refused(tmp_path):
    with pytest.raises(ValueError, match="seed 3 is given 2 times; give it once"):
        execute("curves", [*QUICK, "--seeds", "3", "7", "3", "--out", str(tmp_path)])
    assert not list(tmp_path.iterdir())


def test_a_scenario_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(ValueError, match="no suite 'calm'; available: paper, robust"):
        execute("curves", [*QUICK, "--suites", "calm", "--out", str(tmp_path)])
