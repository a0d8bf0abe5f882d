"""Shortening of a bent panel along its axis, to second order in the bending amplitudes.

A beam that bends without stretching moves its points along the axis by u with u' = -w'^2 / 2, u free of its mean.
Of u the lowest axial modes take their projections s_k = b^T K_k b / 2; the rest is felt at the ends alone, as
b^T S_e b / 2. Its transpose is the tension's action on bending (J. C. Simo and L. Vu-Quoc, J. Sound Vib. 119 (1987)
487, doi:10.1016/0022-460X(87)90410-X, on why it must not be left out).
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.bodies.beam_modes import slope_factor, wave_number

# Bending and axial modes that enter. More change the forces after latching by less than one part in a thousand.
BENDING_MODES = 6
AXIAL_MODES = 3
_NODES = 200  # of Gauss, for products of two slopes with at most seven waves each


def slopes(length: float, mass: float, modes: int, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """(modes, points) slopes of the lowest mass-normalised bending modes at the points `x` [m].

    Hyperbolic functions are taken apart into growing and decaying exponentials, whose factors hold all digits.
    """
    found = np.zeros((modes, x.size))
    for k in range(modes):
        number = wave_number(k + 1)
        factor = slope_factor(number)
        sigma, rest = float(factor), float(1 - factor)
        z = float(number) * x / length
        shape = 0.5 * rest * np.exp(z) - 0.5 * (1.0 + sigma) * np.exp(-z) - np.sin(z) - sigma * np.cos(z)
        found[k] = float(number) / length / math.sqrt(mass) * shape
    return found


def quadratic_forms(
    length: float, mass: float, bending: int, axial: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """K (axial, bending, bending) and S (2, bending, bending) [1/m, and 1/(kg m) as the modes are mass-normalised].

    Args:
        length: [m].
        mass: [kg].
        bending: number of bending modes that enter.
        axial: number of axial modes that enter.
    """
    project, ends = _unit_forms(bending, axial)
    return project / (math.sqrt(mass) * length), ends / (mass * length)


@lru_cache(maxsize=64)
def _unit_forms(bending: int, axial: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Both for a panel of unit length and mass."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    x, w = 0.5 * (nodes + 1.0), 0.5 * weights
    slope = slopes(1.0, 1.0, bending, x)
    numbers = np.arange(1, axial + 1)[:, None]
    # Integrals of rho times the axial modes from the first end, which is the weight of u' in their projections.
    integrated = math.sqrt(2.0) / (numbers * math.pi) * np.sin(numbers * math.pi * x)
    project = np.einsum("kx,ix,jx,x->kij", integrated, slope, slope, w)
    whole = np.stack([1.0 - x, -x])
    ends = np.einsum("ex,ix,jx,x->eij", whole, slope, slope, w)
    shapes = math.sqrt(2.0) * np.stack([np.ones(axial), (-1.0) ** numbers[:, 0]])
    return project, ends - np.einsum("ek,kij->eij", shapes, project)
