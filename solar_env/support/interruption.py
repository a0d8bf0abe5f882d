"""Ctrl-C: one line that says what was kept, and exit status 130, in every command."""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import parent_process

EXIT_STATUS = 130  # 128 + SIGINT, as shells have it


@contextmanager
def keeping(kept: Callable[[], str]) -> Iterator[None]:
    """Let Ctrl-C within the block say what was kept, in the words of `kept`."""
    try:
        yield
    except KeyboardInterrupt as stop:
        stop.add_note(kept())
        raise


def report_interruption(stop: KeyboardInterrupt) -> int:
    """Say in one line what the notes of an interruption say was kept; returns the exit status."""
    notes = getattr(stop, "__notes__", [])
    print(f"interrupted; {'; '.join(notes) or 'nothing was kept'}", file=sys.stderr)
    return EXIT_STATUS


def leave_interruption_to_parent() -> None:
    """In a worker process: let Ctrl-C, which reaches all processes of a terminal, be the parent's alone to answer."""
    if parent_process() is not None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
