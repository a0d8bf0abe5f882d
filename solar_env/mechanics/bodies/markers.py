"""Markers, points of bodies with a direction: motion, loads, and their derivatives with respect to the coordinates.

A marker depends linearly on two coordinate pairs p1 and p2 of its body: the two base points of a rigid body, or
position and slope vector at a beam's node. With constants a1, b1, a2, b2 and c1 of the marker and J = rotation by 90
degrees, position = (a1 + b1 J) p1 + (a2 + b2 J) p2 and direction = c1 p1 + p2. On a rigid body the direction is
p2 - p1, with the body's length; on a beam it is p2, with the local stretch as length. Velocities give rates likewise.
"""

import math

import numpy as np

from solar_env.mechanics.arrays.model import record
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry

marker_type = record(
    [
        ("body", np.int64),
        ("i1", np.int64),  # first coordinate of p1
        ("i2", np.int64),
        ("a1", np.float64),
        ("b1", np.float64),
        ("a2", np.float64),
        ("b2", np.float64),
        ("c1", np.float64),
    ]
)


def pair_coordinates(row: np.void) -> list[int]:
    """Return the indices in q of x1, y1, x2, y2: the two points or vectors on which the marker record `row` depends."""
    return [int(row["i1"]), int(row["i1"]) + 1, int(row["i2"]), int(row["i2"]) + 1]


def place_row(row: np.void, axis: int) -> dict[int, float]:
    """Return marker `row`'s x (`axis` 0) or y (1) as a linear function of q: {index in q: nonzero coefficient}."""
    turn = -1.0 if axis == 0 else 1.0
    entries: dict[int, float] = {}
    for first, a, b in ((int(row["i1"]), row["a1"], row["b1"]), (int(row["i2"]), row["a2"], row["b2"])):
        for index, value in ((first + axis, float(a)), (first + 1 - axis, turn * float(b))):
            if value != 0.0:
                entries[index] = entries.get(index, 0.0) + value
    return entries


@kernel
def place(marker, x):
    """Return a marker's position [m] if `x` (n,) are coordinates, or its velocity [m/s] if `x` are velocities."""
    i, k = marker.i1, marker.i2
    return (
        marker.a1 * x[i] - marker.b1 * x[i + 1] + marker.a2 * x[k] - marker.b2 * x[k + 1],
        marker.a1 * x[i + 1] + marker.b1 * x[i] + marker.a2 * x[k + 1] + marker.b2 * x[k],
    )


@kernel
def direction(marker, x):
    """Return a marker's direction vector if `x` (n,) are coordinates, or the vector's rate if `x` are velocities."""
    i, k = marker.i1, marker.i2
    return marker.c1 * x[i] + x[k], marker.c1 * x[i + 1] + x[k + 1]


@kernel
def spin(marker, q, v):
    """Return the angular velocity [rad/s] of a marker's direction."""
    dx, dy = direction(marker, q)
    ux, uy = direction(marker, v)
    return (dx * uy - dy * ux) / (dx * dx + dy * dy)


@kernel
def vector_angle(marker, q, x, y):
    """Return the angle [rad] from a marker's direction to the vector (x, y)."""
    dx, dy = direction(marker, q)
    return math.atan2(dx * y - dy * x, dx * x + dy * y)


@kernel
def add_point_force(marker, fx, fy, force):
    """Add the generalized force of a point force (fx, fy) [N] at a marker to `force` (n,)."""
    i, k = marker.i1, marker.i2
    force[i] += marker.a1 * fx + marker.b1 * fy
    force[i + 1] += marker.a1 * fy - marker.b1 * fx
    force[k] += marker.a2 * fx + marker.b2 * fy
    force[k + 1] += marker.a2 * fy - marker.b2 * fx


@kernel
def add_torque(marker, q, torque, force):
    """Add a torque's generalized force to `force` (n,): the torque [N m] times the direction angle's gradient."""
    dx, dy = direction(marker, q)
    scale = torque / (dx * dx + dy * dy)
    i, k = marker.i1, marker.i2
    force[i] -= marker.c1 * scale * dy
    force[i + 1] += marker.c1 * scale * dx
    force[k] -= scale * dy
    force[k + 1] += scale * dx


@kernel(inlined=False)
def angle_hessian(dx, dy):
    """Return the entries (xx, xy) of the Hessian of atan2(dy, dx) with respect to (dx, dy); yy = -xx."""
    fourth = (dx * dx + dy * dy) ** 2
    return 2.0 * dx * dy / fourth, (dy * dy - dx * dx) / fourth


@kernel
def fill_slopes(marker, q, v, side, index, gradient, rate_slope):
    """Write derivatives of the motion of marker number `side` (0 or 1) of a pair with respect to its four coordinates.

    They go to columns 4 * side to 4 * side + 3 of `gradient` and `rate_slope` (4, 8), which must be zero before.
    `gradient` gets the derivatives of x and y in rows 0 and 1, and of the direction angle in row 2 + side. `rate_slope`
    gets the derivatives of the angle's rate in row 2 + side. `index` (8,) gets the coordinates' indices in q.
    """
    k, angle = 4 * side, 2 + side
    index[k], index[k + 1] = marker.i1, marker.i1 + 1
    index[k + 2], index[k + 3] = marker.i2, marker.i2 + 1
    x, y = gradient[0], gradient[1]
    x[k], x[k + 1], x[k + 2], x[k + 3] = marker.a1, -marker.b1, marker.a2, -marker.b2
    y[k], y[k + 1], y[k + 2], y[k + 3] = marker.b1, marker.a1, marker.b2, marker.a2
    dx, dy = direction(marker, q)
    ux, uy = direction(marker, v)
    hxx, hxy = angle_hessian(dx, dy)
    squared = dx * dx + dy * dy
    gx, gy = -dy / squared, dx / squared
    sx, sy = hxx * ux + hxy * uy, hxy * ux - hxx * uy
    turn, spin = gradient[angle], rate_slope[angle]
    turn[k], turn[k + 1], turn[k + 2], turn[k + 3] = marker.c1 * gx, marker.c1 * gy, gx, gy
    spin[k], spin[k + 1], spin[k + 2], spin[k + 3] = marker.c1 * sx, marker.c1 * sy, sx, sy


@kernel
def subtract_hessian(marker, q, torque, elimination, matrix):
    """Subtract torque * (Hessian of a marker's direction angle) from a profile matrix in the order `elimination`."""
    dx, dy = direction(marker, q)
    hxx, hxy = angle_hessian(dx, dy)
    for row in range(2):
        first = marker.i1 if row == 0 else marker.i2
        c = marker.c1 if row == 0 else 1.0
        for column in range(2):
            second = marker.i1 if column == 0 else marker.i2
            d = -torque * c * (marker.c1 if column == 0 else 1.0)
            add_entry(elimination, matrix, first, second, d * hxx)
            add_entry(elimination, matrix, first, second + 1, d * hxy)
            add_entry(elimination, matrix, first + 1, second, d * hxy)
            add_entry(elimination, matrix, first + 1, second + 1, -d * hxx)
