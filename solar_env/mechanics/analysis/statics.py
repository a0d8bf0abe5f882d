"""Equilibrium of a mechanism at rest, by Newton's iteration with the analytic tangent."""

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.analysis.linearization import NewtonEquations
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation

_MOST_ITERATIONS = 60
_TOLERANCE = 1e-11  # of a correction, relative to the length scale


def static_equilibrium(mechanism: Mechanism, load_steps: int = 10) -> NDArray[np.float64]:
    """Coordinates (n,) at rest under springs, weight and loads; drives stay at their angles of t = 0.

    Weight and loads grow in equal steps, so that large deflections are reached from the initial state. Stops act,
    contacts in clearance joints do not.

    Raises:
        ValueError: if load_steps is not positive.
        SimulationError: if the iteration does not converge.
    """
    if load_steps < 1:
        raise ValueError(f"load_steps = {load_steps!r} must be at least 1")
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
