"""The ladder: its table says what is measured again, and errors, bands and rankings are what they claim."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solar_env.__main__ import main
from solar_env.array import ModelLevel
from solar_env.array.ladder import PACKAGED_TABLE, QUESTIONS, cheapest, read_answers
from solar_env.studies.common.motion import Level
from solar_env.studies.common.tables import read_table
from solar_env.studies.ladder import campaign
from solar_env.studies.ladder.campaign import CONTROLLERS, deploy, discordant_share, mean_error, ranking_error
from solar_env.studies.ladder.plot import conclusion
from solar_env.support.readme import STUDIES

TINY = campaign.LadderPlan(
    panels=("8 modes",),
    reference=Level("flexible-clearance:8 modes", tighter=2.0),
    duration=12.6,
    members=2,
    ideal_members=1,
    controlled_members=1,
    window=0.2,
)


@pytest.fixture(scope="module")
def finest():
    return deploy(campaign.FULL.reference, 0, float(read_table(PACKAGED_TABLE).provenance["duration_s"]))


@pytest.mark.parametrize(
    "level",
    [
        Level("rigid-ideal"),
        Level("rigid-clearance"),
        Level("flexible-ideal:1 element"),
        Level("flexible-clearance:1 element"),
        Level("flexible-clearance"),
    ],
    ids=lambda level: level.name,
)
def test_a_sample_of_the_table_is_measured_again(level, finest):
    own = deploy(level, 0, float(read_table(PACKAGED_TABLE).provenance["duration_s"]))
    for question in ("latch-time", "tip-motion"):
        (stated,) = (a for a in read_answers() if (a.question, a.level) == (question, level.model))
        error, _ = campaign.error_of(question, [own], [finest])
        # One pair of runs scatters more than the means of the pairs; 3.3 standard deviations, for 1.96 in the table.
        band = 3.3 / 1.96 * stated.half_width * math.sqrt(stated.members)
        assert error == pytest.approx(stated.error, abs=band, rel=0.02), question


# Errors and bands -----------------------------------------------------------------------------------------------------


def test_the_error_is_that_of_the_worst_quantity_and_single_runs_have_no_band():
    reference = np.array([[[1.0], [2.0]]])
    level = np.array([[[1.1], [1.0]]])
    assert mean_error(level, reference, np.array([1.0, 2.0])) == pytest.approx((0.5, 0.0))
    moved = np.array([[[3.0, 4.0]]])
    assert mean_error(moved, np.zeros((1, 1, 2)), np.array([10.0])) == pytest.approx((0.5, 0.0))


@pytest.mark.parametrize("members", [2, 16])
def test_bands_hold_the_true_difference_about_as_often_as_they_say(members):
    random, held = np.random.default_rng(1), 0
    for _ in range(200):
        level = 1.0 + 0.1 * random.normal(size=(members, 1, 1))
        reference = 1.0 + 0.1 * random.normal(size=(members, 1, 1))
        error, half_width = mean_error(level, reference, np.ones(1))
        held += error <= half_width
    assert 0.9 <= held / 200 <= 0.99


def test_what_members_have_in_common_at_all_levels_cancels():
    scatter = np.random.default_rng(0).normal(size=(400, 1, 1))
    own = 0.01 * np.random.default_rng(1).normal(size=(400, 1, 1))
    error, half_width = mean_error(6.0 + scatter + own, 5.0 + scatter, np.full(1, 5.0))
    assert error == pytest.approx(0.2, rel=0.01)
    assert half_width == pytest.approx(1.96 * 0.01 / math.sqrt(400) / 5.0, rel=0.15)


def test_rankings_err_by_the_share_of_pairs_in_the_wrong_order_and_ties_count_half():
    reference = np.array([[1.0, 1.0], [2.0, 2.0], [3.0, 3.0]])
    assert discordant_share(reference, reference) == 0.0
    assert discordant_share(reference[::-1], reference) == 1.0
    assert discordant_share(np.array([[1.0, 0.0], [3.0, 0.0], [2.0, 0.0]]), reference) == pytest.approx(2.5 / 6.0)
    assert ranking_error(reference[np.newaxis, ::-1], reference[np.newaxis]) == (1.0, 0.0)


def test_a_ranking_is_less_certain_the_more_the_runs_scatter():
    clear = np.array([[1.0], [2.0], [3.0]])
    level, reference = np.random.default_rng(0).normal(size=(2, 8, 3, 1))
    widths = [ranking_error(clear + size * level, clear + size * reference)[1] for size in (0.01, 2.0)]
    assert widths[0] == 0.0
    assert widths[1] > 0.0


# The command ----------------------------------------------------------------------------------------------------------


def test_the_command_writes_table_and_figure_draws_from_the_table_alone_and_leaves_the_package_alone(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(campaign, "FULL", TINY)
    monkeypatch.setattr(
        campaign, "CONTROLLERS", {name: CONTROLLERS[name] for name in ("springs alone", "constant drive")}
    )
    packaged = PACKAGED_TABLE.read_bytes()
    arguments = ["ladder", "--out", str(tmp_path)]
    assert main(arguments) == 0
    assert PACKAGED_TABLE.read_bytes() == packaged
    assert {path.name for path in tmp_path.iterdir()} == {"ladder.csv", "ladder.png"}
    printed = capsys.readouterr().out
    assert all(question in printed for question in QUESTIONS)
    answers = read_answers(tmp_path / "ladder.csv")
    assert len(answers) == len(QUESTIONS) * (len(TINY.levels) - 1)
    assert all(math.isfinite(a.bound) and a.cost_ratio > 0.0 for a in answers)
    by_level = {(a.question, a.level): a for a in answers}
    assert by_level["wear", "flexible-clearance:8 modes"].members == 2
    assert by_level["wear", "rigid-ideal"].error == 1.0, "ideal joints do not wear"
    assert by_level["latch-time", "rigid-ideal"].error < 0.01
    assert by_level["latch-time", "flexible-clearance:8 modes"].error < 1e-4
    assert read_table(tmp_path / "ladder.csv").provenance["command"] == "solar-env ladder"
    # Drawn again, from the table alone.
    figure, table = (tmp_path / "ladder.png").read_bytes(), (tmp_path / "ladder.csv").read_bytes()
    monkeypatch.setattr(campaign, "measure_ladder", None)
    assert main([*arguments, "--draw"]) == 0
    assert ((tmp_path / "ladder.png").read_bytes(), (tmp_path / "ladder.csv").read_bytes()) == (figure, table)


def test_every_level_runs_alone_and_under_controllers_and_ideal_joints_less_often():
    plan = replace(TINY, members=3, ideal_members=1, controlled_members=2)
    for level in plan.levels:
        for controlled, most in ((False, 3), (True, 2)):
            members = [member for own, member, other in plan.runs if own == level and other == controlled]
            assert members == list(range(most if level.panels.clearance else 1))


def test_a_deployment_that_does_not_latch_is_refused():
    with pytest.raises(ValueError, match="has not latched within 1 s"):
        deploy(Level("rigid-ideal"), 0, 1.0)


def test_the_figures_title_names_the_cheapest_panels_within_a_tenth():
    answers = read_answers()
    title = conclusion(answers, list(QUESTIONS))
    assert title == "Cheapest within 10%: rigid panels for latch-time and tip-motion, 32 modes for all else"
    for question in QUESTIONS:
        level = cheapest(answers, question, 0.1).level
        assert level.startswith("rigid") == (question in ("latch-time", "tip-motion")), question
        assert level.startswith("rigid") or ModelLevel.of(level).size == "32 modes", question


def test_a_question_that_nothing_answers_is_named_in_the_title():
    coarse = [replace(answer, error=1.0) for answer in read_answers() if answer.question == "wear"]
    rest = [answer for answer in read_answers() if answer.question in ("impulse", "peak-force")]
    assert "none for wear" in conclusion([*rest, *coarse], ["wear", "impulse", "peak-force"])
    assert conclusion(rest, ["impulse", "peak-force"]) == "Cheapest within 10%: 32 modes for all questions"


def test_the_opening_sentence_of_the_page_is_what_its_table_says():
    page = " ".join((STUDIES / "ladder" / "README.md").read_text(encoding="utf-8").split())
    opening = page.split(" a question ")[1].split(" `solar-env ladder` asks")[0]
    answers = read_answers()
    told = {
        "peak-force": "8.2",
        "impulse": "0.098",
        "controller-ranking": "5",
        "tip-motion": "0.028",
        "latch-time": "0.00048",
    }
    for question, percent in told.items():
        assert f"{percent} %" in opening
        assert cheapest(answers, question, float(percent) / 100.0).level == "flexible-clearance"
    costs = {answer.level: answer.cost_ratio for answer in answers if answer.question == "controller-ranking"}
    assert costs["flexible-clearance"] < costs["flexible-clearance:1 element"], "cheaper than one element"
    for question, percent in (("tip-motion", "7.6"), ("latch-time", "0.1")):
        assert f"{percent} %" in opening
        assert cheapest(answers, question, float(percent) / 100.0).level == "rigid-ideal"
