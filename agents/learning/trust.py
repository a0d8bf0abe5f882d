"""Which files were made on this account: what a run leaves is executed when it is loaded, and strangers' is refused.

Policies and checkpoints of Stable-Baselines3 are pickles, and an environment id may name a module to import. The files
of a run are therefore sealed: a checksum tells whether they are damaged, and a digest with a key of the user's own
whether this user's programs have written them.
"""

import hashlib
import hmac
import json
import os
import re
import secrets
import stat
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from platformdirs import user_data_path

from solar_env.support.files import write_bytes, write_text
from solar_env.support.plain_arrays import read_json

SEAL = "seal"  # key of a sealed configuration
_TRAILER = re.compile(rb"\nsolar_env ([0-9a-f]{64}) ([0-9a-f]{64})\n")
_KEY_LENGTH = 32  # bytes
_TRAILER_LENGTH = len("\nsolar_env  \n") + 2 * 64
REMEDY = (
    "loading it executes what its author wrote: if you trust where it comes from, pass --trust once, which seals it as "
    "yours; else ask for the exported policy (solar-env export), which executes nothing"
)


class DamagedFileError(ValueError):
    """A file that is not as it was written."""


class UntrustedFileError(ValueError):
    """A file that would execute code and was not made on this account."""


def key() -> bytes:
    """Return the user's key, made on first use; it lies in the user's data folder, where nobody else can read it.

    Raises:
        OSError: The folder cannot be written, or the key is not whole, another user's, or open to others.
    """
    path = user_data_path("solar_env", appauthor=False) / "key"
    if not path.is_file():
        try:
            path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            fresh = path.with_name(secrets.token_hex(8))
            with open(os.open(fresh, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
                file.write(secrets.token_bytes(_KEY_LENGTH))
                file.flush()
                os.fsync(file.fileno())
            with suppress(FileExistsError):  # of several processes the first one makes it
                os.link(fresh, path)
            fresh.unlink()
        except OSError as error:
            raise OSError(
                f"the key that seals run folders cannot be kept in {path.parent} ({error.strerror}); "
                "set XDG_DATA_HOME to a folder that can be written"
            ) from error
    found, content = path.stat(), path.read_bytes()
    again = f"delete it, and pass --trust once with every run that was sealed with it (rm {path})"
    if len(content) != _KEY_LENGTH:
        raise OSError(f"the key that seals run folders, {path}, has {len(content)} bytes, not {_KEY_LENGTH}; {again}")
    if hasattr(os, "getuid"):
        if found.st_uid != os.getuid():
            raise OSError(
                f"the key that seals run folders, {path}, is another user's; set XDG_DATA_HOME to a folder of your own"
            )
        if found.st_mode & (stat.S_IRWXG | stat.S_IRWXO):
            raise OSError(f"others can read or write the key that seals run folders, {path}; {again}")
    return content


def _digest(content: bytes) -> str:
    return hmac.new(key(), content, hashlib.sha256).hexdigest()


def sealed(content: bytes) -> bytes:
    """Return the content of a file with its seal behind it."""
    return content + f"\nsolar_env {hashlib.sha256(content).hexdigest()} {_digest(content)}\n".encode()


def _split(path: Path) -> tuple[bytes, str]:
    """Return content and digest of a sealed file.

    Raises:
        DamagedFileError: It has no seal, or its checksum is another.
    """
    whole = path.read_bytes()
    content, found = whole[:-_TRAILER_LENGTH], _TRAILER.fullmatch(whole[-_TRAILER_LENGTH:])
    if found is None or hashlib.sha256(content).hexdigest() != found[1].decode():
        raise DamagedFileError(
            f"{path} is damaged: it is not whole, or of an older version; resume the run from its checkpoint, or train "
            "it anew"
        )
    return content, found[2].decode()


def unsealed(path: Path) -> bytes:
    """Return the content of a sealed file.

    Raises:
        DamagedFileError: It is not whole.
        UntrustedFileError: It was not made on this account.
        OSError: It cannot be read.
    """
    content, digest = _split(path)
    if not hmac.compare_digest(digest, _digest(content)):
        raise UntrustedFileError(f"{path} was not made on this account, and {REMEDY}")
    return content


def _canonical(record: Mapping[str, Any]) -> bytes:
    return json.dumps({name: value for name, value in record.items() if name != SEAL}, sort_keys=True).encode()


def sealed_record(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return a record, which JSON keeps, with its seal."""
    plain = json.loads(_canonical(record))
    return {**plain, SEAL: _digest(_canonical(plain))}


def check_record(record: Mapping[str, Any], path: Path) -> None:
    """Refuse the record in the file `path` unless it was made on this account.

    Raises:
        UntrustedFileError: It was not.
    """
    try:
        own = _digest(_canonical(record))
    except RecursionError:  # nothing that this project writes is nested so deeply
        own = ""
    if not own or not hmac.compare_digest(str(record.get(SEAL)).encode(errors="replace"), own.encode()):
        raise UntrustedFileError(f"{path} was not made on this account, and {REMEDY}")


def trust(folder: Path, config: str, sealed_names: tuple[str, ...]) -> None:
    """Seal the files of a run folder as this user's, which says that its author is trusted.

    Raises:
        DamagedFileError: A sealed file is not whole.
        OSError: A file cannot be written.
    """
    record = read_json(folder / config)
    for name in sealed_names:
        if (folder / name).is_file():
            write_bytes(folder / name, sealed(_split(folder / name)[0]))
    write_text(folder / config, json.dumps(sealed_record(record), indent=2) + "\n")
