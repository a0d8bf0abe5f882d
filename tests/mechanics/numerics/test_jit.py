"""The compiled kernels' cache: no edit may leave old code running."""

from __future__ import annotations

import ast
import errno
import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import pytest
from numba.core.caching import IndexDataCacheFile

import solar_env
from solar_env.mechanics.numerics.jit import KernelCache, cache_folder, cache_root, kernel_sources

PROGRAM = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from solar_env.mechanics.numerics import jit
assert jit.__file__.startswith(sys.argv[1])
print(jit.cache_folder(Path(sys.argv[1]).resolve() / "solar_env" / sys.argv[2]))
"""
needs_compiler = pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
ROOT = Path(solar_env.__file__).resolve().parent
COMPILING = [path for path in sorted(ROOT.rglob("*.py")) if "@kernel" in path.read_text(encoding="utf-8")]


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A folder with a copy of the package that may be edited."""
    shutil.copytree(ROOT, tmp_path / "copy" / "solar_env", ignore=shutil.ignore_patterns("__pycache__", "figures"))
    return tmp_path / "copy"


@pytest.fixture
def cache_of(package: Path, tmp_path: Path, run_python: Callable[..., str]) -> Callable[[str], Path]:
    def found(name: str) -> Path:
        environment = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
        return Path(run_python(PROGRAM, str(package), name, **environment).strip())

    return found


def test_every_kernel_that_a_run_calls_stands_behind_the_drivers_cache() -> None:
    drivers = ("mechanics/integrators/run.py", "environment/task/periods.py")
    behind = {path for driver in drivers for path in kernel_sources(ROOT / driver)}
    assert len(COMPILING) > 15
    assert behind >= set(COMPILING)


@pytest.mark.parametrize("path", COMPILING, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_the_sources_of_a_kernel_are_those_that_its_module_imports(path: Path) -> None:
    imported: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("solar_env"):
            imported |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    files = {ROOT.parent.joinpath(*name.split(".")).with_suffix(".py") for name in imported}
    assert {file for file in files if file.is_file()} <= set(kernel_sources(path))


@pytest.mark.parametrize("name", ["numerics/linear.py", "equations/system.py"])
def test_an_edit_of_what_a_kernel_calls_changes_its_cache_folder(
    package: Path, cache_of: Callable[[str], Path], tmp_path: Path, name: str
) -> None:
    driver = "mechanics/integrators/run.py"
    before = cache_of(driver)
    assert before.parent == tmp_path / "cache"
    assert before.is_dir()
    assert cache_of(driver) == before
    path = package / "solar_env" / "mechanics" / name
    path.write_text(path.read_text() + "\n# edited\n")
    after = cache_of(driver)
    assert after != before
    assert after.parent == before.parent


def test_an_edit_of_what_a_kernel_does_not_call_keeps_its_cache(package: Path, cache_of: Callable[[str], Path]) -> None:
    driver = "mechanics/integrators/run.py"
    before, before_task = cache_of(driver), cache_of("environment/task/control.py")
    for name in ("array/construction.py", "environment/task/control.py"):
        path = package / "solar_env" / name
        path.write_text(path.read_text() + "\n# edited\n")
    assert cache_of(driver) == before
    assert cache_of("environment/task/control.py") != before_task


KERNEL = """
import sys
sys.path.insert(0, sys.argv[1])
from solar_env.mechanics.joints.wear import pressed_half_angle
print(pressed_half_angle(1e-4, 1e-4))
"""


def test_an_edited_kernel_runs_as_edited(package: Path, tmp_path: Path, run_python: Callable[..., str]) -> None:
    environment = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    before = float(run_python(KERNEL, str(package), **environment))
    path = package / "solar_env" / "mechanics" / "joints" / "wear.py"
    path.write_text(path.read_text().replace("return math.acos(", "return 2.0 * math.acos("))
    assert float(run_python(KERNEL, str(package), **environment)) == pytest.approx(2.0 * before, rel=1e-15)


def cached(function: Callable[..., Any], folder: Path) -> Any:
    """A function that is compiled, with a cache in a folder."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numba.config, "CACHE_DIR", str(folder))
        compiled = numba.njit(function)
        compiled._cache = KernelCache(function)
    return compiled


def double(x: float) -> float:
    return 2.0 * x


@needs_compiler
@pytest.mark.parametrize("ending", [".nbi", ".nbc"])
def test_a_truncated_cache_is_compiled_anew_and_holds_from_then_on(tmp_path: Path, ending: str) -> None:
    def hits() -> int:
        compiled = cached(double, tmp_path)
        assert compiled(2.0) == 4.0
        return sum(compiled.stats.cache_hits.values())

    assert [hits(), hits()] == [0, 1]
    (path,) = tmp_path.glob(f"*{ending}")
    path.write_bytes(path.read_bytes()[:100])
    assert [hits(), hits()] == [0, 1]


@needs_compiler
def test_a_full_disk_costs_the_cache_and_not_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(IndexDataCacheFile, "_save_index", full)
    compiled = cached(double, tmp_path)
    with pytest.warns(UserWarning, match="could not be kept"):
        assert compiled(2.0) == 4.0


@needs_compiler
def test_compiled_kernels_are_found_again_wherever_the_package_lies(
    package: Path, tmp_path: Path, run_python: Callable[..., str]
) -> None:
    environment = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    program = f"{KERNEL}print(sum(pressed_half_angle.from_python.stats.cache_hits.values()))"
    run_python(program, str(package), **environment)
    moved = shutil.copytree(package, tmp_path / "elsewhere", copy_function=shutil.copyfile)
    assert run_python(program, str(moved), **environment).split()[1] == "1"


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="permissions of POSIX")
def test_a_folder_of_kernels_that_others_can_write_is_refused_and_one_that_cannot_be_made_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    folder = Path(cache_folder.__wrapped__(COMPILING[0]))
    assert folder.stat().st_mode & 0o777 == folder.parent.stat().st_mode & 0o777 == 0o700
    for place in (folder, folder.parent):
        place.chmod(0o777)
        with pytest.raises(OSError, match=f"others can write in {place}, .* set NUMBA_CACHE_DIR"):
            cache_folder.__wrapped__(COMPILING[0])
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file" / "below"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert cache_root().parent == tmp_path, "where the chosen one cannot be made, a temporary one"


def test_the_compilers_own_settings_are_left_alone() -> None:
    assert cache_folder(COMPILING[0]) != numba.config.CACHE_DIR


TWO_KERNELS = """
from solar_env.mechanics.numerics.jit import kernel

@kernel
def called(x):
    return 2.0 * x

@kernel
def caller(x):
    return called(x) + 1.0
"""
CALLS = """
import sys
sys.path.insert(0, sys.argv[1])
from solar_env.kernels import called, caller
print(caller(2.0), len(called.signatures), len(called.from_python.signatures))
print(called(2.0), len(called.from_python.signatures))
"""


@needs_compiler
def test_a_kernel_is_compiled_for_kernels_and_for_python_when_these_call_it(
    package: Path, tmp_path: Path, run_python: Callable[..., str]
) -> None:
    (package / "solar_env" / "kernels.py").write_text(TWO_KERNELS)
    printed = run_python(CALLS, str(package), NUMBA_CACHE_DIR=str(tmp_path / "cache")).split()
    assert printed == ["5.0", "1", "0", "4.0", "1"]
