"""Whoever simulates from Python is told once that kernels are compiled, and never when they are there."""

import gymnasium
import numpy as np
import pytest

import solar_env  # noqa: F401 (registers the environments)
from solar_env.array import compilation
from solar_env.array.deployment import simulate

FUNCTIONS = (compilation.announce_compilation, compilation.mark_compiled)


@pytest.fixture
def nothing_compiled(monkeypatch, tmp_path):
    """As in a new process with an empty cache; the folder of the marks."""
    monkeypatch.setattr(compilation, "_mark", lambda integrator: tmp_path / integrator)
    for function in FUNCTIONS:
        function.cache_clear()
    yield tmp_path
    for function in FUNCTIONS:
        function.cache_clear()


def test_the_first_run_says_that_it_compiles_and_remembers_it(nothing_compiled, capsys):
    for _ in range(2):
        simulate(model="rigid-ideal", duration=0.01)
        compilation.announce_compilation.cache_clear()
    said = capsys.readouterr().err
    assert said.count("solar_env compiles the kernels of runge-kutta: minutes") == 1
    assert (nothing_compiled / "runge-kutta").exists()


@pytest.mark.parametrize("lanes", [0, 2], ids=["single", "vector"])
def test_the_first_episode_says_that_it_compiles_and_remembers_it(lanes, nothing_compiled, capsys):
    said = []
    for _ in range(2):
        make = gymnasium.make_vec if lanes else gymnasium.make
        env = make("solar_env/Deploy-v1", model="rigid-ideal", **({"num_envs": lanes} if lanes else {}))
        assert capsys.readouterr().err == "", "what is not simulated is not compiled"
        env.reset(seed=0)
        env.reset(seed=0)
        said.append(capsys.readouterr().err)
        env.step(np.zeros((lanes, 1) if lanes else 1, np.float32))
        env.close()
        compilation.announce_compilation.cache_clear()
    assert (nothing_compiled / "runge-kutta").exists()
    assert said[0].count("solar_env compiles the kernels of runge-kutta: minutes") == 1
    assert said[1] == ""
