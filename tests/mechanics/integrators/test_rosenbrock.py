"""Linearly implicit steps: their order, what they spare, and that they change nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from helpers import fingerprint
from test_flexible_motion import BEAM, WIDE, flight

from solar_env.array import ArrayParameters, build
from solar_env.array.methods import default_integrator, make_integrator
from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.integrators.settings import Rosenbrock, RungeKutta
from solar_env.mechanics.mechanism.beams import Beam, spin_up_beam
from solar_env.mechanics.mechanism.description import Bearing, FlexibleBody, Mechanism
from solar_env.mechanics.running.simulation import Simulation


def stiff_flight(bearing: Bearing | None = None) -> Mechanism:
    """Two rigid bodies and a beam between them, whose vibrations would bound explicit steps to 37 us."""
    mechanism = flight(bearing and replace(bearing, contact=replace(bearing.contact, stiffness=3000.0)), damping=2e-3)
    bodies = [
        replace(body, axial_stiffness=1e5, bending_stiffness=5.0) if isinstance(body, FlexibleBody) else body
        for body in mechanism.bodies
    ]
    return replace(mechanism, bodies=tuple(bodies))


def after(mechanism: Mechanism, time: float, integrator: RungeKutta) -> Simulation:
    simulation = Simulation(mechanism, integrator)
    simulation.advance(time)
    return simulation


def test_the_error_is_of_fourth_order_in_the_longest_step() -> None:
    reference = after(stiff_flight(), 0.5, RungeKutta(rtol=1e-10)).state.q
    errors, steps = [], (4e-3, 2e-3, 1e-3)
    for step in steps:
        simulation = after(stiff_flight(), 0.5, Rosenbrock(rtol=0.1, max_step=step))
        assert simulation.state.clock["factorizations"][0] > 0.95 * 0.5 / step
        errors.append(np.abs(simulation.state.q - reference).max())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(4.0, abs=0.3)


@pytest.mark.parametrize(("bearing", "share"), [(None, 0.05), (WIDE, 0.1)], ids=["ideal joints", "clearance joints"])
def test_it_agrees_with_the_explicit_method_at_a_small_part_of_the_steps(bearing: Bearing | None, share: float) -> None:
    simulation = after(stiff_flight(bearing), 0.4, Rosenbrock(rtol=4e-5))
    reference = after(stiff_flight(bearing), 0.4, RungeKutta(rtol=1e-8))
    assert simulation.state.joints["contact_starts"].tolist() == reference.state.joints["contact_starts"].tolist()
    assert simulation.state.q == pytest.approx(reference.state.q, abs=1e-6)
    assert simulation.state.clock["factorizations"][0] > 100
    assert simulation.state.clock["steps"][0] < share * reference.state.clock["steps"][0]


def test_joint_forces_and_integrals_are_those_of_the_explicit_method() -> None:
    simulation, reference = (after(stiff_flight(), 0.4, kind(rtol=1e-7)) for kind in (Rosenbrock, RungeKutta))
    forces = [s.joint_loads()[:, columns.NORMAL] for s in (simulation, reference)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-5)
    integrals = [s.state.integrals for s in (simulation, reference)]
    assert integrals[0] == pytest.approx(integrals[1], rel=1e-5, abs=1e-8)
    assert integrals[0][m.MATERIAL_DISSIPATION] > 0.0


def test_friction_in_a_lasting_contact_is_booked() -> None:
    # Steps in which journals roll on by a degree, pressed in by nanometres.
    simulation = after(build(ArrayParameters(), "flexible-clearance:2 elements"), 4.0, Rosenbrock())
    residual, steps = simulation.energy_residual(), int(simulation.state.clock["steps"][0])
    friction = m.joint_integrals(simulation.state.integrals)[:, m.FRICTION_DISSIPATION].sum()
    simulation.advance(9.0)
    friction = m.joint_integrals(simulation.state.integrals)[:, m.FRICTION_DISSIPATION].sum() - friction
    assert simulation.state.clock["steps"][0] - steps < 5000
    assert abs(simulation.energy_residual() - residual) < 1e-3 * friction


@pytest.mark.parametrize("rtol", [5e-4, 1e-3, 2e-3])
def test_a_lasting_contact_has_no_peaks_within_long_steps(rtol: float) -> None:
    # Between the impacts of the start and the latches 2 N press in the bearings, 5 to 11 N at the loosest of these
    # tolerances, by the rounding of the machine; the interpolant of a long step can make 80 N of it.
    simulation = after(build(ArrayParameters(), "flexible-clearance:2 elements"), 3.0, Rosenbrock(rtol=rtol))
    simulation.state.joints["recent_peak_force"] = 0.0
    for period in range(85):
        simulation.advance(3.0 + 0.1 * (period + 1))
    assert 1.0 < simulation.state.joints["recent_peak_force"].max() < 20.0


@pytest.mark.parametrize("bearing", [None, WIDE], ids=["ideal joints", "clearance joints"])
def test_momentum_is_kept_and_the_energy_book_closes(bearing: Bearing | None) -> None:
    mechanism = replace(stiff_flight(bearing), gravity=(0.0, 0.0))
    simulation = Simulation(mechanism, Rosenbrock(rtol=1e-6))
    before, scale = simulation.momenta(), np.abs(simulation.stored_energies()).sum()
    simulation.advance(1.0)
    assert simulation.state.clock["factorizations"][0] > 20
    assert simulation.momenta()[:2] == pytest.approx(before[:2], abs=1e-9)
    assert simulation.momenta()[2] == pytest.approx(before[2], abs=1e-6)
    assert abs(simulation.energy_residual()) < 1e-5 * scale


@pytest.mark.parametrize("bearing", [None, WIDE], ids=["ideal joints", "clearance joints"])
def test_what_follows_a_snapshot_leaves_no_trace_in_what_follows_when_it_is_restored(bearing: Bearing | None) -> None:
    simulation = after(stiff_flight(bearing), 0.2, Rosenbrock(rtol=1e-4))
    snapshot = simulation.snapshot()
    steps = snapshot.clock["steps"][0]

    def pull(other: Simulation, torque: float) -> str:
        factorizations = snapshot.clock["factorizations"][0]
        other.restore(snapshot)
        other.set_motor_torque(0, torque)
        other.advance(0.2 + 1e-4)
        assert other.state.clock["steps"][0] == steps + 1
        assert other.state.clock["factorizations"][0] == factorizations + 1
        return fingerprint(other.state)

    fresh = Simulation(stiff_flight(bearing), Rosenbrock(rtol=1e-4))
    assert pull(simulation, 0.5) != pull(simulation, -0.5) == pull(fresh, -0.5)


def test_without_beams_it_is_the_explicit_method() -> None:
    states = []
    for kind in (Rosenbrock, RungeKutta):
        simulation = Simulation(build(ArrayParameters(), "rigid-clearance"), kind(rtol=1e-6))
        simulation.advance(1.0)
        states.append(simulation.state.q.tobytes())
    assert states[0] == states[1]


def test_the_quiet_deployment_of_flexible_panels_takes_hundreds_of_steps() -> None:
    simulation = Simulation(build(ArrayParameters(), "flexible-ideal:6 elements"), Rosenbrock(rtol=1e-4))
    simulation.advance(3.0)
    before = int(simulation.state.clock["steps"][0])
    simulation.advance(4.0)
    # At the explicit method's stability limit they are 16,000.
    assert simulation.state.clock["steps"][0] - before < 1000


def test_drives_are_refused() -> None:
    beam = Beam(BEAM.length, BEAM.linear_density, BEAM.axial_stiffness, BEAM.bending_stiffness)
    with pytest.raises(ValueError, match="takes no drives"):
        Simulation(spin_up_beam(beam, 2, 1.0, 1.0), Rosenbrock())


@pytest.mark.parametrize("model", ["flexible-ideal:6 elements", "flexible-clearance:6 elements"])
def test_beams_of_elements_get_it_unless_another_is_named(model: str) -> None:
    assert default_integrator(model) == make_integrator("rosenbrock", model)
    assert type(make_integrator("runge-kutta", model)) is RungeKutta
    assert make_integrator("rosenbrock", model, rtol=1e-5, step=0.01) == Rosenbrock(rtol=1e-5, max_step=0.01)
