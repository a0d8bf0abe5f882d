"""The kernels in parts that two processes can compile side by side; the on-disk cache is where they meet."""

from __future__ import annotations

import numba
import numpy as np

from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.integrators.adaptive import make_adaptive_arrays, record_until, refresh
from solar_env.mechanics.integrators.events import NONE, begin_event
from solar_env.mechanics.integrators.recording import make_recorder
from solar_env.mechanics.integrators.rosenbrock import attempt_rosenbrock
from solar_env.mechanics.integrators.runge_kutta import AdaptiveSettings
from solar_env.mechanics.integrators.stiff_forces import begin_step
from solar_env.mechanics.mechanism.description import Mechanism


def compile_evaluation(mechanism: Mechanism) -> None:
    """Compile, or load, the evaluation of the equations of motion, and what a step does before and after it."""
    model, state = compile_mechanism(mechanism)
    arrays = make_adaptive_arrays(model, state)
    refresh(model, state, arrays.stages, arrays.work)
    _compile(begin_step, model, state, arrays.work, arrays.stiff, state.a, 1e-3)
    _compile(begin_event, model, state, NONE, NONE, arrays.scratch)
    recorder = make_recorder(model, state, np.zeros(0), 0)
    _compile(record_until, model, state, arrays.stages, arrays.stiff, arrays.scratch, recorder, 1e-3, 1e-3)


def compile_linear_step(mechanism: Mechanism) -> None:
    """Compile, or load, the linearly implicit step, and with it the tangents and factors of all implicit methods."""
    model, state = compile_mechanism(mechanism)
    arrays = make_adaptive_arrays(model, state)
    settings = AdaptiveSettings(1e-4, 1.0, 1.0, 1.0, 1, 1)
    _compile(attempt_rosenbrock, model, state, arrays.stages, arrays.step, arrays.work, settings, 1e-3)


def _compile(kernel: numba.core.dispatcher.Dispatcher, *arguments: object) -> None:
    """Compile or load a kernel for arguments like these without calling it: inner kernels have no way in."""
    kernel.compile(tuple(numba.typeof(argument) for argument in arguments))
