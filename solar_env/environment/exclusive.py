"""Refusal of calls from several threads at the same time, which would mix their steps."""

import threading
from typing import Any


class Exclusive:
    """A context that only one thread can be in; a second one is refused. Copies and pickles are free again."""

    def __init__(self) -> None:
        self._lock = threading.Lock()

    def __enter__(self) -> None:
        if not self._lock.acquire(blocking=False):
            raise RuntimeError(
                "this environment is in another call just now: give every thread an environment of its own, or take a "
                "vector environment, which has threads inside"
            )

    def __exit__(self, *what: object) -> None:
        self._lock.release()

    def __reduce__(self) -> tuple[Any, tuple[()]]:
        return Exclusive, ()
