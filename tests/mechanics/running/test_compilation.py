"""Kernels compiled ahead are the ones that a run calls."""

from __future__ import annotations

from pathlib import Path

import pytest
from numba.core.dispatcher import Dispatcher

from solar_env.array import ArrayParameters, build
from solar_env.array.methods import make_integrator
from solar_env.commands.warmup import PARTS, compile_part
from solar_env.mechanics.integrators.methods.rosenbrock_step import attempt_implicit
from solar_env.mechanics.integrators.methods.stiff_forces import begin_step
from solar_env.mechanics.modal.solve import solve_step
from solar_env.mechanics.records.recording import record_sample
from solar_env.mechanics.running.simulation import Simulation


@pytest.mark.parametrize("kernel", [attempt_implicit, begin_step, record_sample, solve_step])
def test_compiling_ahead_and_running_share_one_version_of_a_kernel(kernel: Dispatcher) -> None:
    for part in PARTS:
        compile_part(part)
    for name in ("rosenbrock", "modal-radau"):
        Simulation(build(ArrayParameters(), "rigid-ideal"), make_integrator(name, "rigid-ideal")).advance(1e-3)
    module = kernel.py_func.__module__.rpartition(".")[2]
    compiled = Path(kernel.stats.cache_path).glob(f"{module}.{kernel.py_func.__name__}-*.nbc")
    assert len(list(compiled)) == 1
