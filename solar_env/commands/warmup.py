"""``python -m solar_env warmup``: compile every kernel once and say that something is happening."""

from __future__ import annotations

import argparse
import time

from rich.console import Console

from ..array import MODELS, ArrayParameters, build
from ..integrators import make_integrator


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No options."""


def warm_up(console: Console, model: str, integrator: str) -> float:
    """Run a moment of a model so that its kernels are compiled or loaded; returns the wall time it took [s]."""
    from ..mechanics.simulation import Simulation

    start = time.perf_counter()
    with console.status(f"loading kernels of {model}, {integrator} (the first time compiles them: a minute or two)"):
        chosen = make_integrator(integrator, model)
        Simulation(build(ArrayParameters(), model), chosen).advance(1e-3)
    return time.perf_counter() - start


def run_command(args: argparse.Namespace) -> int:
    """Compile the kernels of all models and integrators."""
    import gymnasium

    from ..registration import ENVIRONMENTS

    console = Console()
    for model in MODELS:
        for integrator in ("runge-kutta", "generalized-alpha"):
            console.print(f"{model}, {integrator}: {warm_up(console, model, integrator):.1f} s")
    for name in ENVIRONMENTS:
        start = time.perf_counter()
        gymnasium.make(name).reset(seed=0)
        console.print(f"{name}: {time.perf_counter() - start:.1f} s")
    return 0
