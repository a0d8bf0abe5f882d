"""A flexible beam in motion, described by strains instead of positions: the reference for the engine's beam elements.

The unknowns are the centreline's direction theta(s, t) and stretch 1 + eps(s, t), each a Legendre series over the
whole beam. Positions follow by integration, r = base + integral of (1 + eps) exp(i theta) ds, with complex numbers for
points of the plane. The energies E A eps^2 / 2 and E I theta'^2 / 2 are quadratic in the unknowns. Lagrange's equations
follow without constraints, and the error falls faster than any power of the number of terms. SciPy's DOP853 integrates.

This is the strain-based form of the geometrically exact beam (J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986)
849) without shear. It shares nothing with elements that interpolate positions and slopes.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solar_env.mechanics.mechanism import Beam

Array = NDArray[np.float64]


class StrainBeam:
    """Equations of motion of a beam whose first end is fixed at the origin.

    The coordinates are `turns` Legendre coefficients of the centreline's direction, then `stretches` Legendre
    coefficients of the stretch. The beam is inextensible if `stretches` is 0.
    """

    def __init__(
        self,
        beam: Beam,
        turns: int,
        stretches: int,
        root_angle: Callable[[float], tuple[float, float, float]] | None = None,
        gravity: float = 0.0,
    ) -> None:
        """Set up the equations: `turns` series terms for the centreline's direction, `stretches` terms for its stretch.

        `root_angle` gives the root's angle, rate and acceleration at a time [s]; None pins it. `gravity` acts along -y.
        """
        self.beam, self.turns, self.stretches = beam, turns, stretches
        self.root_angle, self.gravity = root_angle, gravity
        points = turns + stretches + 12
        x, weights = legendre.leggauss(points)
        self.weights = 0.5 * beam.length * weights
        # Matrix that integrates a polynomial, given by its values at the points, from the root to every point.
        integrals = [legendre.Legendre.basis(k).integ(lbnd=-1) for k in range(points)]
        from_values = np.array([(k + 0.5) * weights * legendre.Legendre.basis(k)(x) for k in range(points)])
        self.integrate = 0.5 * beam.length * np.array([p(x) for p in integrals]).T @ from_values
        clamped = root_angle is not None
        bases = [legendre.Legendre.basis(k) for k in range(turns + clamped)][clamped:]
        self.direction = np.array([p(x) - (p(-1.0) if clamped else 0.0) for p in bases]).T
        curvature = np.array([p.deriv()(x) for p in bases]).T * 2.0 / beam.length
        self.stretch = np.array([legendre.Legendre.basis(k)(x) for k in range(stretches)]).reshape(stretches, points).T
        self.bending = beam.bending_stiffness * curvature.T @ (self.weights[:, None] * curvature)
        self.axial = beam.axial_stiffness * self.stretch.T @ (self.weights[:, None] * self.stretch)

    def tangent(self, time: float, coordinates: Array) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Return the centreline's direction exp(i theta) and tangent (1 + eps) exp(i theta) at quadrature points."""
        root = self.root_angle(time)[0] if self.root_angle else 0.0
        way = np.exp(1j * (root + self.direction @ coordinates[: self.turns]))
        return way, (1.0 + self.stretch @ coordinates[self.turns :]) * way

    def accelerations(self, time: float, coordinates: Array, rates: Array) -> Array:
        """Compute the coordinates' second time derivatives, given time [s], coordinates and their rates."""
        beam, n = self.beam, self.turns
        way, tangent = self.tangent(time, coordinates)
        spin, spin_change = self.root_angle(time)[1:] if self.root_angle else (0.0, 0.0)
        turning = spin + self.direction @ rates[:n]
        stretching = self.stretch @ rates[n:]
        known = (1j * spin_change - turning**2) * tangent + 2j * stretching * turning * way
        columns = np.hstack([1j * tangent[:, None] * self.direction, way[:, None] * self.stretch])
        columns, known = self.integrate @ columns, self.integrate @ known
        weighted = beam.linear_density * self.weights[:, None] * columns.conj()
        force = (weighted.T @ (-1j * self.gravity - known)).real
        force[:n] -= self.bending @ (coordinates[:n] + beam.damping * rates[:n])
        force[n:] -= self.axial @ (coordinates[n:] + beam.damping * rates[n:])
        return np.linalg.solve((weighted.T @ columns).real, force)

    def tips(self, times: Sequence[float], rtol: float = 1e-8) -> NDArray[np.complex128]:
        """Integrate from the straight beam at rest on the x axis; return tip positions x + i y [m] at `times` [s]."""
        size = self.turns + self.stretches

        def slope(time: float, state: Array) -> Array:
            return np.concatenate([state[size:], self.accelerations(time, state[:size], state[size:])])

        start = np.zeros(2 * size)
        states = solve_ivp(slope, (0.0, times[-1]), start, "DOP853", times, rtol=rtol, atol=0.1 * rtol).y.T
        return np.array([self.weights @ self.tangent(t, q[:size])[1] for t, q in zip(times, states, strict=True)])
