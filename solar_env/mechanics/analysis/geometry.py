"""Centrelines of bodies as points, computed from the generalized coordinates for drawings and plots. Plain NumPy."""

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.equations.formulation import ModelArrays
from solar_env.mechanics.integrators.formulations import FORMULATIONS

Array = NDArray[np.float64]


def centreline(model: ModelArrays, q: Array, body: int, points_per_element: int = 8) -> Array:
    """Return a polyline along a body's axis, from the body's first end to its last.

    Points are equally spaced on the cubic polynomial of every beam element; a modal panel counts as eight elements.

    Args:
        model: model arrays of the mechanism.
        q: (..., n) generalized coordinates, at one time or at several times.
        body: index of the body in `model.bodies`.
        points_per_element: number of points on every element beyond its first node, 1 or more.

    Returns:
        (..., k, 2) points [m]; k = elements * points_per_element + 1, or 2 for a rigid body.
    """
    return FORMULATIONS[type(model)].centreline(model, np.asarray(q, dtype=np.float64), body, points_per_element)
