"""Atomic writing of files, wholly or not at all; all files of the project are written by `writing`.

The content goes to a temporary file beside the target and is flushed to the disk. The temporary file then replaces the
target in one file-system operation. If a kill or a full disk ends the process earlier, the old target remains.
"""

import os
import secrets
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

PART = ".part"  # suffix of unfinished files and folders


@contextmanager
def writing(path: str | Path) -> Iterator[IO[bytes]]:
    """Open a binary file for writing and reading that replaces `path` when the block ends without an exception.

    A link is followed. A target that is not a regular file, such as `/dev/stdout`, is written directly.

    Raises:
        OSError: the file cannot be written; an old file at `path` remains.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file():
        with target.open("wb") as file:
            yield file
        return
    beside = _unfinished(target)
    try:
        with beside.open("x+b") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if target.exists():
            shutil.copymode(target, beside)
        beside.replace(target)
    except BaseException as error:
        if isinstance(error, OSError) and error.filename in (None, str(beside)):  # failed writes name no file
            error.filename = str(target)
        with suppress(OSError):
            beside.unlink()
        raise
    _sync_folder(target.parent)


def _unfinished(target: Path) -> Path:
    return target.with_name(f".{secrets.token_hex(8)}{PART}")


def _sync_folder(folder: Path) -> None:
    """Flush the names of a folder's files to the disk, if the system can."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def write_bytes(path: str | Path, content: bytes) -> None:
    """Write bytes to a file, wholly or not at all; see `writing`."""
    with writing(path) as file:
        file.write(content)


def write_text(path: str | Path, content: str) -> None:
    """Write a text to a file in UTF-8, wholly or not at all; see `writing`."""
    write_bytes(path, content.encode())


def save_figure(figure: Any, path: str | Path, **options: object) -> None:
    """Write a Matplotlib figure, wholly or not at all, in the format of the suffix, with options of `savefig`."""
    with writing(path) as file:
        figure.savefig(file, format=Path(path).suffix[1:].lower(), **options)


def make_folder(path: str | Path) -> Path:
    """Make a folder with its parents, and check that files can be written in the folder; call this before computations.

    Raises:
        OSError: the folder cannot be made, or no file can be written in it.
    """
    folder = Path(path)
    folder.mkdir(parents=True, exist_ok=True)
    tempfile.TemporaryFile(dir=folder).close()
    return folder


def check_target(path: str | Path, suffixes: Sequence[str] = ()) -> None:
    """Check that a file with one of `suffixes` can be written at `path`; call this before computations.

    Raises:
        ValueError: the suffix is not among `suffixes`, the folder does not exist, or `path` is a folder.
        OSError: no file can be written in the folder, or the name is not allowed.
    """
    target = Path(path)
    if suffixes and target.suffix.lower() not in suffixes:
        raise ValueError(f"the suffix {target.suffix!r} of {target} is unknown; choose from {', '.join(suffixes)}")
    if not target.parent.is_dir():
        raise ValueError(f"the folder of {target} does not exist; make it first")
    if target.is_dir():
        raise ValueError(f"{target} is a folder; name a file in it")
    if not target.exists() or target.is_file():
        tempfile.TemporaryFile(dir=target.parent).close()
