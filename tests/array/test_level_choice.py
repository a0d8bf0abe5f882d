"""The cheapest level that answers a question: its choice from the table, the table's file, and where it is told."""

import math

import pytest

from solar_env.__main__ import main
from solar_env.array import ModelLevel, cheapest_level
from solar_env.array.ladder import PACKAGED_TABLE, QUESTIONS, Answer, cheapest, read_answers, steps
from solar_env.commands.ladder import SECTION, choices
from solar_env.studies.common.tables import read_table
from solar_env.studies.ladder import campaign


def answer(level, error, half_width, cost, question="wear"):
    return Answer(question, level, error, half_width, cost, 1.0, 1)


LEVELS = (
    answer("rigid-ideal", 1.0, 0.0, 0.01),
    answer("rigid-clearance", 0.2, 0.02, 0.1),
    answer("flexible-ideal:2 elements", 1.0, 0.0, 0.5),
    answer("flexible-clearance:2 elements", 0.05, 0.02, 0.4),
    answer("flexible-clearance", 0.0, 0.03, 1.0),
    answer("rigid-ideal", 0.001, 0.0, 0.01, question="latch-time"),
)


def test_the_cheapest_level_within_the_tolerance_is_taken_and_else_the_question_refused_by_name():
    beams, modes = "flexible-clearance:2 elements", "flexible-clearance"
    chosen = {2.0: "rigid-ideal", 0.3: "rigid-clearance", 0.21: beams, 0.07: beams, 0.06: modes, 0.03: modes}
    assert {tolerance: cheapest(LEVELS, "wear", tolerance).level for tolerance in chosen} == chosen
    for question, tolerance, words in (
        ("wear", 0.02, "'wear'.*0.02.*flexible-clearance.*0.03.*name a level"),
        ("wears", 0.1, "question 'wears' is unknown; did you mean 'wear'"),
        ("wear", 20, "tolerance = 20 is 2,000%; give a share"),
        ("wear", "a", "tolerance = 'a' must be"),
        ("impulse", 0.1, "impulse.*solar-env ladder"),
        ("wear", 0.0, "tolerance.*0.0"),
        ("wear", math.nan, "tolerance.*nan"),
    ):
        with pytest.raises(ValueError, match=words):
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


@pytest.mark.parametrize(
    ("name", "text"),
    [("members", "1.5"), ("error", ""), ("evaluations", "many"), ("cost_ratio", "0"), ("cost_ratio", "nan")],
)
def test_another_file_is_no_table(tmp_path, name, text):
    path = tmp_path / "ladder.csv"
    cells = {"question": "wear", "level": "rigid-ideal", "error": 0.1, "half_width": 0.01}
    cells |= {"cost_ratio": 0.5, "evaluations": 10.0, "members": 8}
    lines = [",".join(map(str, row)) for row in (cells, cells.values(), {**cells, name: text}.values())]
    for content in (
        "\n".join(["# command: solar-env ladder", *lines]).encode(),
        b"question\nwear\n",
        b"\xff\xfe",
        None,
    ):
        if content is None:
            path.unlink()
        else:
            path.write_bytes(content)
        with pytest.raises(ValueError, match=r"ladder\.csv is not a table of the ladder .*; measure it: solar-env"):
            read_answers(path)


def test_the_table_of_the_package_answers_every_question_at_every_level_and_says_how_it_was_made():
    answers = read_answers()
    assert {a.question for a in answers} == set(QUESTIONS)
    for question in QUESTIONS:
        own = [a for a in answers if a.question == question]
        assert {a.level for a in own} == {str(level.panels) for level in campaign.FULL.levels[:-1]}
        # Unlike a mean, a ranking can come out the same in all resamples.
        assert all(a.half_width > 0.0 or question == "controller-ranking" for a in own)
        assert all(a.half_width >= 0.0 and a.evaluations > 0 and a.cost_ratio > 0.0 for a in own)
    made_by = read_table(PACKAGED_TABLE).provenance
    assert made_by["command"].endswith(" ladder")
    assert made_by["reference"] == campaign.FULL.reference.name


def test_ladder_tells_the_cheapest_level_of_a_question_and_measures_nothing(capsys):
    assert main(["ladder", "--ask", "tip-motion", "--tolerance", "0.02"]) == 0
    told, chosen = capsys.readouterr(), cheapest(read_answers(), "tip-motion", 0.02)
    assert told.out.split() == chosen.level.split()
    assert ModelLevel.of(chosen.level)
    assert f"error {chosen.error:.2g}, sampling {chosen.half_width:.2g}, {chosen.cost_ratio:.2g} times" in told.err
    assert cheapest_level("tip-motion", 0.02) == chosen.level
    assert main(["ladder", "--ask", "wear", "--tolerance", "1e-9"]) == 2
    assert "no level answers 'wear' to a tolerance of 1e-09" in capsys.readouterr().err


def test_the_page_shows_the_levels_that_the_table_of_the_package_gives():
    assert SECTION.read() == choices(read_answers())
    header, _, *rows = ([cell.strip() for cell in row.split("|")[1:-1]] for row in choices(LEVELS).splitlines())
    assert header[2:] == list(QUESTIONS)
    told = {
        (question, row[0].strip("`"), float(cell.removesuffix(" %")) / 100.0)
        for row in rows
        for question, cell in zip(QUESTIONS, row[2:], strict=True)
        if cell
    }
    assert len(told) == 4
    assert all(cheapest(LEVELS, question, tolerance).level == level for question, level, tolerance in told)
