"""What every call of an environment is checked for: its thread, its actions, its reset options."""

import threading
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array.names import unknown_name


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


def checked_actions(given: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Actions, (motors,) of one array or (lanes, motors) of many, as a new array of floating-point numbers.

    Raises:
        ValueError, TypeError: if they have another shape, are no numbers, or are not finite.
    """
    try:
        actions = np.array(given, dtype=np.float64)
    except OverflowError as error:  # of a whole number of Python, which has no limit
        raise ValueError("action is not finite in floating point; give numbers from -1 to 1") from error
    if actions.shape != shape:
        raise ValueError(f"the action has shape {actions.shape}, expected {shape}")
    if not np.isfinite(actions).all():
        where = "" if actions.ndim == 1 else f" of lane {np.argmin(np.isfinite(actions).all(axis=1))}"
        raise ValueError(f"action{where} is not finite; give numbers from -1 to 1")
    return actions


def checked_options(options: Mapping[str, Any] | None, *known: str) -> dict[str, Any]:
    """The options of a reset.

    Raises:
        ValueError: if one is unknown.
    """
    for name in options or {}:
        if name not in known:
            raise ValueError(unknown_name("the reset option", name, known))
    return dict(options or {})
