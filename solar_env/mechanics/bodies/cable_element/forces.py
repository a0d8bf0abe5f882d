"""Internal forces and strain energy of beams of cable elements (`element.py`).

Three vectors describe an element of length L: the chord d = (r_b - r_a) / L, and the slopes a and b at its ends.
"""

import math

from solar_env.mechanics.bodies.cable_element.matrices import AXIAL, BENDING
from solar_env.mechanics.numerics.jit import kernel

# Number of elements per block, whose forces are computed together in groups of REGISTER elements.
LANES = 64
REGISTER = 4
TABLE_ROWS = 19


@kernel
def add_axial_point(point, x, axial, damping, f):
    """Return `f` plus the axial contribution of one quadrature point of an element of length L.

    `f` holds generalized forces of chord, first and second end slope (x and y of each), then the damping power [W]. `x`
    holds chord and slopes in this order, then their rates. `point` is a row (d, a, b, ..., w) of `AXIAL`: the tangent
    dr/ds is d * chord + a * (first slope) + b * (second slope), and w is the quadrature weight. `axial` is E A L [N m],
    `damping` is the retardation time [s].
    """
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


@kernel
def add_bending_point(point, x, bending, damping, f):
    """Return `f` plus the bending contribution of a quadrature point, a row of `BENDING`; `bending` is E I / L [N m].

    As in `add_axial_point`, `f` holds forces of chord and end slopes and the damping power, and `x` holds chord and
    slopes, then their rates; `damping` is the retardation time [s].
    """
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


@kernel
def element_forces(lanes, constants, table):
    """Compute the internal forces of elements in `table`, in a loop that vectorizes: written out, constant strides.

    Args:
        lanes: number of elements, each of which has a column of `table`.
        constants: (3 * LANES,) rows E A L [N m], E I / L [N m] and retardation time [s], a column per element.
        table: (TABLE_ROWS * LANES,) rows. The first twelve (chord and slopes, then their rates) are read. The last
            seven are written: generalized forces of chord and slopes, viscous part included, and damping power [W].
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


@kernel(inlined=False)
def add_elastic_forces(elements, q, v, force, table):
    """Add the internal forces of all beams to `force` (n,); return damping power [W]. The array `table` is scratch."""
    total = 0.0
    for block in range(elements.offset.shape[0]):
        offset, inverse_length = elements.offset[block], elements.inverse_length[block]
        filled = elements.filled[block]
        # Whole registers are filled: columns after the last element repeat the first element with zero stiffness.
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


@kernel(inlined=False)
def add_elastic_energy(body, q, total):
    """Return `total` [J] plus the strain energy of a beam at the coordinates `q` (n,)."""
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
