"""The search for torques that the reward pays has the passive deployment among its profiles, and any chatter."""

import json

import numpy as np
import pytest

from agents.commands.studies import attack
from agents.commands.studies.attack import KNOTS, NUMBERS, actions, passive_profile
from solar_env.__main__ import execute
from solar_env.environment.task.task import VERSIONS

TASK = VERSIONS["v1"].task


def acted(profile, times, latched=False):
    times = np.asarray(times, dtype=float)
    return actions(np.tile(profile, (len(times), 1)), times, np.full(len(times), latched), TASK).tolist()


def test_the_passive_profile_has_no_torque_at_any_time():
    assert acted(passive_profile(), [0.0, 3.3, 20.0, 29.0]) == [0.0] * 4


def test_torques_are_linear_between_the_knots_and_the_last_one_holds():
    profile = passive_profile()
    profile[:KNOTS] = np.linspace(0.5, 1.0, KNOTS)
    assert acted(profile, [0.0, 10.0, 20.0, 25.0]) == pytest.approx([0.0, 0.5, 1.0, 1.0])


@pytest.mark.parametrize("half_period", [1, 2, 4])
@pytest.mark.parametrize("latched", [False, True])
def test_a_profile_chatters_before_or_after_the_latch_with_its_half_period_and_phase(half_period, latched):
    profile, own = passive_profile(), KNOTS + (3 if latched else 0)
    profile[own : own + 3] = 1.0, half_period / 4.0, 0.0
    times = 0.1 * np.arange(16)
    pattern = [1.0 if (k // half_period) % 2 == 0 else -1.0 for k in range(16)]
    assert acted(profile, times, latched) == pattern
    assert acted(profile, times, not latched) == [0.0] * 16
    profile[own + 2] = 0.5
    assert acted(profile, times, latched) == [-value for value in pattern]


def test_the_study_writes_the_best_profiles_and_their_figures(tmp_path, monkeypatch):
    keywords = {"model": "rigid-ideal", "control_period": 0.5, "settling_window": 1.0}
    monkeypatch.setattr(attack, "KEYWORDS", keywords)
    execute("study", ["attack-on-reward", "--quick", "--quiet", "--out", str(tmp_path)])
    record = json.loads((tmp_path / attack.FILE).read_text())
    assert record["episodes"] == 28
    assert set(record["medians"]) == {"passive", "best episode", "mean of the search"}
    assert all(len(profile) == NUMBERS for profile in record["profiles"].values())
    assert record["medians"]["best episode"]["return"] >= record["medians"]["passive"]["return"]
