"""Verification of modal-radau, the integrator of modal panels: orders of convergence, conserved momenta and energy."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.integrators.settings import ModalRadau
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism import GROUND, Bearing, Joint, Mechanism, Spring
from solar_env.mechanics.mechanism.beams import BEAM, PANEL
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.checks import ENERGY, MOMENTUM, Check
from solar_env.verification.panels.mechanisms import modal, start

OUTER = "outer"
# Panels have no modes except pseudo-modes for their flexibility: otherwise the number of modes that a step resolves
# would change with the step. Initial vibrations have decayed after half a second.
MODES = 0
# Large foreshortening would lower the order with ideal joints to 1.6: these panels bend little.
DAMPED = replace(PANEL, damping=1e-3, bending_stiffness=30.0 * PANEL.bending_stiffness)


def _swing(bearing: Bearing | None) -> Mechanism:
    """Make a chain of two panels with hinge springs under gravity; the first hinge is ideal if `bearing` is None."""
    first = modal(DAMPED, MODES, position=(0.0, -bearing.clearance if bearing else 0.0))
    second = replace(first, name=OUTER, position=(PANEL.length, first.position[1]))
    hinge = Joint("hinge", GROUND, BEAM, (0.0, 0.0), (0.0, 0.0), bearing=bearing, spring=Spring(20.0, 0.5))
    knee = Joint("knee", BEAM, OUTER, (PANEL.length, 0.0), (0.0, 0.0), spring=Spring(10.0, -0.5))
    return Mechanism((first, second), (hinge, knee), gravity=(0.0, -9.81))


def _errors(mechanism: Mechanism, halvings: int) -> NDArray[np.float64]:
    """Return errors (halvings + 1, 3) of motion, spring torques and reactions after 0.256 s; each row halves the step.

    Errors are Euclidean norms, in SI units, of differences from the same integrator at a much smaller step. All runs
    start from one state, in which vibrations have decayed.
    """
    coarse, duration, settling = 0.004, 0.256, 0.5
    settled = start(mechanism, rtol=1e-8)
    settled.advance(settling)

    def run(step: float) -> tuple[NDArray[np.float64], ...]:
        constant = ModalRadau(rtol=0.01, velocity_scale=1e9, max_step=step * (1.0 + 1e-9))
        simulation = Simulation(mechanism, constant)
        simulation.restore(settled.snapshot())
        simulation.state.clock["step_size"] = step
        simulation.advance(settling + duration)
        bodies = simulation.model.bodies["offset"][:2]
        loads = simulation.joint_loads()
        motion = np.concatenate([simulation.state.q[first : first + 3] for first in bodies])
        return motion, loads[:, columns.SPRING_TORQUE], loads[:, [columns.FORCE_X, columns.FORCE_Y]].ravel()

    exact = run(coarse / 2 ** (halvings + 3))
    rows = (run(coarse / 2**k) for k in range(halvings + 1))
    return np.array([[np.linalg.norm(mine - its) for mine, its in zip(row, exact, strict=True)] for row in rows])


def order() -> Iterator[Check]:
    """Check modal-radau's orders of convergence in motion, spring torques and joint forces, on a chain of two panels.

    The first hinge is in lasting contact, or ideal. Reactions are the algebraic variables of a system of index two.
    Reactions, and contact forces at the ends of steps, converge with order three, and motion with order five. With
    ideal joints reactions depend on the panels' foreshortening, which lowers the order of motion to three.
    """
    halvings = 3
    source = "three-stage Radau IIA: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 1996"
    variants = (
        ("contact", Bearing(0.01, 0.1, PowerLaw(1e6)), "its normal force", (5.0, 0.3)),
        ("ideal hinge", None, "reactions", (3.0, 0.5)),
    )
    for name, bearing, load, of_motion in variants:
        errors = _errors(_swing(bearing), halvings)
        found = np.log2(errors[0] / errors[-1]) / halvings
        expected = {"motion": of_motion, "torques of the springs": of_motion, load: (3.0, 0.4)}
        for (quantity, (order_, tolerance)), reached in zip(expected.items(), found, strict=True):
            yield Check(f"{name}: order of convergence in {quantity}", order_, reached, tolerance, source)


def free_chain() -> Iterator[Check]:
    """Check momenta and energy of two free panels whose common hinge rattles, with friction and a spring."""
    panel = replace(PANEL, damping=1e-5)
    bearing = Bearing(2e-4, 0.01, PowerLaw(7.39e10, damping=0.3), friction_coefficient=0.1)
    first = modal(panel, 12, velocity=(0.3, 0.0), spin=0.4)
    # Without the spring both panels would move as one rigid body.
    second = replace(first, name=OUTER, position=(panel.length, 0.0), velocity=(0.3, 0.4 * panel.length))
    hinge = Joint("hinge", BEAM, OUTER, (panel.length, 0.0), (0.0, 0.0), bearing=bearing, spring=Spring(2.0, 1.0))
    for rtol in (1e-2, 1e-3, 1e-4, 1e-5):
        simulation = start(Mechanism((first, second), (hinge,)), rtol)
        before = simulation.momenta()
        simulation.advance(0.3)
        lost = np.abs(simulation.momenta() - before)
        residual, turnover = simulation.energy_book()
        contacts = int(simulation.state.joints[0]["contact_starts"])
        for name, error, scale in (
            ("linear momentum", max(lost[:2]), math.hypot(*before[:2])),
            ("angular momentum", lost[2], abs(before[2])),
        ):
            yield Check(
                f"rtol = {rtol:g}: relative change of {name} in {contacts} contacts", 0.0, error / scale, 1e-8, MOMENTUM
            )
        obtained = abs(residual) / turnover
        quantity = f"rtol = {rtol:g}: energy that the books do not account for over that turned over"
        yield Check(quantity, 0.0, obtained, 0.3 * rtol, ENERGY)
