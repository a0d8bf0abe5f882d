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
    """Let Ctrl-C within the block, or a disk that is full, say what was kept, in the words of `kept`."""
    try:
        yield
    except (KeyboardInterrupt, OSError) as stop:
        stop.add_note(kept())
        raise


def report_interruption(stop: KeyboardInterrupt) -> int:
    """Say in one line what was kept, by the notes of an interruption; returns the exit status."""
    # Libraries end their processes at the exit of this one.
    atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
    # Python's last collections would go over all that PyTorch and the compiler have loaded: seconds under load.
    atexit.register(gc.freeze)
    print("; ".join(["interrupted", *getattr(stop, "__notes__", ())]), file=sys.stderr)
    return EXIT_STATUS


@contextmanager
def _answering(handler: Callable[..., object] | signal.Handlers) -> Iterator[None]:
    """Answer Ctrl-C by `handler` within the block; in other threads than the main one, which hear none, as before."""
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

    Where C has called Python, as compilers do, its exception is lost: it is raised again, and an error that comes of
    the lost one is replaced.
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
    """Hear Ctrl-C only at the end of the block, for what must not be torn.

    A mask of signals would not do: it is one thread's, and the system gives Ctrl-C to any other thread of the process.
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
    """Let processes that start within the block ignore Ctrl-C for good, which reaches all processes of a terminal.

    It is for their parent to answer, though not within the block.
    """
    with _answering(signal.SIG_IGN):
        yield
