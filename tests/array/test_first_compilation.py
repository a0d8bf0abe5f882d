"""Whoever simulates from Python is told once that kernels are compiled, and never when they are there."""

from solar_env.array import compilation
from solar_env.array.deployment import simulate


def test_the_first_run_says_that_it_compiles_and_remembers_it(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(compilation, "_mark", lambda integrator: tmp_path / integrator)
    for function in (compilation.announce_compilation, compilation.mark_compiled):
        function.cache_clear()
    for _ in range(2):
        simulate(model="rigid-ideal", duration=0.01)
        compilation.announce_compilation.cache_clear()
    said = capsys.readouterr().err
    assert said.count("solar_env compiles the kernels of runge-kutta: minutes") == 1
    assert (tmp_path / "runge-kutta").exists()
    compilation.mark_compiled.cache_clear()
