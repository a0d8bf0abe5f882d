"""Safe reading of untrusted npz and JSON files: no code is executed, sizes are limited, faults raise a ValueError."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST_BYTES = 2**30
_LONGEST_JSON = 2**24


def read_arrays(
    path: str | Path, admits: Callable[[str], bool], most_bytes: int = MOST_BYTES
) -> dict[str, NDArray[Any]]:
    """Read all arrays of an npz file, by name.

    Args:
        path: the npz file.
        admits: function that returns whether an array with a given name belongs in the file.
        most_bytes: greatest size of all arrays together; larger files are not inflated.

    Raises:
        OSError: the file cannot be opened.
        ValueError: the file is no npz file, is damaged, holds anything but plain arrays, or is too large.
    """
    with open(path, "rb") as file:
        try:
            with np.load(file, allow_pickle=False) as archive:
                for name in archive.files:
                    if not admits(name):
                        raise ValueError(f"it holds {name[:80]!r}, which does not belong there")
                size = sum(member.file_size for member in archive.zip.infolist())
                if size > most_bytes:
                    raise ValueError(f"it holds {size:,} bytes, more than the {most_bytes:,} that are read")
                return {name: np.asarray(archive[name]) for name in archive.files}
        except Exception as error:  # readers raise errors of all kinds for bytes that no writer wrote
            raise ValueError(_sentence(error)) from error


def read_at_most(path: str | Path, most_bytes: int) -> bytes:
    """Read a file of at most `most_bytes`; a longer file, even an endless one, is refused.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is longer; the message names the file.
    """
    with open(path, "rb") as file:
        content = file.read(most_bytes + 1)
    if len(content) > most_bytes:
        raise ValueError(f"{path} is longer than the {most_bytes:,} bytes that are read")
    return content


def read_json(path: str | Path) -> Any:
    """Read and parse a JSON file of limited size.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is no JSON, nested too deeply, or too large; the message names the file.
    """
    content = read_at_most(path, _LONGEST_JSON)
    try:
        return parse_json(content)
    except ValueError as error:
        raise ValueError(f"{path} is damaged: {error}; restore it, or make it anew") from error


def parse_json(content: str | bytes) -> Any:
    """Parse a JSON text; a text that is not JSON, or is nested too deeply, raises a ValueError."""
    try:
        return json.loads(content)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"it is no JSON: {_sentence(error)}") from error


def _sentence(error: Exception) -> str:
    return " ".join(str(error).split())[:300] or type(error).__name__
