"""Ctrl-C: one line that says what was kept, and exit status 130, in every command."""

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
    """Add a note, which `kept` returns and which says what was kept, to a Ctrl-C or a full disk within the block."""
    try:
        yield
    except (KeyboardInterrupt, OSError) as stop:
        stop.add_note(kept())
        raise


def report_interruption(stop: KeyboardInterrupt) -> int:
    """Print the notes of an interruption, which say what was kept, in one line; return the exit status."""
    # A second Ctrl-C must not disturb libraries, which end their processes when this one exits.
    atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
    # On exit Python would collect all objects of PyTorch and the compiler once more, which takes seconds under load.
    atexit.register(gc.freeze)
    print("; ".join(["interrupted", *getattr(stop, "__notes__", ())]), file=sys.stderr)
    return EXIT_STATUS


@contextmanager
def _answering(handler: Callable[..., object] | signal.Handlers) -> Iterator[None]:
    """Answer Ctrl-C by `handler` within the block; only the main thread hears Ctrl-C, so other threads skip this."""
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
    """Let Ctrl-C end the block wherever it comes.

    Where C code has called Python, as compilers do, the KeyboardInterrupt is lost. It is then raised again, and takes
    the place of an error that the lost one has caused.
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
def deaf() -> Iterator[None]:
    """Delay Ctrl-C to the end of the block, for work that must not be cut in two.

    A mask of signals would not do: a mask is one thread's, and the system gives Ctrl-C to any other thread instead.
    """
    heard: list[object] = []
    try:
        with _answering(lambda *_: heard.append(True)):
            yield
    finally:
        if heard:
            signal.raise_signal(signal.SIGINT)


@contextmanager
def starting_workers() -> Iterator[None]:
    """Let processes that start within the block ignore Ctrl-C for good.

    Ctrl-C reaches all processes of a terminal. The parent answers it, though not within the block.
    """
    with _answering(signal.SIG_IGN):
        yield
