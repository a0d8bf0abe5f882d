"""Seeds, environments, figures of episodes, statistics and the parsing of arguments."""

import re
from dataclasses import dataclass, field
from unittest.mock import Mock

import numpy as np
import pytest
from scipy.stats import norm

from agents.commands import evaluate
from agents.commands.arguments import ModelOptions
from agents.comparison.statistics import difference, estimate, improvement, interquartile_mean
from agents.environments import episode_seeds, with_sampling
from agents.rollout import episode_figures
from solar_env import SimulationError
from solar_env.__main__ import main as solar_env
from solar_env.commands.arguments import Assignments, parse_arguments, parse_assignments
from solar_env.environment.registration import DEPLOY_RANDOMISED_V1


def test_episode_figures_of_the_array_follow_from_those_of_the_joints():
    deployment = {
        "latched": True,
        "latch_times_s": [12.0, 12.5],
        "peak_postlock_force_N": [300.0, 200.0],
        "postlock_sliding_work_J": [0.01, 0.02],
        "contact_starts": [3, 4],
        "motor_work_J": -0.1,
    }
    figures = episode_figures(deployment, {"peak_impact": -3.0, "wear": -1.0})
    assert figures["return"] == -4.0
    assert figures["latch_times_s"] == 12.5
    assert figures["peak_postlock_force_N"] == 300.0
    assert figures["peak_postlock_force_2_N"] == 200.0
    assert figures["postlock_sliding_work_J"] == pytest.approx(0.03)
    assert figures["contact_starts"] == 7


def test_seeds_of_different_purposes_and_run_seeds_never_coincide():
    blocks = [
        set(episode_seeds(purpose, seed, 10_000))
        for purpose in ("training", "validation", "evaluation")
        for seed in (0, 1, 99_999)
    ]
    assert len(set.union(*blocks)) == sum(map(len, blocks))


@pytest.mark.parametrize(("seed", "count"), [(-1, 1), (100_000, 1), (0, 0), (0, 10_001)])
def test_seeds_beyond_their_block_are_refused(seed, count):
    with pytest.raises(ValueError, match="choose one from"):
        episode_seeds("training", seed, count)


def test_nominal_episodes_differ_by_release_rates_and_randomised_ones_as_their_scenario_says():
    assert with_sampling({}) == {"randomize": {"initial_rate": ((-5e-4, -5e-4), (5e-4, 5e-4))}}
    around = with_sampling({"parameters": {"panel_count": 3, "initial_rate": (0.01, 0.0)}})["randomize"]["initial_rate"]
    assert around == ((0.0095, -5e-4, -5e-4), (0.0105, 5e-4, 5e-4))
    assert with_sampling({}, DEPLOY_RANDOMISED_V1) == {}
    for given in ({"randomize": {}}, {"randomize": {"clearance": (1e-4, 2e-4)}}):
        assert with_sampling(given) == given


def test_a_named_model_joins_the_keywords_takes_the_place_of_the_default_and_contradicts_no_other():
    default = {"model": "flexible-clearance"}
    assert ModelOptions(None, {"torque_limit": 0.3}).keywords() == {"torque_limit": 0.3}
    assert ModelOptions().keywords(default) == default
    assert ModelOptions("rigid-clearance").keywords(default) == {"model": "rigid-clearance"}
    assert ModelOptions(None, {"model": "rigid-ideal"}).keywords(default) == {"model": "rigid-ideal"}
    with pytest.raises(ValueError, match="--model flexible-ideal contradicts --env-kwargs model=rigid-ideal"):
        ModelOptions("flexible-ideal", {"model": "rigid-ideal"}).keywords()


def test_interquartile_mean_ignores_the_outer_quarters():
    assert interquartile_mean(np.array([-1e9, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1e9])) == 3.5


def test_the_interval_of_runs_on_common_episodes_covers_the_truth_although_episodes_do_not_average_out():
    """Figures of an episode and of a run, which add up: episodes as hard for one run as for the others."""
    rng = np.random.default_rng(3)
    covered = []
    for _ in range(100):
        hardness, skill = rng.normal(size=40), rng.normal(scale=0.3, size=(5, 1))
        result = estimate(list(skill + hardness), resamples=200, mean=lambda values: np.mean(values, axis=-1))
        covered.append(result.lower <= 0.0 <= result.upper)
    assert 0.85 <= np.mean(covered) <= 0.99


def test_the_interval_of_a_difference_counts_the_runs_of_the_reference_as_a_sample_too():
    rng = np.random.default_rng(4)
    mine, others = rng.normal(size=30), rng.normal(size=(8, 1)) + rng.normal(size=(8, 30))
    apart, pooled = difference([mine], list(others)), difference([mine], [others.mean(axis=0)])
    assert apart.upper - apart.lower > 1.5 * (pooled.upper - pooled.lower)


def test_an_improvement_on_several_runs_is_over_each_of_them():
    good, bad, between = np.full(8, -1.0), np.full(8, -3.0), np.full(8, -2.0)
    assert improvement([between], [good, bad]).mean == 0.5
    assert improvement([good, bad], [good, bad]).mean == 0.5, "ties are half an improvement"


def test_the_probability_of_improvement_is_that_of_two_shifted_normal_laws():
    """Paired and independent: the difference of two unit normals shifted by d is positive with Phi(d / sqrt 2)."""
    rng = np.random.default_rng(0)
    mine, other = rng.normal(0.5, 1.0, 4000), rng.normal(0.0, 1.0, 4000)
    found = improvement([mine], [other])
    assert found.lower < norm.cdf(0.5 / np.sqrt(2.0)) < found.upper
    assert found.upper - found.lower == pytest.approx(2 * 1.96 * np.sqrt(0.64 * 0.36 / 4000), rel=0.1)


def test_missing_figures_are_left_out_of_the_estimate():
    result = estimate([np.array([1.0, np.nan, 1.0])])
    assert (result.mean, result.count) == (1.0, 2)
    assert np.isnan(estimate([np.array([np.nan])]).mean)
    result = estimate([np.array([1.0, np.nan, 1.0]), np.array([2.0, 2.0, np.nan])])
    assert (result.lower, result.upper, result.count) == (1.0, 2.0, 4)


@pytest.mark.parametrize("separator", ["=", ":"])
def test_pairs_are_parsed_as_literals_and_bare_words(separator):
    pairs = ["torque_limit{}0.3", "model{}rigid-ideal", "randomize{}{{'clearance': (1e-4, 2e-4)}}", "wear{}true"]
    pairs += ["start{}null", "end{}None"]
    assert parse_assignments([pair.format(separator) for pair in pairs]) == {
        "torque_limit": 0.3,
        "model": "rigid-ideal",
        "randomize": {"clearance": (1e-4, 2e-4)},
        "wear": True,
        "start": None,
        "end": None,
    }


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        ("0.3", "write key=value"),
        ("torque_limit=__import__('os')", "neither a Python literal nor a plain word"),
    ],
)
def test_pairs_that_cannot_be_read_are_refused(pair, message):
    with pytest.raises(ValueError, match=message):
        parse_assignments([pair])


@dataclass
class Example:
    """An example."""

    env_id: str = "x"
    """the id"""
    steps: int | None = None
    """how many"""
    quiet: bool = False
    """say nothing"""
    names: list[str] = field(default_factory=lambda: ["a"])
    """some names"""
    keywords: Assignments = field(default_factory=dict)
    """some pairs"""


@pytest.mark.parametrize(
    "error",
    [ValueError("no x; name another"), FileNotFoundError("no x; name another"), SimulationError("no x", 1.0, "step")],
)
def test_a_command_that_cannot_go_on_ends_with_a_message(error, capsys, monkeypatch):
    monkeypatch.setattr(evaluate, "run_command", Mock(side_effect=error))
    assert solar_env(["evaluate"]) == 2
    assert capsys.readouterr().err == f"error: {error}\n"


def test_an_error_that_is_none_of_the_input_is_shown_whole(monkeypatch):
    monkeypatch.setattr(evaluate, "run_command", Mock(side_effect=ZeroDivisionError))
    with pytest.raises(ZeroDivisionError):
        solar_env(["evaluate"])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--stepz", "3"], "--stepz"),
        (["--steps", "few"], "--steps: .*'few'"),
        (["--keywords", "k"], "--keywords: cannot read 'k'"),
        (["--keywords", "a=1", "--keywords", "a=2"], "--keywords is given twice"),
    ],
)
def test_wrong_input_ends_the_command_line_with_one_sentence_and_status_2(capsys, arguments, message):
    with pytest.raises(SystemExit) as end:
        parse_arguments(Example, arguments)
    assert end.value.code == 2
    assert re.fullmatch(rf"error: [^\n]*{message}[^\n]*; see --help\n", capsys.readouterr().err)
