"""Single steps over a lasting contact, many times its vibration's length, against the method written out densely."""

from __future__ import annotations

import numpy as np
import pytest
from helpers import attempt, single_steps

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.integrators.methods.runge_kutta import _COUPLING
from solar_env.mechanics.integrators.methods.stiff_forces import COUPLING, DIAGONAL
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.mechanism.description import GROUND, Bearing, Body, Joint, Mechanism
from solar_env.mechanics.running.simulation import Simulation

EXPLICIT = np.array(_COUPLING)  # (5, 4): the last row is the end of the step
IMPLICIT = np.array(COUPLING)[:4] + DIAGONAL * np.eye(4)
STIFFNESS, LOAD, FRICTION, CLEARANCE, RADIUS, SPIN, INERTIA = 1e6, 10.0, 0.3, 100.0, 0.5, 1.0, 0.1
REST = LOAD / STIFFNESS


def pressed(*masses: float) -> Simulation:
    """Spinning blocks, each pressed to its bearing's wall by 10 N for each kilogram, a little off their equilibrium."""
    linear = Bearing(CLEARANCE, RADIUS, PowerLaw(STIFFNESS, 1.0), friction_coefficient=FRICTION)
    bodies, joints = [], []
    for k, mass in enumerate(masses):
        place = (CLEARANCE + mass * REST * 1.01, 0.0)
        bodies.append(Body(f"{k}", mass, INERTIA, 1.0, (0.0, 0.0), position=place, velocity=(5e-6, 0.0), spin=SPIN))
        joints.append(Joint(f"{k}", GROUND, f"{k}", (0.0, 0.0), (0.0, 0.0), bearing=linear))
    # Nothing is ever rejected.
    simulation = single_steps(
        Mechanism(tuple(bodies), tuple(joints), gravity=(LOAD, 0.0)),
        RungeKutta(rtol=0.1, velocity_scale=1e9, max_step=1.0),
    )
    own = simulation.state.joints
    own["in_contact"], own["contact_start"], own["contact_duration"], own["impact_speed"] = 1, -1.0, 1e-3, 0.01
    simulation.state.clock["last_error"], simulation.state.clock["energy_scale"] = 1.0, 1e9
    return simulation


def densely(mass: float, step: float) -> np.ndarray:
    """Place and velocity (x, y, vx, vy) after a step, from the equations of the W-method as they are printed."""
    full = np.zeros((4, 4))
    full[0, 2] = full[1, 3] = 1.0
    # At the contact the spin slides the surface towards +y: friction pulls the body to -y.
    full[2, 0], full[3, 0] = -STIFFNESS / mass, -FRICTION * STIFFNESS / mass
    stiff = full.copy()
    # Of the velocities it takes the part that changes the depth, along the motion that a contact force makes.
    stiff[1, 3], stiff[1, 2] = 0.0, -FRICTION
    constant = np.array([0.0, 0.0, LOAD, 0.0])
    start = np.array([1.01 * mass * REST, 0.0, 5e-6, 0.0])
    stages: list[np.ndarray] = []
    for i in range(4):
        place = start + step * sum((EXPLICIT[i, j] * stages[j] for j in range(i)), np.zeros(4))
        known = full @ place + constant
        known += step * stiff @ sum((IMPLICIT[i, j] * stages[j] for j in range(i)), np.zeros(4))
        stages.append(np.linalg.solve(np.eye(4) - step * DIAGONAL * stiff, known))
    return start + step * sum(weight * stage for weight, stage in zip(EXPLICIT[4], stages, strict=True))


@pytest.mark.parametrize("masses", [(1.0,), (1.0, 0.5)], ids=["one contact", "two contacts"])
@pytest.mark.parametrize("step", [3e-3, 5e-3, 8e-3])
def test_a_step_is_the_methods_own_and_its_impulse_that_of_the_momentum(step: float, masses: tuple[float, ...]) -> None:
    simulation = pressed(*masses)
    simulation.state.clock["step_size"] = step
    attempt(simulation, 1.0)
    assert simulation.time == step
    state = simulation.state
    spins = []
    for k, mass in enumerate(masses):
        q, v = state.q[4 * k : 4 * k + 4], state.v[4 * k : 4 * k + 4]
        expected = densely(mass, step)
        found = np.array([q[0] - CLEARANCE, q[1], v[0], v[1]])
        # The wall curves by a millionth on the way, which friction makes a few ten thousandths of a speed.
        assert found == pytest.approx(expected, rel=1e-3, abs=1e-12)
        # 10 N for each kilogram, less what is left of them in the velocity.
        impulse = m.joint_integrals(state.integrals)[k, m.IMPULSE]
        assert impulse == pytest.approx(mass * (LOAD * step - (v[0] - 5e-6)), rel=1e-6)
        spins.append(np.hypot(*(v[2:] - v[:2])))
        assert spins[k] == pytest.approx(SPIN - FRICTION * impulse * RADIUS / INERTIA, rel=1e-5)
        work = m.joint_integrals(state.integrals)[k, m.FRICTION_DISSIPATION]
        assert 0.0 < work < FRICTION * impulse * RADIUS * SPIN


def test_a_step_that_the_explicit_method_takes_safely_is_left_to_it() -> None:
    step = 1e-3
    simulation = pressed(1.0)
    simulation.state.clock["step_size"] = step
    attempt(simulation, 1.0)
    # Cosine and sine of the angular frequency times the step, 1.
    depth = REST + 0.01 * REST * np.cos(1.0) + 5e-9 * np.sin(1.0)
    assert simulation.state.q[0] - CLEARANCE == pytest.approx(depth, abs=1e-4 * REST)
