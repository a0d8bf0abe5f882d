"""What a command cannot do is told in one sentence, with status 2: the system's refusals, and words without sense."""

from __future__ import annotations

import errno
import os
import subprocess
import sys

import pytest

from solar_env.__main__ import main


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="a device of Linux")
@pytest.mark.parametrize(("words", "unbuffered"), [("--help", ""), ("simulate --help", "1")])
def test_output_that_cannot_be_written_is_told_in_a_sentence(words, unbuffered):
    with open("/dev/full", "w") as full:
        done = run_with_output(words, full, unbuffered)
    assert done.returncode == 2
    assert done.stderr == "error: the output: No space left on device\n"


@pytest.mark.skipif(sys.platform == "win32", reason="pipes of POSIX")
@pytest.mark.parametrize(("words", "unbuffered"), [("--help", ""), ("parameters", "1")])
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


def full(*_):
    error = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "checkpoint.new")
    error.add_note("kept the checkpoint of step 40")
    raise error


def too_large(*_):
    raise MemoryError("Unable to allocate 33.5 GiB")


@pytest.mark.parametrize(
    ("failing", "told"),
    [
        (full, "checkpoint.new: No space left on device; kept the checkpoint of step 40"),
        (too_large, "memory has no room for what was asked for (Unable to allocate 33.5 GiB); ask for less"),
    ],
)
def test_errors_of_the_system_are_told_without_their_numbers_and_with_what_was_kept(failing, told, capsys, monkeypatch):
    monkeypatch.setattr("importlib.import_module", failing)
    assert main(["train"]) == 2
    assert capsys.readouterr().err == f"error: {told}\n"


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["train", "--resume", ""], "a value is empty; give one, or leave it out"),
        (["evaluate", "--out="], "a value is empty; give one, or leave it out"),
        (["simulate", "--set", "clearance=1e-4", "--set", "body_mass=1"], "--set is given twice; give it once"),
    ],
)
def test_an_empty_word_and_an_option_repeated_are_refused_before_the_work(words, told, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    assert capsys.readouterr().err == f"error: {told}; see --help\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["study wear", "study precision", "ladder"])
def test_nothing_is_drawn_from_a_folder_that_is_not_there_and_none_is_made(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*command.split(), "--draw", "--out", "measured"]) == 2
    told = "error: there is no folder measured to draw from; measure first, without --draw\n"
    assert capsys.readouterr().err == told
    assert list(tmp_path.iterdir()) == []
