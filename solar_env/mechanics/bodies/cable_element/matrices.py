"""Mass and stiffness matrices of straight beams of ANCF cable elements, and quadrature of the strains. Plain NumPy."""

import cmath
import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

# Bandwidth of a beam's mass matrix for one axis, diagonal included: the matrix couples neighbouring nodes.
MASS_BAND = 4
# Number of elements beyond which a beam's highest frequency depends on the element length alone.
_REPRESENTATIVE_ELEMENTS = 12


def _quadrature(points: int) -> tuple[tuple[float, ...], ...]:
    """Return a row of seven numbers for each Gauss point on the unit interval of an element of length L.

    An element's chord and end slopes, times the first three numbers, sum to the centreline's tangent r' = dr/ds; times
    the next three they sum to L r''. The last number is the quadrature weight.
    """
    nodes, weights = np.polynomial.legendre.leggauss(points)
    rows = []
    for s, w in zip(0.5 * (nodes + 1.0), 0.5 * weights, strict=True):
        slope = (6.0 * s * (1.0 - s), 1.0 - 4.0 * s + 3.0 * s * s, 3.0 * s * s - 2.0 * s)
        rows.append((*slope, 6.0 - 12.0 * s, 6.0 * s - 4.0, 6.0 * s - 2.0, w))
    return tuple(tuple(float(x) for x in row) for row in rows)


# Quadrature points of the axial strain energy and of the bending energy.
AXIAL = _quadrature(5)
BENDING = _quadrature(3)


def _assembled(element: NDArray[np.float64], elements: int) -> NDArray[np.float64]:
    """Assemble a beam's matrix, whose 2 (elements + 1) rows are r_0, r'_0, r_1, r'_1, ..., from an element's matrix."""
    matrix = np.zeros((2 * (elements + 1), 2 * (elements + 1)))
    for e in range(elements):
        matrix[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += element
    return matrix


def mass_matrix(elements: int, element_length: float, linear_density: float) -> NDArray[np.float64]:
    """Return a beam's mass matrix for one axis; the x coordinates and the y coordinates have the same matrix."""
    L = element_length
    rows = [
        [156.0, 22.0 * L, 54.0, -13.0 * L],
        [22.0 * L, 4.0 * L * L, 13.0 * L, -3.0 * L * L],
        [54.0, 13.0 * L, 156.0, -22.0 * L],
        [-13.0 * L, -3.0 * L * L, -22.0 * L, 4.0 * L * L],
    ]
    return _assembled(linear_density * L / 420.0 * np.array(rows), elements)


def shape_at(elements: int, element_length: float, place: float) -> NDArray[np.float64]:
    """Return weights (2 (elements + 1),) of nodal positions and slopes that give the axis point at `place` [m]."""
    e = min(int(place / element_length), elements - 1)
    s = place / element_length - e
    shape = np.zeros(2 * (elements + 1))
    shape[2 * e : 2 * e + 4] = (
        1.0 - 3.0 * s**2 + 2.0 * s**3,
        element_length * (s - 2.0 * s**2 + s**3),
        3.0 * s**2 - 2.0 * s**3,
        element_length * (s**3 - s**2),
    )
    return shape


def stiffness_matrix(
    elements: int, element_length: float, axial_stiffness: float, bending_stiffness: float
) -> NDArray[np.float64]:
    """Return the sum of a straight beam's axial and transverse stiffness matrices; a stiffness of 0 omits one."""
    element = np.zeros((4, 4))
    bending = bending_stiffness / element_length**2
    for points, stiffness, first in ((AXIAL, axial_stiffness, 0), (BENDING, bending, 3)):
        for row in points:
            d, a, b = row[first : first + 3]
            shape = np.array([-d / element_length, a, d / element_length, b])
            element += row[6] * element_length * stiffness * np.outer(shape, shape)
    return _assembled(element, elements)


def lower_band(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the (rows, MASS_BAND) lower band of a matrix: entry (i, k) is row i, column i - 3 + k."""
    band = np.zeros((len(matrix), MASS_BAND))
    for k in range(MASS_BAND):
        offset = MASS_BAND - 1 - k
        band[offset:, k] = np.diagonal(matrix, -offset)
    return band


def factor_band(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Factor a beam's full mass matrix (rows, rows) as L D L^T, with unit lower triangular L and diagonal D.

    Return an array (rows, MASS_BAND). Entry (i, k) is L[i, i - 3 + k]; in the last column, k = 3, it is 1 / D[i, i].
    """
    factor = np.linalg.cholesky(matrix)
    pivots = np.diagonal(factor)
    band = lower_band(factor / pivots)
    band[:, -1] = 1.0 / pivots**2
    return band


@lru_cache(maxsize=256)
def stable_step(
    elements: int,
    element_length: float,
    linear_density: float,
    axial_stiffness: float,
    bending_stiffness: float,
    damping: float,
) -> float:
    """Return the largest step [s] with which explicit Runge-Kutta of order four is stable on the free straight beam.

    Every vibration u obeys u'' + damping omega^2 u' + omega^2 u = 0. Both eigenvalues times the step must lie in the
    stability domain (E. Hairer and G. Wanner, Solving ODEs II, 1996, section IV.2, doi:10.1007/978-3-642-05221-7).
    """
    count, limit = min(elements, _REPRESENTATIVE_ELEMENTS), math.inf
    mass, reaches = mass_matrix(count, element_length, linear_density), np.linspace(1e-2, 4.0, 40_000)
    for stiffness in ((axial_stiffness, 0.0), (0.0, bending_stiffness)):
        squares = eigh(stiffness_matrix(count, element_length, *stiffness), mass, eigvals_only=True)
        omega = math.sqrt(squares[-1])
        half = 0.5 * damping * omega
        eigenvalue = -omega * (half + cmath.sqrt(half * half - 1.0))
        z = reaches * eigenvalue / abs(eigenvalue)
        unstable = np.abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))) > 1.0 + 1e-12
        limit = min(limit, float(reaches[np.argmax(unstable)]) / abs(eigenvalue))
    return limit
