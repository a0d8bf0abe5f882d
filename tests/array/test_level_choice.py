"""The cheapest level that answers a question: its choice from the table, by `simulate`, and by the environment."""

import copy
import json
import math

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from solar_env import SolarArrayEnv
from solar_env.__main__ import main
from solar_env.array import MODELS, PANELS, PanelModel
from solar_env.array.ladder import (
    DEFAULT_QUESTION,
    DEFAULT_TOLERANCE,
    PACKAGED_TABLE,
    QUESTIONS,
    Answer,
    cheapest,
    read_answers,
    steps,
)
from solar_env.commands.ladder import SECTION, choices
from solar_env.environment.registration import DEPLOY
from solar_env.studies.common.tables import read_table
from solar_env.studies.ladder import campaign


def answer(model="rigid-ideal", error=0.1, half_width=0.0, cost=1.0, question="wear", panels=("", 0)):
    return Answer(question, model, *panels, error, half_width, cost, 1.0, 1)


LEVELS = (
    answer("rigid-ideal", 1.0, 0.0, 0.01),
    answer("rigid-clearance", 0.2, 0.02, 0.1),
    answer("flexible-ideal", 1.0, 0.0, 0.5, panels=("ancf", 2)),
    answer("flexible-clearance", 0.05, 0.02, 0.4, panels=("ancf", 2)),
    answer("flexible-clearance", 0.0, 0.03, 1.0, panels=("modal", 32)),
    answer("rigid-ideal", 0.001, 0.0, 0.01, question="latch-time"),
)


@pytest.mark.parametrize(
    ("tolerance", "level", "panels"),
    [
        (2.0, "rigid-ideal", PanelModel.of("rigid-ideal")),
        (0.3, "rigid-clearance", PanelModel.of("rigid-clearance")),
        (0.21, "flexible-clearance, 2 elements", PanelModel("ancf", 2)),  # sampling counts
        (0.07, "flexible-clearance, 2 elements", PanelModel("ancf", 2)),
        (0.06, "flexible-clearance, 32 modes", PanelModel("modal", 32)),
        (0.03, "flexible-clearance, 32 modes", PanelModel("modal", 32)),
    ],
)
def test_the_cheapest_level_within_the_tolerance_is_taken(tolerance, level, panels):
    chosen = cheapest(LEVELS, "wear", tolerance)
    assert (chosen.level, chosen.panel_model) == (level, panels)


@pytest.mark.parametrize(
    ("question", "tolerance", "words"),
    [
        ("wear", 0.02, ["'wear'", "0.02", "flexible-clearance, 32 modes", "0.03", "choose"]),
        ("wears", 0.1, ["wears", "latch-time", "controller-ranking"]),
        ("impulse", 0.1, ["impulse", "solar-env ladder"]),
        ("wear", 0.0, ["tolerance", "0.0"]),
        ("wear", math.nan, ["tolerance", "nan"]),
        ("wear", math.inf, ["tolerance", "inf"]),
    ],
)
def test_what_cannot_be_answered_is_refused_by_name(question, tolerance, words):
    with pytest.raises(ValueError, match=".*".join(words)):
        cheapest(LEVELS, question, tolerance)


@pytest.mark.parametrize("question", QUESTIONS)
def test_steps_are_what_is_chosen_as_the_tolerance_grows(question):
    answers = read_answers()
    chosen = steps(answers, question)
    assert [step.bound for step in chosen] == sorted(step.bound for step in chosen)
    for step in chosen:
        assert cheapest(answers, question, step.bound * (1.0 + 1e-12) + 1e-15) == step
    # All resamples of the finest level may rank controllers alike: then it meets every tolerance.
    if chosen[0].bound > 0.0:
        with pytest.raises(ValueError, match="no level"):
            cheapest(answers, question, 0.999 * chosen[0].bound)


@pytest.mark.parametrize("text", ["", "question,model\nwear,rigid-ideal\n", "# command: none\nquestion\nwear\n"])
def test_another_file_is_no_table(tmp_path, text):
    path = tmp_path / "ladder.csv"
    path.write_text(text)
    if text:
        with pytest.raises(ValueError, match=r"ladder\.csv, line \d is not of a table of the ladder: it lacks"):
            read_answers(path)
    else:
        assert read_answers(path) == ()
    with pytest.raises(ValueError, match=r"absent\.csv does not exist.*measure"):
        read_answers(tmp_path / "absent.csv")


@pytest.mark.parametrize(
    ("name", "text", "wanted"),
    [
        ("count", "few", "a whole number"),
        ("count", "1.5", "a whole number"),
        ("error", "", "a number"),
        ("evaluations", "many", "a number"),
        ("cost_ratio", "0", "a positive number"),
        ("cost_ratio", "nan", "a positive number"),
    ],
)
def test_a_bad_cell_is_told_with_its_line_and_column(tmp_path, name, text, wanted):
    path = tmp_path / "ladder.csv"
    cells = {"question": "wear", "model": "rigid-ideal", "panels": "", "count": 0, "error": 0.1, "half_width": 0.01}
    cells |= {"cost_ratio": 0.5, "evaluations": 10.0, "members": 8}
    lines = [",".join(map(str, row)) for row in (cells, cells.values(), {**cells, name: text}.values())]
    path.write_text("\n".join(["# command: solar-env ladder", *lines]) + "\n")
    with pytest.raises(ValueError, match=rf"ladder\.csv, line 4: {name} is '{text}', where {wanted} belongs; measure"):
        read_answers(path)
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match=r"ladder\.csv is not a table of the ladder .*; measure it anew"):
        read_answers(path)


def test_the_table_of_the_package_answers_every_question_at_every_level_and_says_how_it_was_made():
    answers = read_answers()
    assert {a.question for a in answers} == set(QUESTIONS)
    for question in QUESTIONS:
        own = [a for a in answers if a.question == question]
        assert {a.level for a in own} == {level.name for level in campaign.FULL.levels[:-1]}
        assert {a.model for a in own} == set(MODELS)
        # Unlike a mean, a ranking can come out the same in all resamples.
        assert all(a.half_width > 0.0 or question == "controller-ranking" for a in own)
        assert all(a.half_width >= 0.0 and a.evaluations > 0 and a.cost_ratio > 0.0 for a in own)
    made_by = read_table(PACKAGED_TABLE).provenance
    assert made_by["command"].endswith(" ladder")
    assert made_by["reference"] == campaign.FULL.reference.name


# Measured again -------------------------------------------------------------------------------------------------------


def test_simulate_takes_the_level_that_answers_and_says_so(tmp_path, capsys):
    path = tmp_path / "run.npz"
    arguments = ["simulate", "--question", "tip-motion", "--tolerance", "0.02", "--duration", "0.05"]
    assert main([*arguments, "--json", "-", "--out", str(path)]) == 0
    captured = capsys.readouterr()
    chosen = cheapest(read_answers(), "tip-motion", 0.02)
    assert json.loads(captured.out)["model"] == chosen.model
    assert f"{chosen.level}: the cheapest level for tip-motion" in captured.err
    assert "not with these" not in captured.err
    from solar_env import Trajectory

    details = Trajectory.load(path).metadata
    assert {name: details[name] for name in chosen.panel_model.keywords} == chosen.panel_model.keywords
    assert main([*arguments, "--json", "-", "--set", "body_mass=1000"]) == 0
    assert "not with these" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--question", "wears"], ["wears", "latch-time"]),
        (["--question", "wear", "--tolerance", "1e-9"], ["wear", "1e-09", "flexible-clearance"]),
        (["--question", "wear", "--tolerance", "-1"], ["tolerance", "-1"]),
        (["--question", "wear", "--model", "rigid-ideal"], ["--question", "--model"]),
        (["--question", "wear", "--elements", "2"], ["--question", "--elements"]),
        (["--tolerance", "0.1"], ["--tolerance", "--question"]),
    ],
)
def test_simulate_refuses_options_that_contradict_each_other(arguments, words, capsys):
    assert main(["simulate", *arguments]) == 2
    message = capsys.readouterr().err
    for word in words:
        assert word in message


def test_the_environment_takes_the_level_of_the_default_question():
    env = gymnasium.make(DEPLOY, model="auto").unwrapped
    chosen = cheapest(read_answers(), DEFAULT_QUESTION, DEFAULT_TOLERANCE)
    assert (env.model, env.panels) == (chosen.model, chosen.panel_model)


@pytest.mark.parametrize("kind", PANELS)
def test_a_level_of_either_kind_of_panels_is_simulated_and_trained_on(kind, monkeypatch, capsys):
    table = (answer("flexible-ideal", panels=(kind, 3)),)
    monkeypatch.setattr("solar_env.environment.settings.read_answers", lambda: table)
    monkeypatch.setattr("solar_env.commands.simulate.read_answers", lambda: table)
    env = gymnasium.make(DEPLOY, model="auto", question="wear").unwrapped
    assert (env.model, env.panels) == ("flexible-ideal", PanelModel(kind, 3))
    assert main(["simulate", "--question", "wear", "--duration", "0.01", "--json", "-"]) == 0
    assert PanelModel(kind, 3).size in capsys.readouterr().err


@pytest.mark.parametrize(("question", "tolerance"), [("latch-time", 0.05), ("tip-motion", 0.02)])
def test_an_environment_that_chose_is_the_one_that_is_named(question, tolerance):
    env = gymnasium.make(DEPLOY, model="auto", question=question, tolerance=tolerance).unwrapped
    check_env(env, skip_render_check=True)
    assert env.model in MODELS
    named = gymnasium.make(DEPLOY, model=env.model, panels=env.panels).unwrapped
    first, second = env.reset(seed=1)[0], named.reset(seed=1)[0]
    for _ in range(5):
        assert np.array_equal(first, second)
        first, second = env.step([0.5])[0], named.step([0.5])[0]
    twin = copy.deepcopy(env)
    assert np.array_equal(twin.step([0.1])[0], env.step([0.1])[0])


@pytest.mark.parametrize(
    ("keywords", "words"),
    [
        ({"question": "wear"}, ["question", "auto", "rigid-clearance"]),
        ({"tolerance": 0.1}, ["tolerance", "auto"]),
        ({"model": "auto", "question": "wears"}, ["wears"]),
        ({"model": "auto", "tolerance": 0.0}, ["tolerance", "0.0"]),
        ({"model": "auto", "question": "wear", "tolerance": 1e-9}, ["no level", "wear"]),
        ({"model": "auto", "elements": 2}, ["auto", "elements", "2"]),
    ],
)
def test_the_environment_refuses_what_does_not_choose_a_level(keywords, words):
    with pytest.raises(ValueError, match=".*".join(words)):
        SolarArrayEnv(**keywords)


def test_the_page_shows_the_levels_that_the_table_of_the_package_gives():
    assert SECTION.read() == choices(read_answers())
    for row in choices(LEVELS).splitlines()[2:]:
        _, _, tolerance, level, _, _ = (cell.strip() for cell in row.split("|"))
        question = "latch-time" if "latch-time" in row else "wear"
        chosen = cheapest(LEVELS, question, float(tolerance.removesuffix(" %")) / 100.0)
        assert chosen.level == level.replace("`", "")
