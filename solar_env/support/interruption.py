"""Ctrl-C: one line that says what was kept, and exit status 130, in every command."""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import parent_process

EXIT_STATUS = 130  # 128 + SIGINT, as shells have it


_waiting: list[Callable[[], str]] = []  # of blocks that have not ended, those of generators that wait included


@contextmanager
def keeping(kept: Callable[[], str]) -> Iterator[None]:
    """Let Ctrl-C before the end of the block say what was kept, in the words of `kept`.

    The block may be that of a generator: where its caller is interrupted, it hears nothing of that itself.
    """
    _waiting.append(kept)
    try:
        yield
    except KeyboardInterrupt as stop:
        stop.add_note(kept())
        raise
    finally:
        _waiting.remove(kept)


def report_interruption(stop: KeyboardInterrupt) -> int:
    """Say in one line what was kept, by the notes of an interruption and by what waits; returns the exit status."""
    notes = [*getattr(stop, "__notes__", []), *(kept() for kept in _waiting)]
    print(f"interrupted; {'; '.join(notes) or 'nothing was kept'}", file=sys.stderr)
    return EXIT_STATUS


def leave_interruption_to_parent() -> None:
    """In a worker process: let Ctrl-C, which reaches all processes of a terminal, be the parent's alone to answer."""
    if parent_process() is not None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
