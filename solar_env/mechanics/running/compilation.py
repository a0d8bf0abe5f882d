"""The kernels in parts that two processes can compile side by side; the on-disk cache is where they meet."""

import numba
import numpy as np

from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.integrators.methods.rosenbrock_step import attempt_implicit
from solar_env.mechanics.integrators.methods.stages import refresh
from solar_env.mechanics.integrators.methods.stiff_forces import begin_step
from solar_env.mechanics.integrators.methods.table import METHODS, method_of
from solar_env.mechanics.integrators.settings import ModalRadau, Rosenbrock
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.solve import solve_step
from solar_env.mechanics.records.recording import make_recorder, record_sample


def compile_evaluation(mechanism: Mechanism) -> None:
    """Compile, or load, the evaluation of the equations of motion, and what a step does before and after it."""
    model, state = compile_mechanism(mechanism)
    _, _, work, scratch, stages, own = METHODS[Rosenbrock.name].arrays(model, state)
    refresh(model, state, stages, work)
    _compile(begin_step, model, state, work, own.stiff, state.a, 1e-3)
    sample = (state.q, state.v, 1e-3, state.integrals, scratch, state.a, state.multipliers, stages.energies)
    _compile(record_sample, make_recorder(model, state, np.zeros(0), 0), model, state.joints, *sample)


def compile_linear_step(mechanism: Mechanism) -> None:
    """Compile, or load, the linearly implicit step, and with it the tangents and factors of all implicit methods."""
    model, state = compile_mechanism(mechanism)
    settings = method_of(Rosenbrock()).convert(Rosenbrock())
    _, _, work, _, stages, own = METHODS[Rosenbrock.name].arrays(model, state)
    _compile(attempt_implicit, model, state, stages, own.step, work, settings, 1e-3)


def compile_modal_step(mechanism: Mechanism) -> None:
    """Compile, or load, the solution of a step on the loads of the joints."""
    model, state = METHODS[ModalRadau.name].formulation.compile(mechanism)
    settings, work = method_of(ModalRadau()).convert(ModalRadau()), METHODS[ModalRadau.name].arrays(model, state)
    _compile(solve_step, model, state, work, settings, model.tables, np.int64(0), 1e-3)


def _compile(kernel: numba.core.dispatcher.Dispatcher, *arguments: object) -> None:
    """Compile or load a kernel for arguments like these without calling it: inner kernels have no way in."""
    kernel.compile(tuple(numba.typeof(argument) for argument in arguments))
