"""Handling of Ctrl-C in every command: one line says which results were kept, and the exit status is 130."""

import _thread
import atexit
import gc
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

EXIT_STATUS = 130  # 128 + SIGINT, as shells have it


@contextmanager
def keeping(kept: Callable[[], str]) -> Iterator[None]:
    """Add `kept()`, a note on which results were saved, to a KeyboardInterrupt or OSError raised in the block."""
    try:
        yield
    except (KeyboardInterrupt, OSError) as stop:
        stop.add_note(kept())
        raise


def report_interruption(stop: KeyboardInterrupt) -> int:
    """Print an interruption's notes about kept results in one line on standard error; return the exit status."""
    # A second Ctrl-C must not disturb libraries that end their own processes when this process exits.
    atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
    # On exit Python would collect all objects of PyTorch and the compiler once more, which takes seconds under load.
    atexit.register(gc.freeze)
    print("; ".join(["interrupted", *getattr(stop, "__notes__", ())]), file=sys.stderr)
    return EXIT_STATUS


@contextmanager
def _answering(handler: Callable[..., object] | signal.Handlers) -> Iterator[None]:
    """Handle Ctrl-C by `handler` in the block; do nothing in threads other than the main one, which get no Ctrl-C."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def hearing() -> Iterator[None]:
    """Make sure that Ctrl-C ends the block by a KeyboardInterrupt, at any point of the block.

    Python loses a KeyboardInterrupt in Python code that is called from C, for example by a compiler. The interrupt is
    then raised again, and replaces any error that its loss has caused.
    """
    heard: list[object] = []
    timers: list[threading.Timer] = []
    usual = sys.unraisablehook

    def press(*_: object) -> None:
        heard.append(True)
        raise KeyboardInterrupt

    def again(lost: "sys.UnraisableHookArgs") -> None:
        if not heard:
            usual(lost)
            return
        timers.append(threading.Timer(0.05, _thread.interrupt_main))
        timers[-1].daemon = True
        timers[-1].start()

    sys.unraisablehook = again
    try:
        with _answering(press):
            yield
    except Exception as error:
        if heard:
            raise KeyboardInterrupt from error
        raise
    finally:
        sys.unraisablehook = usual
        for timer in timers:
            timer.cancel()


@contextmanager
def starting_workers() -> Iterator[None]:
    """Make processes that start within the block ignore Ctrl-C permanently.

    Ctrl-C reaches all processes of a terminal, but only the parent should handle it; within the block no process does.
    """
    with _answering(signal.SIG_IGN):
        yield
