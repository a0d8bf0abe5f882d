"""Kills and full disks at random moments of the commands that work for hours, and a table of what was lost.

`python tests/kills.py --kills 200 --full-disks 50` prints it; `--only train` names one command. Every attempt is a
process of its own, forked from one that has everything loaded. A first one, undisturbed, must succeed; the kills are
spread over the time that it took. A full disk is a bound on the size of files, as the system enforces it. After each
attempt all files are read: none may be damaged. A training is then gone on with to its end, and compared with one that
nothing has interrupted.
"""

import argparse
import contextlib
import json
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

from agents.commands import evaluate, train, tune  # noqa: F401  (loaded before processes are forked)
from agents.laws import baselines
from agents.learning import learn, runs
from agents.learning.storage import unpacked
from solar_env.__main__ import main as solar_env
from solar_env.studies.common.tables import read_table
from solar_env.support.files import PART

QUICK = ["--model", "rigid-ideal", "--env-kwargs", "control_period=0.5", "postlock_window=2.0"]
SMALL = ["--algo", "ppo", *QUICK, "--timesteps", "400", "--n-envs", "2", "--eval-episodes", "1", "--jobs", "1"]
SMALL += ["--checkpoint-interval", "40", "--hyperparams", "n_steps=20", "batch_size=20", "--quiet"]
TUNING = ["--controller", "damper", *QUICK, "--episodes", "80", "--validation-episodes", "2", "--jobs", "1", "--quiet"]


def _train(folder: Path) -> None:
    begun = (folder / runs.CONFIG).exists()
    words = ["--resume", str(folder), "--jobs", "1", "--quiet"] if begun else [*SMALL, "--out", str(folder)]
    sys.exit(solar_env(["train", *words]))


def _tune(folder: Path) -> None:
    folder.mkdir(exist_ok=True)
    baselines.CONFIGS = folder
    sys.exit(solar_env(["tune", *TUNING]))


def _evaluate(folder: Path) -> None:
    words = ["--controllers", "passive", *QUICK, "--episodes", "40", "--jobs", "1", "--quiet", "--out", str(folder)]
    sys.exit(solar_env(["evaluate", *words]))


def _command(*words: str) -> Callable[[Path], object]:
    return lambda folder: sys.exit(solar_env([*words, "--out", str(folder)]))


# Each takes the folder in which everything that it writes lies.
COMMANDS: dict[str, Callable[[Path], object]] = {
    "train": _train,
    "evaluate": _evaluate,
    "tune": _tune,
    "design": _command("design", "--members", "1", "--jobs", "1"),
    "precision": _command("study", "precision", "--quick", "--only", "convergence"),
}


def attempt(
    command: Callable[[Path], object], folder: Path, disturb: Callable[[int], None], limit: int | None = None
) -> tuple[int, str]:
    """Run a command in a process of its own and disturb it; returns its status, and what it wrote to the terminal."""
    said, terminal = os.pipe()
    process = os.fork()
    if process == 0:
        os.setsid()
        os.dup2(terminal, 1)
        os.dup2(terminal, 2)
        if limit is not None:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        status = 0
        try:
            command(folder)
        except SystemExit as end:
            status = int(end.code or 0)
        except BaseException:
            import traceback

            with contextlib.suppress(OSError):
                traceback.print_exc()
            status = 99
        os._exit(status)
    os.close(terminal)
    disturb(process)
    _, status = os.waitpid(process, 0)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process, signal.SIGKILL)  # workers that a disturbed process has left hold the terminal open
    with open(said, errors="replace") as log:
        text = log.read()
    return os.waitstatus_to_exitcode(status), text


def damaged(folder: Path) -> list[str]:
    """Names of files that are not whole; those beside their targets are not counted."""
    found = []
    for path in folder.rglob("*"):
        if not path.is_file() or path.name.endswith(PART) or path.suffix == ".new":
            continue
        try:
            _read(path)
        except Exception as error:
            found.append(f"{path.name}: {error}")
    return found


def _read(path: Path) -> None:
    if path.name in runs.CHECKPOINTS:
        unpacked(path)
    elif path.suffix == ".json":
        json.loads(path.read_text())
    elif path.suffix == ".jsonl":
        # The last line may be cut: its cell is done again.
        for line in path.read_text().splitlines(keepends=True):
            if line.endswith("\n"):
                json.loads(line)
    elif path.suffix == ".npz":
        np.load(path).close()
    elif path.suffix == ".png":
        Image.open(path).verify()
    elif path.suffix == ".csv" and not path.name.endswith("monitor.csv") and path.name != "episodes.csv":
        read_table(path)


def end_of_training(folder: Path) -> bytes:
    """State of a training, as bytes."""
    return (folder / runs.CHECKPOINTS[0]).read_bytes()


def campaign(name: str, kills: int, full_disks: int, place: Path, chance: random.Random) -> str:
    """Disturb a command; returns a row of the table."""
    command, begun = COMMANDS[name], time.monotonic()
    status, said = attempt(command, place / "whole", lambda _: None)
    seconds = time.monotonic() - begun
    if status != 0 or damaged(place / "whole"):
        sys.exit(f"{name} ends with {status} undisturbed: {said[-800:]}")
    reference = end_of_training(place / "whole") if name == "train" else b""
    shutil.rmtree(place / "whole")
    counts = {"damaged": 0, "tracebacks": 0, "not as undisturbed": 0, "hung": 0}
    for number in range(kills + full_disks):
        folder = place / f"{name}-{number}"
        if number < kills:
            wait = chance.uniform(0.0, seconds)

            def disturb(process: int, wait: float = wait) -> None:
                end = time.monotonic() + wait
                looking = os.WEXITED | os.WNOHANG | os.WNOWAIT
                while time.monotonic() < end and os.waitid(os.P_PID, process, looking) is None:
                    time.sleep(0.002)
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process, signal.SIGKILL)

            status, said = attempt(command, folder, disturb)
        else:
            begun = time.monotonic()
            status, said = attempt(command, folder, lambda _: None, int(10 ** chance.uniform(0.0, 5.5)))
            counts["hung"] += time.monotonic() - begun > 20.0 * seconds
        counts["tracebacks"] += "Traceback" in said or status == 99
        broken = damaged(folder) if folder.exists() else []
        if broken or "Traceback" in said:
            print(f"{name} {number}: {broken} {said[-800:]}", file=sys.stderr)
        counts["damaged"] += bool(broken)
        if name == "train":
            attempt(command, folder, lambda _: None)
            counts["not as undisturbed"] += end_of_training(folder) != reference
        shutil.rmtree(folder, ignore_errors=True)
    return f"| {name} | {kills} | {full_disks} | " + " | ".join(map(str, counts.values())) + " |"


def main() -> None:
    """Print the table; see the top of the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--full-disks", type=int, default=50)
    parser.add_argument("--only", choices=COMMANDS)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    learn.VALIDATION_EPISODES = 2
    print("| command | kills | full disks | damaged files | tracebacks | not as undisturbed | hung |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as place:
        for name in [args.only] if args.only else COMMANDS:
            chance = random.Random(args.seed)
            print(campaign(name, args.kills, args.full_disks, Path(place), chance), flush=True)


if __name__ == "__main__":
    main()
