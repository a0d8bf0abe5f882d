"""Learning curves are those of the runs, a run for every agent and seed, and nothing is trained twice."""

import numpy as np
import pytest

from agents.commands.studies import learning
from agents.learning import training
from agents.learning.runs import read_config
from solar_env.__main__ import execute
from solar_env.environment.registration import DEPLOY
from solar_env.studies.common.tables import read_table

pytestmark = pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")


def test_every_agent_has_a_curve_of_every_seed_beside_the_laws(tmp_path, monkeypatch):
    monkeypatch.setattr(learning, "SEEDS", (3, 7))
    monkeypatch.setattr(learning, "EPISODES", 1)
    monkeypatch.setattr(training, "EPISODES", 2)
    monkeypatch.setitem(learning.SCENES, "rigid", (DEPLOY, {"model": "rigid-ideal"}))
    monkeypatch.setitem(learning.LENGTHS, "cma-es", (200, 4))
    words = ["learning", "--only", "cma-es-rigid", "--jobs", "1", "--quiet", "--out", str(tmp_path)]
    execute("study", words)
    table = read_table(tmp_path / learning.TABLE)
    (curves, laws) = learning.panels(table)["rigid"]
    assert laws.keys() == set(learning.LAWS)
    assert table.where(controller="cma-es").values("seed") == (3, 7)
    for seed, (steps, seconds, returns) in zip((3, 7), curves["cma-es"], strict=True):
        assert (seconds / steps).tolist() == pytest.approx([seconds[0] / steps[0]] * len(steps), rel=1e-9)
        with np.load(tmp_path / f"cma-es-rigid-{seed}" / "evaluations.npz") as history:
            assert steps.tolist() == history["timesteps"].tolist()
            assert returns == pytest.approx(history["results"].mean(axis=1), rel=1e-9)
    assert (tmp_path / learning.FIGURE).stat().st_size > 0

    monkeypatch.setattr(learning, "train", lambda *_: pytest.fail("trained again"))
    execute("study", words)
    others = (tmp_path / learning.TABLE).read_text().replace("cma-es", "ppo")
    (tmp_path / learning.TABLE).write_text(others)
    execute("study", words)
    assert set(learning.panels(read_table(tmp_path / learning.TABLE))["rigid"].curves) == {"cma-es", "ppo"}
    before = (tmp_path / learning.FIGURE).read_bytes()
    execute("study", [*words, "--draw"])
    assert (tmp_path / learning.FIGURE).read_bytes() == before


def test_refinement_goes_on_from_the_best_policies_of_ppo(tmp_path, monkeypatch):
    monkeypatch.setattr(learning, "SEEDS", (3,))
    monkeypatch.setattr(learning, "EPISODES", 1)
    monkeypatch.setattr(training, "EPISODES", 2)
    monkeypatch.setattr(training, "VALIDATIONS", 2)
    monkeypatch.setitem(learning.SCENES, "rigid", (DEPLOY, {"model": "rigid-ideal"}))
    monkeypatch.setitem(learning.LENGTHS, "ppo", (2048, 1))
    monkeypatch.setitem(learning.LENGTHS, "refined", (200, 4))
    words = ["--only", "refined-rigid", "ppo-rigid", "--jobs", "1", "--quiet", "--out", str(tmp_path)]
    execute("study", ["learning", *words])
    curves = learning.panels(read_table(tmp_path / learning.TABLE))["rigid"].curves
    ((before, seconds_before, _),), ((after, seconds_after, returns),) = curves["ppo"], curves["refined"]
    assert after[0] > before[-1]
    assert seconds_after[0] > seconds_before[-1]
    start = read_config(tmp_path / "refined-rigid-3").hyperparameters["start"]
    assert start == str(tmp_path / "ppo-rigid-3" / "best_model.zip")
    assert np.isfinite(returns).all()


def test_an_algorithm_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(ValueError, match="part of the study learning 'a2c' is unknown"):
        execute("study", ["learning", "--only", "a2c", "--out", str(tmp_path)])
