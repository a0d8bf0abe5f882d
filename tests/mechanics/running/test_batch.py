"""Lanes side by side: what is refused, what a lane owes to the others (nothing), and what is said of it."""

from __future__ import annotations

import threading
import time
import warnings
from collections.abc import Callable

import numpy as np
import pytest
from helpers import fingerprint

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, Rosenbrock, RungeKutta
from solar_env.mechanics.running import batch as module
from solar_env.mechanics.running.batch import Batch
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation

LANES = np.arange(3)


def lane(integrator: Integrator | None = None, **parameters: float) -> Simulation:
    return Simulation(build(ArrayParameters(**parameters)), integrator)


def lanes() -> list[Simulation]:
    """Three arrays of other springs."""
    return [lane(spring_stiffness=0.1 * (k + 1)) for k in range(3)]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Batch([]), "a batch needs at least one simulation"),
        (lambda: Batch([lane()], threads=0), "threads = 0 must be at least 1"),
        (lambda: Batch([lane(), lane(GeneralizedAlpha())]), r"integrates with RungeKutta\(.*, not with Generalized"),
        (lambda: Batch([lane(), lane(Rosenbrock(rtol=1e-6))]), r"integrates with RungeKutta\(.*, not with Rosenbrock"),
        (lambda: Batch([lane(), lane(RungeKutta(rtol=1e-7))]), r"rtol=1e-06, .*, not with RungeKutta\(rtol=1e-07"),
        (lambda: Batch([lane(), lane(wear_bins=7)]), r"wear_journal of shape \(2, 7\), the others .* \(2, 360\)"),
        (lambda: Batch([lane(), lane(panel_count=3)]), r"bodies of shape \(4,\), the others of the batch \(3,\)"),
    ],
)
def test_what_cannot_be_a_batch_is_refused(make: Callable[[], Batch], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_lanes_that_are_not_named_stay_where_they_are() -> None:
    batch = Batch(lanes())
    before = fingerprint(batch.simulations[1].state)
    batch.advance(np.array([2, 0]), np.array([0.2, 0.3, 0.4]))
    assert [simulation.time for simulation in batch.simulations] == [0.2, 0.0, 0.4]
    assert fingerprint(batch.simulations[1].state) == before


@pytest.mark.parametrize("other", [lambda: lane(RungeKutta(rtol=1e-3)), lambda: lane(wear_bins=7)])
def test_a_refused_replacement_leaves_the_lane_that_was_there(other: Callable[[], Simulation]) -> None:
    batch, refused, alone = Batch(lanes()), other(), lanes()
    was_there = batch.simulations[1]
    batch.advance(LANES, np.full(3, 0.2))
    with pytest.raises(ValueError, match="the batch"):
        batch.replace(1, refused)
    batch.advance(LANES, np.full(3, 0.5))
    assert batch.simulations[1] is was_there
    assert np.shares_memory(was_there.state.q, batch.states.q)
    alone[1].advance(0.2)
    alone[1].advance(0.5)
    assert fingerprint(was_there.state) == fingerprint(alone[1].state)
    refused.advance(0.1)
    assert was_there.time == 0.5


def test_a_replaced_simulation_goes_on_alone() -> None:
    batch, alone = Batch(lanes()), lanes()
    before, after = batch.simulations[1], lane(spring_stiffness=0.7)
    batch.replace(1, after)
    batch.advance(LANES, np.full(3, 0.2))
    assert (before.time, after.time) == (0.0, 0.2)
    for simulation in (before, alone[1]):
        simulation.advance(0.4)
    assert fingerprint(before.state) == fingerprint(alone[1].state)
    assert after.time == 0.2


def test_an_open_energy_book_is_told_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "STEPS_BETWEEN_LOOKS", 10)
    batch = Batch(lanes())
    batch.simulations[1].state.clock["initial_energy"] += 1.0
    with pytest.warns(SimulationWarning, match="accounts for") as told:
        batch.advance(LANES, np.full(3, 1.0))
    assert len(told) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        batch.advance(LANES, np.full(3, 2.0))


def test_between_looks_nothing_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    looked = []
    monkeypatch.setattr(module, "STEPS_BETWEEN_LOOKS", 400)
    monkeypatch.setattr(Simulation, "check", lambda simulation: looked.append(simulation))
    batch = Batch(lanes()[:1])
    for k in range(60):
        batch.advance(LANES[:1], np.full(1, 0.05 * (k + 1)))
    steps = int(batch.states.clock["steps"][0, 0])
    assert 2 <= len(looked) <= steps // 400


@pytest.mark.parametrize("threads", [1, 2])
def test_the_others_arrive_when_a_lane_fails_and_the_error_names_it(threads: int) -> None:
    batch = Batch(lanes(), threads)
    batch.advance(LANES, np.full(3, 0.1))
    batch.simulations[1].set_motor_torque(0, 1e308)
    with pytest.raises(SimulationError, match="the state is no longer finite") as caught:
        batch.advance(LANES, np.array([0.3, 0.4, 0.5]))
    assert caught.value.__notes__ == ["in lane 1 of the batch"]
    assert (batch.simulations[0].time, batch.simulations[2].time) == (0.3, 0.5)
    assert caught.value.time == batch.simulations[1].time < 0.4
    # A failure of one call is none of the next one.
    batch.simulations[1].set_motor_torque(0, 0.0)
    batch.advance(LANES, np.full(3, 0.6))
    assert [simulation.time for simulation in batch.simulations] == [0.6, 0.6, 0.6]


def test_of_several_failures_the_first_lane_is_told_and_the_others_are_named() -> None:
    batch = Batch(lanes())
    batch.advance(LANES, np.array([0.1, 0.15, 0.2]))
    for k in (2, 1):
        batch.simulations[k].set_motor_torque(0, 1e308)
    with pytest.raises(SimulationError) as caught:
        batch.advance(LANES[::-1].copy(), np.full(3, 0.3))
    assert caught.value.__notes__ == ["in lane 1 of the batch, and others in [2]"]
    assert caught.value.time == batch.simulations[1].time < batch.simulations[2].time
    assert batch.simulations[0].time == 0.3


def test_other_threads_of_python_go_on_while_lanes_advance() -> None:
    batch = Batch([lane()], threads=1)
    ticks, over = [], threading.Event()

    def tick() -> None:
        while not over.wait(1e-3):
            ticks.append(time.perf_counter())

    ticker = threading.Thread(target=tick)
    ticker.start()
    start = time.perf_counter()
    batch.advance(LANES[:1], np.full(1, 30.0))
    end = time.perf_counter()
    over.set()
    ticker.join()
    # With the interpreter's lock held there would be one at either end.
    assert sum(start < moment < end for moment in ticks) > 10
