"""The benchmark measures what it says, and its table holds all of it."""

from types import SimpleNamespace

import numpy as np
import pytest
from helpers import numbers

from solar_env.__main__ import main
from solar_env.studies.throughput import step_rates
from solar_env.studies.throughput.step_rates import (
    MOMENTS,
    FromMoment,
    as_markdown,
    compare,
    make_native,
    moments,
    place,
    placements,
)

MODEL = "rigid-ideal"


@pytest.fixture
def brief(monkeypatch):
    """Measurements of some milliseconds with few lanes."""
    for name, value in (("LANES", (1, 3)), ("SCALED_LANES", 3), ("COMPARED_LANES", 2), ("ENOUGH", 0.01)):
        monkeypatch.setattr(step_rates, name, value)


def test_the_moments_are_spread_over_a_whole_deployment_and_lanes_go_through_all_of_them():
    times = [float(state.clock["time"][0]) for state in moments(MODEL)]
    assert len(times) == MOMENTS
    assert times[0] == 0.0
    assert np.diff(times) == pytest.approx(np.full(MOMENTS - 1, times[-1] / (MOMENTS - 1)), abs=0.11)
    assert any(state.joints["latched"].all() for state in moments(MODEL))
    assert not moments(MODEL)[MOMENTS // 4].joints["latched"].any()
    for lanes in (16, 256):
        met = [id(state) for chosen in placements(MODEL, lanes) for state in chosen]
        assert set(met) == set(map(id, moments(MODEL)))
        assert len(met) == max(lanes, MOMENTS)


def test_every_kind_of_vector_begins_at_the_same_moments():
    chosen = [moments(MODEL)[k] for k in (3, 20)]
    native = make_native(MODEL, 2)
    place(native, chosen)
    first = native.step(np.zeros((2, 1)))[0]
    for lane, moment in enumerate(chosen):
        env = FromMoment(MODEL, moment)
        env.reset(seed=0)
        assert env.step(np.zeros(1))[0].tobytes() == first[lane].tobytes()


def test_compiled_calls_take_a_share_of_the_steps(brief):
    assert step_rates.measure_rate(MODEL, 1).keys() == {"1"}
    figures = step_rates.measure_rate(MODEL, 3)
    assert 0.0 < figures["compiled"] < 1.0
    assert figures["3"] > 0.0


class Clock:
    """A clock that only what is timed moves on."""

    def __init__(self):
        self.now = 0.0
        self.stepped = []

    def contestant(self, name, *seconds):
        """An environment whose steps take so long, the last of these again and again; to begin takes longer."""
        left = list(seconds)

        def step(actions):
            self.stepped.append((name, actions.shape))
            self.now += left.pop(0) if len(left) > 1 else left[0]

        def begin():
            self.now += 0.1

        return SimpleNamespace(step=step, close=lambda: self.stepped.append((name, "closed"))), [begin]


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(step_rates, "time", SimpleNamespace(perf_counter=lambda: clock.now))
    return clock


def test_who_takes_a_third_of_the_time_makes_three_times_as_many_steps_and_all_are_stepped_in_turn(brief, clock):
    # Of three rounds the first one warms up; the median of the others is 1 ms.
    contestants = {"quick": clock.contestant("a", 9.0, 0.5e-3, 1.5e-3), "slow": clock.contestant("b", 3e-3)}
    assert compare(contestants, 4) == {"quick": pytest.approx(4 / 1e-3), "slow": pytest.approx(4 / 3e-3)}
    assert clock.stepped == [("a", (4, 1)), ("b", (4, 1))] * 3 + [("a", "closed"), ("b", "closed")]


def test_one_round_out_of_many_that_is_disturbed_makes_no_difference(clock):
    contestants = {"disturbed": clock.contestant("a", 1e-3, 1e-3, 0.5, 1e-3)}
    assert compare(contestants, 1) == {"disturbed": pytest.approx(1e3)}


def test_more_threads_that_are_quicker_scale_by_more_than_one(monkeypatch):
    monkeypatch.setattr(step_rates, "make_native", lambda model, lanes, threads: threads)
    monkeypatch.setattr(step_rates, "available_processors", lambda: 4)
    rates = {1: 1000.0, 4: 3200.0}
    monkeypatch.setattr(
        step_rates, "compare", lambda made, lanes: {name: rates[env] for name, (env, _) in made.items()}
    )
    assert step_rates.measure_threads(MODEL) == {"threads": 3.2}


def test_the_tables_hold_every_figure():
    rates = {str(lanes): 1000.0 * lanes for lanes in step_rates.LANES}
    others = {"threads": 1.93, "compiled": 0.9, "SyncVectorEnv": 2.5, "SubprocVecEnv": 3.5}
    text = as_markdown({MODEL: rates | others})
    assert "| 1,000 | 2,000 | 16,000 | 64,000 | 256,000 |" in text
    assert "| 1.93 | 90.0% | 2.50 | 3.50 |" in text


def test_the_command_prints_and_writes_its_table(brief, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(step_rates, "measure_peers", lambda model: {"SyncVectorEnv": 2.0, "SubprocVecEnv": 3.0})
    assert main(["study", "throughput", "--only", MODEL, "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert numbers((tmp_path / "throughput.md").read_text()) <= numbers(printed)
    assert MODEL in printed


@pytest.mark.slow
def test_vectors_of_other_libraries_are_measured(monkeypatch):
    monkeypatch.setattr(step_rates, "ENOUGH", 0.1)
    assert all(ratio > 0.0 for ratio in step_rates.measure_peers(MODEL).values())
