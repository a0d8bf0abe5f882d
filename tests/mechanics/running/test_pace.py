"""Compiled calls come back to Python often, which changes nothing and lets Ctrl-C through."""

import os
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers import fingerprint

from solar_env.array import MODELS, ArrayParameters, build
from solar_env.array.methods import default_integrator
from solar_env.mechanics.integrators.methods.table import METHODS
from solar_env.mechanics.integrators.settings import INTEGRATORS
from solar_env.mechanics.running.batch import Batch
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation, simulate

# Impacts within the first 0.1 s, and many of them.
ARRAY = ArrayParameters(clearance=1e-5, spring_stiffness=2.0)


def simulation(model: str, integrator: Any = None, array: ArrayParameters = ARRAY) -> Simulation:
    if model.startswith("flexible") and integrator is not None and integrator.name != "modal-radau":
        model += ":6 elements"
    return Simulation(build(array, model), integrator or default_integrator(model))


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("model", MODELS)
def test_how_often_a_call_comes_back_changes_no_bit(name: str, model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    ends = []
    for steps in (7, 1_000_000):
        monkeypatch.setattr("solar_env.mechanics.running.simulation.STEPS_PER_CALL", steps)
        run = simulation(model, INTEGRATORS[name]().with_options(1e-5, None))
        for end in (0.04, 0.1):
            run.advance(end)
        ends.append((fingerprint(run.state), run.state.clock["steps"].tolist()))
    assert run.state.clock["steps"] > 5
    assert ends[0] == ends[1]


def test_a_bound_on_steps_holds_over_all_that_a_call_consists_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solar_env.mechanics.running.simulation.STEPS_PER_CALL", 16)
    run = simulation("rigid-clearance", replace(INTEGRATORS["runge-kutta"](), max_steps=100))
    with pytest.raises(SimulationError, match=r"100 steps were taken in one call .* raise max_steps"):
        run.advance(30.0)
    assert 90 <= run.state.clock["steps"][0] + run.state.clock["rejected_steps"][0] <= 100
    batch = Batch([run, simulation("rigid-clearance", run.integrator)])
    with pytest.raises(SimulationError, match=r"100 steps were taken in one call"):
        batch.advance(np.arange(2), np.full(2, 30.0))


def one(model: str) -> Callable[[], object]:
    run = simulation(model, replace(default_integrator(model), max_steps=10**12))
    return lambda: run.advance(1e9)


def whole_run() -> Callable[[], object]:
    return lambda: simulate(build(ARRAY), 1e5, output_step=1e3)


def many() -> Callable[[], object]:
    integrator = replace(default_integrator("rigid-clearance"), max_steps=10**12)
    batch = Batch([simulation("rigid-clearance", integrator) for _ in range(300)], 2)
    return lambda: batch.advance(np.arange(300), np.full(300, 1e9))


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="signals of POSIX")
@pytest.mark.parametrize(
    "make", [lambda: one("rigid-clearance"), lambda: one("flexible-clearance"), whole_run, many],
    ids=["rigid", "modal", "simulate", "batch"],
)  # fmt: skip
def test_ctrl_c_ends_a_compiled_call_soon(make: Callable[[], Callable[[], object]]) -> None:
    call = make()
    pressed: list[float] = []

    def press() -> None:
        pressed.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.5, press)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        call()
    assert time.perf_counter() - pressed[0] < 2.0
