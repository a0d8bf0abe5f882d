"""The compiled kernels' cache: no edit may leave old code running."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import solar_env

PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from solar_env.mechanics.numerics import jit
assert jit.__file__.startswith(sys.argv[1])
print(jit._CACHE_DIRECTORY)
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A folder with a copy of the package that may be edited."""
    source = Path(solar_env.__file__).parent
    shutil.copytree(source, tmp_path / "copy" / "solar_env", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "copy"


@pytest.fixture
def cache_of(package: Path, tmp_path: Path, run_python: Callable[..., str]) -> Callable[[], Path]:
    def found() -> Path:
        environment = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
        return Path(run_python(PROGRAM, str(package), **environment).strip())

    return found


@pytest.mark.parametrize(
    "name",
    [
        "mechanics/numerics/linear.py",
        "mechanics/arrays/model.py",
        "mechanics/bodies/rigid.py",
        "mechanics/joints/contact.py",
        "mechanics/equations/system.py",
        "mechanics/integrators/adaptive.py",
        "environment/task.py",
    ],
)
def test_editing_a_kernels_source_changes_the_cache_folder(
    package: Path, cache_of: Callable[[], Path], tmp_path: Path, name: str
) -> None:
    before = cache_of()
    assert before.parent == tmp_path / "cache"
    assert before.is_dir()
    assert cache_of() == before
    path = package / "solar_env" / name
    path.write_text(path.read_text() + "\n# edited\n")
    after = cache_of()
    assert after != before
    assert after.parent == before.parent


def test_editing_what_holds_no_kernel_keeps_the_cache(package: Path, cache_of: Callable[[], Path]) -> None:
    before = cache_of()
    path = package / "solar_env" / "array" / "construction.py"
    path.write_text(path.read_text() + "\n# edited\n")
    assert cache_of() == before


def test_every_module_that_compiles_is_watched() -> None:
    from solar_env.mechanics.numerics.jit import _kernel_sources

    root = Path(solar_env.__file__).parent
    compiling = {path for path in root.rglob("*.py") if "@njit" in path.read_text()}
    assert len(compiling) > 5
    assert compiling <= set(_kernel_sources())


STALE = """
import sys
sys.path.insert(0, sys.argv[1])
from solar_env.mechanics.joints.wear import pressed_half_angle
print(pressed_half_angle(1e-4, 1e-4))
"""


def test_an_edited_kernel_runs_as_edited(package: Path, tmp_path: Path, run_python: Callable[..., str]) -> None:
    environment = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    before = float(run_python(STALE, str(package), **environment))
    path = package / "solar_env" / "mechanics" / "joints" / "wear.py"
    path.write_text(path.read_text().replace("return math.acos(", "return 2.0 * math.acos("))
    assert float(run_python(STALE, str(package), **environment)) == pytest.approx(2.0 * before, rel=1e-15)


def test_a_folder_that_cannot_be_written_is_replaced_by_a_temporary_one(
    package: Path, tmp_path: Path, run_python: Callable[..., str]
) -> None:
    # A file stands where the folder should be.
    (tmp_path / "cache").write_text("")
    environment = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "TMPDIR": str(tmp_path)}
    folder = Path(run_python(PROGRAM, str(package), **environment).strip())
    assert folder.is_dir()
    assert tmp_path in folder.parents


def test_the_compilers_own_settings_are_left_alone() -> None:
    import numba

    from solar_env.mechanics.numerics import jit

    assert numba.config.CACHE_DIR != jit._CACHE_DIRECTORY
