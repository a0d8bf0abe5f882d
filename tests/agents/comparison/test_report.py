"""Comparisons as numbers and tables: pooled seeds, intervals, units."""

import re

import pytest

from agents.comparison.report import reference, summarize, tabulate


def episode(controller, spec, index, force, latched=True):
    return {
        "controller": controller,
        "spec": spec,
        "episode": index,
        "latched": latched,
        "return": -force,
        "peak_postlock_force_N": force if latched else float("nan"),
        "sliding_work_J": 1e-3 * force,
    }


def test_runs_under_one_name_are_pooled_as_training_seeds():
    rows = [episode("ppo", spec, i, force) for spec, force in (("a", 1.0), ("b", 3.0)) for i in range(4)]
    entry = summarize(rows)["ppo"]
    assert entry["runs"] == 2
    assert entry["return"].mean == -2.0
    assert (entry["return"].lower, entry["return"].upper) == (-3.0, -1.0)


def test_tables_are_in_the_units_of_their_headings():
    head, _, row = tabulate([episode("x", "x", i, 2.5) for i in range(4)]).splitlines()[-3:]
    cells = dict(zip(head.split(" | "), row.split(" | "), strict=True))
    assert cells["peak post-lock force [N]"] == "2.5 [2.5, 2.5]; worst 2.5"
    assert cells["sliding work [mJ]"] == "2.5 [2.5, 2.5]; worst 2.5"


def test_a_controller_is_compared_with_every_run_of_a_reference():
    rows = [episode("first", spec, i, force) for spec, force in (("a", 1.0), ("b", 3.0)) for i in range(4)]
    rows += [episode("second", "c", i, 2.5) for i in reversed(range(4))]
    assert reference(rows) == "first"
    entry = summarize(rows)["second"]
    assert entry["better"].mean == 0.5
    assert entry["above"].mean == -0.5


def test_missed_deployments_lower_the_latched_share_and_not_the_force():
    rows = [episode("x", "x", 0, 100.0), episode("x", "x", 1, 900.0, latched=False)]
    entry = summarize(rows)["x"]
    assert entry["latched"] == 0.5
    assert entry["peak_postlock_force_N"].mean == 100.0
    assert "| x | 50% |" in tabulate(rows)


def test_the_worst_episode_is_the_lowest_return_and_the_highest_force():
    text = tabulate([episode("x", "x", i, force) for i, force in enumerate((100.0, 900.0))])
    assert "worst -900" in text
    assert "worst 900" in text


@pytest.mark.parametrize("episodes", [1, 3, 4])
def test_too_few_episodes_have_no_interval(episodes):
    rows = [
        episode(name, name, i, force) for name, force in (("passive", 100.0), ("x", 900.0)) for i in range(episodes)
    ]
    text = tabulate(rows)
    assert bool(re.search(r"\d%? \[", text)) == (episodes >= 4)
    assert ("; worst" in text) == (episodes > 1)


def test_the_runs_of_a_controller_count_too():
    assert re.search(r"\d \[", tabulate([episode("x", spec, 0, 100.0) for spec in "abcd"]))
