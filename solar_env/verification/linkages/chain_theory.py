"""An open chain of rigid bodies in minimal coordinates: the angles of the bodies, and the place of a free base.

With complex numbers for points of the plane, centroid i lies at p + sum over k of s_ik exp(i angle_k): the base point
p, and constant arms s_ik from pin to pin and from the last pin to the centroid. Lagrange's equations follow from these
arms without constraints. Integrated with SciPy's DOP853 (E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary
Differential Equations I, 1993).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

MINIMAL = "minimal coordinates, integrated by SciPy's DOP853 at rtol 1e-12"


@dataclass(frozen=True)
class ChainLink:
    """One body of a chain.

    Attributes:
        mass: [kg].
        inertia: about the centroid [kg m2].
        centroid: from the inboard pin, x + i y in the body's frame [m].
        next_pin: from the inboard pin to the outboard one [m].
    """

    mass: float
    inertia: float
    centroid: complex
    next_pin: complex = 0j


class Chain:
    """Equations of motion of n links, pinned at the origin or (`free`) floating.

    Coordinates are the n angles, followed by x and y of the first inboard pin if the chain is free.
    """

    def __init__(self, links: Sequence[ChainLink], free: bool = False, gravity: float = 0.0) -> None:
        self.links, self.free, self.gravity = tuple(links), free, gravity
        self.size = len(self.links) + (2 if free else 0)
        n = len(self.links)
        self.arms = np.zeros((n, n), dtype=complex)
        for i, link in enumerate(self.links):
            self.arms[i, :i] = [inner.next_pin for inner in self.links[:i]]
            self.arms[i, i] = link.centroid
        self.masses = np.array([link.mass for link in self.links])
        self.inertias = np.array([link.inertia for link in self.links])

    def jacobian(self, angles: Array) -> NDArray[np.complex128]:
        """(n, size) velocity of every centroid per unit coordinate velocity, as complex numbers."""
        turning = 1j * self.arms * np.exp(1j * angles)
        if not self.free:
            return turning
        ones = np.ones((len(self.links), 1))
        return np.hstack([turning, ones, 1j * ones])

    def mass_matrix(self, angles: Array) -> Array:
        """(size, size) generalized mass matrix [kg m2, kg m, kg]."""
        jacobian = self.jacobian(angles)
        matrix = (jacobian.conj().T @ (self.masses[:, None] * jacobian)).real
        n = len(self.links)
        matrix[np.arange(n), np.arange(n)] += self.inertias
        return matrix

    def applied(self, angles: Array, rates: Array, torques: Array) -> Array:
        """(size,) generalized forces: torques (n,) on the angles [N m], weight and centripetal terms."""
        centripetal = -(self.arms * np.exp(1j * angles)) @ rates**2
        forces = self.masses * (-1j * self.gravity - centripetal)
        total = (self.jacobian(angles).conj().T @ forces).real
        total[: len(self.links)] += torques
        return total

    def solve(
        self,
        angles: Sequence[float],
        rates: Sequence[float],
        torques: Callable[[Array, Array], Array],
        times: Sequence[float],
        coupling: tuple[Array, Array] | None = None,
        stop: Callable[[float, Array], float] | None = None,
    ) -> Any:
        """SciPy's solution at some times [s] under torques [N m] of angles and rates; states hold n angles, n rates.

        A coupling is a constraint c . angles = const that acts through torques proportional to g, as rows (c, g).
        """
        n = len(self.links)

        def slope(_: float, state: Array) -> Array:
            a, w = state[:n], state[n:]
            matrix, force = self.mass_matrix(a), self.applied(a, w, torques(a, w))
            if coupling is None:
                return np.concatenate([w, np.linalg.solve(matrix, force)[:n]])
            row, way = (np.concatenate([part, np.zeros(self.size - n)])[None, :] for part in coupling)
            bordered = np.block([[matrix, -way.T], [row, np.zeros((1, 1))]])
            return np.concatenate([w, np.linalg.solve(bordered, np.append(force, 0.0))[:n]])

        if stop is not None:
            stop.terminal = True  # type: ignore[attr-defined]
        return solve_ivp(
            slope,
            (0.0, times[-1]),
            np.concatenate([angles, rates]),
            method="DOP853",
            t_eval=times,
            events=stop,
            rtol=1e-12,
            atol=1e-13,
        )
