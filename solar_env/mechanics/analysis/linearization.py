"""Small motions about the initial state: mass, damping, stiffness, constraints, and natural frequencies.

The matrices are those of Newton's equations of the implicit integrator (`generalized_alpha.py`).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from solar_env.mechanics.arrays.model import Model, State
from solar_env.mechanics.equations.newton import assemble, linearize_forces
from solar_env.mechanics.equations.system import Workspace, accelerations, add_mass_products, make_workspace
from solar_env.mechanics.integrators.methods.generalized_alpha import Iteration, fill_residual, make_iteration
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.numerics.profile import dense
from solar_env.mechanics.running.simulation import Simulation

Matrix = NDArray[np.float64]

_SYMMETRY = 1e-9  # relative asymmetry of a stiffness that has a potential


class Linearization(NamedTuple):
    """M a + D v + K x + C^T (multipliers) = 0 with C x = 0, for coordinates x that are small.

    The coordinates of fixed bodies have zero rows and columns, and are held.
    """

    mass: Matrix  # (n, n)
    damping: Matrix  # (n, n)
    stiffness: Matrix  # (n, n), with that of the constraints' forces
    constraints: Matrix  # (m, n)


class NewtonEquations:
    """Newton's equations of a mechanism at a configuration, as dense matrices.

    Stops act, contacts in clearance joints do not: these are struck in motion only.
    """

    def __init__(self, model: Model, state: State) -> None:
        self.model, self.state = model, state
        # Within a step a stop that is met later must not act; here it acts wherever the angle lies in it.
        state.joints["stop_engaged"] = 1
        self.work: Workspace = make_workspace(model, state)
        self.iteration: Iteration = make_iteration(model, state, self.work)
        self.iteration.q[:] = state.q
        self.iteration.v[:] = state.v
        self.moving = np.flatnonzero(model.elimination.position >= 0)  # unknowns that are not held

    def residual(self, model: Model) -> Matrix:
        """(unknowns,) minus the forces' imbalance and the constraints' violation; `model` may bear other loads."""
        fill_residual(model, self.state, self.iteration, self.work, 0.0, 1.0)
        return np.asarray(self.iteration.rhs)

    def matrix(self, model: Model) -> Matrix:
        """(unknowns, unknowns) stiffness, bordered by the constraints. Call `residual` before."""
        it = self.iteration
        linearize_forces(model, self.state.joints, it.q, it.v, it.newton)
        assemble(model, it.q, it.multipliers, self.work.row_value, it.newton, (0.0, 0.0, 1.0))
        return dense(model.elimination, it.newton.matrix)

    def damping(self) -> Matrix:
        """(n, n) minus the slope of the forces by velocities. Call `residual` before."""
        it, model, n = self.iteration, self.model, self.iteration.q.size
        linearize_forces(model, self.state.joints, it.q, it.v, it.newton)
        return dense(model.elimination, it.newton.damping)[:n, :n]

    def mass(self) -> Matrix:
        """(n, n); zero for the coordinates of fixed bodies."""
        n = self.iteration.q.size
        matrix = np.zeros((n, n))
        for k in self.moving[self.moving < n]:
            unit = np.zeros(n)
            unit[k] = 1.0
            add_mass_products(self.model, unit, matrix[k])
        return matrix


def linearize(mechanism: Mechanism) -> Linearization:
    """Linearize a mechanism about its initial state.

    Raises:
        ValueError: if the constraints are violated there, or redundant.
    """
    simulation = Simulation(mechanism)
    model, state = simulation.model, simulation.state
    equations = NewtonEquations(model, state)
    it = equations.iteration
    if not accelerations(model, state.joints, it.q, it.v, 0.0, equations.work, it.a, it.multipliers):
        raise ValueError("the constraints of the mechanism are redundant or contradict each other; remove one")
    equations.residual(model)
    bordered = equations.matrix(model)
    n = state.q.size
    rows = equations.moving[equations.moving >= n]
    return Linearization(equations.mass(), equations.damping(), bordered[:n, :n], bordered[rows, :n])


def natural_frequencies(mechanism: Mechanism) -> NDArray[np.float64]:
    """Undamped natural frequencies [Hz] at the initial state, ascending; rigid-body motions count as zeros.

    Raises:
        ValueError: if the forces have no potential, or an equilibrium is unstable.
    """
    mass, _, stiffness, constraints = linearize(mechanism)
    held = np.flatnonzero(~mass.any(axis=0))
    rows = np.vstack([constraints, np.eye(len(mass))[held]])
    free = null_space(rows) if len(rows) else np.eye(len(mass))
    scale = np.abs(stiffness).max()
    reduced = free.T @ stiffness @ free
    if np.abs(reduced - reduced.T).max() > _SYMMETRY * scale:
        raise ValueError("the forces have no potential: natural frequencies are not defined")
    squares = eigh(0.5 * (reduced + reduced.T), free.T @ mass @ free, eigvals_only=True)
    if squares[0] < -1e-9 * max(squares[-1], 1.0):
        raise ValueError(f"the equilibrium is unstable: a squared frequency is {squares[0]:.3g} 1/s2")
    return np.sqrt(np.maximum(squares, 0.0)) / (2.0 * math.pi)
