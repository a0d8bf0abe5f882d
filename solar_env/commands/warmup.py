"""``python -m solar_env warmup``: compile every kernel once and say that something is happening."""

from __future__ import annotations

import argparse
import multiprocessing
import time
from concurrent.futures import ProcessPoolExecutor, as_completed

from rich.console import Console

from ..array import MODELS, ArrayParameters, build
from ..integrators import make_integrator

# The two share few kernels, so that they are compiled side by side. "runge-kutta" has those of the first, "paper" those
# of the second.
_COMPILED_TOGETHER = ("rosenbrock", "generalized-alpha")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No options."""


def load_kernels(model: str, integrator: str) -> float:
    """Run a moment of a model so that its kernels are compiled or loaded; returns the wall time it took [s]."""
    from ..mechanics.simulation import Simulation

    start = time.perf_counter()
    Simulation(build(ArrayParameters(), model), make_integrator(integrator, model)).advance(1e-3)
    return time.perf_counter() - start


def load_all_models(integrator: str) -> list[float]:
    """:func:`load_kernels` for every model; the models share their kernels."""
    return [load_kernels(model, integrator) for model in MODELS]


def warm_up(console: Console, model: str, integrator: str) -> None:
    """Compile or load the kernels of a model, saying so."""
    with console.status(f"loading kernels of {model}, {integrator} (compiled the first time: up to three minutes)"):
        load_kernels(model, integrator)


def run_command(args: argparse.Namespace) -> int:
    """Compile the kernels of all models and integrators, those of the environments included."""
    import gymnasium

    from ..registration import ENVIRONMENTS

    console = Console()
    start = time.perf_counter()
    with (
        console.status("compiling the kernels of all models (one to three minutes; later runs load them)"),
        ProcessPoolExecutor(len(_COMPILED_TOGETHER), multiprocessing.get_context("spawn")) as pool,
    ):
        jobs = {pool.submit(load_all_models, integrator): integrator for integrator in _COMPILED_TOGETHER}
        for job in as_completed(jobs):
            for model, seconds in zip(MODELS, job.result(), strict=True):
                console.print(f"{model}, {jobs[job]}: {seconds:.1f} s")
    for name in ENVIRONMENTS:
        before = time.perf_counter()
        gymnasium.make(name).reset(seed=0)
        console.print(f"{name}: {time.perf_counter() - before:.1f} s")
    console.print(f"all: {time.perf_counter() - start:.1f} s")
    return 0
