"""Rigid bodies in natural coordinates: two base points p1, p2 a fixed distance apart.

The mass matrix is constant and the only constraint is the length. The multiplier of a single body therefore has a
closed form (J. Garcia de Jalon and E. Bayo, Kinematic and Dynamic Simulation of Multibody Systems, Springer 1994,
doi:10.1007/978-1-4612-2600-0; Li et al. 2019, Eqs 8-15). The mass matrix and its inverse consist of 2 x 2 blocks
a I + b J, stored as factors a and b; J is the rotation by 90 degrees.
"""

import math
from typing import Any, ClassVar

import numpy as np

from solar_env.mechanics.bodies.description import Body, Point
from solar_env.mechanics.bodies.kind import Array, BodyKind, Fields
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry


class NaturalCoordinates(BodyKind[Body]):
    """Kind of rigid bodies, described by the natural coordinates of two base points."""

    description = Body
    # Mass matrix [[m11 I, m12 I + n12 J], [(..)^T, m22 I]] and its inverse (w..).
    body_fields: ClassVar[Fields] = [
        (name, np.float64) for name in ("m11", "m22", "m12", "n12", "w11", "w22", "w12", "x12")
    ]
    constraints = 1

    def coordinates(self, body: Body) -> int:
        """Return four, the number of coordinates."""
        return 4

    def fill(self, body: Body, row: np.void, constants: list[float]) -> None:
        """Write the body's length, mass matrix and inverse mass matrix to its record `row`; `constants` is unused."""
        row["length"], row["fixed"] = body.length, body.fixed
        mass = mass_parameters(body.mass, body.inertia, body.length, body.centroid)
        row["m11"], row["m22"], row["m12"], row["n12"] = mass
        row["w11"], row["w22"], row["w12"], row["x12"] = inverse_mass_parameters(*mass)

    def fill_marker(self, body: Body, row: np.void, first: int, point: Point) -> None:
        """Write to `row` a marker at body-frame `point` [m], directed from base point p1 (index `first` in q) to p2."""
        along, across = point[0] / body.length, point[1] / body.length
        row["i1"], row["i2"], row["c1"] = first, first + 2, -1.0
        row["a1"], row["b1"], row["a2"], row["b2"] = 1.0 - along, -across, along, across

    def initial_motion(self, body: Body) -> tuple[Array, Array]:
        """Return the base points' positions (4,) and velocities (4,) at t = 0; a fixed body is at rest."""
        c, s = math.cos(body.angle), math.sin(body.angle)
        points = np.array([0.0, body.length])
        q = (np.array(body.position) + np.outer(points, (c, s))).ravel()
        v = (np.array(body.velocity) + np.outer(points, (-s * body.spin, c * body.spin))).ravel()
        return q, np.zeros(4) if body.fixed else v

    def weight(self, body: Body, gravity: Point) -> Array:
        """Return the generalized gravity force (4,), which acts at the centroid; it is zero for a fixed body."""
        along, across = body.centroid[0] / body.length, body.centroid[1] / body.length
        gx, gy = gravity
        force = np.zeros(4)
        if not body.fixed:
            for k, a, b in ((0, 1.0 - along, -across), (2, along, across)):
                force[k] = body.mass * (a * gx + b * gy)
                force[k + 1] = body.mass * (a * gy - b * gx)
        return force

    def centreline(self, row: Any, q: Array, points_per_element: int) -> Array:
        """Return the two base points (..., 2, 2) [m], the axis's ends, from `q` (..., 4); ignore other arguments."""
        return q.reshape(*q.shape[:-1], 2, 2).copy()


def mass_parameters(
    mass: float, inertia: float, length: float, centroid: tuple[float, float]
) -> tuple[float, float, float, float]:
    """Return the factors (m11, m22, m12, n12) [kg] in the mass matrix [[m11 I, m12 I + n12 J], [(..)^T, m22 I]].

    `centroid`: position [m] along and across the line p1 -> p2, measured from p1. J is the rotation by 90 degrees.
    """
    along, across = centroid[0] / length, centroid[1] / length
    second = inertia / length**2 + mass * (along**2 + across**2)
    first = inertia / length**2 + mass * ((1.0 - along) ** 2 + across**2)
    return first, second, mass * along - second, mass * across


def inverse_mass_parameters(m11: float, m22: float, m12: float, n12: float) -> tuple[float, float, float, float]:
    """Return (w11, w22, w12, x12) [1/kg] in the inverse mass matrix [[w11 I, w12 I + x12 J], [(..)^T, w22 I]].

    The mass matrix is [[m11 I, m12 I + n12 J], [(..)^T, m22 I]], with factors in kg; J is the rotation by 90 degrees.
    """
    determinant = m11 * m22 - m12**2 - n12**2
    return m22 / determinant, m11 / determinant, -m12 / determinant, -n12 / determinant


@kernel
def add_mass_product(body, a, out):
    """Add a rigid body's mass matrix times the accelerations `a` (n,) to `out` (n,)."""
    k = body.offset
    ax, ay, bx, by = a[k], a[k + 1], a[k + 2], a[k + 3]
    out[k] += body.m11 * ax + body.m12 * bx - body.n12 * by
    out[k + 1] += body.m11 * ay + body.m12 * by + body.n12 * bx
    out[k + 2] += body.m22 * bx + body.m12 * ax + body.n12 * ay
    out[k + 3] += body.m22 * by + body.m12 * ay - body.n12 * ax


@kernel
def add_body_matrix(body, weight, multiplier, elimination, matrix):
    """Add weight * (mass matrix) + multiplier * (length constraint's Hessian) to `matrix`, ordered by `elimination`."""
    k = body.offset
    for axis in range(2):
        turn = -1.0 if axis == 0 else 1.0
        i, j = k + axis, k + 2 + axis
        cross = weight * body.m12 - multiplier
        add_entry(elimination, matrix, i, i, weight * body.m11 + multiplier)
        add_entry(elimination, matrix, j, j, weight * body.m22 + multiplier)
        add_entry(elimination, matrix, i, j, cross)
        add_entry(elimination, matrix, j, i, cross)
        add_entry(elimination, matrix, i, k + 3 - axis, weight * turn * body.n12)
        add_entry(elimination, matrix, j, k + 1 - axis, -weight * turn * body.n12)


@kernel
def solve_mass(body, force, a):
    """Write M^-1 times a rigid body's `force` to `a` (n,): its acceleration without joints and length constraint."""
    k = body.offset
    fx, fy, gx, gy = force[k], force[k + 1], force[k + 2], force[k + 3]
    a[k] = body.w11 * fx + body.w12 * gx - body.x12 * gy
    a[k + 1] = body.w11 * fy + body.w12 * gy + body.x12 * gx
    a[k + 2] = body.w22 * gx + body.w12 * fx + body.x12 * fy
    a[k + 3] = body.w22 * gy + body.w12 * fy - body.x12 * fx


@kernel
def solve_body(body, q, v, force, a, with_velocity):
    """Write a rigid body's acceleration under `force` (n,), no joints, to `a`; return the length constraint multiplier.

    `with_velocity` is 1, or 0 to omit the centripetal term: the acceleration is then linear in `force`.
    """
    k = body.offset
    fx, fy, gx, gy = force[k], force[k + 1], force[k + 2], force[k + 3]
    w12, x12 = body.w12, body.x12
    ax = body.w11 * fx + w12 * gx - x12 * gy
    ay = body.w11 * fy + w12 * gy + x12 * gx
    bx = body.w22 * gx + w12 * fx + x12 * fy
    by = body.w22 * gy + w12 * fy - x12 * fx
    dx, dy = q[k + 2] - q[k], q[k + 3] - q[k + 1]
    ux, uy = v[k + 2] - v[k], v[k + 3] - v[k + 1]
    squared = dx * dx + dy * dy
    compliance = body.w11 + body.w22 - 2.0 * w12
    multiplier = (dx * (bx - ax) + dy * (by - ay) + with_velocity * (ux * ux + uy * uy)) / (compliance * squared)
    c1 = (w12 - body.w11) * multiplier
    c2 = (body.w22 - w12) * multiplier
    cx = x12 * multiplier
    a[k] = ax - c1 * dx + cx * dy
    a[k + 1] = ay - c1 * dy - cx * dx
    a[k + 2] = bx - c2 * dx + cx * dy
    a[k + 3] = by - c2 * dy - cx * dx
    return multiplier


@kernel
def project_length(body, q, v):
    """Project a rigid body's `q` and `v` onto its length constraint, by the least change in the mass metric."""
    k = body.offset
    dx, dy = q[k + 2] - q[k], q[k + 3] - q[k + 1]
    squared = dx * dx + dy * dy
    compliance = body.w11 + body.w22 - 2.0 * body.w12
    error = 0.5 * (squared - body.length * body.length) / (squared * compliance)
    rate = (dx * (v[k + 2] - v[k]) + dy * (v[k + 3] - v[k + 1])) / (squared * compliance)
    c1, c2, cx = body.w12 - body.w11, body.w22 - body.w12, body.x12
    ax, ay = c1 * dx - cx * dy, c1 * dy + cx * dx
    bx, by = c2 * dx - cx * dy, c2 * dy + cx * dx
    q[k] -= error * ax
    q[k + 1] -= error * ay
    q[k + 2] -= error * bx
    q[k + 3] -= error * by
    v[k] -= rate * ax
    v[k + 1] -= rate * ay
    v[k + 2] -= rate * bx
    v[k + 3] -= rate * by


@kernel
def stretch_along(body, q, x, y):
    """Return the scalar product of (x, y), a motion of base point p2 relative to p1, with the vector p2 - p1 at `q`."""
    k = body.offset
    return (q[k + 2] - q[k]) * x + (q[k + 3] - q[k + 1]) * y


@kernel
def length_compliance(body, q):
    """Return the compliance C M^-1 C^T of the length constraint with gradient C = (-d, d), where d = p2 - p1."""
    k = body.offset
    dx, dy = q[k + 2] - q[k], q[k + 3] - q[k + 1]
    return (body.w11 + body.w22 - 2.0 * body.w12) * (dx * dx + dy * dy)


@kernel
def add_length_force(body, q, multiplier, out):
    """Add the length constraint's generalized force for `multiplier` to `out` (n,); return the violation [m2]."""
    k = body.offset
    dx, dy = q[k + 2] - q[k], q[k + 3] - q[k + 1]
    out[k] += dx * multiplier
    out[k + 1] += dy * multiplier
    out[k + 2] -= dx * multiplier
    out[k + 3] -= dy * multiplier
    return 0.5 * (dx * dx + dy * dy - body.length * body.length)


@kernel
def add_length_border(body, q, row, elimination, matrix):
    """Add the gradient of a rigid body's length constraint to the row and the column of its multiplier in `matrix`.

    `row` is the multiplier's index among all unknowns, and `elimination` gives each unknown's place in `matrix`.
    """
    k = body.offset
    for axis in range(2):
        d = q[k + 2 + axis] - q[k + axis]
        add_entry(elimination, matrix, row, k + axis, -d)
        add_entry(elimination, matrix, row, k + 2 + axis, d)
        add_entry(elimination, matrix, k + axis, row, -d)
        add_entry(elimination, matrix, k + 2 + axis, row, d)


@kernel(inlined=False)
def kinetic_energy(body, v):
    """Return the kinetic energy [J] of a rigid body from the velocities `v` (n,)."""
    k = body.offset
    ax, ay, bx, by = v[k], v[k + 1], v[k + 2], v[k + 3]
    total = 0.5 * body.m11 * (ax * ax + ay * ay) + 0.5 * body.m22 * (bx * bx + by * by)
    return total + body.m12 * (ax * bx + ay * by) + body.n12 * (ay * bx - ax * by)
