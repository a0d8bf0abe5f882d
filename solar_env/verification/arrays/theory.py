"""Theory of the rigid array with ideal hinges in minimal coordinates, and of latch times with an inextensible cable.

The array is an open chain of rigid bodies. Coordinates are the angles of the bodies, and the position of a free base.

Complex numbers stand for points of the plane. Centroid i lies at p + sum over k of s_ik exp(i angle_k). Here p is the
base point, and the constant arms s_ik lead from pin to pin and from the last pin to the centroid. Lagrange's equations
follow from these arms without constraints. SciPy's DOP853 integrates them (E. Hairer, S. P. Norsett and G. Wanner,
Solving Ordinary Differential Equations I, 1993).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.linalg import eigh

from solar_env.array import ArrayParameters

Array = NDArray[np.float64]

MINIMAL = "minimal coordinates, integrated by SciPy's DOP853 at rtol 1e-12"


@dataclass(frozen=True)
class ChainLink:
    """A rigid body of a chain, between an inboard and an outboard pin.

    Attributes:
        mass: mass [kg].
        inertia: moment of inertia about the centroid [kg m2].
        centroid: vector from the inboard pin to the centroid, x + i y in the body's frame [m].
        next_pin: vector from the inboard to the outboard pin, x + i y in the body's frame [m].
    """

    mass: float
    inertia: float
    centroid: complex
    next_pin: complex = 0j


class Chain:
    """Equations of motion of a chain of n links, pinned at the origin or, if `free`, floating.

    Coordinates are the n angles, followed by x and y of the first inboard pin if the chain is free.
    """

    def __init__(self, links: Sequence[ChainLink], free: bool = False, gravity: complex = 0j) -> None:
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
        """Return velocities x + i y (n, size) of n centroids, per unit velocity of each of the `size` coordinates."""
        turning = 1j * self.arms * np.exp(1j * angles)
        if not self.free:
            return turning
        ones = np.ones((len(self.links), 1))
        return np.hstack([turning, ones, 1j * ones])

    def mass_matrix(self, angles: Array) -> Array:
        """Return the (size, size) mass matrix [kg m2, kg m, kg] of the `size` coordinates at link angles [rad]."""
        jacobian = self.jacobian(angles)
        matrix = (jacobian.conj().T @ (self.masses[:, None] * jacobian)).real
        n = len(self.links)
        matrix[np.arange(n), np.arange(n)] += self.inertias
        return matrix

    def applied(self, angles: Array, rates: Array, torques: Array) -> Array:
        """Return the (`size`,) sum of generalized forces: `torques` (n,) on links [N m], gravity, centrifugal terms."""
        forces = self.masses * ((self.arms * np.exp(1j * angles)) @ rates**2 + self.gravity)
        total = (self.jacobian(angles).conj().T @ forces).real
        total[: len(self.links)] += torques
        return total

    def solve(
        self,
        angles: Array,
        torques: Callable[[Array, Array], Array],
        times: Sequence[float],
        coupling: tuple[Array, Array] | None = None,
        stop: Callable[[float, Array], float] | None = None,
    ) -> Any:
        """Integrate link angles [rad] and rates [rad/s] from rest at `angles`; return SciPy's solution at `times` [s].

        `torques` maps angles and rates to the torques on the links [N m]. A coupling (c, g) is a constraint c . angles
        = const, enforced by torques proportional to g. The motion ends when the function `stop` of time and state
        (angles, rates) becomes zero.
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
            np.concatenate([angles, np.zeros(n)]),
            method="DOP853",
            t_eval=times,
            events=stop,
            rtol=1e-12,
            atol=1e-13,
        )


def make_chain(p: ArrayParameters) -> Chain:
    """Return the chain of the array's panels; a free main body is the first link, with its centroid as inboard pin."""
    rows = [p.panel(joint.index) for joint in p.joints]
    panels = [ChainLink(row.mass, row.inertia, row.centroid + 0j, row.length + 0j) for row in rows]
    if p.body_fixed:
        return Chain(panels, gravity=complex(*p.unsupported_gravity))
    return Chain([ChainLink(p.body_mass, p.body_inertia, 0j, complex(p.hinge_x, p.hinge_y)), *panels], free=True)


def folded_angles(p: ArrayParameters) -> Array:
    """Return the absolute angles [rad] of the chain's links in the folded array, at t = 0."""
    panels = -np.cumsum([joint.sign * joint.fold_angle for joint in p.joints])
    return panels if p.body_fixed else np.append(0.0, panels)


def hinge_map(p: ArrayParameters) -> NDArray[np.float64]:
    """Return M (joints, links): joint angles = M (link angles - folded angles), link torques = M^T joint torques."""
    matrix = np.zeros((p.panel_count, p.panel_count + 1))
    for k, joint in enumerate(p.joints):
        matrix[k, k], matrix[k, k + 1] = -joint.sign, joint.sign
    return matrix[:, 1:] if p.body_fixed else matrix


def spring_torques(p: ArrayParameters, joint_angles: Array) -> Array:
    """Return the (panels,) torques K (preload angle - joint angle) [N m] of the hinge springs."""
    return np.array(p.for_each_joint("spring_stiffness")) * (p.for_each_joint("spring_preload_angle") - joint_angles)


def hinge_torques(p: ArrayParameters) -> Callable[[Array, Array], Array]:
    """Return a function from joint angles and rates to (panels,) torques [N m] of spring, harness, damper, friction."""
    curves = [
        (joint.index, PchipInterpolator(*np.array(table).T))
        for name in ("spring_torque", "harness_torque")
        for joint in p.joints
        if (table := p.table(name, joint.index))
    ]
    damping = np.array(p.for_each_joint("hinge_damping"))
    friction, ramp = (
        np.array([read(joint.index) for joint in p.joints]) for read in (p.friction_torque, p.friction_rate)
    )

    def torques(angles: Array, rates: Array) -> Array:
        total = spring_torques(p, angles) - damping * rates - friction * rates / np.hypot(rates, ramp)
        for joint, curve in curves:
            total[joint] += curve(angles[joint])
        return np.asarray(total)

    return torques


def cable_torques(p: ArrayParameters, joint_angles: Array) -> Array:
    """Return the (panels,) joint torques [N m] of taut cable loops; wheel ratios follow from the lock angles."""
    total = np.zeros(p.panel_count)
    for k in range(1, p.panel_count):
        ratio = p.joints[k].lock_angle / p.joints[k - 1].lock_angle
        torque = p.by_joint("cable_stiffness", k - 1) * (ratio * joint_angles[k - 1] - joint_angles[k])
        total[k] += torque
        total[k - 1] -= (ratio if p.cable_torque_ratio is None else p.cable_torque_ratio) * torque
    return total


def joint_angles_over_time(p: ArrayParameters, times: list[float]) -> NDArray[np.float64]:
    """Solve the deployment with an elastic cable and without latches for the (times, panels) joint angles [rad]."""
    chain, start, matrix = make_chain(p), folded_angles(p), hinge_map(p)

    at_hinges = hinge_torques(p)

    def torques(angles: Array, rates: Array) -> Array:
        joint_angles = matrix @ (angles - start)
        return matrix.T @ (at_hinges(joint_angles, matrix @ rates) + cable_torques(p, joint_angles))

    solution = chain.solve(start, torques, times)
    return (solution.y[: len(start)].T - start) @ matrix.T


def frequencies_on_latches(p: ArrayParameters) -> Array:
    """Compute the (panels,) frequencies [Hz] of the deployed array, with a spring of latch stiffness at each joint."""
    chain, matrix = make_chain(p), hinge_map(p)
    deployed = folded_angles(p) + np.append(
        [] if p.body_fixed else 0.0, np.cumsum([j.sign * j.lock_angle for j in p.joints])
    )
    stiffness = np.zeros((chain.size, chain.size))
    links = len(chain.links)
    stiffness[:links, :links] = matrix.T @ np.diag(p.for_each_joint("latch_stiffness")) @ matrix
    squares = eigh(stiffness, chain.mass_matrix(deployed), eigvals_only=True)[-p.panel_count :]
    return np.asarray(np.sqrt(squares) / (2.0 * math.pi))


def latch_time(p: ArrayParameters) -> float:
    """Compute the latch time [s] of two panels whose joint angles an inextensible cable holds at 1 : 2.

    The cable loads the two joints with torques in the ratio -r : 1, where r is `p.cable_torque_ratio`, or 2 if None.
    """
    chain, start, matrix = make_chain(p), folded_angles(p), hinge_map(p)
    ratio = 2.0 if p.cable_torque_ratio is None else p.cable_torque_ratio

    def torques(angles: Array, _: Array) -> Array:
        return matrix.T @ spring_torques(p, matrix @ (angles - start))

    def locked(_: float, state: Array) -> float:
        return float(matrix[0] @ (state[: len(start)] - start)) - math.pi / 2

    coupling = (matrix.T @ np.array([2.0, -1.0]), matrix.T @ np.array([-ratio, 1.0]))
    solution = chain.solve(start, torques, [100.0], coupling, locked)
    return float(solution.t_events[0][0])
