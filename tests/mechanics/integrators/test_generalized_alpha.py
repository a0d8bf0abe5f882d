"""Generalized-alpha: its coefficients, order, iteration, start, fixed and adaptive steps, and how it fails."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from deployments import NATURAL_LEVELS
from helpers import orders
from mechanisms import beam_rotor, block, double_pendulum, pendulum

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.arrays.columns import FORCE_X, FORCE_Y
from solar_env.mechanics.arrays.model import MOTOR_WORK
from solar_env.mechanics.equations.constraints import constraint_drift
from solar_env.mechanics.equations.system import make_workspace
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, RungeKutta, alpha_coefficients
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing, Mechanism
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation, simulate

RADII = (0.0, 0.3, 0.5, 0.8, 0.9, 1.0)


@pytest.mark.parametrize("rho", RADII)
def test_the_coefficients_are_of_second_order_and_optimal(rho: float) -> None:
    alpha_m, alpha_f, beta, gamma = alpha_coefficients(rho)
    assert gamma == pytest.approx(0.5 + alpha_f - alpha_m, rel=1e-14)
    assert beta == pytest.approx(0.25 * (1.0 + alpha_f - alpha_m) ** 2, rel=1e-14)
    assert alpha_m <= alpha_f <= 0.5


def test_the_radius_one_gives_the_trapezoidal_rule() -> None:
    assert alpha_coefficients(1.0) == (0.5, 0.5, 0.25, 0.5)


@pytest.mark.parametrize("rho", RADII)
def test_the_spectral_radius_at_infinite_frequency_is_the_one_asked_for(rho: float) -> None:
    alpha_m, alpha_f, beta, gamma = alpha_coefficients(rho)
    # One step for u'' = -w^2 u with x the auxiliary accelerations and h = 1, in the limit of large w:
    # (1 - alpha_m) x1 + alpha_m x0 = (1 - alpha_f) a1 + alpha_f a0, a = -w^2 u.
    w2 = 1e12
    left = np.array([[1.0, 0.0, -beta], [0.0, 1.0, -gamma], [(1.0 - alpha_f) * w2, 0.0, 1.0 - alpha_m]])
    right = np.array([[1.0, 1.0, 0.5 - beta], [0.0, 1.0, 1.0 - gamma], [-alpha_f * w2, 0.0, -alpha_m]])
    radius = np.abs(np.linalg.eigvals(np.linalg.solve(left, right))).max()
    # A double eigenvalue (a triple one at 0): known to the root of rounding.
    assert radius == pytest.approx(rho, abs=2e-4)


def run_pendulum(step: float, rho: float, end: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and velocities, and the reaction of the pin, at the end."""
    simulation = Simulation(pendulum(), GeneralizedAlpha(step=step, rho_inf=rho))
    simulation.advance(end)
    assert simulation.state.clock["steps"][0] == round(end / step)
    return np.concatenate([simulation.state.q, simulation.state.v]), simulation.state.multipliers.copy()


@pytest.mark.parametrize("rho", [0.5, 0.8, 1.0])
def test_coordinates_velocities_and_multipliers_are_of_order_two(rho: float) -> None:
    exact = Simulation(pendulum(), RungeKutta(rtol=1e-12))
    exact.advance(0.5)
    state = np.concatenate([exact.state.q, exact.state.v])
    reaction = exact.joint_loads()[0, [FORCE_X, FORCE_Y]]
    runs = [run_pendulum(0.01 / 2**k, rho) for k in range(4)]
    motion = [np.abs(found - state).max() for found, _ in runs]
    # Row multipliers are minus the force on the outboard body.
    reactions = [np.abs(-multipliers[:2] - reaction).max() for _, multipliers in runs]
    assert orders(motion) == pytest.approx(2.0, abs=0.1)
    assert orders(reactions) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("rho", [0.8, 1.0])
def test_constraints_are_met_at_every_step_to_newtons_tolerance(rho: float) -> None:
    simulation = Simulation(pendulum(), GeneralizedAlpha(step=5e-3, rho_inf=rho))
    work = make_workspace(simulation.model, simulation.state)
    for end in np.arange(1, 41) * 0.05:
        simulation.advance(end)
        q = simulation.state.q
        assert constraint_drift(simulation.model, q, simulation.time, work) < 1e-12
        assert math.hypot(*(q[2:4] - q[:2])) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(("end", "steps"), [(0.1, 10), (0.095, 10), (0.0951, 10), (0.004, 1), (0.3, 30)])
def test_fixed_steps_divide_a_call_evenly_and_end_on_its_end(end: float, steps: int) -> None:
    simulation = Simulation(pendulum(), GeneralizedAlpha(step=0.01))
    simulation.advance(end)
    assert simulation.time == end
    clock = simulation.state.clock[0]
    assert clock["steps"] == steps
    assert clock["last_step"] == pytest.approx(end / steps, rel=1e-9)
    assert clock["rejected_steps"] == 0


def test_a_call_that_ends_between_two_steps_keeps_the_order() -> None:
    # Every call of 0.07 s ends on a shorter step than the one of 0.02 s that was asked for.
    exact = Simulation(pendulum(), RungeKutta(rtol=1e-12))
    exact.advance(0.49)
    errors = []
    for step in (0.02, 0.01, 0.005):
        simulation = Simulation(pendulum(), GeneralizedAlpha(step=step))
        for k in range(1, 8):
            simulation.advance(0.07 * k if k < 7 else 0.49)
        errors.append(np.abs(simulation.state.q - exact.state.q).max())
    assert np.all(orders(errors) > 1.5)


@pytest.mark.parametrize("factor", [0.5, 0.1])
def test_after_a_change_of_step_reactions_are_as_good_as_after_a_start_with_that_step(factor: float) -> None:
    # From the index-3 equations the first reactions are of order one, whatever the start. Accelerations and multipliers
    # left over from the longer step would make them 3 and 100 times worse.
    step, begin = 2e-3, 0.4
    exact = Simulation(pendulum(), RungeKutta(rtol=1e-11))
    exact.advance(begin)
    chosen = GeneralizedAlpha(step=step * factor)
    fresh, changed = Simulation(pendulum(), chosen), Simulation(pendulum(), GeneralizedAlpha(step=step))
    fresh.restore(exact.snapshot())
    fresh.state.clock["acceleration_current"] = 0
    changed.advance(begin)
    changed.integrator = chosen
    errors = np.zeros((10, 2))
    for row in errors:
        end = exact.time + step * factor
        exact.advance(end)
        reaction = exact.joint_loads()[0, [FORCE_X, FORCE_Y]]
        for k, simulation in enumerate((fresh, changed)):
            simulation.advance(end)
            row[k] = np.abs(-simulation.state.multipliers[:2] - reaction).max()
    of_start, of_change = errors.max(axis=0)
    assert of_change < 1.5 * of_start


def test_coming_back_from_another_integrator_it_restarts_as_from_a_restored_state() -> None:
    chosen = GeneralizedAlpha(step=2e-3)
    changed, fresh = (Simulation(pendulum(), chosen) for _ in range(2))
    changed.advance(0.1)
    changed.integrator = RungeKutta(rtol=1e-10)
    changed.advance(0.4)
    fresh.restore(changed.snapshot())
    fresh.state.clock["acceleration_current"] = 0
    changed.integrator = chosen
    for simulation in (changed, fresh):
        simulation.advance(0.45)
    assert changed.state.q.tobytes() == fresh.state.q.tobytes()
    assert changed.state.multipliers.tobytes() == fresh.state.multipliers.tobytes()


def test_implicit_and_explicit_integration_agree_on_the_latchings() -> None:
    mechanism = build(ArrayParameters(), "rigid-ideal")
    implicit = simulate(mechanism, 13.0, integrator=GeneralizedAlpha(step=5e-4))
    explicit = simulate(mechanism, 13.0, integrator=RungeKutta(rtol=1e-8))
    assert np.all(explicit.latch_times > 12.0)
    assert implicit.latch_times == pytest.approx(explicit.latch_times, abs=1e-4)
    assert implicit.angles[-1] == pytest.approx(explicit.angles[-1], abs=1e-3)


def test_implicit_and_explicit_integration_agree_on_an_impact() -> None:
    mechanism = block((0.3, 0.0))
    runs = [simulate(mechanism, 0.01, integrator=i) for i in (GeneralizedAlpha(step=1e-6), RungeKutta(rtol=1e-9))]
    found, expected = (run.contacts[0] for run in runs)
    assert found["start_s"] == pytest.approx(expected["start_s"], rel=1e-3)
    assert found["impact_speed"] == pytest.approx(expected["impact_speed"], rel=1e-3)
    assert found["peak_force"] == pytest.approx(expected["peak_force"], rel=0.01)
    assert found["impulse"] == pytest.approx(expected["impulse"], rel=0.01)


@pytest.mark.parametrize("rho", [0.8, 1.0])
def test_the_energy_book_closes_to_second_order(rho: float) -> None:
    residuals = []
    for step in (5e-3, 2.5e-3, 1.25e-3):
        simulation = Simulation(pendulum(), GeneralizedAlpha(step=step, rho_inf=rho))
        simulation.set_motor_torque(0, 3.0)
        simulation.advance(1.0)
        assert abs(simulation.state.integrals[MOTOR_WORK]) > 1.0
        residuals.append(abs(simulation.energy_residual()))
    assert orders(residuals) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("model", NATURAL_LEVELS)
def test_an_absurd_step_fails_with_time_and_remedy_at_the_last_accepted_state(model: str) -> None:
    # With clearance the first impact is too much, without it the first latching.
    simulation = Simulation(build(ArrayParameters(), model), GeneralizedAlpha(step=0.5))
    before = simulation.snapshot()
    with pytest.raises(SimulationError, match=r"at t = \d.*reduce the step") as caught:
        simulation.advance(30.0)
    assert caught.value.reason in ("newton", "not_finite")
    assert caught.value.time == simulation.time == 0.5 * simulation.state.clock["steps"][0]
    assert np.isfinite(simulation.state.q).all()
    if simulation.time == 0.0:
        for name in ("integrals", "wear_journal", "wear_bearing"):
            assert np.array_equal(getattr(simulation.state, name), getattr(before, name))
        # The first step of a call returns to the joints' constraints, which are met but for rounding.
        rounding = 1e-14 if model.endswith("ideal") else 0.0
        for name in ("q", "v"):
            assert getattr(simulation.state, name) == pytest.approx(getattr(before, name), rel=0.0, abs=rounding)


def test_newtons_iteration_converges_fast_with_the_analytic_tangents() -> None:
    # Quadratic convergence doubles the digits: from a prediction good to h^3 = 1e-9, two corrections and a check.
    smooth = Simulation(pendulum(), GeneralizedAlpha(step=1e-3))
    smooth.advance(0.5)
    assert smooth.state.clock["factorizations"][0] <= 3 * smooth.state.clock["steps"][0]
    rough = Simulation(build(ArrayParameters()), GeneralizedAlpha(step=2e-5))
    rough.advance(1.0)
    assert rough.state.joints["contact_starts"].min() > 5
    assert rough.state.clock["factorizations"][0] <= 4 * rough.state.clock["steps"][0]


@pytest.mark.filterwarnings("ignore:an impact of")
@pytest.mark.parametrize("rho", [0.4, 0.8, 1.0])
def test_a_step_in_which_friction_stops_a_body_is_solved_though_full_corrections_go_back_and_forth(rho: float) -> None:
    # Pressed to the wall by 10 N, sliding at 5 mm/s: 3 N of friction stop the 1 kg in 1.7 ms, and change sign within
    # 0.2 mm/s, where full corrections from either side land on the other one.
    bearing = Bearing(1e-3, 0.01, PowerLaw(1e6, 1.0), friction_coefficient=0.3, friction_speeds=(1e-5, 1e-4))
    mechanism = block((0.0, 5e-3), bearing=bearing, position=(1e-3 + 1e-5, 0.0), gravity=(10.0, 0.0))
    simulation = Simulation(mechanism, GeneralizedAlpha(step=5e-3, rho_inf=rho))
    simulation.advance(5e-3)
    v = simulation.state.v
    spin = v[3] - v[1]
    assert abs(v[1] + 0.01 * spin) < 1e-4
    assert simulation.state.clock["factorizations"][0] < 50


def test_a_smooth_step_takes_a_few_corrections_which_are_counted() -> None:
    simulation = Simulation(pendulum(), GeneralizedAlpha(step=1e-3))
    simulation.advance(1e-3)
    clock = simulation.state.clock[0]
    # From a prediction good to h^3 = 1e-9 two corrections and a check.
    assert 2 <= clock["factorizations"] <= 3
    # Two more are for the accelerations at the start and at the instant that the auxiliary ones stand for.
    assert clock["evaluations"] == clock["factorizations"] + 2


@pytest.mark.parametrize("mechanism", [double_pendulum, lambda: beam_rotor(3.0)], ids=["two bodies", "a beam"])
def test_steps_follow_the_explicit_method_and_meet_the_constraints(mechanism: Callable[[], Mechanism]) -> None:
    errors = []
    exact = Simulation(mechanism(), RungeKutta(rtol=1e-10))
    exact.advance(4e-3)
    for step in (1e-3, 0.5e-3):
        simulation = Simulation(mechanism(), GeneralizedAlpha(step=step))
        simulation.advance(4e-3)
        state = simulation.state
        work = make_workspace(simulation.model, state)
        assert constraint_drift(simulation.model, state.q, simulation.time, work) < 1e-12
        errors.append(np.abs(state.q - exact.state.q).max())
    assert orders(errors) == pytest.approx(2.0, abs=0.1)


def released(time: float) -> Simulation:
    """A pendulum some time after its release, exact but for rounding."""
    simulation = Simulation(pendulum(), RungeKutta(rtol=1e-11))
    simulation.advance(time)
    return simulation


def test_the_first_step_begins_with_the_accelerations_of_the_instant_that_the_auxiliary_ones_stand_for() -> None:
    begin, step = 0.05, 0.02
    simulation = Simulation(pendulum(), GeneralizedAlpha(step=step, rho_inf=0.0))
    simulation.restore(released(begin).snapshot())
    simulation.state.clock["acceleration_current"] = 0
    simulation.advance(begin + step)
    # With alpha_m = -1 and alpha_f = 0 the step solved 2 x1 - x0 = a1.
    assert alpha_coefficients(0.0)[:2] == (-1.0, 0.0)
    auxiliary = 2.0 * simulation.state.algorithmic_a - simulation.state.a
    # They stand for t + (alpha_m - alpha_f) h = t - h; the accelerations of that instant as differences of velocities.
    width = 1e-3
    before, after = (released(begin - step + side * width).state.v for side in (-1.0, 1.0))
    there = (after - before) / (2.0 * width)
    assert np.abs(there).max() > 1.0
    assert auxiliary == pytest.approx(there, abs=1e-3)
