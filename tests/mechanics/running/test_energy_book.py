"""Energy and momentum of whole runs: what is stored, put in and lost balances."""

from __future__ import annotations

import math

import numpy as np
import pytest
from deployments import array

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ANGLE
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, ModalRadau, RungeKutta
from solar_env.mechanics.joints.laws import CONTACT_LAWS, SLIDING_READINGS
from solar_env.mechanics.mechanism.description import GROUND, Body, Joint, Mechanism, Stop
from solar_env.mechanics.running.simulation import Simulation, simulate


def test_formulations_agree_on_energies_and_momenta_of_a_moving_array() -> None:
    mechanism = build(ArrayParameters(initial_spin=0.3, initial_rate=(0.2, 0.5), hinge_y=0.1))
    one, other = (Simulation(mechanism, integrator) for integrator in (RungeKutta(), ModalRadau()))
    assert one.momenta() == pytest.approx(other.momenta(), rel=1e-12, abs=1e-12)
    assert np.abs(one.momenta()).min() > 1e-3
    assert one.stored_energies() == pytest.approx(other.stored_energies(), rel=1e-12, abs=1e-15)
    p = ArrayParameters(initial_spin=0.3, initial_rate=(0.2, 0.5))
    beams = Simulation(build(p, "flexible-ideal:3 elements"), RungeKutta())
    modes = Simulation(build(p, "flexible-ideal:3 modes"), ModalRadau())
    assert beams.momenta() == pytest.approx(modes.momenta(), rel=1e-12, abs=1e-12)


def test_a_mechanism_may_start_inside_a_stop_whose_energy_is_in_the_book() -> None:
    stop = Stop(gap=0.01, stiffness=1e3, exponent=1.5, ramp_depth=1e-3, damping=0.0)
    body = Body("arm", 2.0, 0.3, length=1.0, centroid=(0.6, 0.1))
    pin = Joint("pin", GROUND, "arm", (0.0, 0.0), (0.0, 0.0), stop=stop, stow_angle=0.1)
    run = simulate(Mechanism((body,), (pin,)), 0.3)
    # Beyond the gap it lies 0.09 rad deep; the stop throws it out.
    deep = 1e3 * 0.09**2.5 / 2.5
    assert run.energies["latch"][0] == pytest.approx(deep, rel=1e-9)
    assert run.energies["kinetic"][-1] == pytest.approx(deep, rel=1e-4)
    assert run.energy_residual < 1e-4 * deep


def test_the_energy_book_of_a_whole_deployment_closes() -> None:
    run = simulate(build(ArrayParameters()), 30.0)
    assert run.energy_residual < 1e-5 * run.energy_put_in
    # All of it that the springs gave has been lost or is on its way.
    assert np.isfinite(run.latch_times).all()
    for name in ("contact_dissipation", "friction_dissipation", "latch_dissipation"):
        assert run.energies[name][-1] > 0.0
        assert np.diff(run.energies[name]).min() > -1e-7 * run.energy_put_in


@pytest.mark.parametrize("law", CONTACT_LAWS)
@pytest.mark.parametrize("sliding", SLIDING_READINGS)
def test_the_energy_book_closes_for_every_contact_law_and_sliding_speed(law: str, sliding: str) -> None:
    p = ArrayParameters(contact_law=law, contact_stiffness=None, friction_sliding=sliding, clearance=(1e-4, 5e-4))
    run = simulate(build(p), 3.0)
    assert run.contact_starts.min() > 10
    assert run.energy_residual < 1e-5 * run.energy_put_in
    if law == "hertz":
        assert abs(run.energies["contact_dissipation"][-1]) < 1e-12


@pytest.mark.parametrize(
    "integrator", [RungeKutta(), GeneralizedAlpha(step=2e-5), ModalRadau(rtol=1e-4)], ids=lambda i: i.name
)
def test_the_energy_book_closes_for_every_method(integrator: Integrator) -> None:
    run = simulate(build(ArrayParameters(friction_speed_full=1e-2)), 3.0, integrator=integrator)
    assert run.contact_starts.min() > 10
    assert run.energy_residual < 1e-4 * run.energy_put_in
    assert run.energies["friction_dissipation"][-1] > 0.0


@pytest.mark.parametrize("model", ["rigid-ideal", "rigid-clearance"])
def test_a_cable_couple_that_does_not_conserve_energy_has_its_work_booked(model: str) -> None:
    mechanism = build(ArrayParameters(cable_torque_ratio=1.0), model)
    run = simulate(mechanism, 5.0)
    assert run.energies["cable_work"][-1] < -1e-3 * run.energy_put_in
    # What the couple took out was not put in.
    assert run.energy_put_in == pytest.approx(0.5 * (0.1 * (math.pi / 2) ** 2 + 0.075 * math.pi**2), rel=1e-9)
    assert run.energy_residual < 1e-5 * run.energy_put_in
    simulation = Simulation(mechanism)
    simulation.advance(5.0)
    assert abs(simulation.energy_residual()) < 1e-5 * run.energy_put_in


@pytest.mark.parametrize(
    ("integrator", "tolerance"), [(RungeKutta(rtol=1e-7), 1e-6), (ModalRadau(rtol=1e-6), 2e-4)], ids=["rigid", "modal"]
)
@pytest.mark.parametrize("model", ["rigid-ideal", "rigid-clearance"])
def test_the_work_of_a_motor_is_torque_times_angle_and_balances(
    model: str, integrator: Integrator, tolerance: float
) -> None:
    simulation = Simulation(array(integrator, model), integrator)
    torque, work, angle = 0.3, 0.0, 0.0
    for k in range(1, 9):
        held = torque if k % 2 else 0.5 * torque
        simulation.set_motor_torque(0, held)
        simulation.advance(0.5 * k)
        turned = float(simulation.joint_loads()[0, ANGLE])
        work += held * (turned - angle)
        angle = turned
    booked = simulation.state.integrals[m.MOTOR_WORK]
    assert abs(booked) > 1e-3
    # The book is kept to the tolerance of energy of every step.
    assert booked == pytest.approx(work, rel=tolerance)
    assert abs(simulation.energy_residual()) < 1e-5 * 0.5
