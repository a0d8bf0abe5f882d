"""Where compiled kernels are kept: in a folder that nobody else can write, and compiled anew where it is damaged.

What is in the cache is executed. The folder is therefore the user's own, and every file carries a checksum.
"""

import hashlib
import os
import pickle
import stat
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import FunctionCache, IndexDataCacheFile
from platformdirs import user_cache_path

_CHECKSUM = 32  # bytes


def cache_root() -> Path:
    """The folder of all compiled kernels; it is there, can be written, and only by this user.

    It is that of the environment variable `NUMBA_CACHE_DIR`, else the user's cache folder; where that cannot be
    written, a private one in the temporary folder.

    Raises:
        OSError: others can write there, or there is no folder that can be written.
    """
    chosen = Path(os.environ.get("NUMBA_CACHE_DIR") or user_cache_path("solar_env", appauthor=False))
    owner = f"-{os.getuid()}" if hasattr(os, "getuid") else ""
    for root in (chosen, Path(tempfile.gettempdir()) / f"solar_env{owner}"):
        try:
            return private_folder(root)
        except (FileExistsError, NotADirectoryError, FileNotFoundError, PermissionError):
            continue
    raise OSError(f"no folder for compiled kernels can be written (tried {chosen}); set NUMBA_CACHE_DIR to one")


def private_folder(path: Path) -> Path:
    """Make a folder that only this user can write, or check that an existing one is so.

    Raises:
        OSError: it belongs to somebody else, or others can write it or put another in its place.
        PermissionError, FileExistsError, FileNotFoundError, NotADirectoryError: it cannot be made or written.
    """
    try:
        path.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise PermissionError(f"{path} cannot be made ({error.strerror})") from error
    if not os.access(path, os.W_OK):
        raise PermissionError(f"{path} cannot be written")
    if hasattr(os, "getuid"):
        _check_private(path.resolve())
    return path


def _check_private(path: Path) -> None:
    # The owner of a folder can put another in the place of what is in it. Whoever owns the root can do so anywhere: the
    # administrator, or where there is none that the system would name, as in some containers, its stand-in.
    trusted = {0, os.getuid(), Path(path.anchor).stat().st_uid}
    for folder in (path, *path.parents):
        found = folder.stat()
        others_write = found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
        if folder != path:
            # In a folder with the sticky bit nobody can move what is another's.
            others_write = others_write and not found.st_mode & stat.S_ISVTX
        elif found.st_uid != os.getuid():
            raise OSError(
                f"{path}, for compiled kernels, belongs to another user; set NUMBA_CACHE_DIR to a folder of your own"
            )
        if found.st_uid not in trusted:
            raise OSError(
                f"{folder} belongs to another user, who can put any folder in the place of {path}, whose compiled "
                "kernels are executed; set NUMBA_CACHE_DIR to a folder below folders of your own"
            )
        if others_write:
            # What they have put there already would be executed, too: to take their right away is not enough.
            first = "" if folder == path else f"take their right away (chmod go-w {folder}), "
            raise OSError(
                f"others can write in {folder}, and what is in the folder of compiled kernels {path} is executed; "
                f"{first}delete {path} (rm -r) if it holds nothing else, and kernels are compiled anew, or set "
                "NUMBA_CACHE_DIR to another folder"
            )


class KernelCache(FunctionCache):
    """Numba's cache of a function, of which nothing damaged is loaded and no failure to write ends a run.

    Args:
        function: to be compiled; Numba's setting `CACHE_DIR` is the folder, named after the hash of all its sources.
    """

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        # Neither place nor time of the source file: the folder's name says of which sources the kernels are.
        self._cache_path = self._impl.locator._cache_path = numba.config.CACHE_DIR
        name = self._impl.filename_base
        self._cache_file = _CheckedFile(cache_path=self._cache_path, filename_base=name, source_stamp="")

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load what was compiled for a signature; None where there is nothing, or what is there is damaged."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever unpickling or linking makes of bytes that are no longer what was written
            self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled.

        Warns:
            UserWarning: it could not be written, and the next run compiles it anew.
        """
        try:
            super().save_overload(sig, data)
        except OSError as error:
            warnings.warn(f"compiled kernels could not be kept, later runs compile them anew: {error}", stacklevel=2)

    def flush(self) -> None:
        """Forget what is kept of this function."""
        try:
            super().flush()
        except OSError as error:
            warnings.warn(f"a damaged file of compiled kernels could not be replaced: {error}", stacklevel=2)


class _CheckedFile(IndexDataCacheFile):
    """Files of a function's cache, the compiled ones behind their checksum."""

    def _load_data(self, name: str) -> Any:
        content = Path(self._data_path(name)).read_bytes()
        checksum, data = content[:_CHECKSUM], content[_CHECKSUM:]
        if hashlib.sha256(data).digest() != checksum:
            raise ValueError(f"{name} is damaged")
        return pickle.loads(data)

    def _save_data(self, name: str, data: Any) -> None:
        dumped = self._dump(data)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(hashlib.sha256(dumped).digest() + dumped)
