"""Writing files whole or not at all: every file of the project goes through `writing`.

Content goes into a file beside the target, is brought to the disk, and takes the target's place in one operation of
the file system. Whatever ends the process in between, a kill or a full disk, leaves what was there before.
"""

import os
import secrets
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

PART = ".part"  # end of the names of unfinished files and folders


@contextmanager
def writing(path: str | Path) -> Iterator[IO[bytes]]:
    """Open a binary file, to be written and read, that becomes `path` when the block ends without an exception.

    A link is followed. Anything but a regular file, such as `/dev/stdout`, is written directly.

    Raises:
        OSError: the file cannot be written; what was at `path` is still there.
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
    """Bring the names in a folder to the disk, where the system can."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def write_bytes(path: str | Path, content: bytes) -> None:
    """Write a file whole or not at all; see `writing`."""
    with writing(path) as file:
        file.write(content)


def write_text(path: str | Path, content: str) -> None:
    """Write a file of UTF-8 whole or not at all; see `writing`."""
    write_bytes(path, content.encode())


def save_figure(figure: Any, path: str | Path, **options: object) -> None:
    """Write a Matplotlib figure whole or not at all, in the format that the name ends in, with options of `savefig`."""
    with writing(path) as file:
        figure.savefig(file, format=Path(path).suffix[1:].lower(), **options)


def make_folder(path: str | Path) -> Path:
    """Make a folder with its parents, and test that files can be written there; call this before the work.

    Raises:
        OSError: it cannot be made, or no file can be written there.
    """
    folder = Path(path)
    folder.mkdir(parents=True, exist_ok=True)
    tempfile.TemporaryFile(dir=folder).close()
    return folder


def check_target(path: str | Path, suffixes: Sequence[str] = ()) -> None:
    """Check that a file can be written at `path`, with one of `suffixes`; call this before the work.

    Raises:
        ValueError: the suffix is another one, the folder does not exist, or `path` is a folder.
        OSError: no file can be written there, or the name is not allowed.
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
