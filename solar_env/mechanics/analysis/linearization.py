"""Linearization about the initial state, natural frequencies and modes, and static equilibria of a mechanism.

The matrices come from the Newton iteration of the implicit integrator (`generalized_alpha.py`).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from solar_env.mechanics.arrays.model import Model, State
from solar_env.mechanics.equations.newton import assemble, linearize_forces
from solar_env.mechanics.equations.system import Workspace, accelerations, make_workspace
from solar_env.mechanics.integrators.methods.generalized_alpha import Iteration, fill_residual, make_iteration
from solar_env.mechanics.mechanism import Mechanism
from solar_env.mechanics.numerics.profile import dense
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation

Matrix = NDArray[np.float64]

_SYMMETRY = 1e-9  # greatest relative asymmetry of a stiffness matrix whose forces have a potential
_MOST_ITERATIONS = 60  # most Newton iterations for an equilibrium
_TOLERANCE = 1e-11  # tolerance of a Newton correction, relative to the length scale


class Linearization(NamedTuple):
    """Matrices of the linear equations M x'' + D x' + K x + C^T mu = 0 with C x = 0.

    x and mu are small changes of coordinates and multipliers. Rows and columns of fixed bodies' coordinates are zero.
    """

    mass: Matrix  # (n, n)
    damping: Matrix  # (n, n)
    stiffness: Matrix  # (n, n), including the geometric stiffness of the constraint forces
    constraints: Matrix  # (m, n)


class NewtonEquations:
    """Dense residual and matrix of Newton's iteration for a mechanism's equations of motion with constraints, at t = 0.

    The unknowns are coordinates and multipliers, at given accelerations (zero for an equilibrium). Torques of stops
    are included. Contact forces in clearance joints are not, because a contact begins only in motion.
    """

    def __init__(self, model: Model, state: State) -> None:
        self.model, self.state = model, state
        # In a run a stop acts only after the event that engages it; here it acts wherever the angle lies in the stop.
        state.joints["stop_engaged"] = 1
        self.work: Workspace = make_workspace(model, state)
        self.iteration: Iteration = make_iteration(model, state, self.work)
        self.iteration.q[:] = state.q
        self.iteration.v[:] = state.v
        self.moving = np.flatnonzero(model.elimination.position >= 0)  # unknowns that are not held

    def residual(self, model: Model) -> Matrix:
        """Return the negative residuals (unknowns,) of motion and constraint equations, under the loads of `model`."""
        fill_residual(model, self.state, self.iteration, self.work, 0.0, 1.0)
        return np.asarray(self.iteration.rhs)

    def matrix(self, model: Model) -> Matrix:
        """Return the stiffness matrix (unknowns, unknowns), bordered by constraint gradients. Call `residual` first."""
        it = self.iteration
        linearize_forces(model, self.state.joints, it.q, it.v, it.newton)
        assemble(model, it.q, it.multipliers, self.work.row_value, it.newton, (0.0, 0.0, 1.0))
        return dense(model.elimination, it.newton.matrix)


def linearize(mechanism: Mechanism) -> Linearization:
    """Return mass, damping, stiffness and constraint matrices of a mechanism, linearized about its initial state.

    Raises:
        ValueError: if the initial state violates the constraints, or if constraints are redundant.
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
    mass, damping = (dense(model.elimination, part)[:n, :n] for part in (it.newton.mass, it.newton.damping))
    return Linearization(mass, damping, bordered[:n, :n], bordered[rows, :n])


def natural_frequencies(mechanism: Mechanism) -> NDArray[np.float64]:
    """Return the undamped natural frequencies (k,) [Hz] at the initial state, ascending; rigid-body motions give zeros.

    Raise a ValueError in the same cases as `natural_modes`.
    """
    return natural_modes(mechanism)[0]


def natural_modes(mechanism: Mechanism) -> tuple[NDArray[np.float64], Matrix]:
    """Return the undamped natural frequencies (k,) [Hz], ascending, and the mode shapes (n, k) at the initial state.

    Raises:
        ValueError: if the forces have no potential, or the initial state is an unstable equilibrium.
    """
    mass, _, stiffness, constraints = linearize(mechanism)
    held = np.flatnonzero(~mass.any(axis=0))
    rows = np.vstack([constraints, np.eye(len(mass))[held]])
    free = null_space(rows) if len(rows) else np.eye(len(mass))
    scale = np.abs(stiffness).max()
    reduced = free.T @ stiffness @ free
    if np.abs(reduced - reduced.T).max() > _SYMMETRY * scale:
        raise ValueError("the forces have no potential: natural frequencies are not defined")
    squares, shapes = eigh(0.5 * (reduced + reduced.T), free.T @ mass @ free)
    if squares[0] < -1e-9 * max(squares[-1], 1.0):
        raise ValueError(f"the equilibrium is unstable: a squared frequency is {squares[0]:.3g} 1/s2")
    return np.sqrt(np.maximum(squares, 0.0)) / (2.0 * math.pi), free @ shapes


def static_equilibrium(mechanism: Mechanism, load_steps: int = 10) -> NDArray[np.float64]:
    """Return the equilibrium coordinates (n,) under springs, weight and loads; drives keep their angles at t = 0.

    Weight and loads grow in `load_steps` equal steps, so that Newton's iteration reaches large deflections. Torques of
    stops are included; contact forces in clearance joints are not.

    Raises:
        SimulationError: if the iteration does not converge, or the mechanism can move freely.
    """
    simulation = Simulation(mechanism)
    model, state = simulation.model, simulation.state
    equations = NewtonEquations(model, state)
    it, moving = equations.iteration, equations.moving
    it.v[:] = 0.0
    n = it.q.size
    for step in range(1, load_steps + 1):
        share = step / load_steps
        loads = model.loads.copy()
        loads["torque"] *= share
        loaded = model._replace(constant_force=share * model.constant_force, loads=loads)
        for _ in range(_MOST_ITERATIONS):
            residual = equations.residual(loaded)[moving]
            matrix = equations.matrix(loaded)[np.ix_(moving, moving)]
            change = np.zeros(n + it.multipliers.size)
            try:
                change[moving] = np.linalg.solve(matrix, residual)
            except np.linalg.LinAlgError:
                raise SimulationError(
                    "the mechanism can move freely: it has no equilibrium of its own", 0.0, "statics"
                ) from None
            it.q[:] += change[:n]
            it.multipliers[:] += change[n:]
            largest = float(np.abs(change[:n]).max())
            if largest <= _TOLERANCE * model.length_scale:
                break
        else:
            raise SimulationError(
                f"the equilibrium under {share:.3g} of the loads was not found (last correction {largest:.3g} m); "
                "raise load_steps",
                0.0,
                "statics",
            )
    return it.q.copy()
