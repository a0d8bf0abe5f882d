"""The rigid array with ideal hinges in minimal coordinates; its latch times with an inextensible cable."""

import math

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.verification.linkages.chain_theory import Array, Chain, ChainLink


def make_chain(p: ArrayParameters) -> Chain:
    """Main body (left out if it is fixed) and panels; the first inboard pin is the main body's centroid."""
    mass = p.panel_density * p.panel_length * p.panel_width * p.panel_thickness
    inertia = mass * (p.panel_length**2 + p.panel_thickness**2) / 12.0
    panels = [ChainLink(mass, inertia, p.panel_length / 2 + 0j, p.panel_length + 0j)] * p.panel_count
    if p.body_fixed:
        return Chain(panels)
    return Chain([ChainLink(p.body_mass, p.body_inertia, 0j, complex(p.hinge_x, p.hinge_y)), *panels], free=True)


def folded_angles(p: ArrayParameters) -> Array:
    """Absolute angles of the chain's links at t = 0: panels alternate between -pi/2 and pi/2."""
    panels = [-math.pi / 2 * (-1) ** k for k in range(p.panel_count)]
    return np.array(panels if p.body_fixed else [0.0, *panels])


def hinge_map(p: ArrayParameters) -> NDArray[np.float64]:
    """(panels, links) matrix: joint angles = matrix (angles - folded ones); its transpose spreads torques."""
    matrix = np.zeros((p.panel_count, p.panel_count + 1))
    for k in range(p.panel_count):
        sign = (-1.0) ** k
        matrix[k, k], matrix[k, k + 1] = -sign, sign
    return matrix[:, 1:] if p.body_fixed else matrix


def spring_torques(p: ArrayParameters, joint_angles: Array) -> Array:
    """(panels,) K (preload angle - angle) [N m]."""
    return np.array(p.for_each_joint("spring_stiffness")) * (p.for_each_joint("spring_preload_angle") - joint_angles)


def cable_torques(p: ArrayParameters, joint_angles: Array) -> Array:
    """(panels,) of loops whose strands are both taut [N m]; wheel ratios are those of the lock angles."""
    total = np.zeros(p.panel_count)
    for k in range(1, p.panel_count):
        ratio = 2.0 if k == 1 else 1.0
        torque = p.by_joint("cable_stiffness", k - 1) * (ratio * joint_angles[k - 1] - joint_angles[k])
        total[k] += torque
        total[k - 1] -= (ratio if p.cable_torque_ratio is None else p.cable_torque_ratio) * torque
    return total


def joint_angles_over_time(p: ArrayParameters, times: list[float]) -> NDArray[np.float64]:
    """(times, panels) joint angles [rad] of the deployment with an elastic cable, before any latching."""
    chain, start, matrix = make_chain(p), folded_angles(p), hinge_map(p)

    def torques(angles: Array, _: Array) -> Array:
        joint_angles = matrix @ (angles - start)
        return matrix.T @ (spring_torques(p, joint_angles) + cable_torques(p, joint_angles))

    solution = chain.solve(list(start), [0.0] * len(start), torques, times)
    return (solution.y[: len(start)].T - start) @ matrix.T


def latch_time(p: ArrayParameters) -> float:
    """Latch time [s] of two panels whose angles are held at 1 : 2 by a cable that does not stretch.

    The cable's torque acts on the joints as (-torque ratio, 1).
    """
    chain, start, matrix = make_chain(p), folded_angles(p), hinge_map(p)
    ratio = 2.0 if p.cable_torque_ratio is None else p.cable_torque_ratio

    def torques(angles: Array, _: Array) -> Array:
        return matrix.T @ spring_torques(p, matrix @ (angles - start))

    def locked(_: float, state: Array) -> float:
        return float(matrix[0] @ (state[: len(start)] - start)) - math.pi / 2

    coupling = (matrix.T @ np.array([2.0, -1.0]), matrix.T @ np.array([-ratio, 1.0]))
    solution = chain.solve(list(start), [0.0] * len(start), torques, [100.0], coupling, locked)
    return float(solution.t_events[0][0])
