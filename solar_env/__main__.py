"""The command line, `solar-env COMMAND`; `python -m solar_env` is the same where no script is installed.

`COMMANDS` names all of them by their modules, those of `agents` too: the package itself knows nothing of `agents`.
"""

import errno
import importlib
import os
import sys
import warnings
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any, NamedTuple

from solar_env.support.interruption import first_alone, report_interruption

PROG = "solar-env"
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EIO)  # of output that has no name


class Command(NamedTuple):
    """A row of the table: a module with a dataclass `Args` and a function `run_command(args)`."""

    module: str
    summary: str

    def load(self) -> Any:
        """The module, which is loaded only where its command runs."""
        return importlib.import_module(self.module)


# Group -> command -> row.
COMMANDS = {
    "an array": {
        "parameters": Command("solar_env.commands.parameters", "print a complete file of parameters, each explained"),
        "simulate": Command("solar_env.commands.simulate", "simulate one deployment"),
        "loads": Command(
            "solar_env.commands.studies.loads", "say how hard hinges and hub are hit, and how sure that is"
        ),
    },
    "controllers": {
        "train": Command("agents.commands.train", "train an agent, and compare it with the baselines"),
        "tune": Command("agents.commands.tune", "tune a law"),
        "evaluate": Command("agents.commands.evaluate", "compare controllers on the same episodes"),
        "play": Command("solar_env.commands.play", "drive the array by hand, in a window"),
        "record": Command("agents.commands.showing.record", "film an episode of a controller"),
        "replay": Command("agents.commands.showing.replay", "show controllers side by side, in motion, on a page"),
        "show": Command("agents.commands.showing.show", "draw one episode of several controllers, and animate them"),
        "attack": Command("agents.commands.attack", "search torques for what the reward would pay for"),
        "curves": Command("agents.commands.curves", "train over seeds and draw the learning curves"),
        "export": Command("agents.commands.export", "ship a trained policy"),
        "header": Command("agents.commands.header", "write a shipped policy as one C header"),
    },
    "trust": {
        "verify": Command("solar_env.commands.verify", "run the cases with known answers"),
        "chart": Command("solar_env.commands.studies.chart", "measure speed against accuracy and draw it"),
        "ladder": Command(
            "solar_env.commands.studies.ladder", "measure which level of the model answers which question"
        ),
        "stability": Command("solar_env.commands.studies.stability", "map where methods fail"),
        "paper": Command("solar_env.commands.studies.paper", "draw the figures of the paper and judge what it says"),
    },
    "studies": {
        "design": Command(
            "solar_env.commands.studies.design", "map peak force and wear over clearances and stiffnesses"
        ),
        "ground-test": Command("solar_env.commands.studies.ground_test", "repeat deployments with the wear fed back"),
        "bench": Command("solar_env.commands.studies.bench", "measure environment steps per second"),
        "figures": Command("solar_env.commands.figures", "draw the pictures of the pages"),
        "warmup": Command("solar_env.commands.warmup", "compile all kernels, which later runs load"),
    },
}


def command_named(name: str) -> Command:
    """The row of a command.

    Raises:
        ValueError: if there is none.
    """
    from solar_env.array.names import unknown_name

    rows = {own: row for group in COMMANDS.values() for own, row in group.items()}
    if name not in rows:
        raise ValueError(f"{unknown_name('command', name, rows)} ({PROG} --help lists them)")
    return rows[name]


def overview() -> str:
    """All commands, in groups, a line each."""
    lines = [f"usage: {PROG} COMMAND [OPTIONS]", f"       {PROG} COMMAND --help", f"       {PROG} --version", ""]
    lines += ["Deployment of a spacecraft's solar array: simulation, loads, and controllers.", ""]
    for title, group in COMMANDS.items():
        lines.append(f"{title}:")
        lines += [f"  {name:<12}{row.summary}" for name, row in group.items()]
        lines.append("")
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; returns the exit status.

    0: done; 1: a verification or map failed; 2: wrong input or a failed run; 130: interrupted by Ctrl-C.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    usual = warnings.formatwarning
    warnings.formatwarning = lambda message, *_, **__: f"warning: {message}\n"  # without the line of code
    try:
        with first_alone():
            status = _answer(words)
        if sys.stdout is not None:
            sys.stdout.flush()
        return status
    except BrokenPipeError:  # who reads the output has left, as `head` does
        _drop_output()
        return 0
    except (ValueError, OSError, MemoryError) as error:
        _drop_output()
        print("; ".join([f"error: {_sentence(error)}", *getattr(error, "__notes__", ())]), file=sys.stderr)
        return 2
    except KeyboardInterrupt as stop:
        return report_interruption(stop)
    finally:
        warnings.formatwarning = usual


def _answer(words: Sequence[str]) -> int:
    if not words or words[0] in ("-h", "--help"):
        print(overview(), end="", file=sys.stdout if words else sys.stderr)
        return 0 if words else 2
    if words[0] == "--version":
        print(f"{PROG} {version('solar-env')}")
        return 0
    return _run(words[0], words[1:])


def _sentence(error: Exception) -> str:
    """What an error says; one of the system without its number."""
    if isinstance(error, MemoryError):
        return f"memory has no room for what was asked for ({str(error) or 'it is full'}); ask for less"
    if not isinstance(error, OSError) or error.strerror is None:
        return str(error)
    if error.filename is not None and error.errno in _FULL:
        return f"{error.filename} cannot be written ({error.strerror}); make room, or choose another place"
    if error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    if error.errno in _FULL:
        return f"the output cannot be written ({error.strerror}); make room, or send it elsewhere"
    return error.strerror


def _drop_output() -> None:
    """Let what is left of the output go nowhere: else Python tries once more at its end, and says so at length."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def execute(name: str, words: Sequence[str]) -> int:
    """Run a command by its name and the words behind it; its exit status.

    Raises:
        SystemExit: wrong input, of which a sentence is printed, or the help was asked for.
        ValueError, OSError, SimulationError: what the command raises.
    """
    module = command_named(name).load()
    from solar_env.commands.arguments import parse_arguments

    status: int = module.run_command(parse_arguments(module.Args, words, f"{PROG} {name}"))
    return status


def _run(name: str, words: Sequence[str]) -> int:
    try:
        return execute(name, words)
    except SystemExit as stop:  # of the parser
        return int(stop.code or 0)
    except RuntimeError as error:
        if isinstance(error.__cause__, KeyboardInterrupt):  # Python's, of Ctrl-C while a class is being made
            raise error.__cause__ from None
        from solar_env.mechanics.running.errors import SimulationError

        if not isinstance(error, SimulationError):
            raise
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
