"""Whether the kernels of an integrator are compiled already, and a word before they are."""

import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from solar_env.array.level import MODELS
from solar_env.array.methods import make_integrator


def kernels_are_compiled(integrator: str) -> bool:
    """Whether the cache holds the kernels of an integrator for these very sources, or none are to be compiled."""
    import numba

    return bool(numba.config.DISABLE_JIT) or _mark(integrator).exists()


def compilation_note(integrators: Iterable[str]) -> str:
    """A remark that the kernels of some integrators are compiled first; empty if all are compiled already."""
    return "" if all(map(kernels_are_compiled, integrators)) else " (compiles kernels first: minutes, this time alone)"


@cache
def announce_compilation(integrator: str) -> None:
    """Say on standard error, once a process, that kernels are going to be compiled."""
    if not kernels_are_compiled(integrator):
        note = f"solar_env compiles the kernels of {integrator}: minutes, this time alone; later runs load them"
        print(note, file=sys.stderr, flush=True)


@cache
def mark_compiled(integrator: str) -> None:
    """Remember that an integrator has run, and its kernels lie in the cache."""
    _mark(integrator).touch()


def _mark(integrator: str) -> Path:
    """File beside the kernels of the run."""
    from solar_env.mechanics.integrators import run
    from solar_env.mechanics.numerics.jit import cache_folder

    method = make_integrator(integrator, MODELS[0]).name
    return Path(cache_folder(Path(run.__file__).resolve())) / f"{method}.compiled"
