"""The transfer matrix judges what every level trained on all levels, and does not train twice."""

import json

import pytest
from helpers import numbers

from agents.commands import transfer
from agents.comparison.controllers import parse_controllers
from agents.environments import episode_seeds, make_env, with_sampling
from agents.laws.baselines import make_baseline
from agents.learning import configurations, learn
from agents.rollout import run_episode
from solar_env.__main__ import execute

TASK = {"parameters": {"spring_stiffness": 1.0}, "postlock_window": 0.5}  # deploys within five seconds
QUICK = [
    *[
        "--algo",
        "ppo",
        "--timesteps",
        "20",
        "--episodes",
        "1",
        "--quiet",
        "--jobs",
        "1",
    ],
    *[
        "--hyperparams",
        "n_steps=10",
        "batch_size=10",
        "--env-kwargs",
        *(f"{key}={value}" for key, value in TASK.items()),
    ],
]


@pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")
def test_every_level_is_judged_on_all_levels_beside_passive_and_servo(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(learn, "VALIDATION_EPISODES", 2)
    monkeypatch.setattr(transfer, "LEVELS", {name: transfer.LEVELS[name] for name in ("rigid", "2 elements")})
    options = [*QUICK, "--out", str(tmp_path)]
    execute("transfer", options)
    printed = capsys.readouterr().out
    returns = json.loads((tmp_path / "transfer.json").read_text())
    assert set(returns) == set(transfer.LEVELS)
    for level, by_training in returns.items():
        assert list(by_training) == ["passive", "servo", *transfer.LEVELS]
        assert all(value["count"] == 1 for value in by_training.values())
        env = make_env(env_kwargs=with_sampling({**TASK, **transfer.LEVELS[level]}))
        alone = run_episode(
            env, make_baseline("passive", env), episode_seeds("evaluation", transfer.EVALUATION_SEED, 1)[0]
        )
        assert by_training["passive"]["mean"] == alone["return"]
    assert returns["rigid"]["passive"] != returns["2 elements"]["passive"]
    for level, keywords in transfer.LEVELS.items():
        trained = configurations.stored_configuration(tmp_path / f"{level.replace(' ', '-')}-0").env_kwargs
        assert trained.items() >= keywords.items()
    assert numbers((tmp_path / "transfer.md").read_text()) <= numbers(printed)
    assert (tmp_path / "transfer.png").stat().st_size > 0

    def refuse(*arguments):
        raise AssertionError("trained again")

    monkeypatch.setattr(learn, "train", refuse)
    execute("transfer", options)
    with pytest.raises(ValueError, match="another configuration"):
        execute("transfer", [*options, "--timesteps", "30"])
    with pytest.raises(ValueError, match="--model rigid-clearance contradicts --env-kwargs model=rigid-ideal"):
        execute("transfer", [*QUICK, "--out", str(tmp_path), "--env-kwargs", "model=rigid-ideal"])


def test_every_number_stands_where_it_belongs(tmp_path, monkeypatch, saved_figures):
    """Evaluations are replaced by returns that tell which run was judged on what."""
    levels = list(transfer.LEVELS)

    def pretend(controllers, episodes, seed, env_id, env_kwargs, *others):
        judged = [transfer.LEVELS[level] for level in levels].index(env_kwargs)
        return [
            {"controller": c.name, "spec": c.spec, "episode": e, "latched": True, "return": -(10.0 * k + judged + 1.0)}
            for k, c in enumerate(parse_controllers(controllers))
            for e in range(4)
        ]

    monkeypatch.setattr(transfer, "evaluate", pretend)
    monkeypatch.setattr(transfer, "train_all", lambda args: {level: [tmp_path / level] for level in levels})
    execute("transfer", ["--out", str(tmp_path), "--quiet"])
    rows = ["passive", "servo", *levels]
    expected = {level: {row: -(10.0 * i + j + 1.0) for i, row in enumerate(rows)} for j, level in enumerate(levels)}
    returns = json.loads((tmp_path / "transfer.json").read_text())
    assert {
        level: {row: value["mean"] for row, value in column.items()} for level, column in returns.items()
    } == expected
    head, _, *lines = [line for line in (tmp_path / "transfer.md").read_text().splitlines() if line.startswith("|")]
    assert head == "| trained on | " + " | ".join(f"judged on {level}" for level in levels) + " |"
    for row, line in zip(rows, lines, strict=True):
        cells = [f"{expected[level][row]:.3g}" for level in levels]
        assert line == f"| {row} | " + " | ".join(f"{cell} [{cell}, {cell}]" for cell in cells) + " |"
    axes = saved_figures[0].axes[0]
    assert [text.get_text() for text in axes.get_xticklabels()] == levels
    assert [text.get_text() for text in axes.get_yticklabels()] == rows


@pytest.mark.parametrize("keywords", transfer.LEVELS.values(), ids=transfer.LEVELS)
def test_what_is_wanted_of_the_environment_joins_a_level_and_must_not_contradict_it(keywords):
    assert transfer.on_level(transfer.Args(env_kwargs=TASK), keywords) == {**TASK, **keywords}
    with pytest.raises(ValueError, match=r"--model .* contradicts --env-kwargs model=rigid-ideal"):
        transfer.on_level(transfer.Args(env_kwargs={"model": "rigid-ideal"}), keywords)
