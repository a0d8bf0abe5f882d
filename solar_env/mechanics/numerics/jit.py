"""Compilation of the project's kernels by Numba, with an on-disk cache that cannot go stale.

Numba's own cache notices an edit of a function's file, but not of the files whose functions are called: cached callers
would go on running the old code. Here a kernel's cache folder is named by a hash of the kernel's source file and of
every package file that it imports. Any edit therefore recompiles all kernels that depend on the edited file.
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
    """Return the package files that a source file imports directly, from its lines `from solar_env... import ...`."""
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
    """Return a file and all package files that it imports, directly or indirectly: all sources of its kernels' code."""
    found, waiting = set(), [path]
    while waiting:
        source = waiting.pop()
        if source not in found:
            found.add(source)
            waiting += imported_files(source)
    return sorted(found)


def private_folder(path: Path) -> Path:
    """Make `path` a folder that only this user can write, or check an existing one; return `path`.

    Raises:
        OSError: if the folder cannot be made or written, or others can write to it: the cache's code is executed.
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
        OSError: if no folder can be made, or others can write to it.
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
    """Return the cache folder for a file's compiled kernels, named by a hash of the file and all files that it imports.

    Raise an OSError in the same cases as `cache_root`.
    """
    digest = hashlib.sha256()
    for source in kernel_sources(path):
        digest.update(source.relative_to(_PACKAGE).as_posix().encode())
        digest.update(source.read_bytes())
    folder = private_folder(cache_root() / digest.hexdigest()[:16])
    return str(folder)


class KernelCache(FunctionCache):
    """Numba's cache of a function, changed to ignore damaged files, and to warn if it cannot write a file.

    Its files lie directly in the folder of Numba's setting `CACHE_DIR`, which `kernel` names by a hash of the sources.
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
        """Write the compiled code to the cache; warn if it cannot be written."""
        try:
            super().save_overload(sig, data)
        except Exception as error:  # a full disk, or an index that is damaged
            warnings.warn(f"compiled kernels could not be kept, later runs compile them anew: {error}", stacklevel=2)


class Kernel(CPUDispatcher):
    """A compiled function in two forms: code that is linked into other kernels, and a function to call from Python.

    Each form is compiled at the first use; only the Python form is kept on disk.
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

    The kernel may not allocate memory. In exchange it counts no references, which would take more than half of the
    run time of small mechanisms.

    Args:
        function: function to compile; left out if the decorator has options.
        inlined: whether LLVM must inline every call by another kernel, which spares passing tuples of arrays. Long
            kernels with several callers or few calls compile faster if LLVM decides.
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
        # Always set: otherwise a kernel takes the option from the caller that happens to be compiled first, and the
        # last bits of a run's results would depend on the order of compilation.
        "forceinline": inlined,
    }
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = cache_folder(Path(function.__code__.co_filename).resolve())
    try:
        return Kernel(function, options)
    finally:
        numba.config.CACHE_DIR = previous
