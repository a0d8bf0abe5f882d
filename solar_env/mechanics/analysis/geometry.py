"""Shapes of bodies from their coordinates, for drawing and for figures. Plain NumPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import FLEXIBLE, Model

Array = NDArray[np.float64]


def centreline(model: Model, q: Array, body: int, points_per_element: int = 8) -> Array:
    """Points along the axis of a body, from its first end to its last, as a polyline.

    The axis of a flexible body is a cubic polynomial between nodes (``flexible.py``), of which every element gives
    equally spaced points; a node that two elements share counts once. A rigid body gives its two base points.

    Args:
        model: of the mechanism.
        q: (..., n) generalized coordinates, at one time or at several.
        body: row of the body in ``model.bodies``.
        points_per_element: points on every element beyond its first node, 1 or more.

    Returns:
        (..., k, 2) points [m]; k = elements * points_per_element + 1, or 2 for a rigid body. They share no memory
        with ``q``.

    Raises:
        ValueError: if ``points_per_element`` is below 1.
    """
    if points_per_element < 1:
        raise ValueError(f"points_per_element = {points_per_element!r} must be at least 1")
    record = model.bodies[body]
    first = int(record["offset"])
    own = np.asarray(q, dtype=np.float64)[..., first : first + int(record["coordinates"])]
    if record["kind"] != FLEXIBLE:
        return own.reshape(*own.shape[:-1], 2, 2).copy()
    nodes = own.reshape(*own.shape[:-1], int(record["elements"]) + 1, 2, 2)
    shares = np.arange(points_per_element) / points_per_element
    inner = _interpolate(nodes[..., :-1, :, :], nodes[..., 1:, :, :], float(record["element_length"]), shares)
    return np.concatenate([inner, nodes[..., -1:, 0, :]], axis=-2)


def _interpolate(start: Array, end: Array, length: float, shares: Array) -> Array:
    """Cubic Hermite interpolation within every element.

    Args:
        start, end: (..., elements, 2, 2) position [m] and slope at the nodes of the elements.
        length: of an element [m].
        shares: (p,) where, from 0 at the start to 1 at the end.

    Returns:
        (..., elements * p, 2) points [m].
    """
    s = shares[:, None]
    weights = ((1.0 + 2.0 * s) * (1.0 - s) ** 2, length * s * (1.0 - s) ** 2,
               s * s * (3.0 - 2.0 * s), length * s * s * (s - 1.0))  # fmt: skip
    nodal = (start[..., None, 0, :], start[..., None, 1, :], end[..., None, 0, :], end[..., None, 1, :])
    points = sum(weight * value for weight, value in zip(weights, nodal, strict=True))
    return np.reshape(points, (*start.shape[:-3], -1, 2))
