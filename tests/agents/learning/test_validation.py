"""Validation: on episodes of its own, and what is kept is never worse there than what training began with."""

import numpy as np

from agents.environments import DEFAULT_ENV_ID
from agents.learning import learn, runs


def configuration():
    """Steps so large that training makes the agent worse than it began."""
    spoiling = {"n_steps": 50, "batch_size": 50, "learning_rate": 1.0}
    return runs.complete("ppo", DEFAULT_ENV_ID, {"model": "rigid-ideal"}, 0, 1, 100, spoiling)


def test_a_training_that_spoils_the_agent_keeps_it_as_it_was_and_so_does_one_that_goes_on(tmp_path, monkeypatch):
    monkeypatch.setattr(learn, "VALIDATION_EPISODES", 2)
    first, second = tmp_path / "first", tmp_path / "second"
    for folder in (first, second):
        folder.mkdir()
    learn.train(learn.Training(configuration(), first, progress=False, threads=1))
    with np.load(first / "evaluations.npz") as history:
        before, after = history["results"].mean(axis=1)
        assert history["timesteps"].tolist() == [0, 100]
    assert after < before
    assert runs.best_policy(first).description.training_steps == 0
    learn.train(learn.Training(runs.read_config(first), second, first, progress=False, threads=1))
    for name in runs.POLICY:
        assert (second / name).read_bytes() == (first / name).read_bytes()


def test_a_training_ends_with_a_validation_wherever_the_one_before_was_and_says_so(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(learn, "VALIDATION_EPISODES", 1)
    monkeypatch.setattr(learn, "SHORTEST_VALIDATION_INTERVAL", 70)
    learn.train(learn.Training(configuration(), tmp_path, threads=1))
    with np.load(tmp_path / "evaluations.npz") as history:
        assert history["timesteps"].tolist() == [0, 70, 100]
    told = [line for line in capsys.readouterr().err.splitlines() if "in validation" in line]
    assert [line.split(":")[0] for line in told] == ["step 0", "step 70", "step 100"]
