"""Ctrl-C: one line that says what was kept, and exit status 130, in every command."""

import _thread
import atexit
import gc
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

EXIT_STATUS = 130  # 128 + SIGINT, as shells have it


_left: list[str] = []  # what the last generator said that was left before its end


@contextmanager
def keeping(kept: Callable[[], str]) -> Iterator[None]:
    """Let Ctrl-C within the block, or a disk that is full, say what was kept, in the words of `kept`.

    The block may be that of a generator. Where its caller is interrupted, it is only closed, and does not hear why.
    """
    try:
        yield
    except (KeyboardInterrupt, OSError) as stop:
        stop.add_note(kept())
        raise
    except GeneratorExit:
        _left[:] = [kept()]
        raise


def report_interruption(stop: KeyboardInterrupt) -> int:
    """Say in one line what was kept, by the notes of an interruption or what was left; returns the exit status."""
    # Libraries end their processes at the exit of this one.
    atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
    # Python's last collections would go over all that PyTorch and the compiler have loaded: seconds under load.
    atexit.register(gc.freeze)
    notes = getattr(stop, "__notes__", _left)
    print(f"interrupted; {'; '.join(notes) or 'nothing was kept'}", file=sys.stderr)
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


_AGAIN_AFTER = 0.05  # s


@contextmanager
def first_alone() -> Iterator[None]:
    """Hear one Ctrl-C within the block, and no second one, which would tear what the first lets end, workers too.

    It ends the block wherever it comes. Where C has called Python, as compilers do, the exception that an interruption
    is cannot get through: it is raised again a moment later, and an error that comes of the first one is replaced.
    """
    heard = False
    timers: list[threading.Timer] = []
    usual = sys.unraisablehook

    def first(*_: object) -> None:
        nonlocal heard
        heard = True
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        raise KeyboardInterrupt

    def again(lost: Any) -> None:
        if not (heard and lost.exc_type is KeyboardInterrupt):
            usual(lost)
            return
        signal.signal(signal.SIGINT, first)
        timer = threading.Timer(_AGAIN_AFTER, _thread.interrupt_main)
        timer.daemon = True
        timers.append(timer)
        timer.start()

    sys.unraisablehook = again
    try:
        with _answering(first):
            try:
                yield
            except Exception as error:
                if heard:
                    raise KeyboardInterrupt from error
                raise
            finally:
                for timer in timers:
                    timer.cancel()
    finally:
        sys.unraisablehook = usual


@contextmanager
def deaf() -> Iterator[None]:
    """Hear Ctrl-C only at the end of the block, for what must not be torn.

    A mask of signals would not do: it is one thread's, and the system gives Ctrl-C to any other thread of the process.
    """
    heard = False

    def remember(*_: object) -> None:
        nonlocal heard
        heard = True

    try:
        with _answering(remember):
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
