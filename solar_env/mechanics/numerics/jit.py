"""The project's kernels: compiled by Numba with an on-disk cache that cannot go stale.

Numba's cache notices an edit of the file that holds a function, but not of the files whose functions it
calls; cached callers would go on running the old code. Here the cache folder of a kernel carries a hash of its source
file and of every file of the package that this imports, so that any edit compiles afresh what depends on it.
"""

import hashlib
import os
import re
import tempfile
import warnings
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.registry import CPUDispatcher
from platformdirs import user_cache_path

from solar_env.mechanics.numerics.linking import LinkedCompiler

_PACKAGE = Path(__file__).resolve().parents[2]


@cache
def imported_files(path: Path) -> tuple[Path, ...]:
    """Return the files of the package that a file of it imports, by its lines `from solar_env... import ...`."""
    lines = rf"^ *from {_PACKAGE.name}\.([\w.]+) import (\([^)]*\)|.*)$"
    files = []
    for module, names in re.findall(lines, path.read_text(encoding="utf-8"), re.MULTILINE):
        base = _PACKAGE.joinpath(*module.split("."))
        # An imported name may be a module, too.
        places = [base.with_suffix(".py"), base / "__init__.py"]
        places += [(base / name).with_suffix(".py") for name in re.findall(r"\w+", names)]
        files += [place for place in places if place.is_file()]
    return tuple(files)


def kernel_sources(path: Path) -> list[Path]:
    """Return a file and all it imports from the package, directly or not: constants and array types are compiled in."""
    found, waiting = set(), [path]
    while waiting:
        source = waiting.pop()
        if source not in found:
            found.add(source)
            waiting += imported_files(source)
    return sorted(found)


def private_folder(path: Path) -> Path:
    """Make a folder that only this user can write, or check an existing one.

    Raises:
        OSError: if it cannot be made or written, or others can write there: the cache's code is executed.
    """
    path.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not os.access(path, os.W_OK):
        raise PermissionError(f"{path} cannot be written")
    found = path.stat()
    if hasattr(os, "getuid") and (found.st_uid != os.getuid() or found.st_mode & 0o022):
        raise OSError(
            f"others can write in {path}, whose compiled kernels are executed; delete it (rm -r), or set "
            "NUMBA_CACHE_DIR to a folder of your own"
        )
    return path


def cache_root() -> Path:
    """Return the compiled kernels' folder: `NUMBA_CACHE_DIR`, the user's cache folder, or one in the temporary folder.

    Raises:
        OSError: if no folder can be made, or others can write there.
    """
    chosen = Path(os.environ.get("NUMBA_CACHE_DIR") or user_cache_path("solar_env", appauthor=False))
    owner = f"-{os.getuid()}" if hasattr(os, "getuid") else ""
    for root in (chosen, Path(tempfile.gettempdir()) / f"solar_env{owner}"):
        try:
            return private_folder(root)
        except (PermissionError, FileExistsError, NotADirectoryError, FileNotFoundError):
            continue
        except OSError as error:
            if error.errno is None:
                raise
    raise OSError(f"no folder for compiled kernels can be written (tried {chosen}); set NUMBA_CACHE_DIR to one")


@cache
def cache_folder(path: Path) -> str:
    """Return the folder of the compiled kernels of a source file.

    Raises:
        OSError: as `cache_root`.
    """
    digest = hashlib.sha256()
    for source in kernel_sources(path):
        digest.update(source.relative_to(_PACKAGE).as_posix().encode())
        digest.update(source.read_bytes())
    folder = private_folder(cache_root() / digest.hexdigest()[:16])
    return str(folder)


class KernelCache(FunctionCache):
    """Numba's cache of a function that loads nothing damaged, and whose failures to write end no run.

    Its folder is Numba's setting `CACHE_DIR`, whose name identifies the sources of the kernels, whatever the place and
    time of the source file.
    """

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        self._cache_path = self._impl.locator._cache_path = numba.config.CACHE_DIR
        name = self._impl.filename_base
        self._cache_file = IndexDataCacheFile(cache_path=self._cache_path, filename_base=name, source_stamp="")

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load the compiled code for a signature; return None if it is missing or damaged."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever unpickling or linking makes of bytes that are no longer what was written
            self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the compiled code, if it can be written."""
        try:
            super().save_overload(sig, data)
        except Exception as error:  # a full disk, or an index that is damaged
            warnings.warn(f"compiled kernels could not be kept, later runs compile them anew: {error}", stacklevel=2)


class Kernel(CPUDispatcher):
    """A compiled function with two faces: for other kernels, code that is linked into theirs; for Python, a function.

    Each is compiled when it is first asked for, and only the second is kept on disk.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        linked = options | {"nopython": True, "boundscheck": None, "no_cpython_wrapper": True}
        super().__init__(function, targetoptions=linked, pipeline_class=LinkedCompiler)
        self.from_python = numba.njit(**options)(function)
        self.from_python._cache = KernelCache(function)

    def __call__(self, *args: Any) -> Any:
        """Call the function from Python."""
        return self.from_python(*args)


def kernel(function: Callable[..., Any] | None = None, *, inlined: bool = True) -> Any:
    """Compile a function in nopython mode, without the interpreter lock, cached under the hash of its sources.

    It may not allocate. In exchange it does no reference counting, which would otherwise cost two atomic operations for
    every field taken out of a tuple of arrays: more than half of the run time of small mechanisms.

    Args:
        function: to compile; left out where the decorator has options.
        inlined: LLVM replaces every call by a kernel with the code, which spares passing tuples of arrays. Long kernels
            that several others call, or that are called seldom, compile faster where LLVM is left to decide.
    """
    if function is None:
        return partial(kernel, inlined=inlined)
    if numba.config.DISABLE_JIT:
        return function
    options = {
        "nogil": True,
        "error_model": "numpy",
        "fastmath": {"contract"},
        "no_cfunc_wrapper": True,
        "_nrt": False,
        # Always named: otherwise a kernel takes it from the caller that happens to be compiled first, and what a run
        # computes would depend on that in its last bits.
        "forceinline": inlined,
    }
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = cache_folder(Path(function.__code__.co_filename).resolve())
    try:
        return Kernel(function, options)
    finally:
        numba.config.CACHE_DIR = previous
