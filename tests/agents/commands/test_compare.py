"""A passive damper beside controlled drives, on an array from a file."""

import json

import pytest

from agents.commands import compare
from agents.comparison.evaluation import run_cells
from agents.comparison.passive_damper import Contest
from agents.environments import episode_seeds
from agents.laws.table import TUNABLE
from solar_env.__main__ import main

COMPARE = ["compare", "--model", "rigid-ideal", "--points", "6", "--quiet", "--jobs", "1"]
ARRAY = "spring_stiffness = [2.5, 1.875]\ncable_preload_force = 1250.0\nwear_bins = 8\n"


@pytest.fixture
def contest():
    randomize = {"initial_rate": ((-5e-4, -5e-4), (5e-4, 5e-4))}
    parameters = {"spring_stiffness": (2.5, 1.875), "cable_preload_force": 1250.0, "wear_bins": 8}
    kwargs = {"parameters": parameters, "model": "rigid-ideal", "randomize": randomize}
    return Contest("solar_env/Deploy-v2", kwargs, 6, 2, 1, 0, False)


def test_the_best_damper_is_better_than_a_weaker_and_a_stronger_one(contest):
    best = contest.best_damper()
    seeds = episode_seeds("training", 0, 2)

    def mean(damping):
        cells = contest.cells("passive", contest.damped(damping), seeds)
        return sum(run["return"] for run in run_cells(cells, 1, False))

    assert mean(best) > max(mean(0.0), mean(0.5 * best), mean(2.0 * best))


def test_damper_laws_and_a_policy_that_fits_are_compared_on_one_array(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(compare, "TUNABLE", {"damper": TUNABLE["damper"]})
    file = tmp_path / "array.toml"
    file.write_text(ARRAY)
    assert main([*COMPARE, str(file), "--episodes", "3", "--out", str(tmp_path / "out")]) == 0
    told = capsys.readouterr().out
    assert " does better than the " in told
    assert ", latch torque " in told
    assert "the drive turns the root alone, with up to " in told
    found = json.loads((tmp_path / "out" / "metrics.json").read_text())
    damping = found["settings"]["found"]["hinge_damping"]
    names = {"springs alone", f"passive damper of {damping:g} N m s/rad", "drive by damper", "drive by rigid"}
    assert set(found["controllers"]) == names
    assert found["settings"]["found"]["unfit"] == []


def test_a_policy_that_does_not_fit_the_array_is_told_and_left_out(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(compare, "TUNABLE", {"damper": TUNABLE["damper"]})
    monkeypatch.setattr(Contest, "best_damper", lambda self: 0.1)
    file = tmp_path / "array.toml"
    file.write_text(f"panel_count = 3\n{ARRAY}")
    assert main([*COMPARE, str(file), "--episodes", "1", "--out", str(tmp_path / "out")]) == 0
    assert "The shipped policy rigid does not fit: " in capsys.readouterr().out
