"""Tuning finds what it looks for within its budget, repeats itself, and keeps what it found."""

import json
from dataclasses import asdict, fields

import numpy as np
import pytest
from stable_baselines3.common.utils import set_random_seed

from agents.comparison.law_search import LawSearch
from agents.environments import DEFAULT_ENV_ID, OF_LAWS, make_env
from agents.laws.baselines import make_baseline
from agents.laws.table import TUNABLE
from solar_env.__main__ import execute
from solar_env.support.minimisation import minimise


@pytest.mark.parametrize("name", TUNABLE)
def test_parameters_survive_the_way_to_the_unit_cube_and_back(name):
    cls = type(TUNABLE[name].defaults)
    count = cls().to_unit().size
    assert np.all((cls().to_unit() >= 0.0) & (cls().to_unit() <= 1.0)), "the defaults are within their bounds"
    inside = cls.from_unit(np.random.default_rng(0).random(count))
    assert inside.to_unit() == pytest.approx(cls.from_unit(inside.to_unit()).to_unit())
    for value, default in zip(vars(inside).values(), vars(cls()).values(), strict=True):
        assert type(value) is type(default)
    low, high = cls.from_unit(np.zeros(count)), cls.from_unit(np.ones(count))
    for f in fields(cls):
        assert np.all(f.metadata["bounds"] == np.array([getattr(low, f.name), getattr(high, f.name)]).T)


def test_the_points_of_a_search_do_not_depend_on_what_else_draws_random_numbers():
    """A training between two generations seeds NumPy's global generator, a finished one that is only read does not."""
    generations = {}
    for disturbed in (False, True):

        def costs(points, disturbed=disturbed):
            generations.setdefault(disturbed, []).append(np.array(points))
            if disturbed:
                set_random_seed(0)
            return [float(point[0]) for point in points]

        minimise(costs, np.full(2, 0.5), 18, seed=0, progress=False)
    assert len(generations[True]) == 3
    np.testing.assert_array_equal(generations[True], generations[False])


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("--validation-episodes", "the number of episodes is 0"),
        ("--episodes-per-candidate", "--episodes-per-candidate is 0; give a positive number"),
    ],
)
def test_what_would_end_a_tuning_is_refused_before_it_begins(monkeypatch, option, message):
    monkeypatch.setattr(LawSearch, "_returns", lambda *arguments: pytest.fail("simulates"))
    with pytest.raises(ValueError, match=message):
        execute("tune", ["--controller", "damper", "--episodes", "6", "--quiet", option, "0"])


@pytest.fixture
def judged(monkeypatch):
    """Points that get simulated, at no cost here: a damper is the better the nearer its damping is to 0.3."""
    candidates = []

    def returns(search, parameters, seeds):
        candidates.append((list(parameters), tuple(seeds)))
        return [-((p.damping - 0.3) ** 2) for p in parameters]

    monkeypatch.setattr(LawSearch, "_returns", returns)
    return candidates


def stored(configs):
    return json.loads((configs / "damper.json").read_text())[DEFAULT_ENV_ID]["rigid-clearance"]


def test_the_command_stores_the_best_that_it_found_with_its_return_and_that_of_the_start(configs, judged):
    execute("tune", ["--controller", "damper", "--episodes", "600", "--quiet", "--validation-episodes", "1"])
    found = stored(configs)
    assert found["parameters"]["damping"] == pytest.approx(0.3, abs=0.01)
    assert found["tuning"]["validation_return"] == -((found["parameters"]["damping"] - 0.3) ** 2)
    assert found["tuning"]["validation_return"] == max(-((p.damping - 0.3) ** 2) for p in judged[-1][0])
    assert found["tuning"]["validation_return_before_tuning"] == -((TUNABLE["damper"].defaults.damping - 0.3) ** 2)
    assert found["tuning"]["training_episodes"] <= 600
    seeds = [seed for _, seeds in judged for seed in seeds]
    assert len(set(seeds)) == len(seeds), "every generation has fresh episodes, the same for all its candidates"


def test_refining_starts_from_what_the_model_has_and_stays_closer(configs, judged):
    budget = ["--episodes", "6", "--episodes-per-candidate", "1", "--validation-episodes", "1"]
    had = {"parameters": {"damping": 0.25, "settling_damping": 0.5}, "tuning": {"training_episodes": 30}}
    found, distances = {}, {}
    for options in ([], ["--refine", DEFAULT_ENV_ID]):
        judged.clear()
        (configs / "damper.json").write_text(json.dumps({DEFAULT_ENV_ID: {"rigid-clearance": had}}))
        execute("tune", ["--controller", "damper", "--quiet", *options, *budget])
        found[bool(options)] = stored(configs)["tuning"]
        start = TUNABLE["damper"].defaults.settling_damping if not options else 0.5
        distances[bool(options)] = np.mean([abs(p.settling_damping - start) for p in judged[0][0]])
    assert found[False]["start"] == asdict(TUNABLE["damper"].defaults)
    assert found[True]["start"] == {"damping": 0.25, "settling_damping": 0.5}
    assert distances[True] < 0.5 * distances[False]
    assert found[False]["training_episodes_with_start"] == 6
    assert found[True]["training_episodes_with_start"] == 36


@pytest.mark.parametrize(
    ("options", "model"),
    [([], "rigid-clearance"), (["--model", "flexible-ideal:1 element"], "flexible-ideal")],
)
def test_the_command_stores_what_it_tuned_for_a_model_and_keeps_the_other_models(configs, options, model):
    before = json.loads((configs / "damper.json").read_text())[DEFAULT_ENV_ID]
    short = ["--env-kwargs", "deadline=0.3", "settling_window=0.5", "--quiet"]
    budget = ["--episodes", "6", "--episodes-per-candidate", "1", "--validation-episodes", "1", "--jobs", "1"]
    execute("tune", ["--controller", "damper", *options, *budget, *short])
    after = json.loads((configs / "damper.json").read_text())[DEFAULT_ENV_ID]
    written = after[model]
    assert written["tuning"]["training_episodes"] == 6
    assert after == {**before, model: written} != before
    with make_env(DEFAULT_ENV_ID, {"model": model, **OF_LAWS}) as made:
        assert asdict(make_baseline("damper", made).parameters) == written["parameters"]
