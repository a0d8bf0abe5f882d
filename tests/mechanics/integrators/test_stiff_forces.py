"""Linearly implicit stiff forces: order and stability of the coefficients, and a journal at rest in its bearing."""

from __future__ import annotations

import numpy as np
import pytest
from mechanisms import block

from solar_env.array import ArrayParameters, build
from solar_env.array.methods import default_integrator
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import NORMAL
from solar_env.mechanics.integrators.methods.runge_kutta import _COUPLING, _ERROR
from solar_env.mechanics.integrators.methods.stiff_forces import COUPLING, DIAGONAL
from solar_env.mechanics.integrators.settings import Rosenbrock, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.numerics.linear import lu_factor, lu_solve
from solar_env.mechanics.running.simulation import Simulation, simulate

EXPLICIT = np.pad(np.array(_COUPLING), ((0, 0), (0, 1)))
IMPLICIT = np.pad(np.array(COUPLING), ((0, 0), (0, 1))) + DIAGONAL * np.eye(5)
WEIGHTS, ESTIMATE, ONES = EXPLICIT[4], np.array(_ERROR), np.ones(5)


@pytest.mark.parametrize("weights", [WEIGHTS, ESTIMATE], ids=["method", "estimate"])
def test_the_coefficients_are_of_order_three_whatever_the_stiff_part(weights: np.ndarray) -> None:
    # Steihaug and Wolfbrandt's conditions beyond those of the explicit method.
    for product in (IMPLICIT, EXPLICIT @ IMPLICIT, IMPLICIT @ EXPLICIT, IMPLICIT @ IMPLICIT):
        assert weights @ product @ ONES == pytest.approx(0.0, abs=1e-15)


def test_linear_equations_are_solved_to_order_four_and_vibrations_decay_at_every_step() -> None:
    whole = EXPLICIT + IMPLICIT
    assert WEIGHTS @ np.linalg.matrix_power(whole, 3) @ ONES == pytest.approx(1.0 / 24.0, abs=1e-15)
    for z in 1j * np.logspace(-2, 6, 200):
        factor = 1.0 + z * WEIGHTS @ np.linalg.solve(np.eye(5) - z * whole, ONES)
        assert abs(factor) <= 1.0 + 1e-15
    assert abs(factor) == pytest.approx(1.0 / 3.0, abs=1e-5)


def test_factors_without_pivoting_solve() -> None:
    rng = np.random.default_rng(0)
    skew = rng.normal(size=(4, 4))
    matrix = 2.0 * np.eye(4) + 0.5 * (skew - skew.T)
    factor, right = matrix.copy(), rng.normal(size=4)
    expected = np.linalg.solve(matrix, right)
    assert lu_factor(factor, 4)
    lu_solve(factor, 4, right)
    np.testing.assert_allclose(right, expected, rtol=1e-13)
    assert not lu_factor(np.array([[1.0, 2.0], [2.0, 1.0]]), 2)
    assert not lu_factor(np.full((1, 1), np.nan), 1)


def test_what_stiff_stops_take_is_booked_to_order_three() -> None:
    # Beam ends have next to no inertia: the latches' dampers slow them within microseconds.
    fast = ArrayParameters(spring_stiffness=(2.5, 1.875), cable_preload_force=1250.0)
    residuals = []
    for step in (2e-5, 1e-5):
        simulation = Simulation(build(fast, "flexible-ideal:6 elements"), Rosenbrock())
        simulation.advance(2.3)
        simulation.integrator = RungeKutta(rtol=1e-3, max_step=step)
        before = simulation.energy_residual()
        simulation.advance(2.5)
        assert simulation.state.joints["stop_engaged"].all()
        residuals.append(abs(simulation.energy_residual() - before) / simulation.state.clock["energy_scale"][0])
    assert residuals[0] < 3e-8
    assert residuals[0] / residuals[1] > 2.0**2.5


def test_a_journal_at_rest_is_stepped_over_and_its_load_booked() -> None:
    clearance, stiffness, gravity = 1e-3, 1e9, 9.81
    bearing = Bearing(clearance, 0.01, PowerLaw(stiffness, damping=0.1))
    mechanism = block((0.0, 0.0), bearing=bearing, gravity=(0.0, -gravity), position=(0.0, -clearance - 1e-9))
    simulation = Simulation(mechanism, RungeKutta(rtol=1e-6))
    simulation.advance(2.0)
    steps = simulation.state.clock["steps"][0]
    before = m.joint_integrals(simulation.state.integrals)[0, m.IMPULSE]
    simulation.advance(12.0)
    after = m.joint_integrals(simulation.state.integrals)[0, m.IMPULSE]
    weight = simulation.joint_loads()[0, NORMAL]
    # Stability would ask for a step of some 0.4 ms.
    assert simulation.state.clock["steps"][0] - steps < 500
    assert after - before == pytest.approx(10.0 * weight, rel=1e-6)
    assert simulation.state.joints["in_contact"][0]


PERIOD = 0.1  # s


def peaks_under_a_motor_that_changes_its_mind(integrator: RungeKutta) -> np.ndarray:
    """(periods,) peak force [N] while a small torque on the pressed root joint jumps to and fro."""
    simulation = Simulation(build(ArrayParameters()), integrator)
    simulation.advance(3.0)
    starts, peaks = simulation.state.joints["contact_starts"].copy(), []
    for period in range(30):
        simulation.set_motor_torque(0, 0.02 * (-1) ** period)
        simulation.state.joints["recent_peak_force"] = 0.0
        simulation.advance(3.0 + (period + 1) * PERIOD)
        peaks.append(float(simulation.state.joints["recent_peak_force"].max()))
    assert np.array_equal(simulation.state.joints["contact_starts"], starts), "the journals stay pressed"
    return np.array(peaks)


@pytest.mark.parametrize("integrator", [default_integrator("rigid-clearance"), RungeKutta(rtol=1e-5)])
def test_the_force_of_a_lasting_contact_is_right_though_its_depth_is_below_the_tolerance_of_positions(
    integrator: RungeKutta,
) -> None:
    exact = peaks_under_a_motor_that_changes_its_mind(RungeKutta(rtol=1e-8))
    assert 0.2 < exact.min() < exact.max() < 0.4
    found = peaks_under_a_motor_that_changes_its_mind(integrator)
    # Vibrations of the contact itself are stepped over.
    assert np.all(found < 1.02 * exact)
    assert np.all(found > 0.85 * exact)


def test_samples_within_long_steps_show_the_force_of_a_lasting_contact() -> None:
    mechanism = build(ArrayParameters())
    coarse = simulate(mechanism, 8.0, integrator=default_integrator("rigid-clearance"))
    exact = simulate(mechanism, 8.0, integrator=RungeKutta(rtol=1e-8))
    lasting = exact.time > 2.0
    assert coarse.metadata["steps"] < 0.3 * exact.metadata["steps"]
    assert exact.normal_force[lasting].min() > 0.1
    assert coarse.normal_force[lasting] == pytest.approx(exact.normal_force[lasting], rel=0.1)
    assert coarse.penetration[lasting] == pytest.approx(exact.penetration[lasting], rel=0.07, abs=0.0)
