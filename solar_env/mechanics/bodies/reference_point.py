"""Rigid bodies in reference point coordinates: place (x, y) of the centroid and angle phi.

The mass matrix is diagonal and constant, and no constraint is left; in exchange place and direction of a marker are
trigonometric in phi (J. Garcia de Jalon and E. Bayo, Kinematic and Dynamic Simulation of Multibody Systems, Springer
1994, section 2.1.2, doi:10.1007/978-1-4612-2600-0). It is a body in a floating frame that does not deform.
"""

import math
from typing import Any, ClassVar

import numpy as np

from solar_env.mechanics.bodies.description import Point, ReferencePointBody
from solar_env.mechanics.bodies.kind import Array, BodyKind, Fields
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry


class ReferencePoint(BodyKind[ReferencePointBody]):
    """Rigid bodies in reference point coordinates."""

    description = ReferencePointBody
    body_fields: ClassVar[Fields] = [
        ("mass", np.float64),
        ("inertia", np.float64),
        ("centroid_x", np.float64),  # in the body frame
        ("centroid_y", np.float64),
    ]
    # From the centroid to the marker, in the body frame.
    marker_fields: ClassVar[Fields] = [("offset", np.int64), ("arm_x", np.float64), ("arm_y", np.float64)]

    def coordinates(self, body: ReferencePointBody) -> int:
        """Return three, the number of coordinates."""
        return 3

    def fill(self, body: ReferencePointBody, row: np.void, constants: list[float]) -> None:
        """Fill mass, inertia and centroid."""
        row["length"], row["mass"], row["inertia"] = body.length, body.mass, body.inertia
        row["centroid_x"], row["centroid_y"] = body.centroid

    def fill_marker(self, body: ReferencePointBody, row: np.void, first: int, point: Point) -> None:
        """Fill the arm from the centroid."""
        row["offset"] = first
        row["arm_x"], row["arm_y"] = point[0] - body.centroid[0], point[1] - body.centroid[1]

    def marker_coordinates(self, row: np.void) -> list[int]:
        """Return all three coordinates of the body."""
        return [int(row["offset"]) + k for k in range(3)]

    def initial_motion(self, body: ReferencePointBody) -> tuple[Array, Array]:
        """Return centroid and angle, with their rates, as described."""
        c, s = math.cos(body.angle), math.sin(body.angle)
        x, y = c * body.centroid[0] - s * body.centroid[1], s * body.centroid[0] + c * body.centroid[1]
        q = np.array([body.position[0] + x, body.position[1] + y, body.angle])
        return q, np.array([body.velocity[0] - body.spin * y, body.velocity[1] + body.spin * x, body.spin])

    def weight(self, body: ReferencePointBody, gravity: Point) -> Array:
        """Return the gravity force, which acts at the centroid."""
        return body.mass * np.array([*gravity, 0.0])

    def error_weight(self, body: ReferencePointBody) -> Array:
        """Weigh the angle by the radius of gyration."""
        return np.array([1.0, 1.0, math.sqrt(body.inertia / body.mass)])

    def rigid_motions(self, q: Array) -> Array:
        """Return the rigid motions of centroid and angle."""
        return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-q[1], q[0], 1.0]])

    def centreline(self, row: Any, q: Array, points_per_element: int) -> Array:
        """Return both ends of the body frame's x axis."""
        turn = np.exp(1j * q[..., 2])
        start = q[..., 0] + 1j * q[..., 1] - turn * complex(row["centroid_x"], row["centroid_y"])
        ends = np.stack([start, start + turn * row["length"]], axis=-1)
        return np.stack([ends.real, ends.imag], axis=-1)


@kernel(inlined=True)
def solve_mass(body, force, a):
    """Write the body's M^-1 force into `a` (n,)."""
    k = body.offset
    a[k], a[k + 1], a[k + 2] = force[k] / body.mass, force[k + 1] / body.mass, force[k + 2] / body.inertia


@kernel(inlined=True)
def add_mass_product(body, a, out):
    """Add the body's M a to `out` (n,)."""
    k = body.offset
    out[k] += body.mass * a[k]
    out[k + 1] += body.mass * a[k + 1]
    out[k + 2] += body.inertia * a[k + 2]


@kernel(inner=True)
def add_mass_matrix(body, elimination, matrix):
    """Add the mass matrix to `matrix`."""
    k = body.offset
    add_entry(elimination, matrix, k, k, body.mass)
    add_entry(elimination, matrix, k + 1, k + 1, body.mass)
    add_entry(elimination, matrix, k + 2, k + 2, body.inertia)


@kernel(inlined=True)
def kinetic_energy(body, v):
    """Kinetic energy [J] of the body."""
    k = body.offset
    return 0.5 * body.mass * (v[k] * v[k] + v[k + 1] * v[k + 1]) + 0.5 * body.inertia * v[k + 2] * v[k + 2]


@kernel(inlined=True)
def arm(marker, q):
    """Vector [m] from the centroid to the marker."""
    angle = q[marker.offset + 2]
    c, s = math.cos(angle), math.sin(angle)
    return c * marker.arm_x - s * marker.arm_y, s * marker.arm_x + c * marker.arm_y


@kernel(inlined=True)
def place(marker, q):
    """Place [m] of the marker."""
    x, y = arm(marker, q)
    return q[marker.offset] + x, q[marker.offset + 1] + y


@kernel(inlined=True)
def velocity(marker, q, v):
    """Velocity [m/s] of the marker."""
    k = marker.offset
    x, y = arm(marker, q)
    return v[k] - v[k + 2] * y, v[k + 1] + v[k + 2] * x


@kernel(inlined=True)
def direction(marker, q):
    """Unit vector along the body frame's x axis."""
    angle = q[marker.offset + 2]
    return math.cos(angle), math.sin(angle)


@kernel(inlined=True)
def direction_rate(marker, q, v):
    """Rate of change of the direction."""
    c, s = direction(marker, q)
    turn = v[marker.offset + 2]
    return -turn * s, turn * c


@kernel(inlined=True)
def spin(marker, v):
    """Angular velocity [rad/s] of the direction."""
    return v[marker.offset + 2]


@kernel(inlined=True)
def add_point_force(marker, q, fx, fy, force):
    """Add the generalized force of a force at the marker: itself, and its moment about the centroid."""
    k = marker.offset
    x, y = arm(marker, q)
    force[k] += fx
    force[k + 1] += fy
    force[k + 2] += x * fy - y * fx


@kernel(inlined=True)
def add_torque(marker, torque, force):
    """Add the generalized force of a torque."""
    force[marker.offset + 2] += torque


@kernel
def fill_slopes(marker, q, v, side, index, gradient, rate_slope):
    """Fill what `markers.fill_slopes` asks for."""
    k, first = 4 * side, marker.offset
    index[k], index[k + 1], index[k + 2], index[k + 3] = first, first + 1, first + 2, first + 2
    x, y = arm(marker, q)
    gradient[0, k], gradient[0, k + 2] = 1.0, -y
    gradient[1, k + 1], gradient[1, k + 2] = 1.0, x
    gradient[2 + side, k + 2] = 1.0
    rate_slope[0, k + 2], rate_slope[1, k + 2] = -v[first + 2] * x, -v[first + 2] * y


@kernel
def subtract_hessian(marker, q, fx, fy, elimination, matrix):
    """Subtract the slope by phi of the moment of a constant force; the angle itself has none."""
    x, y = arm(marker, q)
    k = marker.offset + 2
    add_entry(elimination, matrix, k, k, x * fx + y * fy)
