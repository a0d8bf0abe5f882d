"""The benchmark measures what it says, and its tables hold all of it."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from helpers import numbers

from solar_env.__main__ import main
from solar_env.studies.throughput import step_rates
from solar_env.studies.throughput.rate_tables import tables
from solar_env.studies.throughput.step_rates import (
    MOMENTS,
    FromMoment,
    Split,
    compare,
    make_native,
    moments,
    place,
)

MODEL = "rigid-ideal"


@pytest.fixture
def brief(monkeypatch):
    """Measurements of some milliseconds with few lanes."""
    for name, value in (
        ("LANES", (1, 3)), ("SCALED_LANES", 3), ("COMPARED_LANES", 2), ("ENOUGH", 0.01), ("LONG_ENOUGH", 0.01),
    ):  # fmt: skip
        monkeypatch.setattr(step_rates, name, value)


def test_the_moments_are_spread_over_a_whole_deployment():
    times = [float(state.clock["time"][0]) for state in moments(MODEL)]
    assert len(times) == MOMENTS
    assert times[0] == 0.0
    assert np.diff(times) == pytest.approx(np.full(MOMENTS - 1, times[-1] / (MOMENTS - 1)), abs=0.11)
    assert any(state.joints["latched"].all() for state in moments(MODEL))
    assert not moments(MODEL)[MOMENTS // 4].joints["latched"].any()


def test_every_kind_of_vector_begins_at_the_same_moments():
    chosen = [moments(MODEL)[k] for k in (3, 20)]
    native = make_native(MODEL, 2)
    place(native, chosen)
    first = native.step(np.zeros((2, 1)))[0]
    for lane, moment in enumerate(chosen):
        env = FromMoment(MODEL, moment)
        env.reset(seed=0)
        assert env.step(np.zeros(1))[0].tobytes() == first[lane].tobytes()


def test_the_split_adds_up(brief):
    split = step_rates.measure_native(MODEL, 3)
    assert min(split.physics, split.observation, split.python) > 0.0
    assert split.physics + split.observation + split.python == pytest.approx(split.wall)
    assert split.steps % 3 == 0
    assert split.rate == split.steps / split.wall


def test_contestants_are_stepped_in_turn(brief):
    order = []

    class Contestant:
        def __init__(self, name):
            self.name = name

        def step(self, actions):
            order.append((self.name, actions.shape))

        def close(self):
            order.append((self.name, "closed"))

    rates = compare({name: (Contestant(name), lambda: None) for name in "ab"}, 4)
    assert order[:4] == [("a", (4, 1)), ("b", (4, 1))] * 2
    assert order[-2:] == [("a", "closed"), ("b", "closed")]
    assert set(rates) == {"a", "b"}


class Clock:
    """A clock that only what is timed moves on."""

    def __init__(self):
        self.now = 0.0

    def contestant(self, *seconds):
        """An environment whose steps take so long, the last of these again and again; to begin takes longer."""
        left = list(seconds)

        def step(actions):
            self.now += left.pop(0) if len(left) > 1 else left[0]

        def begin():
            self.now += 0.1

        return SimpleNamespace(step=step, close=lambda: None), begin


def test_who_takes_a_third_of_the_time_makes_three_times_as_many_steps(brief, monkeypatch):
    clock = Clock()
    monkeypatch.setattr(step_rates, "time", SimpleNamespace(perf_counter=lambda: clock.now))
    # Of three rounds the first one warms up; the median of the others is 1 ms.
    rates = compare({"quick": clock.contestant(9.0, 0.5e-3, 1.5e-3), "slow": clock.contestant(3e-3)}, 4)
    assert rates == {"quick": pytest.approx(4 / 1e-3), "slow": pytest.approx(4 / 3e-3)}


def test_one_round_out_of_many_that_is_disturbed_makes_no_difference(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(step_rates, "time", SimpleNamespace(perf_counter=lambda: clock.now))
    monkeypatch.setattr(step_rates, "LONG_ENOUGH", 1.05)
    rates = compare({"disturbed": clock.contestant(1e-3, 1e-3, 0.5, 1e-3)}, 1)
    assert rates == {"disturbed": pytest.approx(1e3)}


@pytest.fixture
def measured_rates(monkeypatch):
    """Rates by name that \"compare\" is to find; nothing is made and nothing runs."""
    rates = {}

    def found(contestants, lanes):
        assert set(contestants) == set(rates)
        return rates

    class Nothing:
        def __init__(self, *arguments):
            pass

        def reset(self):
            pass

    monkeypatch.setattr(step_rates, "compare", found)
    monkeypatch.setattr(step_rates, "make_native", lambda *arguments: None)
    monkeypatch.setattr(step_rates, "spread", lambda *arguments: [])
    monkeypatch.setattr(step_rates, "available_processors", lambda: 4)
    monkeypatch.setattr("gymnasium.vector.SyncVectorEnv", Nothing)
    monkeypatch.setattr("stable_baselines3.common.vec_env.SubprocVecEnv", Nothing)
    return rates


def test_more_threads_that_are_quicker_scale_by_more_than_one(measured_rates):
    measured_rates |= {"1": 1000.0, "4": 3200.0}
    assert step_rates.measure_scaling(MODEL) == 3.2


def test_the_native_vector_is_the_quicker_the_higher_its_ratios(measured_rates):
    measured_rates |= {"native": 3000.0, "SyncVectorEnv": 1000.0, "SubprocVecEnv": 2000.0}
    assert step_rates.measure_peers(MODEL) == {"SyncVectorEnv": 3.0, "SubprocVecEnv": 1.5}


def test_the_tables_hold_every_measurement():
    results = {("lanes", MODEL, lanes): Split(1000 * lanes, 2.0, 1.8, 0.1) for lanes in step_rates.LANES}
    results["threads", MODEL, ""] = 1.93
    results["peers", MODEL, ""] = {"SyncVectorEnv": 2.5, "SubprocVecEnv": 3.5}
    results["memory", MODEL, ""] = 42_000.0
    results["startup", MODEL, "cached"] = 1.25
    results["startup", MODEL, "cold"] = 123.0
    text = tables(results)
    for expected in ("| 500 | 1,000 | 8,000 |", "1.93", "90.0% | 5.0% | 5.0%", "2.50 | 3.50 | 42 | 1.2", "123 s"):
        assert expected in text


def test_the_command_prints_and_writes_its_tables(brief, monkeypatch, tmp_path: Path, capsys):
    monkeypatch.setattr(step_rates, "measure_memory", lambda model: 1000.0)
    monkeypatch.setattr(step_rates, "measure_startup", lambda model, cold: 1.0)
    monkeypatch.setattr(step_rates, "measure_peers", lambda model: {"SyncVectorEnv": 2.0, "SubprocVecEnv": 3.0})
    assert main(["study", "throughput", "--only", MODEL, "--quick", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert numbers((tmp_path / "throughput.md").read_text()) <= numbers(printed)
    assert MODEL in printed


@pytest.mark.slow
def test_vectors_of_other_libraries_memory_and_startup_are_measured(monkeypatch):
    monkeypatch.setattr(step_rates, "LONG_ENOUGH", 0.1)
    assert all(ratio > 0.0 for ratio in step_rates.measure_peers(MODEL).values())
    assert 1e3 < step_rates.measure_memory(MODEL, 200) < 1e7
    assert step_rates.measure_startup(MODEL, cold=False) > 0.0
