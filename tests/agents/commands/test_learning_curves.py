"""Learning curves are those of the runs, a run for every agent and seed, and nothing is trained twice."""

import numpy as np
import pytest

from agents.commands.studies import learning
from agents.learning import learn, runs
from solar_env.__main__ import execute
from solar_env.studies.common.tables import read_table

SMALL = {"n_steps": 10, "batch_size": 10}
SHORT = {"settling_window": 0.2, "control_period": 0.1}


def test_every_agent_has_a_curve_of_every_seed_beside_the_laws(tmp_path, monkeypatch):
    complete = runs.complete
    monkeypatch.setattr(
        runs,
        "complete",
        lambda algo, env_id, keywords, *others: complete(algo, env_id, keywords, others[0], 2, 20, SMALL),
    )
    monkeypatch.setattr(learning, "SEEDS", (3, 7))
    monkeypatch.setattr(learning, "RIGID", {"model": "rigid-clearance", **SHORT, "deadline": 0.3})
    monkeypatch.setattr(learn, "VALIDATION_EPISODES", 2)
    words = ["learning", "--only", "ppo", "--jobs", "1", "--quiet", "--out", str(tmp_path)]
    execute("study", words)
    table = read_table(tmp_path / learning.TABLE)
    curves, laws = learning.drawn(table)
    assert laws.keys() == {"servo", "damper"}
    assert table.where(controller="ppo").values("seed") == (3, 7)
    for seed, (times, returns) in zip((3, 7), curves["ppo"], strict=True):
        with np.load(tmp_path / f"ppo-{seed}" / "evaluations.npz") as history:
            assert times == pytest.approx(0.1 * history["timesteps"])
            assert returns.tolist() == history["results"].mean(axis=1).tolist()
    assert (tmp_path / learning.FIGURE).stat().st_size > 0

    monkeypatch.setattr(learn, "train", lambda training: pytest.fail("trained again"))
    execute("study", words)
    before = (tmp_path / learning.FIGURE).read_bytes()
    execute("study", [*words, "--draw"])
    assert (tmp_path / learning.FIGURE).read_bytes() == before


def test_an_algorithm_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(ValueError, match="part of the study learning 'a2c' is unknown"):
        execute("study", ["learning", "--only", "a2c", "--out", str(tmp_path)])
