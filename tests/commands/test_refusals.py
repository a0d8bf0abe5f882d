"""What a command cannot do is told in one sentence, with status 2: the system's refusals, and words without sense."""

from __future__ import annotations

import errno
import os
import subprocess
import sys

import pytest

from solar_env.__main__ import main


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="a device of Linux")
@pytest.mark.parametrize("words", ["--help", "--version", "parameters", "simulate --help"])
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_output_that_cannot_be_written_is_told_in_a_sentence(words, unbuffered):
    with open("/dev/full", "w") as full:
        done = run_with_output(words, full, unbuffered)
    assert done.returncode == 2
    assert done.stderr == (
        "error: the output cannot be written (No space left on device); make room, or send it elsewhere\n"
    )


@pytest.mark.skipif(sys.platform == "win32", reason="pipes of POSIX")
@pytest.mark.parametrize("words", ["--help", "parameters"])
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_reader_who_leaves_early_is_no_error(words, unbuffered):
    read, write = os.pipe()
    os.close(read)
    done = run_with_output(words, write, unbuffered)
    os.close(write)
    assert (done.returncode, done.stderr) == (0, "")


def run_with_output(words, output, unbuffered):
    return subprocess.run(
        [sys.executable, "-m", "solar_env", *words.split()],
        env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
        stdout=output,
        stderr=subprocess.PIPE,
        text=True,
        timeout=120,
    )


def test_errors_of_the_system_are_told_without_their_numbers(tmp_path, capsys, monkeypatch):
    def refused(*_, **__):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(tmp_path / "array.yaml"))

    monkeypatch.setattr("importlib.import_module", refused)
    assert main(["simulate"]) == 2
    assert capsys.readouterr().err == f"error: {tmp_path / 'array.yaml'}: Permission denied\n"


def test_a_full_disk_is_told_with_the_file_and_what_was_kept(capsys, monkeypatch, tmp_path):
    def full(*_):
        error = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(tmp_path / "checkpoint.new"))
        error.add_note("kept the checkpoint of step 40")
        raise error

    monkeypatch.setattr("importlib.import_module", full)
    assert main(["train"]) == 2
    told = f"error: {tmp_path / 'checkpoint.new'} cannot be written (No space left on device); make room, or choose "
    assert capsys.readouterr().err == f"{told}another place; kept the checkpoint of step 40\n"


def test_memory_that_runs_out_is_told_in_a_sentence(capsys, monkeypatch):
    def full(*_):
        raise MemoryError("Unable to allocate 33.5 GiB")

    monkeypatch.setattr("importlib.import_module", full)
    assert main(["train"]) == 2
    told = "error: memory has no room for what was asked for (Unable to allocate 33.5 GiB); ask for less\n"
    assert capsys.readouterr().err == told


@pytest.mark.parametrize(
    ("words", "of"),
    [
        (["train", "--resume", ""], " of --resume"),
        (["evaluate", "--out="], " of --out"),
        (["evaluate", "--controllers", "passive", ""], " of --controllers"),
        (["simulate", ""], ""),
    ],
)
def test_an_empty_word_is_refused_before_the_work(words, of, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    assert capsys.readouterr().err == f"error: a value{of} is empty; give one, or leave it out; see --help\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["design", "study precision", "ladder"])
def test_nothing_is_drawn_from_a_folder_that_is_not_there_and_none_is_made(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*command.split(), "--draw", "--out", "measured"]) == 2
    told = "error: there is no folder measured to draw from; measure first, without --draw\n"
    assert capsys.readouterr().err == told
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", ["evaluate --controllers", "train --seeds", "study paper --only"])
def test_a_list_without_entries_is_refused_before_the_work(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(words.split()) == 2
    told = f"error: {words.split()[-1]} is given without a value; give at least one, or leave it out; see --help\n"
    assert capsys.readouterr().err == told
    assert list(tmp_path.iterdir()) == []
