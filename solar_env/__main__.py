"""The command line `solar-env COMMAND`; `python -m solar_env COMMAND` does the same without an installed script.

Commands are entries of `[project.entry-points."solar_env.commands"]` in pyproject.toml.
"""

import os
import sys
import warnings
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from solar_env.commands import table
from solar_env.support.interruption import hearing, report_interruption

PROG = "solar-env"


def overview() -> str:
    """Return the help text, which lists all commands with one line per command."""
    lines = [f"usage: {PROG} COMMAND [OPTIONS]", f"       {PROG} COMMAND --help", f"       {PROG} --version", ""]
    lines += ["Deployment of a spacecraft's solar array: simulation, loads, and controllers.", ""]
    lines += [f"  {name:<12}{summary}" for name, summary in table.summaries(table.COMMANDS, "Args").items()]
    return "\n".join([*lines, ""])


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command that `arguments` (by default `sys.argv[1:]`) name, and return the exit status.

    The status is 0 for success, 1 if a check fails, 2 for wrong input or a failed run, 130 for Ctrl-C.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    usual = warnings.formatwarning
    warnings.formatwarning = lambda message, *_, **__: f"warning: {message}\n"  # without the line of code
    try:
        with hearing():
            status = _answer(words)
        if sys.stdout is not None:
            sys.stdout.flush()
        return status
    except SystemExit as stop:  # raised by the parser
        return int(stop.code or 0)
    except BrokenPipeError:  # the reader of the output has closed it, as `head` does
        _drop_output()
        return 0
    except (ValueError, OSError, MemoryError, RuntimeError) as error:
        if isinstance(error, RuntimeError) and not _failed_run(error):
            raise
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
    return execute(words[0], words[1:])


def _sentence(error: Exception) -> str:
    """Return an error's message for the user; for an operating-system error, without the error number."""
    if isinstance(error, MemoryError):
        return f"memory has no room for what was asked for ({str(error) or 'it is full'}); ask for less"
    if not isinstance(error, OSError) or error.strerror is None:
        return str(error)
    return f"{'the output' if error.filename is None else error.filename}: {error.strerror}"


def _failed_run(error: RuntimeError) -> bool:
    from solar_env.mechanics.running.errors import SimulationError

    return isinstance(error, SimulationError)


def _drop_output() -> None:
    """Discard buffered output that cannot be written; otherwise Python tries again on exit and prints a long error."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def execute(name: str, words: Sequence[str]) -> int:
    """Run the command `name` with `words`, the command-line arguments after the name, and return the exit status.

    Raises:
        SystemExit: the arguments ask for help, or are wrong; a printed sentence then explains the error.
        ValueError, OSError, SimulationError: raised by the command.
    """
    module = table.load(table.COMMANDS, name)
    from solar_env.commands.arguments import parse_arguments

    status: int = module.run_command(parse_arguments(module.Args, words, f"{PROG} {name}"))
    return status


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # otherwise a user's folder agents/ hides ours
    sys.exit(main())
