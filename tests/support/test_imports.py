"""Modules that an import brings along, and those that it must not."""

from __future__ import annotations

from collections.abc import Callable

import pytest

PROGRAM = """
import sys
import {module}
for name in {unwanted!r}:
    if name in sys.modules:
        print(name)
"""

PUBLIC = (
    *("MODELS", "ArrayParameters", "GeneralizedAlpha", "Hardware", "Rosenbrock", "RungeKutta", "Simulation", "build"),
    *("SimulationError", "SimulationWarning", "SolarArrayEnv", "SolarArrayVectorEnv", "Trajectory", "simulate"),
)
HEAVY = ("numba", "torch", "stable_baselines3", "matplotlib", "tensorboard", "cma", "PIL", "scipy")


def loaded(run_python: Callable[..., str], module: str, unwanted: tuple[str, ...]) -> list[str]:
    return run_python(PROGRAM.format(module=module, unwanted=unwanted)).split()


def test_importing_the_package_brings_neither_compiler_nor_learning_nor_plotting(
    run_python: Callable[..., str],
) -> None:
    assert loaded(run_python, "solar_env", HEAVY) == []


def test_describing_a_mechanism_needs_no_compiler(run_python: Callable[..., str]) -> None:
    assert loaded(run_python, "solar_env.array", HEAVY) == []
    assert loaded(run_python, "solar_env.array.methods", HEAVY) == []


@pytest.mark.parametrize(
    "module", ["running.simulation", "integrators.methods.generalized_alpha", "running.trajectory", "equations.build"]
)
def test_the_simulator_knows_nothing_of_learning_or_drawing(run_python: Callable[..., str], module: str) -> None:
    # Importing the package itself registers its environments with Gymnasium: here the package is bypassed.
    program = """
import importlib.util, pathlib, sys, types
folder = pathlib.Path(importlib.util.find_spec("gymnasium").origin) and sys.argv[1]
package = types.ModuleType("solar_env")
package.__path__ = [folder]
sys.modules["solar_env"] = package
import importlib
importlib.import_module("solar_env.mechanics." + sys.argv[2])
print(*[name for name in ("gymnasium", "torch", "stable_baselines3", "matplotlib", "PIL") if name in sys.modules])
below = ("solar_env.mechanics", "solar_env.support")
print(*[name for name in sys.modules if name.startswith("solar_env.") and not name.startswith(below)])
"""
    from pathlib import Path

    import solar_env

    assert run_python(program, str(Path(solar_env.__file__).parent), module).split() == []


def test_public_names_are_all_there_and_load_on_first_use(run_python: Callable[..., str]) -> None:
    program = """
import sys, solar_env
assert "numba" not in sys.modules
print([name for name in {names!r} if not hasattr(solar_env, name)])
"""
    assert run_python(program.format(names=PUBLIC)).strip() == "[]"


def test_an_unknown_public_name_is_an_attribute_error() -> None:
    import solar_env

    with pytest.raises(AttributeError, match="'solar_env' has no attribute 'simulte'"):
        solar_env.simulte  # noqa: B018


def test_importing_the_package_registers_its_environments() -> None:
    import gymnasium

    from solar_env.environment.registration import DEPLOY_V1

    assert gymnasium.spec(DEPLOY_V1).entry_point == "solar_env.environment.env:SolarArrayEnv"
