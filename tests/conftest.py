"""Fixtures of all tests: compiled kernels, and a fresh interpreter for claims about processes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import pytest
from hypothesis import HealthCheck, settings
from platformdirs import user_cache_path

import solar_env

# Kernels of the tests' own: the user's cache is neither asked nor filled.
os.environ.setdefault("NUMBA_CACHE_DIR", str(user_cache_path("solar_env_tests", appauthor=False)))
os.environ["SDL_VIDEODRIVER"] = "dummy"  # windows without a display
signal.signal(signal.SIGINT, signal.default_int_handler)  # shells let commands in the background ignore Ctrl-C
PACKAGE_PARENT = Path(solar_env.__file__).resolve().parent.parent

# The option --hypothesis-profile is read before any module of tests.
usual = {"deadline": None, "suppress_health_check": list(HealthCheck), "print_blob": True}
settings.register_profile("suite", max_examples=15, derandomize=True, database=None, **usual)
settings.register_profile("night", max_examples=3400, **usual)
settings.load_profile("suite")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile the kernels if they are not in the cache, and say so: it takes minutes.

    Where tests are distributed over processes, this is done before those begin.
    """
    if hasattr(session.config, "workerinput") or session.config.option.collectonly:
        return
    from solar_env.array.methods import kernels_are_compiled
    from solar_env.commands.warmup import compile_side_by_side
    from solar_env.mechanics.integrators.settings import INTEGRATORS

    if not all(kernels_are_compiled(integrator) for integrator in INTEGRATORS):
        reporter = session.config.pluginmanager.get_plugin("terminalreporter")
        reporter.write_line("compiling the kernels, which takes two to four minutes the first time ...")
        start = time.perf_counter()
        list(compile_side_by_side())
        reporter.write_line(f"kernels compiled in {time.perf_counter() - start:.0f} s")


@pytest.fixture(scope="session", autouse=True)
def kernels() -> None:
    """Load the compiled kernels once, where there is a compiler."""
    if numba.config.DISABLE_JIT:
        return
    from solar_env.commands.warmup import load_all_models
    from solar_env.mechanics.integrators.settings import INTEGRATORS

    load_all_models(tuple(INTEGRATORS))


@pytest.fixture(scope="session")
def run_python() -> Callable[..., str]:
    """Run a program in a fresh interpreter that finds the package, and return what it prints."""

    def run(program: str, *arguments: str, **environment: str) -> str:
        done = subprocess.run(
            [sys.executable, "-W", "error", "-c", program, *arguments],
            env={**os.environ, "PYTHONPATH": str(PACKAGE_PARENT), **environment},
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture
def saved_figures(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The figures that are written, to look into."""
    from matplotlib.figure import Figure

    figures: list[Any] = []
    write = Figure.savefig

    def keep(self: Figure, *args: Any, **kwargs: Any) -> None:
        figures.append(self)
        write(self, *args, **kwargs)

    monkeypatch.setattr(Figure, "savefig", keep)
    return figures


@pytest.fixture
def configs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of configurations of its own, with a damper tuned for two of the models."""
    from agents.laws import baselines
    from solar_env.environment.registration import DEPLOY, DEPLOY_V1

    monkeypatch.setattr(baselines, "CONFIGS", tmp_path)
    dampings = {"rigid-clearance": 0.1, "flexible-clearance": 0.2}
    tuned = {model: {"parameters": {"damping": d, "settling_damping": 0.0}} for model, d in dampings.items()}
    (tmp_path / "damper.json").write_text(json.dumps(dict.fromkeys((DEPLOY_V1, DEPLOY), tuned)))
    return tmp_path
