"""One step of generalized-alpha: its iteration where corrections go back and forth, kinds of bodies, its start."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from helpers import orders
from mechanisms import beam_rotor, block, pendulum

from solar_env.mechanics.equations.constraints import constraint_drift
from solar_env.mechanics.equations.system import make_workspace
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, RungeKutta, alpha_coefficients
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.friction.ramp import RampedCoulomb
from solar_env.mechanics.mechanism.description import Bearing, Mechanism
from solar_env.mechanics.mechanism.textbook import double_pendulum
from solar_env.mechanics.running.simulation import Simulation


@pytest.mark.filterwarnings("ignore:an impact of")
@pytest.mark.parametrize("rho", [0.4, 0.8, 1.0])
def test_a_step_in_which_friction_stops_a_body_is_solved_though_full_corrections_go_back_and_forth(rho: float) -> None:
    # Pressed to the wall by 10 N, sliding at 5 mm/s: 3 N of friction stop the 1 kg in 1.7 ms, and change sign within
    # 0.2 mm/s, where full corrections from either side land on the other one.
    stopping = RampedCoulomb(1e-5, 1e-4)
    bearing = Bearing(1e-3, 0.01, PowerLaw(1e6, 1.0), friction_coefficient=0.3, friction=stopping)
    mechanism = block((0.0, 5e-3), bearing=bearing, position=(1e-3 + 1e-5, 0.0), gravity=(10.0, 0.0))
    simulation = Simulation(mechanism, GeneralizedAlpha(step=5e-3, rho_inf=rho))
    simulation.advance(5e-3)
    v = simulation.state.v
    spin = v[3] - v[1]
    assert abs(v[1] + 0.01 * spin) < stopping.speed_full
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
