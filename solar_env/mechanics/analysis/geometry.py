"""Shapes of bodies from their coordinates, for drawing and for figures. Plain NumPy."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.integrators.formulations import FORMULATIONS

Array = NDArray[np.float64]


def centreline(model: Any, q: Array, body: int, points_per_element: int = 8) -> Array:
    """Points along the axis of a body, from its first end to its last, as a polyline.

    The axis of a beam is a cubic polynomial between nodes, of which every element gives equally spaced points; a node
    that two elements share counts once. A modal panel counts as eight elements. A rigid body gives the two ends of its
    x axis.

    Args:
        model: of the mechanism.
        q: (..., n) generalized coordinates, at one time or at several.
        body: row of the body in `model.bodies`.
        points_per_element: points on every element beyond its first node, 1 or more.

    Returns:
        (..., k, 2) points [m]; k = elements * points_per_element + 1, or 2 for a rigid body. They share no memory
        with `q`.

    Raises:
        ValueError: if `points_per_element` is below 1.
    """
    if points_per_element < 1:
        raise ValueError(f"points_per_element = {points_per_element!r} must be at least 1")
    return FORMULATIONS[type(model)].centreline(model, np.asarray(q, dtype=np.float64), body, points_per_element)
