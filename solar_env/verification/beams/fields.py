"""Positions, velocities and momenta of bodies, computed from coordinates; cubic Hermite splines interpolate beams."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from solar_env.mechanics.mechanism import Body, FlexibleBody, Mechanism
from solar_env.mechanics.running.trajectory import Trajectory

Field = NDArray[np.complex128]


def flexible_body(mechanism: Mechanism) -> FlexibleBody:
    """Return the first body of a mechanism, which must be flexible."""
    body = mechanism.bodies[0]
    assert isinstance(body, FlexibleBody)
    return body


def coordinates_of(body: FlexibleBody, first: int = 0) -> slice:
    """Return the slice of the mechanism's coordinates that holds a beam's coordinates, which begin at index `first`."""
    return slice(first, first + 4 * (body.elements + 1))


def as_complex(coordinates: NDArray[np.float64]) -> Field:
    """Convert coordinates (..., 2 * points), alternately x and y, to complex numbers x + i y (points, ...)."""
    pairs = coordinates.reshape(*coordinates.shape[:-1], -1, 2)
    return np.moveaxis(pairs[..., 0] + 1j * pairs[..., 1], -1, 0)


def nodes(body: FlexibleBody, values: NDArray[np.float64], first: int = 0) -> tuple[Field, Field]:
    """Return a beam's nodal positions and slope vectors x + i y, each (nodes, ...), or their velocities.

    `values` (..., n) are the mechanism's coordinates or velocities; the beam's begin at index `first` of the last axis.
    """
    points = as_complex(np.asarray(values)[..., coordinates_of(body, first)])
    return points[0::2], points[1::2]


def tip(body: FlexibleBody, values: NDArray[np.float64]) -> Any:
    """Return the last node's position x + i y if `values` are coordinates, or its velocity if they are velocities."""
    return nodes(body, values)[0][-1]


def beam_points(
    body: FlexibleBody, coordinates: NDArray[np.float64], velocities: NDArray[np.float64], first: int
) -> tuple[Field, Field, NDArray[np.float64]]:
    """Return positions and velocities (..., points), x + i y, and masses (points,) [kg] at a beam's Gauss points.

    Coordinates start at index `first`. Mass-weighted sums integrate products of positions and velocities exactly.
    """
    x, weights = np.polynomial.legendre.leggauss(4)
    ends, size = np.linspace(0.0, body.length, body.elements + 1), body.length / body.elements
    points = ((np.arange(body.elements)[:, None] + 0.5 * (x + 1.0)) * size).ravel()
    mass = body.linear_density * np.tile(0.5 * size * weights, body.elements)
    splines = [CubicHermiteSpline(ends, *nodes(body, values, first)) for values in (coordinates, velocities)]
    place, velocity = (np.moveaxis(spline(points), 0, -1) for spline in splines)
    return place, velocity, mass


def momenta(mechanism: Mechanism, motion: Trajectory) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Return linear momenta x + i y [kg m/s], and angular momenta about the origin [kg m2/s], each (times, bodies).

    They are computed only from the motion of base points or nodes and the masses in the mechanism's description.
    """
    linear, angular = [], []
    first = 0
    for body in mechanism.bodies:
        if isinstance(body, FlexibleBody):
            last = first + 4 * (body.elements + 1)
            place, velocity, mass = beam_points(body, motion.coordinates, motion.velocities, first)
            linear.append(velocity @ mass)
            angular.append((place.conj() * velocity).imag @ mass)
        else:
            assert isinstance(body, Body)
            last = first + 4
            p1, p2 = as_complex(motion.coordinates[:, first:last])
            v1, v2 = as_complex(motion.velocities[:, first:last])
            share = complex(*body.centroid) / body.length
            spin = ((v2 - v1) / (p2 - p1)).imag
            centre, momentum = p1 + share * (p2 - p1), body.mass * (v1 + share * (v2 - v1))
            linear.append(momentum)
            angular.append((centre.conj() * momentum).imag + body.inertia * spin)
        first = last
    return np.array(linear).T, np.array(angular).T
