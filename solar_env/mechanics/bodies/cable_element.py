"""Flexible bodies: planar beams of cable elements in the absolute nodal coordinate formulation.

Every node has a position r and a slope r' = dr/ds, both in inertial axes, and the centreline is a cubic polynomial
between nodes (J. L. Escalona, H. A. Hussien and A. A. Shabana, J. Sound Vib. 214 (1998) 833,
doi:10.1006/jsvi.1998.1563; paper, Eqs 16-30). The mass matrix is constant and banded. The strains are the extension
eps = |r'| - 1 and the turn of the tangent per undeformed length, kappa = (r' x r'') / |r'|^2 (J. Gerstmayr and
H. Irschik, J. Sound Vib. 318 (2008) 461, doi:10.1016/j.jsv.2008.04.019: with other curvatures stretch and bending
couple falsely). Material damping is proportional to their rates, so that rigid rotation is not damped.

Within an element of length L everything follows from three vectors: the chord d = (r_b - r_a) / L and the slopes a, b.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import FLEXIBLE, Elements
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry

# Elements whose forces are worked out together, in blocks of constant length; and how many at least.
LANES = 64
REGISTER = 4
TABLE_ROWS = 19
# Bandwidth of a flexible body's mass matrix, the diagonal included: two neighbouring nodes.
MASS_BAND = 4


def _quadrature(points: int) -> tuple[tuple[float, ...], ...]:
    """Rows (weights of d, a, b in r'; the same in L r''; quadrature weight) at Gauss points of the unit interval."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    rows = []
    for s, w in zip(0.5 * (nodes + 1.0), 0.5 * weights, strict=True):
        slope = (6.0 * s * (1.0 - s), 1.0 - 4.0 * s + 3.0 * s * s, 3.0 * s * s - 2.0 * s)
        rows.append((*slope, 6.0 - 12.0 * s, 6.0 * s - 4.0, 6.0 * s - 2.0, w))
    return tuple(tuple(float(x) for x in row) for row in rows)


# Points that integrate the axial and the bending part.
AXIAL = _quadrature(5)
BENDING = _quadrature(3)


def mass_band(elements: int, element_length: float, linear_density: float) -> NDArray[np.float64]:
    """Lower band (2 (elements + 1), MASS_BAND) of the mass matrix that acts on the x, and on the y coordinates.

    Entry (i, k) is M[i, i - 3 + k], in the order r_0, r'_0, r_1, r'_1, ...
    """
    L = element_length
    element = (
        linear_density
        * L
        / 420.0
        * np.array(
            [
                [156.0, 22.0 * L, 54.0, -13.0 * L],
                [22.0 * L, 4.0 * L * L, 13.0 * L, -3.0 * L * L],
                [54.0, 13.0 * L, 156.0, -22.0 * L],
                [-13.0 * L, -3.0 * L * L, -22.0 * L, 4.0 * L * L],
            ]
        )
    )
    band = np.zeros((2 * (elements + 1), MASS_BAND))
    for e in range(elements):
        for i in range(4):
            for k in range(i + 1):
                band[2 * e + i, MASS_BAND - 1 - i + k] += element[i, k]
    return band


def stiffness_matrix(
    elements: int, element_length: float, axial_stiffness: float, bending_stiffness: float
) -> NDArray[np.float64]:
    """Stiffness (2 (elements + 1), same) of the straight beam, axial and transverse motion added up.

    The two do not couple; with one stiffness zero the matrix is that of the other motion.
    """
    size = 2 * (elements + 1)
    element = np.zeros((4, 4))
    chord = 1.0 / element_length
    for points, stiffness, first in (
        (AXIAL, axial_stiffness, 0),
        (BENDING, bending_stiffness / element_length**2, 3),
    ):
        for row in points:
            d, a, b = row[first : first + 3]
            shape = np.array([-d * chord, a, d * chord, b])
            element += row[6] * element_length * stiffness * np.outer(shape, shape)
    matrix = np.zeros((size, size))
    for e in range(elements):
        matrix[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += element
    return matrix


def element_blocks(beams: list[tuple[int, int, float, float, float, float]]) -> Elements:
    """Table of all elements, in blocks.

    Args:
        beams: by flexible body: first coordinate, number of elements, element length [m], axial stiffness [N],
            bending stiffness [N m2], retardation time [s].
    """
    rows = [
        (first + 4 * e, 1.0 / length, axial * length, bending / length, damping)
        for first, count, length, axial, bending, damping in beams
        for e in range(count)
    ]
    blocks = -(-len(rows) // LANES)
    offset = np.full((blocks, LANES), rows[0][0] if rows else 0, dtype=np.int64)
    inverse_length = np.ones((blocks, LANES))
    constants = np.zeros((blocks, 3, LANES))
    filled = np.zeros(blocks, dtype=np.int64)
    for i, row in enumerate(rows):
        block, lane = divmod(i, LANES)
        offset[block, lane], inverse_length[block, lane] = row[0], row[1]
        constants[block, :, lane] = row[2:]
        filled[block] = lane + 1
    return Elements(offset, inverse_length, constants.reshape(blocks, 3 * LANES), filled)


def factor_band(band: NDArray[np.float64]) -> NDArray[np.float64]:
    """Factors L D L^T of a banded matrix as :func:`mass_band` returns it: L below, 1 / D in the last column."""
    factor = band.copy()
    last = MASS_BAND - 1
    for i in range(len(band)):
        for k in range(last):
            column = i - last + k
            if column < 0:
                continue
            for earlier in range(max(0, i - last), column):
                factor[i, k] -= factor[i, earlier - i + last] * factor[column, earlier - column + last]
        for k in range(last):
            column = i - last + k
            if column >= 0:
                scaled = factor[i, k] * factor[column, last]
                factor[i, last] -= scaled * factor[i, k]
                factor[i, k] = scaled
        factor[i, last] = 1.0 / factor[i, last]
    return factor


@kernel
def add_mass_product(body, band, a, out):
    """Add the body's M a to ``out`` (n,)."""
    rows = body.coordinates // 2
    for i in range(rows):
        x = body.offset + 2 * i
        weight = band[body.band + i, MASS_BAND - 1]
        out[x] += weight * a[x]
        out[x + 1] += weight * a[x + 1]
        for k in range(max(0, MASS_BAND - 1 - i), MASS_BAND - 1):
            weight = band[body.band + i, k]
            z = x - 2 * (MASS_BAND - 1 - k)
            out[x] += weight * a[z]
            out[x + 1] += weight * a[z + 1]
            out[z] += weight * a[x]
            out[z + 1] += weight * a[x + 1]


@kernel
def solve_mass(body, factor, force, a):
    """Write the body's M^-1 force into ``a`` (n,)."""
    rows, first = body.coordinates // 2, body.band
    fx, fy, gx, gy, hx, hy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(rows):
        k = body.offset + 2 * i
        l0, l1, l2 = factor[first + i, 0], factor[first + i, 1], factor[first + i, 2]
        x = force[k] - l0 * fx - l1 * gx - l2 * hx
        y = force[k + 1] - l0 * fy - l1 * gy - l2 * hy
        a[k], a[k + 1] = x, y
        fx, fy, gx, gy, hx, hy = gx, gy, hx, hy, x, y
    # The unknowns behind the row in hand, each with the row that holds its factors.
    fx, fy, gx, gy, hx, hy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    l0, l1, l2, m0, m1, n0 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(rows - 1, -1, -1):
        k = body.offset + 2 * i
        inverse = factor[first + i, 3]
        x = a[k] * inverse - l2 * hx - m1 * gx - n0 * fx
        y = a[k + 1] * inverse - l2 * hy - m1 * gy - n0 * fy
        a[k], a[k + 1] = x, y
        fx, fy, gx, gy, hx, hy = gx, gy, hx, hy, x, y
        n0, m0, m1 = m0, l0, l1
        l0, l1, l2 = factor[first + i, 0], factor[first + i, 1], factor[first + i, 2]


@kernel(inlined=True)
def add_axial_point(point, x, axial, damping, f):
    """Add one quadrature point's part of the axial force to the tuple that :func:`element_forces` builds up."""
    d, a, b, _, _, _, w = point
    dx, dy, ax, ay, bx, by, ux, uy, px, py, wx, wy = x
    f0, f1, f2, f3, f4, f5, power = f
    rx, ry = d * dx + a * ax + b * bx, d * dy + a * ay + b * by
    vx, vy = d * ux + a * px + b * wx, d * uy + a * py + b * wy
    stretch = math.sqrt(rx * rx + ry * ry)
    inverse = 1.0 / stretch
    tx, ty = rx * inverse, ry * inverse
    rate = tx * vx + ty * vy
    weight = w * axial
    viscous = damping * rate
    force = weight * (stretch - 1.0 + viscous)
    nx, ny = force * tx, force * ty
    return f0 + d * nx, f1 + d * ny, f2 + a * nx, f3 + a * ny, f4 + b * nx, f5 + b * ny, power + weight * viscous * rate


@kernel(inlined=True)
def add_bending_point(point, x, bending, damping, f):
    """Add one quadrature point's part of the bending moment to the tuple that :func:`element_forces` builds up."""
    d, a, b, e, g, h, w = point
    dx, dy, ax, ay, bx, by, ux, uy, px, py, wx, wy = x
    f0, f1, f2, f3, f4, f5, power = f
    rx, ry = d * dx + a * ax + b * bx, d * dy + a * ay + b * by
    vx, vy = d * ux + a * px + b * wx, d * uy + a * py + b * wy
    # L r'' and its rate.
    cx, cy = e * dx + g * ax + h * bx, e * dy + g * ay + h * by
    zx, zy = e * ux + g * px + h * wx, e * uy + g * py + h * wy
    inverse = 1.0 / (rx * rx + ry * ry)
    turn = (rx * cy - ry * cx) * inverse
    rate = (vx * cy - vy * cx + rx * zy - ry * zx - 2.0 * turn * (rx * vx + ry * vy)) * inverse
    weight = w * bending
    viscous = damping * rate
    moment = weight * (turn + viscous) * inverse
    nx, ny = moment * (cy - 2.0 * turn * rx), moment * (-cx - 2.0 * turn * ry)
    mx, my = -moment * ry, moment * rx
    return (
        f0 + d * nx + e * mx,
        f1 + d * ny + e * my,
        f2 + a * nx + g * mx,
        f3 + a * ny + g * my,
        f4 + b * nx + h * mx,
        f5 + b * ny + h * my,
        power + weight * viscous * rate,
    )


@kernel(inner=True)
def element_forces(lanes, constants, table):
    """Internal forces of a block of elements, several at a time in the processor's vector registers.

    For that the loop has no branch, its quadrature points are written out, and all distances in ``table`` are constant.

    Args:
        lanes: number of columns to work on.
        constants: (3 * LANES,) E A L, E I / L and retardation time by element.
        table: (TABLE_ROWS * LANES,) rows of chord and slopes, then of their rates, are read; the gradient of the strain
            energy (plus viscous part) by chord and slopes, and the power that damping takes [W], are written behind.
    """
    for i in range(lanes):
        x = (
            table[i],
            table[LANES + i],
            table[2 * LANES + i],
            table[3 * LANES + i],
            table[4 * LANES + i],
            table[5 * LANES + i],
            table[6 * LANES + i],
            table[7 * LANES + i],
            table[8 * LANES + i],
            table[9 * LANES + i],
            table[10 * LANES + i],
            table[11 * LANES + i],
        )
        axial, bending, damping = constants[i], constants[LANES + i], constants[2 * LANES + i]
        f = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        f = add_axial_point(AXIAL[0], x, axial, damping, f)
        f = add_axial_point(AXIAL[1], x, axial, damping, f)
        f = add_axial_point(AXIAL[2], x, axial, damping, f)
        f = add_axial_point(AXIAL[3], x, axial, damping, f)
        f = add_axial_point(AXIAL[4], x, axial, damping, f)
        f = add_bending_point(BENDING[0], x, bending, damping, f)
        f = add_bending_point(BENDING[1], x, bending, damping, f)
        f = add_bending_point(BENDING[2], x, bending, damping, f)
        table[12 * LANES + i] = f[0]
        table[13 * LANES + i] = f[1]
        table[14 * LANES + i] = f[2]
        table[15 * LANES + i] = f[3]
        table[16 * LANES + i] = f[4]
        table[17 * LANES + i] = f[5]
        table[18 * LANES + i] = f[6]


@kernel
def add_elastic_forces(elements, q, v, force, table):
    """Add the internal forces of all flexible bodies to ``force``; returns the power [W] that damping takes.

    ``table`` (TABLE_ROWS * LANES,) is scratch.
    """
    total = 0.0
    for block in range(elements.offset.shape[0]):
        offset, inverse_length = elements.offset[block], elements.inverse_length[block]
        filled = elements.filled[block]
        # Whole registers: the columns behind the last element repeat the first one, without stiffness.
        lanes = (filled + REGISTER - 1) // REGISTER * REGISTER
        for i in range(lanes):
            k, inverse = offset[i], inverse_length[i]
            table[i] = (q[k + 4] - q[k]) * inverse
            table[LANES + i] = (q[k + 5] - q[k + 1]) * inverse
            table[6 * LANES + i] = (v[k + 4] - v[k]) * inverse
            table[7 * LANES + i] = (v[k + 5] - v[k + 1]) * inverse
            for row in range(2):
                table[(2 + row) * LANES + i] = q[k + 2 + row]
                table[(4 + row) * LANES + i] = q[k + 6 + row]
                table[(8 + row) * LANES + i] = v[k + 2 + row]
                table[(10 + row) * LANES + i] = v[k + 6 + row]
        element_forces(lanes, elements.constants[block], table)
        for i in range(filled):
            k, inverse = offset[i], inverse_length[i]
            for axis in range(2):
                chord = table[(12 + axis) * LANES + i] * inverse
                force[k + axis] += chord
                force[k + 2 + axis] -= table[(14 + axis) * LANES + i]
                force[k + 4 + axis] -= chord
                force[k + 6 + axis] -= table[(16 + axis) * LANES + i]
            total += table[18 * LANES + i]
    return total


@kernel
def elastic_energy(bodies, q):
    """Strain energy [J] of all flexible bodies."""
    total = 0.0
    for body in bodies:
        if body.kind != FLEXIBLE:
            continue
        length = body.element_length
        for e in range(body.elements):
            k = body.offset + 4 * e
            dx, dy = (q[k + 4] - q[k]) / length, (q[k + 5] - q[k + 1]) / length
            for d, a, b, _, _, _, w in AXIAL:
                rx, ry = d * dx + a * q[k + 2] + b * q[k + 6], d * dy + a * q[k + 3] + b * q[k + 7]
                total += 0.5 * w * length * body.axial_stiffness * (math.sqrt(rx * rx + ry * ry) - 1.0) ** 2
            for d, a, b, i, g, h, w in BENDING:
                rx, ry = d * dx + a * q[k + 2] + b * q[k + 6], d * dy + a * q[k + 3] + b * q[k + 7]
                cx, cy = i * dx + g * q[k + 2] + h * q[k + 6], i * dy + g * q[k + 3] + h * q[k + 7]
                turn = (rx * cy - ry * cx) / (rx * rx + ry * ry)
                total += 0.5 * w / length * body.bending_stiffness * turn * turn
    return total


@kernel
def kinetic_energy(body, band, v):
    """Kinetic energy [J] of the body."""
    total = 0.0
    for i in range(body.coordinates // 2):
        x = body.offset + 2 * i
        weight = 0.5 * band[body.band + i, MASS_BAND - 1]
        total += weight * (v[x] * v[x] + v[x + 1] * v[x + 1])
        for k in range(max(0, MASS_BAND - 1 - i), MASS_BAND - 1):
            z = x - 2 * (MASS_BAND - 1 - k)
            total += band[body.band + i, k] * (v[x] * v[z] + v[x + 1] * v[z + 1])
    return total


@kernel
def add_body_mass(body, band, weight, elimination, matrix):
    """Add weight * (mass matrix of the body) to ``matrix``."""
    for i in range(body.coordinates // 2):
        for k in range(max(0, MASS_BAND - 1 - i), MASS_BAND):
            j = i - (MASS_BAND - 1) + k
            value = weight * band[body.band + i, k]
            for axis in range(2):
                row, column = body.offset + 2 * i + axis, body.offset + 2 * j + axis
                add_entry(elimination, matrix, row, column, value)
                if row != column:
                    add_entry(elimination, matrix, column, row, value)
