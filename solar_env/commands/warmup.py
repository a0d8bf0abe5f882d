"""`solar-env warmup`: compile every kernel once, and show the progress."""

import multiprocessing
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass

from rich.console import Console

from solar_env.array import MODELS, ArrayParameters, ModelLevel, build, compilation_note, make_integrator, mark_compiled
from solar_env.mechanics.integrators.settings import INTEGRATORS, GeneralizedAlpha, ModalRadau, Rosenbrock, RungeKutta
from solar_env.support.interruption import starting_workers
from solar_env.support.progress import stage

# Integrators by compilation job, in order. The first two jobs share almost no kernels. Kernels that the last job shares
# with the first are compiled by then. The two integrators of the first job have the same kernels.
_ORDER = ((RungeKutta.name, Rosenbrock.name), (ModalRadau.name,), (GeneralizedAlpha.name,))


@dataclass
class Args:
    """Compile all kernels, which later runs load from the cache."""


def load_kernels(model: str, integrator: str) -> float:
    """Simulate 1 ms, so that a model's kernels for an integrator are compiled or loaded; return the wall time [s]."""
    from solar_env.mechanics.running.simulation import Simulation

    start, level = time.perf_counter(), ModelLevel.of(model)
    if level.flexible and integrator != ModalRadau.name:
        level = ModelLevel.of(f"{level.name}:6 elements")
    Simulation(build(ArrayParameters(), level), make_integrator(integrator, level)).advance(1e-3)
    mark_compiled(integrator)
    return time.perf_counter() - start


def load_all_models(integrators: Sequence[str]) -> dict[str, list[float]]:
    """Load the kernels of some integrators for every model level; return the wall times [s] by integrator."""
    return {integrator: [load_kernels(model, integrator) for model in MODELS] for integrator in integrators}


def compile_side_by_side() -> Iterator[tuple[str, list[float]]]:
    """Compile the kernels of all integrators in two processes.

    Yields:
        (name of an integrator, list of wall times [s] to compile or load from the cache, one per level in MODELS).
    """
    # Joblib, used elsewhere, will not do: it takes the memory of compiling for a leak, and restarts its workers.
    pool = ProcessPoolExecutor(2, multiprocessing.get_context("spawn"))
    try:
        with starting_workers():
            jobs = [pool.submit(load_all_models, integrators) for integrators in _ORDER]
        for job in as_completed(jobs):
            yield from job.result().items()
    except BaseException:
        for worker in multiprocessing.active_children():  # otherwise each would finish its present compilation
            worker.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def warm_up(console: Console, model: str, integrator: str) -> None:
    """Compile or load a model's kernels for an integrator, and show the name of this stage on a console."""
    with stage(console, f"loading kernels of {model}, {integrator}{compilation_note([integrator])}"):
        load_kernels(model, integrator)


def run_command(args: Args) -> int:
    """Compile the kernels of all models and integrators, and of the environments."""
    import gymnasium

    from solar_env.environment.registration import CURRENT

    console = Console()
    start = time.perf_counter()
    text = f"loading the kernels of all models{compilation_note(INTEGRATORS)}"
    with stage(console if console.is_interactive else Console(stderr=True), text):
        for integrator, times in compile_side_by_side():
            for model, seconds in zip(MODELS, times, strict=True):
                console.print(f"{model}, {integrator}: {seconds:.1f} s")
    for name in CURRENT:
        before = time.perf_counter()
        for model in MODELS:
            env = gymnasium.make(name, model=model)
            env.reset(seed=0)
            env.step(env.action_space.sample())
        console.print(f"{name}: {time.perf_counter() - before:.1f} s")
    console.print(f"all: {time.perf_counter() - start:.1f} s")
    return 0
