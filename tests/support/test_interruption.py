"""Ctrl-C ends every command with exit status 130 and one line of what was kept, in worker processes too."""

import builtins
import ctypes
import os
import re
import signal
import subprocess
import sys
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


@pytest.mark.parametrize(("notes", "told"), [(["kept the half of it"], "; kept the half of it"), ([], "")])
def test_every_command_ends_with_130_and_one_line(notes, told, monkeypatch, capsys):
    monkeypatch.setattr("importlib.import_module", lambda _: interrupt(*notes))
    for name in table.rows(table.COMMANDS):
        assert command_line.main([name]) == 130
        assert capsys.readouterr().err == f"interrupted{told}\n"


def test_so_does_the_script_while_packages_are_being_loaded(capsys, monkeypatch):
    load = builtins.__import__
    monkeypatch.setattr(
        builtins, "__import__", lambda name, *rest: interrupt() if name == "solar_env.__main__" else load(name, *rest)
    )
    assert script.main(["train"]) == 130
    assert capsys.readouterr().err == "interrupted; nothing was kept\n"


@pytest.mark.parametrize("afterwards", ["it goes on", "it fails"])
def test_ctrl_c_where_c_has_called_python_is_heard(afterwards, capsys):
    def in_a_callback(call):
        """Call Python from C, as a compiler does: an exception does not get out of it."""
        ctypes.CFUNCTYPE(None)(call)()

    def press():
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1)

    @interruption.hearing()
    def work():
        in_a_callback(press)
        if afterwards == "it fails":
            raise RuntimeError("no compiled object yet")
        in_a_callback(lambda: time.sleep(1))  # where it comes again, and is lost again
        time.sleep(10)

    usual = sys.unraisablehook
    with pytest.raises(KeyboardInterrupt):
        work()
    assert capsys.readouterr().err == ""
    assert sys.unraisablehook is usual


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


CAMPAIGN = """
import sys, time
from dataclasses import make_dataclass
from pathlib import Path
from types import SimpleNamespace
from solar_env import __main__
from solar_env.commands import table
from solar_env.support.campaigns import Campaign

def nap(cell):
    time.sleep(0.2)

def run(args):
    list(Campaign(nap, [{"number": number} for number in range(1000)], Path(sys.argv[1])).run(2))

table.load = lambda *_: SimpleNamespace(Args=make_dataclass("Args", []), run_command=run)
sys.exit(__main__.main(["design"]))
"""
TRAINING = [
    "-m", "solar_env", "train", "--algo", "ppo", "--model", "rigid-ideal", "--timesteps", "20000", "--n-envs", "2",
    "--hyperparams", "n_steps=20", "batch_size=20", "--quiet", "--out",
]  # fmt: skip


@pytest.mark.parametrize(
    ("words", "begun", "kept"),
    [
        pytest.param(["-c", CAMPAIGN], "*out", "kept .* results in .*; the same command goes on from there", id="runs"),
        pytest.param(
            TRAINING, "out/last_model.zip", "solar-env train --resume .* goes on from the last validation",
            id="train", marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
def test_ctrl_c_in_a_terminal_ends_a_command_at_once(tmp_path, words, begun, kept):
    # A group of its own: Ctrl-C reaches all its processes, as from a terminal.
    process = subprocess.Popen(
        [sys.executable, *words, str(tmp_path / "out")], cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)},
        text=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and process.poll() is None:
        time.sleep(0.1)
        # The workers of a campaign have given a result each, or a validation is over.
        if any(path.name != "out" or path.read_bytes().count(b"\n") > 2 for path in tmp_path.glob(begun)):
            break
    os.killpg(process.pid, signal.SIGINT)
    pressed = time.monotonic()
    _, error = process.communicate(timeout=60)
    assert process.returncode == 130, error
    assert time.monotonic() - pressed < 5.0, "a second, and what a machine under load takes to end a process"
    assert re.fullmatch(f"interrupted; {kept}\n", error.splitlines(keepends=True)[-1]), error
