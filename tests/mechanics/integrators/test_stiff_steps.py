"""Single steps over a lasting contact, many times its vibration's length, against the method written out densely."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import attempt, single_steps
from mechanisms import Vector, turned

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.integrators.methods.runge_kutta import _COUPLING
from solar_env.mechanics.integrators.methods.stiff_forces import COUPLING, DIAGONAL
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import GROUND, Bearing, Body, Joint, Load, Mechanism, Point
from solar_env.mechanics.running.simulation import Simulation

EXPLICIT = np.array(_COUPLING)  # (5, 4): the last row is the end of the step
IMPLICIT = np.array(COUPLING)[:4] + DIAGONAL * np.eye(4)
STIFFNESS, LOAD, FRICTION, CLEARANCE, RADIUS, SPIN, INERTIA = 1e6, 10.0, 0.3, 100.0, 0.5, 1.0, 0.1
REST, DRIFT = LOAD / STIFFNESS, 5e-6
LINEAR = Bearing(CLEARANCE, RADIUS, PowerLaw(STIFFNESS, 1.0), friction_coefficient=FRICTION)


def stepped(mechanism: Mechanism, step: float) -> Simulation:
    """A mechanism whose joints have been in contact for long, after one step of the explicit method."""
    # Nothing is ever rejected.
    simulation = single_steps(mechanism, RungeKutta(rtol=0.1, velocity_scale=1e9, max_step=1.0))
    own, clock = simulation.state.joints, simulation.state.clock
    own["in_contact"], own["contact_start"], own["contact_duration"], own["impact_speed"] = 1, -1.0, 1e-3, 0.01
    clock["last_error"], clock["energy_scale"], clock["step_size"] = 1.0, 1e9, step
    attempt(simulation, 1.0)
    assert simulation.time == step
    return simulation


def spinning_block(name: str, mass: float, place: float) -> Body:
    """A spinning block on its way into a wall."""
    return Body(name, mass, INERTIA, 1.0, (0.0, 0.0), position=(place, 0.0), velocity=(DRIFT, 0.0), spin=SPIN)


def pressed(*masses: float) -> Mechanism:
    """Spinning blocks, each pressed to its bearing's wall by 10 N for each kilogram, a little off their equilibrium."""
    bodies = tuple(spinning_block(f"{k}", mass, CLEARANCE + mass * REST * 1.01) for k, mass in enumerate(masses))
    joints = (Joint(body.name, GROUND, body.name, (0.0, 0.0), (0.0, 0.0), bearing=LINEAR) for body in bodies)
    return Mechanism(bodies, tuple(joints), gravity=(LOAD, 0.0))


def densely(start: Vector, loads: Vector, gradient: Vector, response: Vector, step: float) -> Vector:
    """Places and velocities after a step, from the equations of the W-method as they are printed.

    Args:
        start: (2n,) places, from where the contact just touches, and velocities.
        loads: (n,) constant accelerations.
        gradient: (n,) of the contact's depth.
        response: (n,) accelerations by a unit force that opens it, with its friction.
        step: [s].
    """
    n = gradient.size
    still, unit, size = np.zeros((n, n)), np.eye(n), 2 * n
    accelerations = -STIFFNESS * np.outer(response, gradient)
    full = np.block([[still, unit], [accelerations, still]])
    # Of the velocities it takes the part that changes the depth, along the motion that a contact force makes.
    motion = np.outer(response, gradient) / (gradient @ response)
    stiff = np.block([[still, motion], [accelerations, still]])
    constant = np.concatenate([np.zeros(n), loads])
    stages: list[Vector] = []
    for i in range(4):
        place = start + step * sum((EXPLICIT[i, j] * stages[j] for j in range(i)), np.zeros(size))
        known = full @ place + constant
        known += step * stiff @ sum((IMPLICIT[i, j] * stages[j] for j in range(i)), np.zeros(size))
        stages.append(np.linalg.solve(np.eye(size) - step * DIAGONAL * stiff, known))
    end: Vector = start + step * sum(weight * stage for weight, stage in zip(EXPLICIT[4], stages, strict=True))
    return end


@pytest.mark.parametrize("masses", [(1.0,), (1.0, 0.5)], ids=["one contact", "two contacts"])
@pytest.mark.parametrize("step", [3e-3, 5e-3, 8e-3])
def test_a_step_is_the_methods_own_and_its_impulse_that_of_the_momentum(step: float, masses: tuple[float, ...]) -> None:
    state = stepped(pressed(*masses), step).state
    for k, mass in enumerate(masses):
        q, v = state.q[4 * k : 4 * k + 4], state.v[4 * k : 4 * k + 4]
        # At the contact the spin slides the surface towards +y: friction pulls the body to -y.
        gradient, response = np.array([1.0, 0.0]), np.array([1.0, FRICTION]) / mass
        start = np.array([1.01 * mass * REST, 0.0, DRIFT, 0.0])
        expected = densely(start, np.array([LOAD, 0.0]), gradient, response, step)
        # The wall curves by a millionth on the way, which friction makes a few ten thousandths of a speed.
        assert [q[0] - CLEARANCE, q[1], v[0], v[1]] == pytest.approx(expected, rel=1e-3, abs=1e-12)
        # 10 N for each kilogram, less what is left of them in the velocity.
        impulse = m.joint_integrals(state.integrals)[k, m.IMPULSE]
        assert impulse == pytest.approx(mass * (LOAD * step - (v[0] - DRIFT)), rel=1e-6)
        spin = np.hypot(*(v[2:] - v[:2]))
        assert spin == pytest.approx(SPIN - FRICTION * impulse * RADIUS / INERTIA, rel=1e-5)
        work = m.joint_integrals(state.integrals)[k, m.FRICTION_DISSIPATION]
        assert 0.0 < work < FRICTION * impulse * RADIUS * SPIN


@pytest.mark.parametrize("direction", [0.0, 0.6])
@pytest.mark.parametrize("step", [3e-3, 5e-3])
def test_a_step_over_a_contact_between_two_moving_bodies_keeps_their_momenta(step: float, direction: float) -> None:
    mass, carrier_mass, carrier_inertia = 1.0, 3.0, 1e6

    def along(length: float) -> Point:
        return length * math.cos(direction), length * math.sin(direction)

    carrier = Body("carrier", carrier_mass, carrier_inertia, 1.0, (0.0, 0.0))
    inner = replace(
        spinning_block("journal", mass, 0.0), position=along(CLEARANCE + REST * 1.01), velocity=along(DRIFT)
    )
    joint = Joint("pin", "carrier", "journal", (0.0, 0.0), (0.0, 0.0), bearing=LINEAR)
    loads = (Load("journal", (0.0, 0.0), along(LOAD)), Load("carrier", (0.0, 0.0), along(-LOAD)))
    simulation = stepped(Mechanism((carrier, inner), (joint,), loads=loads), step)
    (q, q1), (v, v1) = (array[:8].reshape(2, 4) for array in (simulation.state.q, simulation.state.v))
    places, velocities = (np.concatenate([turned(of[:2], -direction) for of in pair]) for pair in ((q, q1), (v, v1)))
    places[2] -= CLEARANCE
    gradient = np.array([-1.0, 0.0, 1.0, 0.0])
    response = np.array([-1.0, -FRICTION, 1.0, FRICTION]) / np.repeat([carrier_mass, mass], 2)
    start = np.array([0.0, 0.0, 1.01 * REST, 0.0, 0.0, 0.0, DRIFT, 0.0])
    pull = np.array([-LOAD / carrier_mass, 0.0, LOAD / mass, 0.0])
    expected = densely(start, pull, gradient, response, step)
    assert np.concatenate([places, velocities]) == pytest.approx(expected, rel=1e-3, abs=1e-11)
    impulse = m.joint_integrals(simulation.state.integrals)[0, m.IMPULSE]
    # Friction acts on the carrier at the wall.
    turning = FRICTION * impulse * (CLEARANCE + RADIUS) / carrier_inertia
    assert v[3] - v[1] == pytest.approx(turning, rel=1e-3)


def test_a_step_that_the_explicit_method_takes_safely_is_left_to_it() -> None:
    state = stepped(pressed(1.0), 1e-3).state
    # Cosine and sine of the angular frequency times the step, 1.
    depth = REST + 0.01 * REST * np.cos(1.0) + 1e-3 * DRIFT * np.sin(1.0)
    assert state.q[0] - CLEARANCE == pytest.approx(depth, abs=1e-4 * REST)
