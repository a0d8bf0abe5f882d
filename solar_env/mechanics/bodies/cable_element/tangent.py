"""Derivatives of the internal forces in beams of ANCF cable elements (`element.py`), for implicit integration.

An element with x = (chord, slopes) has the strains e(x) and the strain rates de/dt = G dx/dt with G = de/dx. Its
internal force is the integral of G^T (stiffness) (e + damping * de/dt). At a quadrature point the axial strain depends
on r' = dr/ds, and the bending strain on r' and L r''. Derivatives with respect to r' and L r'' come first; the shape
functions turn them into derivatives with respect to x. Input and output arrays do not overlap, so that loops vectorize.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.bodies.cable_element.forces import LANES, REGISTER
from solar_env.mechanics.bodies.cable_element.matrices import AXIAL, BENDING
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import BLOCK

# Number of elements that are computed together.
COLUMNS = 16
# Number of 2 x 2 derivative blocks: one (by r') per axial point, then four (by r' and L r'') per bending point.
_POINTS = len(AXIAL) + 4 * len(BENDING)


class ElementSlopes(NamedTuple):
    """Work arrays for derivatives of beam elements' internal forces; a row holds one quantity for COLUMNS elements."""

    motion: NDArray[np.float64]  # 12 rows: chord and slopes, then their rates
    local_stiffness: NDArray[np.float64]  # 4 rows for each of the _POINTS blocks
    local_damping: NDArray[np.float64]
    stiffness: NDArray[np.float64]  # 36 rows: force derivatives by chord and slopes
    damping: NDArray[np.float64]


def make_element_slopes() -> ElementSlopes:
    """Allocate the work arrays of `add_elastic_tangents`."""
    return ElementSlopes(
        motion=np.zeros(12 * COLUMNS),
        local_stiffness=np.zeros(4 * _POINTS * COLUMNS),
        local_damping=np.zeros(4 * _POINTS * COLUMNS),
        stiffness=np.zeros(36 * COLUMNS),
        damping=np.zeros(36 * COLUMNS),
    )


def _expansion() -> NDArray[np.float64]:
    """Return weights (9, _POINTS) that turn force derivatives at quadrature points into an element's force derivatives.

    Row 3 i + j is for the force conjugate to vector i and its derivative with respect to vector j, where vector 0 is
    the chord, 1 and 2 are the end slopes. First comes one column per axial point, for the force conjugate to r' = dr/ds
    and its derivative with respect to r'. Then come four columns per bending point, for the force conjugate to r' and
    its derivatives with respect to r' and to L r'' (L: element length), and likewise for the force conjugate to L r''.
    """
    rows = []
    for i in range(3):
        for j in range(3):
            row = [point[i] * point[j] for point in AXIAL]
            for point in BENDING:
                slope, bend = point[:3], point[3:6]
                row += [slope[i] * slope[j], slope[i] * bend[j], bend[i] * slope[j], bend[i] * bend[j]]
            rows.append(row)
    return np.array(rows)


_EXPANSION = _expansion()


@kernel
def _axial_slopes(point, lanes, constants, table, stiffness, viscosity):
    """Compute 2 x 2 derivatives of the axial force conjugate to r' = dr/ds at a quadrature point of `lanes` elements.

    They go to four rows (xx, xy, yx, yy) of `stiffness`, with respect to r', and of `viscosity`, with respect to the
    rate of r'. All arrays have one column per beam element. The twelve rows of `table` are x and y of chord, first and
    second end slope, then their rates. Of the numbers in `point`, r' is the chord times the first, plus the end slopes
    times the next two; the last is the quadrature weight; the others are for bending. The three rows of `constants` are
    E A L [N m], E I / L [N m] and retardation time [s].
    """
    d, a, b, _, _, _, w = point
    for i in range(lanes):
        rx = d * table[i] + a * table[2 * COLUMNS + i] + b * table[4 * COLUMNS + i]
        ry = d * table[COLUMNS + i] + a * table[3 * COLUMNS + i] + b * table[5 * COLUMNS + i]
        vx = d * table[6 * COLUMNS + i] + a * table[8 * COLUMNS + i] + b * table[10 * COLUMNS + i]
        vy = d * table[7 * COLUMNS + i] + a * table[9 * COLUMNS + i] + b * table[11 * COLUMNS + i]
        weight, damping = w * constants[i], constants[2 * LANES + i]
        stretch = math.sqrt(rx * rx + ry * ry)
        inverse = 1.0 / stretch
        tx, ty = rx * inverse, ry * inverse
        rate = tx * vx + ty * vy
        geometric = weight * (stretch - 1.0 + damping * rate) * inverse
        # Weighted derivative, by r', of strain + damping * (strain rate).
        sx = weight * (tx + damping * (vx - tx * rate) * inverse)
        sy = weight * (ty + damping * (vy - ty * rate) * inverse)
        stiffness[i] = tx * sx + geometric * ty * ty
        stiffness[COLUMNS + i] = tx * sy - geometric * tx * ty
        stiffness[2 * COLUMNS + i] = ty * sx - geometric * tx * ty
        stiffness[3 * COLUMNS + i] = ty * sy + geometric * tx * tx
        viscous = weight * damping
        viscosity[i] = viscous * tx * tx
        viscosity[COLUMNS + i] = viscous * tx * ty
        viscosity[2 * COLUMNS + i] = viscous * tx * ty
        viscosity[3 * COLUMNS + i] = viscous * ty * ty


@kernel
def _bending_slopes(point, lanes, constants, table, stiffness, viscosity):
    """Compute derivatives of the bending forces conjugate to r' and L r'' at a quadrature `point`, a row of `BENDING`.

    Four 2 x 2 matrices, in sixteen rows, go to `stiffness`: derivatives with respect to r' and to L r'', first of the
    force conjugate to r', then of the force conjugate to L r''. Derivatives with respect to the rates go to `viscosity`
    in this order. The layout of rows and the other arguments are as in `_axial_slopes`.
    """
    d, a, b, e, g, h, w = point
    for i in range(lanes):
        dx, dy, ax, ay = table[i], table[COLUMNS + i], table[2 * COLUMNS + i], table[3 * COLUMNS + i]
        bx, by = table[4 * COLUMNS + i], table[5 * COLUMNS + i]
        ux, uy, px, py = (
            table[6 * COLUMNS + i],
            table[7 * COLUMNS + i],
            table[8 * COLUMNS + i],
            table[9 * COLUMNS + i],
        )
        wx, wy = table[10 * COLUMNS + i], table[11 * COLUMNS + i]
        rx, ry = d * dx + a * ax + b * bx, d * dy + a * ay + b * by
        vx, vy = d * ux + a * px + b * wx, d * uy + a * py + b * wy
        # L r'' and its rate.
        cx, cy = e * dx + g * ax + h * bx, e * dy + g * ay + h * by
        zx, zy = e * ux + g * px + h * wx, e * uy + g * py + h * wy
        weight, damping = w * constants[LANES + i], constants[2 * LANES + i]
        inverse = 1.0 / (rx * rx + ry * ry)
        turn = (rx * cy - ry * cx) * inverse
        # Gradient of the turn by r' (g) and by L r'' (m).
        gx, gy = (cy - 2.0 * turn * rx) * inverse, (-cx - 2.0 * turn * ry) * inverse
        mx, my = -ry * inverse, rx * inverse
        rate = gx * vx + gy * vy + mx * zx + my * zy
        moment = turn + damping * rate
        # Hessian of the turn: by r' twice, and by L r'' and r'; the part by L r'' twice is zero.
        gxx, gxy = -2.0 * inverse * (2.0 * rx * gx + turn), -2.0 * inverse * (rx * gy + ry * gx)
        gyy = -2.0 * inverse * (2.0 * ry * gy + turn)
        mxx, mxy = -2.0 * inverse * rx * mx, -inverse - 2.0 * inverse * ry * mx
        myx, myy = inverse - 2.0 * inverse * rx * my, -2.0 * inverse * ry * my
        # Derivatives, by r' and by L r'', of turn + damping * (its rate).
        sgx = gx + damping * (gxx * vx + gxy * vy + mxx * zx + myx * zy)
        sgy = gy + damping * (gxy * vx + gyy * vy + mxy * zx + myy * zy)
        smx, smy = mx + damping * (mxx * vx + mxy * vy), my + damping * (myx * vx + myy * vy)
        stiffness[i] = weight * (gx * sgx + moment * gxx)
        stiffness[COLUMNS + i] = weight * (gx * sgy + moment * gxy)
        stiffness[2 * COLUMNS + i] = weight * (gy * sgx + moment * gxy)
        stiffness[3 * COLUMNS + i] = weight * (gy * sgy + moment * gyy)
        stiffness[4 * COLUMNS + i] = weight * (gx * smx + moment * mxx)
        stiffness[5 * COLUMNS + i] = weight * (gx * smy + moment * myx)
        stiffness[6 * COLUMNS + i] = weight * (gy * smx + moment * mxy)
        stiffness[7 * COLUMNS + i] = weight * (gy * smy + moment * myy)
        stiffness[8 * COLUMNS + i] = weight * (mx * sgx + moment * mxx)
        stiffness[9 * COLUMNS + i] = weight * (mx * sgy + moment * mxy)
        stiffness[10 * COLUMNS + i] = weight * (my * sgx + moment * myx)
        stiffness[11 * COLUMNS + i] = weight * (my * sgy + moment * myy)
        stiffness[12 * COLUMNS + i] = weight * mx * smx
        stiffness[13 * COLUMNS + i] = weight * mx * smy
        stiffness[14 * COLUMNS + i] = weight * my * smx
        stiffness[15 * COLUMNS + i] = weight * my * smy
        viscous = weight * damping
        viscosity[i] = viscous * gx * gx
        viscosity[COLUMNS + i] = viscosity[2 * COLUMNS + i] = viscous * gx * gy
        viscosity[3 * COLUMNS + i] = viscous * gy * gy
        viscosity[4 * COLUMNS + i] = viscosity[8 * COLUMNS + i] = viscous * gx * mx
        viscosity[5 * COLUMNS + i] = viscosity[10 * COLUMNS + i] = viscous * gx * my
        viscosity[6 * COLUMNS + i] = viscosity[9 * COLUMNS + i] = viscous * gy * mx
        viscosity[7 * COLUMNS + i] = viscosity[11 * COLUMNS + i] = viscous * gy * my
        viscosity[12 * COLUMNS + i] = viscous * mx * mx
        viscosity[13 * COLUMNS + i] = viscosity[14 * COLUMNS + i] = viscous * mx * my
        viscosity[15 * COLUMNS + i] = viscous * my * my


@kernel
def _expand(lanes, local, found):
    """Compute force derivatives of `lanes` beam elements as weighted sums of force derivatives at quadrature points.

    `local` holds one 2 x 2 matrix per axial point, the derivative of the force conjugate to r' = dr/ds with respect to
    r'. Four per bending point follow: derivatives of the force conjugate to r' with respect to r' and to L r'' (L:
    element length), then likewise of the force conjugate to L r''. A matrix has four rows of COLUMNS numbers. `found`
    gets 36 such rows: 6 x 6 derivatives of forces conjugate to chord and end slopes with respect to these vectors.
    """
    for pair in range(9):
        weights = _EXPANSION[pair]
        for entry in range(4):
            row = (6 * (2 * (pair // 3) + entry // 2) + 2 * (pair % 3) + entry % 2) * COLUMNS
            out = found[row : row + COLUMNS]
            for i in range(0, lanes, REGISTER):
                y0, y1, y2, y3 = 0.0, 0.0, 0.0, 0.0
                for point in range(_POINTS):
                    w = weights[point]
                    source = local[(4 * point + entry) * COLUMNS :]
                    y0 += w * source[i]
                    y1 += w * source[i + 1]
                    y2 += w * source[i + 2]
                    y3 += w * source[i + 3]
                out[i], out[i + 1], out[i + 2], out[i + 3] = y0, y1, y2, y3


@kernel
def _scatter(elimination, matrix, k, inverse, slopes, i):
    """Convert the force derivatives of element `i` to nodal coordinates, and add them to the profile matrix `matrix`.

    Column `i` of the 36 rows in `slopes` has 6 x 6 derivatives of the forces conjugate to the chord and the two end
    slopes, with respect to these vectors. `elimination` gives each coordinate's place in `matrix`. `k` is the index of
    the element's first coordinate, and `inverse` is 1 / length, the factor between nodal positions and chord.
    """
    inner, outer = elimination.position[k] // BLOCK, elimination.position[k + BLOCK] // BLOCK
    cross = elimination.base[outer] + inner
    innermost, upper = matrix.diagonal[inner], matrix.upper[cross]
    lower, outermost = matrix.lower[cross], matrix.diagonal[outer]
    for r in range(BLOCK):
        # The nodes' positions enter through the chord alone.
        here, there = (-inverse, inverse) if r < 2 else (1.0, 1.0)
        row, other = 6 * COLUMNS * r + i, 6 * COLUMNS * (r if r < 2 else r + 2) + i
        for c in range(BLOCK):
            left, right = (-inverse, inverse) if c < 2 else (1.0, 1.0)
            column, beyond = COLUMNS * c, COLUMNS * (c if c < 2 else c + 2)
            innermost[BLOCK * r + c] += here * left * slopes[row + column]
            upper[BLOCK * r + c] += here * right * slopes[row + beyond]
            lower[BLOCK * c + r] += there * left * slopes[other + column]
            outermost[BLOCK * r + c] += there * right * slopes[other + beyond]


@kernel(inlined=False)
def add_elastic_tangents(elements, q, v, slopes, elimination, stiffness, damping):
    """Add df/dq to the profile matrix `stiffness` and df/dv to `damping`, for internal forces f in M a + f = loads.

    `elimination` gives the order of unknowns in both matrices; `slopes` holds scratch arrays.
    """
    motion = slopes.motion
    for block in range(elements.offset.shape[0]):
        offset, inverse_length = elements.offset[block], elements.inverse_length[block]
        constants, filled = elements.constants[block], elements.filled[block]
        for first in range(0, filled, COLUMNS):
            count = min(filled - first, COLUMNS)
            # Whole registers are filled: columns after the last element repeat the first element with zero stiffness.
            lanes = (count + REGISTER - 1) // REGISTER * REGISTER
            for i in range(lanes):
                k, inverse = offset[first + i], inverse_length[first + i]
                for axis in range(2):
                    motion[axis * COLUMNS + i] = (q[k + 4 + axis] - q[k + axis]) * inverse
                    motion[(2 + axis) * COLUMNS + i] = q[k + 2 + axis]
                    motion[(4 + axis) * COLUMNS + i] = q[k + 6 + axis]
                    motion[(6 + axis) * COLUMNS + i] = (v[k + 4 + axis] - v[k + axis]) * inverse
                    motion[(8 + axis) * COLUMNS + i] = v[k + 2 + axis]
                    motion[(10 + axis) * COLUMNS + i] = v[k + 6 + axis]
            of_element = constants[first:]
            for p in range(len(AXIAL)):
                place = 4 * COLUMNS * p
                stiff, viscous = slopes.local_stiffness[place:], slopes.local_damping[place:]
                _axial_slopes(AXIAL[p], lanes, of_element, motion, stiff, viscous)
            for p in range(len(BENDING)):
                place = 4 * COLUMNS * (len(AXIAL) + 4 * p)
                stiff, viscous = slopes.local_stiffness[place:], slopes.local_damping[place:]
                _bending_slopes(BENDING[p], lanes, of_element, motion, stiff, viscous)
            _expand(lanes, slopes.local_stiffness, slopes.stiffness)
            _expand(lanes, slopes.local_damping, slopes.damping)
            for i in range(count):
                k, inverse = offset[first + i], inverse_length[first + i]
                _scatter(elimination, stiffness, k, inverse, slopes.stiffness, i)
                _scatter(elimination, damping, k, inverse, slopes.damping, i)
