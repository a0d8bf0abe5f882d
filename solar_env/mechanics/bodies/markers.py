"""Place and direction of a body's markers, their rates, and the generalized forces of loads there, by kind.

Each function chooses by the marker's kind of body; nothing else looks into a marker's row.
"""

import math

from solar_env.mechanics.bodies import linear_marker, reference_point
from solar_env.mechanics.bodies.kinds import REFERENCE_POINT
from solar_env.mechanics.numerics.jit import kernel


@kernel(inlined=True)
def place(marker, q):
    """Place (x, y) [m] of the marker."""
    if marker.kind == REFERENCE_POINT:
        return reference_point.place(marker, q)
    return linear_marker.place(marker, q)


@kernel(inlined=True)
def velocity(marker, q, v):
    """Velocity (x, y) [m/s] of the marker's place."""
    if marker.kind == REFERENCE_POINT:
        return reference_point.velocity(marker, q, v)
    return linear_marker.place(marker, v)


@kernel(inlined=True)
def direction(marker, q):
    """Direction vector of the marker, of any length but zero."""
    if marker.kind == REFERENCE_POINT:
        return reference_point.direction(marker, q)
    return linear_marker.direction(marker, q)


@kernel(inlined=True)
def direction_rate(marker, q, v):
    """Rate of change of the direction vector."""
    if marker.kind == REFERENCE_POINT:
        return reference_point.direction_rate(marker, q, v)
    return linear_marker.direction(marker, v)


@kernel(inlined=True)
def spin(marker, q, v):
    """Angular velocity [rad/s] of the marker's direction."""
    if marker.kind == REFERENCE_POINT:
        return reference_point.spin(marker, v)
    return linear_marker.spin(marker, q, v)


@kernel(inlined=True)
def vector_angle(marker, q, x, y):
    """Angle [rad] of a vector, counted from the marker's direction."""
    dx, dy = direction(marker, q)
    return math.atan2(dx * y - dy * x, dx * x + dy * y)


@kernel(inlined=True)
def add_point_force(marker, q, fx, fy, force):
    """Add to `force` (n,) the generalized force of a force [N] at the marker's place."""
    if marker.kind == REFERENCE_POINT:
        reference_point.add_point_force(marker, q, fx, fy, force)
    else:
        linear_marker.add_point_force(marker, fx, fy, force)


@kernel(inlined=True)
def add_torque(marker, q, torque, force):
    """Add to `force` (n,) the generalized force of a torque [N m] on the marker's direction."""
    if marker.kind == REFERENCE_POINT:
        reference_point.add_torque(marker, torque, force)
    else:
        linear_marker.add_torque(marker, q, torque, force)


@kernel(inner=True)
def fill_slopes(marker, q, v, side, index, gradient, rate_slope):
    """Fill the slopes of a marker's motion by its coordinates, at most four, in columns 4 * side and following.

    Args:
        marker: row of the marker.
        q, v: (n,) coordinates and velocities.
        side: 0 or 1.
        index: (8,) the coordinates; those beyond the marker's own repeat the last one, with zero slopes.
        gradient: (4, 8) slopes of x and y in rows 0 and 1, of the direction's angle in row 2 + side; zero before.
        rate_slope: (4, 8) slopes by the coordinates of the rates of these, likewise.
    """
    if marker.kind == REFERENCE_POINT:
        reference_point.fill_slopes(marker, q, v, side, index, gradient, rate_slope)
    else:
        linear_marker.fill_slopes(marker, q, v, side, index, gradient, rate_slope)


@kernel(inner=True)
def subtract_hessian(marker, q, fx, fy, torque, elimination, matrix):
    """Subtract from `matrix` the slopes by q of a constant force's and torque's generalized force at the marker."""
    if marker.kind == REFERENCE_POINT:
        reference_point.subtract_hessian(marker, q, fx, fy, elimination, matrix)
    else:
        linear_marker.subtract_hessian(marker, q, torque, elimination, matrix)
