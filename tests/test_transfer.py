"""The transfer matrix judges what every level trained on all levels, and does not train twice."""

import json

import pytest

from agents import learn, transfer

QUICK = [
    *["--timesteps", "20", "--residual", "0.1", "--episodes", "1", "--quiet", "--jobs", "1"],
    *["--hyperparams", "n_steps=10", "batch_size=10", "--env-kwargs", "deadline=0.4", "postlock_window=0.2"],
]


@pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")
def test_every_level_is_judged_on_all_levels_beside_passive_and_servo(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(transfer, "LEVELS", {name: transfer.LEVELS[name] for name in ("rigid", "1 element")})
    options = [*QUICK, "--out", str(tmp_path)]
    transfer.main(options)
    printed = capsys.readouterr().out
    returns = json.loads((tmp_path / "transfer.json").read_text())
    assert set(returns) == set(transfer.LEVELS)
    for by_training in returns.values():
        assert list(by_training) == ["passive", "servo", *transfer.LEVELS]
        assert all(value["count"] == 1 for value in by_training.values())
        assert all(value["mean"] == -25.0 for value in by_training.values()), "the deadline is impossible"
    assert (tmp_path / "transfer.md").read_text() in printed
    assert (tmp_path / "transfer.png").stat().st_size > 0

    def refuse(*arguments):
        raise AssertionError("trained again")

    monkeypatch.setattr(learn, "train_one", refuse)
    transfer.main(options)
    with pytest.raises(ValueError, match="another configuration"):
        transfer.main([*options, "--timesteps", "30"])
