"""Rigid bodies in natural coordinates: two base points p1, p2 a fixed distance apart.

The mass matrix is constant and the only constraint is the length, so that the multiplier of a single body is a
closed expression (Garcia de Jalon and Bayo 1994, doi:10.1007/978-1-4612-2600-0; paper, Eqs 8-15).
With J the quarter turn, every 2 x 2 block has the form a I + b J.
"""

from __future__ import annotations

from solar_env.mechanics.arrays.model import RIGID
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry


def mass_parameters(
    mass: float, inertia: float, length: float, centroid: tuple[float, float]
) -> tuple[float, float, float, float]:
    """Blocks (m11, m22, m12, n12) [kg] of the mass matrix [[m11 I, m12 I + n12 J], [(..)^T, m22 I]].

    Args:
        mass: [kg].
        inertia: about the centroid [kg m2].
        length: distance of the base points [m].
        centroid: along and across the line p1 -> p2, from p1 [m].
    """
    along, across = centroid[0] / length, centroid[1] / length
    second = inertia / length**2 + mass * (along**2 + across**2)
    first = inertia / length**2 + mass * ((1.0 - along) ** 2 + across**2)
    return first, second, mass * along - second, mass * across


def inverse_mass_parameters(m11: float, m22: float, m12: float, n12: float) -> tuple[float, float, float, float]:
    """Blocks (w11, w22, w12, x12) of the inverse of the matrix that :func:`mass_parameters` describes."""
    determinant = m11 * m22 - m12**2 - n12**2
    return m22 / determinant, m11 / determinant, -m12 / determinant, -n12 / determinant


@kernel(inlined=True)
def add_mass_product(body, a, out):
    """Add the body's M a to ``out`` (n,)."""
    k = body.offset
    ax, ay, bx, by = a[k], a[k + 1], a[k + 2], a[k + 3]
    out[k] += body.m11 * ax + body.m12 * bx - body.n12 * by
    out[k + 1] += body.m11 * ay + body.m12 * by + body.n12 * bx
    out[k + 2] += body.m22 * bx + body.m12 * ax + body.n12 * ay
    out[k + 3] += body.m22 * by + body.m12 * ay - body.n12 * ax


@kernel(inner=True)
def add_body_matrix(body, weight, multiplier, elimination, matrix):
    """Add weight * (mass matrix of a rigid body) + multiplier * (second derivative of its length constraint)."""
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


@kernel(inlined=True)
def solve_free(body, force, a):
    """Acceleration ``a`` of one body under a generalized ``force`` if its length were free."""
    k = body.offset
    if body.kind != RIGID:
        a[k] = a[k + 1] = a[k + 2] = a[k + 3] = 0.0
        return
    fx, fy, gx, gy = force[k], force[k + 1], force[k + 2], force[k + 3]
    a[k] = body.w11 * fx + body.w12 * gx - body.x12 * gy
    a[k + 1] = body.w11 * fy + body.w12 * gy + body.x12 * gx
    a[k + 2] = body.w22 * gx + body.w12 * fx + body.x12 * fy
    a[k + 3] = body.w22 * gy + body.w12 * fy - body.x12 * fx


@kernel(inlined=True)
def solve_body(body, q, v, force, a, with_velocity):
    """Acceleration ``a`` of one body under a generalized ``force`` that keeps its length; returns its multiplier.

    With ``with_velocity`` zero the centripetal term is left out, which makes the map linear: the body's compliance.
    """
    k = body.offset
    if body.kind != RIGID:
        a[k] = a[k + 1] = a[k + 2] = a[k + 3] = 0.0
        return 0.0
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


@kernel(inlined=True)
def project_lengths(bodies, q, v):
    """Return every body to its length, and its velocity to rigid motion, by the smallest change in the mass metric."""
    for b in range(bodies.size):
        body = bodies[b]
        if body.kind != RIGID:
            continue
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
def kinetic_energy(body, v):
    """Kinetic energy [J] of the body."""
    k = body.offset
    ax, ay, bx, by = v[k], v[k + 1], v[k + 2], v[k + 3]
    total = 0.5 * body.m11 * (ax * ax + ay * ay) + 0.5 * body.m22 * (bx * bx + by * by)
    return total + body.m12 * (ax * bx + ay * by) + body.n12 * (ay * bx - ax * by)
