"""Mass and stiffness of straight beams of cable elements, and the quadrature of their strains. Plain NumPy."""

import numpy as np
from numpy.typing import NDArray

# Bandwidth of a beam's mass matrix, the diagonal included: two neighbouring nodes.
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


def factor_band(band: NDArray[np.float64]) -> NDArray[np.float64]:
    """Factors L D L^T of a banded matrix as `mass_band` returns it: L below, 1 / D in the last column."""
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
