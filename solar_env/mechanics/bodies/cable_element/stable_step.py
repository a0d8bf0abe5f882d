"""The largest step with which explicit Runge-Kutta integrates a beam: a property of the discretised beam.

Every free vibration of a beam with stiffness-proportional damping obeys z'' + damping omega^2 z' + omega^2 z = 0. Its
two eigenvalues times the step must lie where the method's stability function is at most 1 in magnitude.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from solar_env.mechanics.bodies.cable_element.matrices import mass_band, stiffness_matrix

# Beyond this number the highest frequency depends on the length of an element alone.
_REPRESENTATIVE_ELEMENTS = 12


def largest_frequencies(
    elements: int, element_length: float, linear_density: float, axial_stiffness: float, bending_stiffness: float
) -> NDArray[np.float64]:
    """Highest axial and highest bending angular frequency [rad/s] of a free straight beam."""
    count = min(elements, _REPRESENTATIVE_ELEMENTS)
    band = mass_band(count, element_length, linear_density)
    mass = np.zeros((len(band), len(band)))
    for i, row in enumerate(band):
        for k, value in enumerate(row[::-1]):
            if k <= i:
                mass[i, i - k] = mass[i - k, i] = value
    squares = []
    for stiffness in ((axial_stiffness, 0.0), (0.0, bending_stiffness)):
        matrix = stiffness_matrix(count, element_length, *stiffness)
        squares.append(eigh(matrix, mass, eigvals_only=True, subset_by_index=[len(band) - 1, len(band) - 1])[0])
    return np.sqrt(squares)


def _reach(direction: complex) -> float:
    """Greatest r for which the method is stable at r * direction: |1 + z + z^2/2 + z^3/6 + z^4/24| <= 1 up to there."""
    r = np.linspace(1e-2, 4.0, 40_000)
    z = r * direction
    unstable = np.abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))) > 1.0 + 1e-12
    return float(r[np.argmax(unstable)])


@lru_cache(maxsize=256)
def beam_stable_step(
    elements: int,
    element_length: float,
    linear_density: float,
    axial_stiffness: float,
    bending_stiffness: float,
    damping: float,
) -> float:
    """`stable_step` of a free straight beam; kept, since every build of an array asks for the same few beams."""
    frequencies = largest_frequencies(elements, element_length, linear_density, axial_stiffness, bending_stiffness)
    return stable_step(frequencies, damping)


def stable_step(frequencies: NDArray[np.float64], damping: float) -> float:
    """Largest stable step [s] of a four-stage method of order four for vibrations of the given frequencies [rad/s].

    E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 1996, section IV.2,
    doi:10.1007/978-3-642-05221-7.
    """
    limit = math.inf
    for omega in frequencies:
        half = 0.5 * damping * omega
        root = np.sqrt(complex(half * half - 1.0))
        eigenvalue = -omega * (half + root)
        limit = min(limit, _reach(eigenvalue / abs(eigenvalue)) / abs(eigenvalue))
    return limit
