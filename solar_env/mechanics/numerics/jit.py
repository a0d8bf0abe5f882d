"""The project's ``njit``: Numba with an on-disk cache that cannot go stale.

Numba's own cache notices an edit of the file that holds a function, but not of the files whose functions it
calls; cached callers would go on running the old code. Here the cache folder carries a hash of every source
file that holds kernels, so that any edit compiles afresh.
"""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

_PACKAGE = Path(__file__).resolve().parents[2]


def _kernel_sources() -> list[Path]:
    """Files that hold kernels, and what these import of the package: constants and array types are compiled in."""
    texts = {path: path.read_text(encoding="utf-8") for path in _PACKAGE.rglob("*.py")}
    found: set[Path] = set()
    waiting = [path for path, text in texts.items() if "@njit" in text]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting += [other for other in _imported(texts[path]) if other in texts]
    return sorted(found)


def _imported(text: str) -> list[Path]:
    """Files that a module of the package may import from it: each name may be that of a module, too."""
    paths = []
    for module, names in re.findall(rf"^from {_PACKAGE.name}\.([\w.]+) import (\([^)]*\)|.*)$", text, re.MULTILINE):
        base = _PACKAGE.joinpath(*module.split("."))
        paths += [base.with_suffix(".py"), *((base / name).with_suffix(".py") for name in re.findall(r"\w+", names))]
    return paths


def _cache_directory() -> str:
    digest = hashlib.sha256()
    for source in _kernel_sources():
        digest.update(source.relative_to(_PACKAGE).as_posix().encode())
        digest.update(source.read_bytes())
    base = os.environ.get("NUMBA_CACHE_DIR") or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache"), "solar_env"
    )
    name = digest.hexdigest()[:16]
    for root in (base, os.path.join(tempfile.gettempdir(), "solar_env")):
        folder = os.path.join(root, name)
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    raise OSError(f"no writable folder for compiled kernels (tried {base!r}); set NUMBA_CACHE_DIR to one")


_CACHE_DIRECTORY = _cache_directory()


def _compile(function: Callable[..., Any], **options: Any) -> Any:
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = _CACHE_DIRECTORY
    try:
        return numba.njit(
            cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, no_cfunc_wrapper=True, **options
        )(function)
    finally:
        numba.config.CACHE_DIR = previous


def njit(function: Callable[..., Any]) -> Any:
    """Compile a kernel in nopython mode, without the interpreter lock, cached under the hash of all kernel sources.

    The kernel may not allocate. In exchange it does no reference counting, which would otherwise cost two atomic
    operations for every field taken out of a tuple of arrays: more than half of the run time of small mechanisms.
    """
    return _compile(function, _nrt=False)


def njit_inner(function: Callable[..., Any]) -> Any:
    """Like :func:`njit`, for kernels that only kernels call: leaving out the way in from Python saves compile time."""
    return _compile(function, _nrt=False, no_cpython_wrapper=True)


def njit_inner_inlined(function: Callable[..., Any]) -> Any:
    """Like :func:`njit_inlined`, for kernels that only kernels call."""
    return _compile(function, _nrt=False, forceinline=True, no_cpython_wrapper=True)


def njit_merged(function: Callable[..., Any]) -> Any:
    """Like :func:`njit`, for kernels with one caller: they are compiled as a part of it only, which saves time."""
    return _compile(function, _nrt=False, inline="always")


def njit_inlined(function: Callable[..., Any]) -> Any:
    """Like :func:`njit`, for the innermost functions: LLVM inlines them, which spares passing tuples of arrays."""
    return _compile(function, _nrt=False, forceinline=True)
