"""Checks of numbers that users or files give, and their plain form."""

from typing import Any

import numpy as np


def is_number(value: object) -> bool:
    """Whether it is an int or a float of Python, as NumPy's float64 is; a bool is none."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_whole_number(value: object, least: int) -> bool:
    """Whether it is an int of Python, no bool, and at least so large."""
    return isinstance(value, int) and not isinstance(value, bool) and value >= least


def plain(value: Any) -> Any:
    """A value with Python's types in place of NumPy's, and tuples in place of lists."""
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    return tuple(plain(entry) for entry in value) if isinstance(value, (list, tuple)) else value
