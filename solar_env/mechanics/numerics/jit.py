"""The project's kernels: compiled by Numba with an on-disk cache that cannot go stale.

Numba's own cache notices an edit of the file that holds a function, but not of the files whose functions it
calls; cached callers would go on running the old code. Here the cache folder of a kernel carries a hash of its source
file and of every file of the package that this imports, so that any edit compiles afresh what depends on it.
"""

import hashlib
import re
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba

from solar_env.mechanics.numerics.kernel_cache import KernelCache, cache_root, private_folder

_PACKAGE = Path(__file__).resolve().parents[2]


@cache
def imported_files(path: Path) -> tuple[Path, ...]:
    """Files of the package that a file of it imports, by its lines `from solar_env... import ...`."""
    lines = rf"^ *from {_PACKAGE.name}\.([\w.]+) import (\([^)]*\)|.*)$"
    files = []
    for module, names in re.findall(lines, path.read_text(encoding="utf-8"), re.MULTILINE):
        base = _PACKAGE.joinpath(*module.split("."))
        # What is imported may be a module, too.
        places = [base.with_suffix(".py"), base / "__init__.py"]
        places += [(base / name).with_suffix(".py") for name in re.findall(r"\w+", names)]
        files += [place for place in places if place.is_file()]
    return tuple(files)


def kernel_sources(path: Path) -> list[Path]:
    """A file with all that it imports of the package, directly or not: constants and array types are compiled in."""
    found, waiting = set(), [path]
    while waiting:
        source = waiting.pop()
        if source not in found:
            found.add(source)
            waiting += imported_files(source)
    return sorted(found)


@cache
def cache_folder(path: Path) -> str:
    """Folder of the compiled kernels of a source file; it is there and can be written.

    Raises:
        OSError: if there is none, or others can write there.
    """
    digest = hashlib.sha256()
    for source in kernel_sources(path):
        digest.update(source.relative_to(_PACKAGE).as_posix().encode())
        digest.update(source.read_bytes())
    return str(private_folder(cache_root() / digest.hexdigest()[:16]))


def kernel(
    function: Callable[..., Any] | None = None,
    *,
    inner: bool = False,
    inlined: bool = False,
    single_caller: bool = False,
) -> Any:
    """Compile a function in nopython mode, without the interpreter lock, cached under the hash of its sources.

    It may not allocate. In exchange it does no reference counting, which would otherwise cost two atomic operations for
    every field taken out of a tuple of arrays: more than half of the run time of small mechanisms.

    Args:
        function: to compile; left out where the decorator has options.
        inner: only kernels call it. It has no way in from Python, which saves compile time, and LLVM inlines it, which
            spares passing tuples of arrays.
        inlined: LLVM inlines it, though Python calls it as well.
        single_caller: one kernel calls it, in one place; it is compiled as a part of that only, which saves time.
    """
    if function is None:
        return partial(kernel, inner=inner, inlined=inlined, single_caller=single_caller)
    wishes = {"no_cpython_wrapper": inner, "inline": "always" if single_caller else ""}
    # Only what is wished for: to name the default "never" keeps LLVM from inlining, which costs up to half the speed.
    options: dict[str, Any] = {name: value for name, value in wishes.items() if value}
    # But this always: where it is not named, a kernel takes it from the caller that happens to be compiled first, and
    # what a run computes would depend on that in its last bits.
    options["forceinline"] = inner or inlined
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = cache_folder(Path(function.__code__.co_filename).resolve())
    try:
        compiled = numba.njit(
            nogil=True,
            error_model="numpy",
            fastmath={"contract"},
            no_cfunc_wrapper=True,
            _nrt=False,
            **options,
        )(function)
        if not numba.config.DISABLE_JIT:
            compiled._cache = KernelCache(function)
        return compiled
    finally:
        numba.config.CACHE_DIR = previous
