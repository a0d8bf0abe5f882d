"""Files are written whole or not at all, whatever ends the process, and targets are checked before the work."""

import errno
import os
import re
import signal
from pathlib import Path
from types import SimpleNamespace

import pytest

import solar_env
from solar_env.__main__ import main
from solar_env.support import files

ROOT = Path(solar_env.__file__).resolve().parent.parent
# What writes a file by its name, past `solar_env.support.files`.
BYPASSES = re.compile(
    r"""open\([^()]*["'][rb]*[wxa]\+?[bt]?["']|\.write_(text|bytes)\(|np\.savez?(_compressed)?\((?!file\b)|json\.dump\((?!.*stdout)"""
    r"""|\.savefig\(|torch\.save\(|\.save\((?!file\b|made, policy|figure, |self\.|lane\b|args\.out\))"""
    r"""|shutil\.(copy|copyfile|move)\("""
)
ALLOWED = {
    # An own record of every cell, appended: what an interruption cuts short is done again.
    "solar_env/support/campaigns.py": 1,
    "solar_env/support/files.py": 3,
    # Of a trajectory, which goes through the one function.
    "solar_env/array/data_files.py": 1,
}


def test_every_file_is_written_by_the_one_function():
    found = {}
    for path in sorted([*ROOT.glob("solar_env/**/*.py"), *ROOT.glob("agents/**/*.py")]):
        if "examples" in path.parts:
            continue  # for readers, in whom the one function would only be in the way
        count = sum(len(BYPASSES.findall(line)) for line in path.read_text(encoding="utf-8").splitlines())
        if count:
            found[path.relative_to(ROOT).as_posix()] = count
    assert found == ALLOWED


@pytest.mark.parametrize("written", [0, 5000])
def test_a_full_disk_leaves_the_file_that_was_there(tmp_path, monkeypatch, written):
    path = tmp_path / "table.csv"
    path.write_text("before")
    fill_disk_after(monkeypatch, written)
    with pytest.raises(OSError, match="No space left") as error:
        files.write_bytes(path, b"x" * 5001)
    assert error.value.filename == str(path)
    assert [p.name for p in tmp_path.iterdir()] == ["table.csv"]
    assert path.read_text() == "before"


def fill_disk_after(monkeypatch, count):
    """Let writes through `files.writing` fail as on a full disk from byte `count` on."""
    opened = Path.open

    def limited(self, mode="r", *args, **kwargs):
        file = opened(self, mode, *args, **kwargs)
        return LimitedFile(file, count) if self.suffix == files.PART else file

    monkeypatch.setattr(Path, "open", limited)


class LimitedFile:
    """A file on a disk with room for `room` bytes."""

    def __init__(self, file, room):
        self._file, self._room = file, room

    def write(self, content):
        taken = memoryview(content).nbytes
        if taken > self._room:
            self._file.write(bytes(content)[: self._room])
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        self._room -= taken
        return self._file.write(content)

    def __enter__(self):
        return self

    def __exit__(self, *what):
        self._file.close()

    def __getattr__(self, name):
        return getattr(self._file, name)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills a child process")
@pytest.mark.parametrize("moment", ["written", "synced", "replaced"])
def test_a_kill_at_any_moment_leaves_the_old_file_or_the_new_one(tmp_path, monkeypatch, moment):
    path = tmp_path / "summary.json"
    path.write_bytes(b"before")
    child = os.fork()
    if child == 0:
        if moment == "written":
            monkeypatch.setattr(os, "fsync", lambda _: os.kill(os.getpid(), signal.SIGKILL))
        elif moment == "synced":
            monkeypatch.setattr(Path, "replace", lambda *_: os.kill(os.getpid(), signal.SIGKILL))
        else:
            monkeypatch.setattr(files, "_sync_folder", lambda _: os.kill(os.getpid(), signal.SIGKILL))
        files.write_bytes(path, b"after" * 1000)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert os.WIFSIGNALED(status)
    assert path.read_bytes() == (b"after" * 1000 if moment == "replaced" else b"before")


def test_a_link_is_followed_and_a_mode_kept(tmp_path):
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("before")
    target.chmod(0o600)
    link.symlink_to(target)
    files.write_text(link, "after")
    assert link.is_symlink()
    assert target.read_text() == "after"
    assert target.stat().st_mode & 0o777 == 0o600


def test_an_exception_while_writing_leaves_nothing_behind(tmp_path):
    with pytest.raises(KeyboardInterrupt), files.writing(tmp_path / "new"):
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []


OUTPUTS = {
    **{
        f"study {name}": ["--out", "{}"]
        for name in ("precision", "stability", "paper", "throughput", "figures", "wear")
    },
    "design": ["--out", "{}"],
    "ladder": ["--out", "{}"],
    "simulate": ["--out", "{}/trajectory.npz"],
    "verify": ["--json", "{}/rows.json"],
}


@pytest.mark.parametrize(
    ("place", "told"),
    [("file/folder", "file"), ("a" * 256, "File name too long"), ("full", "Read-only file system")],
)
def test_commands_refuse_a_folder_that_cannot_be_before_the_work(place, told, tmp_path, monkeypatch, capsys):
    (tmp_path / "file").write_text("of the user's")
    (tmp_path / "full").mkdir()

    def no_room(dir):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(dir))

    monkeypatch.setattr(files, "tempfile", SimpleNamespace(TemporaryFile=no_room))
    for command, options in OUTPUTS.items():
        assert main([*command.split(), *(word.format(tmp_path / place) for word in options)]) == 2, command
        error = capsys.readouterr().err
        assert error.count("\n") == 1, command
        assert error.startswith("error: "), command
        assert told in error, command
