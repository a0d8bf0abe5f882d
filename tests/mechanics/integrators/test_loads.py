"""Rigid and flexible bodies under loads, drives and weight."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import Forces, rigid_motions
from mechanisms import Vector, turned
from test_flexible_motion import BEAM, both_integrators

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.equations.system import accelerations
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism.description import GROUND, Body, Drive, FlexibleBody, Joint, Load, Mechanism, Point
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.simulation import Simulation

# With rho_inf = 1, which conserves energy, the constraint forces alternate, as the library tells; here motion counts.
pytestmark = pytest.mark.filterwarnings("ignore:.* the constraint forces of the integrator")

RIGID = Body("body", 1.5, 0.2, 0.9, (0.4, 0.1), position=(0.3, -0.2), angle=0.5)
LOADED = {
    "rigid": (RIGID, (0.2, 0.3)),
    "flexible": (replace(BEAM, name="body", position=(0.3, -0.2), angle=0.5), (0.6, 0.0)),
}
on_either_body = pytest.mark.parametrize(("body", "place"), LOADED.values(), ids=LOADED.keys())


def mass_of(body: Body | FlexibleBody) -> float:
    return body.mass if isinstance(body, Body) else body.linear_density * body.length


def initial_accelerations(mechanism: Mechanism) -> tuple[Forces, Vector]:
    forces = Forces(mechanism)
    state, a = forces.state, np.zeros_like(forces.state.a)
    multipliers = np.zeros_like(state.multipliers)
    assert accelerations(forces.model, state.joints, state.q, state.v, 0.0, forces.work, a, multipliers)
    return forces, a


@on_either_body
def test_a_force_changes_momentum_by_itself_and_angular_momentum_by_its_moment(
    body: Body | FlexibleBody, place: Point
) -> None:
    force = np.array([0.7, -1.1])
    forces, a = initial_accelerations(Mechanism((body,), loads=(Load("body", place, tuple(force.tolist())),)))
    rates = rigid_motions(forces.model, forces.state.q) @ forces.mass_product(a)
    point = np.array(body.position) + turned(place, body.angle)
    assert rates[:2] == pytest.approx(force, rel=1e-12)
    assert rates[2] == pytest.approx(point[0] * force[1] - point[1] * force[0], rel=1e-12)


@on_either_body
def test_a_torque_changes_angular_momentum_alone(body: Body | FlexibleBody, place: Point) -> None:
    forces, a = initial_accelerations(Mechanism((body,), loads=(Load("body", place, torque=0.4),)))
    rates = rigid_motions(forces.model, forces.state.q) @ forces.mass_product(a)
    assert rates == pytest.approx([0.0, 0.0, 0.4], abs=1e-13)


@both_integrators
@on_either_body
def test_a_constant_load_drives_the_centre_of_mass_on_a_parabola_and_pays_for_the_energy(
    body: Body | FlexibleBody, place: Point, integrator: Integrator
) -> None:
    force, torque, end = np.array([0.7, -1.1]), 0.4, 1.0
    mechanism = Mechanism((body,), loads=(Load("body", place, tuple(force.tolist()), torque),))
    simulation = Simulation(mechanism, integrator)
    forces = Forces.of(simulation)
    start = rigid_motions(simulation.model, simulation.state.q)[:2] @ forces.mass_product(simulation.state.q)
    simulation.advance(end)
    q, v = simulation.state.q, simulation.state.v
    motions = rigid_motions(simulation.model, q)[:2]
    assert motions @ forces.mass_product(v) == pytest.approx(force * end, rel=1e-9)
    travel = (motions @ forces.mass_product(q) - start) / mass_of(body)
    assert travel == pytest.approx(0.5 * force / mass_of(body) * end**2, abs=1e-6)
    exact = integrator.name == "runge-kutta"
    kinetic = simulation.stored_energies()[m.KINETIC]
    assert kinetic > 0.1
    assert simulation.energy_residual() == pytest.approx(0.0, abs=(1e-7 if exact else 1e-4) * kinetic)


@both_integrators
def test_the_work_of_a_torque_is_torque_times_turn(integrator: Integrator) -> None:
    simulation = Simulation(Mechanism((replace(RIGID, spin=0.3),), loads=(Load("body", torque=0.4),)), integrator)
    simulation.advance(1.0)
    turn = 0.3 + 0.5 * 0.4 / RIGID.inertia
    assert simulation.state.integrals[m.EXTERNAL_WORK] == pytest.approx(0.4 * turn, rel=1e-6)
    # On a beam it is the turn of the node.
    end = (BEAM.length, 0.0)
    bent = Simulation(Mechanism((replace(BEAM, damping=0.01),), loads=(Load("beam", end, torque=0.1),)), integrator)
    bent.advance(0.5)
    exact = integrator.name == "runge-kutta"
    slopes = bent.state.q.reshape(-1, 4)[:, 2:]
    turns = np.arctan2(slopes[:, 1], slopes[:, 0])
    assert np.ptp(turns) > 0.05
    assert bent.state.integrals[m.EXTERNAL_WORK] == pytest.approx(0.1 * turns[-1], rel=1e-6 if exact else 1e-2)
    # A constant force is conservative: its work is a change of potential.
    forced = Simulation(Mechanism((RIGID,), loads=(Load("body", (0.1, 0.0), (1.0, 2.0)),)), integrator)
    before = forced.stored_energies()[m.GRAVITY]
    point = np.array(RIGID.position) + turned((0.1, 0.0), RIGID.angle)
    assert before == pytest.approx(-point @ (1.0, 2.0), rel=1e-12)
    forced.advance(0.5)
    assert forced.state.integrals[m.EXTERNAL_WORK] == 0.0
    assert forced.stored_energies()[m.GRAVITY] < before


def test_an_end_torque_rolls_a_cantilever_into_an_arc() -> None:
    # The turn of the tip is torque * length / E I, whatever its size: here a quarter turn.
    beam = replace(BEAM, elements=6, damping=0.2)
    torque = 0.5 * math.pi * beam.bending_stiffness / beam.length
    mechanism = Mechanism(
        (beam,),
        (Joint("wall", GROUND, "beam", (0.0, 0.0), (0.0, 0.0)),),
        drives=(Drive("beam", 0.0, 0.0),),
        loads=(Load("beam", (beam.length, 0.0), torque=torque),),
    )
    simulation = Simulation(mechanism, GeneralizedAlpha(step=5e-4, rho_inf=0.5))
    # Algorithmic damping takes its share of the vibrations that the load starts.
    with pytest.warns(SimulationWarning, match="of the .* J turned over; reduce the step"):
        simulation.advance(30.0)
    tip = simulation.state.q[4 * beam.elements : 4 * beam.elements + 4]
    radius = beam.length / (0.5 * math.pi)
    assert tip[:2] == pytest.approx([radius, radius], rel=2e-3)
    assert math.atan2(tip[3], tip[2]) == pytest.approx(0.5 * math.pi, rel=2e-3)
    assert np.abs(simulation.state.v).max() < 2e-6
    # Of the load's work one half is stored; damping took the other.
    assert simulation.stored_energies()[m.ELASTIC] == pytest.approx(0.25 * math.pi * torque, rel=2e-3)


@both_integrators
@pytest.mark.parametrize("end", [0.3, 0.8, 1.5], ids=["in the ramp", "at its end", "after it"])
def test_a_driven_body_follows_the_ramp(end: float, integrator: Integrator) -> None:
    rate, ramp, start = 2.0, 0.8, 0.4
    arm = Body("arm", 1.5, 0.2, 0.9, (0.4, 0.1), angle=start)
    pin = Joint("pin", GROUND, "arm", (0.0, 0.0), (0.0, 0.0))
    simulation = Simulation(Mechanism((arm,), (pin,), drives=(Drive("arm", start, rate, ramp),)), integrator)
    simulation.advance(end)
    phase = 2.0 * math.pi * end / ramp
    turn, speed = rate * (end - 0.5 * ramp), rate
    if end < ramp:
        turn = rate / ramp * (0.5 * end**2 + (ramp / (2.0 * math.pi)) ** 2 * (math.cos(phase) - 1.0))
        speed = rate / ramp * (end - ramp / (2.0 * math.pi) * math.sin(phase))
    d, u = simulation.state.q[2:4], simulation.state.v[2:4]
    assert math.atan2(d[1], d[0]) == pytest.approx(start + turn, abs=1e-10)
    exact = integrator.name == "runge-kutta"
    assert (d[0] * u[1] - d[1] * u[0]) / arm.length**2 == pytest.approx(speed, abs=1e-9 if exact else 1e-4)
    # The drive has paid for the motion about the pin.
    inertia = arm.inertia + arm.mass * (0.4**2 + 0.1**2)
    work = simulation.state.integrals[m.EXTERNAL_WORK]
    assert work == pytest.approx(0.5 * inertia * speed**2, rel=1e-6 if exact else 1e-3)


@both_integrators
@pytest.mark.parametrize("node", [0, 2])
def test_a_beam_is_driven_by_the_direction_of_one_of_its_nodes(node: int, integrator: Integrator) -> None:
    rate, ramp, end = 1.5, 0.5, 1.0
    pin = Joint("pin", GROUND, "beam", (0.0, 0.0), (0.0, 0.0))
    place = (0.5 * node * BEAM.length, 0.0)
    mechanism = Mechanism((replace(BEAM, damping=0.02),), (pin,), drives=(Drive("beam", 0.0, rate, ramp, place),))
    simulation = Simulation(mechanism, integrator)
    simulation.advance(end)
    slopes = simulation.state.q[: 4 * 3].reshape(3, 4)[:, 2:]
    turns = np.arctan2(slopes[:, 1], slopes[:, 0])
    assert turns[node] == pytest.approx(rate * (end - 0.5 * ramp), abs=1e-10)
    # The other nodes lag or lead: the beam bends.
    assert np.ptp(turns) > 0.01
    work = simulation.state.integrals[m.EXTERNAL_WORK]
    assert work > 0.1
    exact = integrator.name == "runge-kutta"
    assert simulation.energy_residual() == pytest.approx(0.0, abs=(1e-6 if exact else 1e-3) * work)


def test_a_cantilever_vibrates_at_its_first_natural_frequency() -> None:
    beam = replace(BEAM, elements=4)
    wall = Joint("wall", GROUND, "beam", (0.0, 0.0), (0.0, 0.0))
    simulation = Simulation(Mechanism((beam,), (wall,), drives=(Drive("beam", 0.0, 0.0),)), RungeKutta(rtol=1e-8))
    # Root of cos x cosh x = -1.
    number = 1.8751040687119611
    omega = number**2 * math.sqrt(beam.bending_stiffness / beam.linear_density) / beam.length**2
    # First mode, of small amplitude.
    x = np.linspace(0.0, number, beam.elements + 1)
    ratio = (math.cos(number) + math.cosh(number)) / (math.sin(number) + math.sinh(number))
    shape = np.cosh(x) - np.cos(x) - ratio * (np.sinh(x) - np.sin(x))
    slope = (np.sinh(x) + np.sin(x) - ratio * (np.cosh(x) - np.cos(x))) * number / beam.length
    own = simulation.state.v[: 4 * (beam.elements + 1)]
    own[1::4], own[3::4] = 1e-4 * shape, 1e-4 * slope
    tip = 4 * beam.elements + 1
    period = 2.0 * math.pi / omega
    simulation.advance(0.25 * period)
    amplitude = simulation.state.q[tip]
    assert amplitude == pytest.approx(1e-4 * shape[-1] / omega, rel=1e-3)
    simulation.advance(5.25 * period)
    assert simulation.state.q[tip] == pytest.approx(amplitude, rel=2e-3)
    simulation.advance(5.5 * period)
    assert abs(simulation.state.q[tip]) < 0.01 * amplitude
