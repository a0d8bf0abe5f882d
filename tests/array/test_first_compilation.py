"""Whoever simulates from Python is told once that kernels are compiled, and never when they are there."""

import gymnasium
import numpy as np
import pytest

import solar_env  # noqa: F401 (registers the environments)
from solar_env.__main__ import main
from solar_env.array import methods as compilation
from solar_env.environment.registration import DEPLOY_V1

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


@pytest.mark.parametrize("lanes", [0, 2], ids=["single", "vector"])
def test_the_first_episode_says_that_it_compiles_and_remembers_it(lanes, nothing_compiled, capsys):
    said = []
    for _ in range(2):
        make = gymnasium.make_vec if lanes else gymnasium.make
        env = make(DEPLOY_V1, model="rigid-ideal", **({"num_envs": lanes} if lanes else {}))
        assert capsys.readouterr().err == "", "what is not simulated is not compiled"
        env.reset(seed=0)
        env.reset(seed=0)
        said.append(capsys.readouterr().err)
        env.step(np.zeros((lanes, 1) if lanes else 1, np.float32))
        env.close()
        compilation.announce_compilation.cache_clear()
    assert (nothing_compiled / "runge-kutta").exists()
    assert said[0].count("solar_env compiles the kernels of runge-kutta: about two minutes") == 1
    assert said[1] == ""


def test_commands_say_that_kernels_are_compiled_where_they_are_not_there_yet(nothing_compiled, capsys):
    told = []
    for _ in range(2):
        assert main(["simulate", "--duration", "0.1"]) == 0
        told.append(capsys.readouterr().err.splitlines())
    loading = "loading kernels of rigid-clearance, runge-kutta"
    assert told[0][0] == f"{loading} (compiles kernels first: minutes, this time alone)"
    assert told[1][0] == loading
    assert told[0][1:] == told[1][1:] == []
