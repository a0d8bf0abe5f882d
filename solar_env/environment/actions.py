"""Actions as users give them, for environments and their wrappers."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def as_floats(action: Any) -> NDArray[np.float64]:
    """An action as an array of its own of floating-point numbers.

    Raises:
        ValueError, TypeError: if it is no array of numbers, or has one that is too large for floating point.
    """
    try:
        return np.array(action, dtype=np.float64)
    except OverflowError as error:  # of a whole number of Python, which has no limit
        raise ValueError("action is not finite in floating point; give numbers from -1 to 1") from error
