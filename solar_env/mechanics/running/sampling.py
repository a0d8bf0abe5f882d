"""When a run is sampled; to know this, nothing is compiled."""

import math

import numpy as np
from numpy.typing import NDArray

_MOST_SAMPLES = 10_000_000


def sample_times(duration: float, output_step: float) -> NDArray[np.float64]:
    """Times [s] every `output_step` [s] from 0, and at the end of `duration` [s].

    Raises:
        ValueError: if one of them is not positive and finite, or the samples are too many.
    """
    for name, value in (("duration", duration), ("output_step", output_step)):
        if not 0.0 < value < math.inf:
            raise ValueError(f"{name} = {value!r} s must be positive and finite")
    count = duration / output_step
    if count > _MOST_SAMPLES:
        raise ValueError(
            f"output_step = {output_step!r} s makes {count:.3g} samples of {duration!r} s, more than "
            f"{_MOST_SAMPLES:,}; choose at least {duration / _MOST_SAMPLES:.2g} s, or simulate a shorter time"
        )
    return np.append(np.arange(math.ceil(count - 1e-9)) * output_step, duration)
