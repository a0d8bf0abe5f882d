"""Ctrl-C ends every command with exit status 130 and one line of what was kept, in worker processes too."""

import builtins
import ctypes
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from agents import script
from solar_env import __main__ as command_line
from solar_env.commands import table
from solar_env.support import interruption
from solar_env.support.campaigns import Campaign

ROOT = Path(command_line.__file__).resolve().parent.parent
pytestmark = pytest.mark.skipif(not hasattr(os, "killpg"), reason="signals of POSIX")


def interrupt(*notes):
    stop = KeyboardInterrupt()
    for note in notes:
        stop.add_note(note)
    raise stop


@pytest.mark.parametrize("name", table.rows(table.COMMANDS))
def test_every_command_ends_with_130_and_one_line(name, monkeypatch, capsys):
    monkeypatch.setattr("importlib.import_module", lambda _: interrupt("kept the half of it"))
    assert command_line.main([name]) == 130
    assert capsys.readouterr().err == "interrupted; kept the half of it\n"


def test_it_says_so_where_nothing_was_kept(capsys, monkeypatch):
    monkeypatch.setattr(interruption, "_left", [])
    monkeypatch.setattr("importlib.import_module", lambda _: interrupt())
    assert command_line.main(["train"]) == 130
    assert capsys.readouterr().err == "interrupted; nothing was kept\n"


def test_so_does_the_script_while_packages_are_being_loaded(capsys, monkeypatch):
    load = builtins.__import__
    monkeypatch.setattr(
        builtins, "__import__", lambda name, *rest: interrupt() if name == "solar_env.__main__" else load(name, *rest)
    )
    assert script.main(["train"]) == 130
    assert capsys.readouterr().err == "interrupted; nothing was kept\n"


def test_what_was_loaded_is_not_gone_over_at_the_end(run_python):
    program = """
import atexit, gc
before = gc.get_freeze_count()  # Python 3.12 begins with some
from solar_env.support.interruption import report_interruption
atexit.register(lambda: print(gc.get_freeze_count() > before))  # called last
report_interruption(KeyboardInterrupt())
print(gc.get_freeze_count() > before)
"""
    assert run_python(program).split() == ["False", "True"]


def test_a_second_ctrl_c_does_not_tear_what_the_first_lets_end():
    ended = []

    @interruption.first_alone()
    def work():
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(10)
        finally:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.01)
            ended.append("whole")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert ended == ["whole"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def in_a_callback(call):
    """Call Python from C, as a compiler does: an exception does not get out of it."""
    ctypes.CFUNCTYPE(None)(call)()


@pytest.mark.parametrize("afterwards", ["it goes on", "it fails"])
def test_ctrl_c_where_c_has_called_python_is_heard(afterwards, capsys):
    def press():
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1)

    @interruption.first_alone()
    def work():
        in_a_callback(press)
        if afterwards == "it fails":
            raise RuntimeError("no compiled object yet")
        in_a_callback(lambda: time.sleep(1))  # where it comes again, and is lost again
        time.sleep(10)

    usual = sys.unraisablehook
    with pytest.raises(KeyboardInterrupt):
        work()
    time.sleep(0.1)
    assert capsys.readouterr().err == ""
    assert sys.unraisablehook is usual


def test_an_error_without_ctrl_c_stays_what_it_is():
    with pytest.raises(RuntimeError, match="of its own"), interruption.first_alone():
        raise RuntimeError("of its own")


def test_what_must_not_be_torn_hears_ctrl_c_at_its_end_with_other_threads_about():
    done = []

    @interruption.deaf()
    def work():
        for _ in range(20):
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.01)
        done.append("whole")

    end = threading.Event()
    other = threading.Thread(target=end.wait)
    other.start()
    with pytest.raises(KeyboardInterrupt):
        work()
    end.set()
    assert done == ["whole"]


def stop_at_three(cell):
    if cell["number"] == 3:
        raise KeyboardInterrupt
    return cell["number"]


def test_a_campaign_says_what_it_has_kept_and_goes_on_from_there(tmp_path):
    cells = [{"number": number} for number in range(5)]
    campaign = Campaign(stop_at_three, cells, tmp_path / "results.jsonl")
    with pytest.raises(KeyboardInterrupt) as stop:
        list(campaign.run())
    assert stop.value.__notes__ == [
        f"kept 3 of 5 results in {tmp_path / 'results.jsonl'}; the same command goes on from there"
    ]
    assert [cell["number"] for cell in Campaign(stop_at_three, cells, tmp_path / "results.jsonl").missing] == [3, 4]


def test_it_says_so_too_where_ctrl_c_comes_between_two_results(tmp_path, capsys, monkeypatch):
    def go():
        for _ in Campaign(stop_at_three, [{"number": 0}, {"number": 1}], tmp_path / "results.jsonl").run():
            raise KeyboardInterrupt

    monkeypatch.setattr("importlib.import_module", lambda _: go())
    assert command_line.main(["design"]) == 130
    assert capsys.readouterr().err.startswith("interrupted; kept 1 of 2 results in ")


def has_begun(path):
    """Whether the workers of a campaign have given a result each, or a checkpoint is there."""
    return path.suffix != ".jsonl" or path.read_bytes().count(b"\n") > 2


SMALL_TRAINING = [
    "-m", "solar_env", "train", "--algo", "ppo", "--model", "rigid-ideal", "--timesteps", "100000", "--n-envs", "2",
    "--hyperparams", "n_steps=20", "batch_size=20", "--checkpoint-interval", "40", "--quiet",
]  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "begun", "kept"),
    [
        (["-m", "solar_env", "simulate", "--duration", "1e6", "--output-step", "1e5"], None, "nothing was kept"),
        (
            ["-m", "solar_env", "design", "--members", "1", "--jobs", "2", "--out", "{}"],
            "*.jsonl", "kept .* results in .*; the same command goes on from there",
        ),
        (
            [*SMALL_TRAINING, "--out", "{}"],
            "checkpoint-previous.npz", "kept the checkpoint of step .* --resume .* goes on",
        ),
    ],
    ids=["simulate", "design", "train"],
)  # fmt: skip
def test_ctrl_c_in_a_terminal_ends_a_command_at_once(tmp_path, arguments, begun, kept):
    words = [word.format(tmp_path / "out") for word in arguments]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    # A group of its own: Ctrl-C reaches all its processes, as from a terminal.
    process = subprocess.Popen(
        [sys.executable, *words], cwd=ROOT, env=environment, text=True, stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and process.poll() is None:
        time.sleep(0.2)
        if begun is None and time.monotonic() > deadline - 105:
            break
        if begun is not None and any(has_begun(path) for path in tmp_path.glob(f"out/{begun}")):
            break
    os.killpg(process.pid, signal.SIGINT)
    pressed = time.monotonic()
    _, error = process.communicate(timeout=60)
    assert process.returncode == 130, error
    assert time.monotonic() - pressed < 5.0, "a second, and what a machine under load takes to end a process"
    assert "Traceback" not in error
    lines = [line for line in error.splitlines() if line.startswith("interrupted")]
    assert len(lines) == 1
    assert re.fullmatch(f"interrupted; {kept}", lines[0])
