import math
from dataclasses import replace

import numpy as np
import pytest

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.mechanism.textbook import (
    FOUR_BAR_PINS,
    Link,
    bouncing_block,
    flores_bearing,
    four_bar,
    loaded_journal,
    pendulum,
)
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation, simulate


@pytest.mark.parametrize("angle", np.linspace(-math.pi, math.pi, 7))
def test_initial_states_meet_the_constraints_at_every_crank_angle(angle):
    # Simulation refuses a state that does not.
    Simulation(four_bar(crank_angle=angle))
    Simulation(pendulum(angle=angle))


def test_all_pins_can_be_clearance_joints_at_once():
    bearings = {pin: flores_bearing(1e-4) for pin in FOUR_BAR_PINS}
    motion = simulate(four_bar(clearances=bearings), 0.2, integrator=RungeKutta(rtol=1e-6))
    assert (motion.contact_starts > 0).all()
    assert motion.energy_residual < 1e-5 * motion.energy_put_in


def test_both_integrators_agree_on_the_first_impacts_of_a_clearance_pin():
    mechanism = four_bar(crank_rate=50.0, clearances={"coupler-rocker": flores_bearing()})
    runs = [simulate(mechanism, 0.02, integrator=i) for i in (RungeKutta(rtol=1e-8), GeneralizedAlpha(step=1e-6))]
    speeds = [run.contacts["impact_speed"][:2] for run in runs]
    assert len(speeds[0]) == 2
    np.testing.assert_allclose(*speeds, rtol=1e-2)


def test_the_default_four_bar_is_a_crank_rocker_whose_crank_turns_at_its_rate():
    simulation = Simulation(four_bar(crank_angle=0.3, crank_rate=4.0))
    simulation.advance(0.5)
    q = simulation.state.q
    assert math.atan2(q[3] - q[1], q[2] - q[0]) == pytest.approx(0.3 + 4.0 * 0.5, abs=1e-12)
    rocker = simulate(four_bar(), 1.0, integrator=RungeKutta(rtol=1e-8)).angles[:, 3]
    assert rocker[-1] == pytest.approx(rocker[0], abs=1e-9)
    assert np.ptp(rocker) < math.pi


@pytest.mark.parametrize("driven", [True, False])
def test_a_parallelogram_stays_one_through_its_dead_points_or_they_are_named(driven):
    """At a dead point all links lie in a line and the constraints lose rank; inertia carries the rocker through."""
    equal = Link.slender(0.1, 0.1)
    linkage = four_bar(equal, Link.slender(0.4, 0.4), equal, ground_length=0.4, crank_angle=0.5, gravity=0.0)
    linkage = linkage if driven else replace(linkage, drives=())
    for integrator in (RungeKutta(), GeneralizedAlpha(step=2.5e-3)):
        motion = simulate(linkage, 2.0, integrator=integrator, output_step=0.1)
        crank, rocker = (motion.coordinates[:, k + 2 : k + 4] - motion.coordinates[:, k : k + 2] for k in (0, 8))
        assert crank == pytest.approx(rocker, abs=1e-6), integrator
    if driven:
        with pytest.raises(SimulationError, match=r"redundant .* pass a dead point with GeneralizedAlpha"):
            simulate(linkage, 2.0, integrator=RungeKutta(rtol=1e-9), output_step=0.1)


@pytest.mark.parametrize("housing_mass", [None, 2.0])
def test_block_bounces_on_a_line(housing_mass):
    bearing = Bearing(1e-3, 0.01, PowerLaw(1e10))
    motion = simulate(bouncing_block(bearing, mass=1.0, speed=0.5, housing_mass=housing_mass), 0.1)
    assert motion.contact_starts[0] > 10
    np.testing.assert_allclose(motion.coordinates[:, 1::2], 0.0, atol=1e-15)


def test_loaded_journal_starts_in_balance():
    bearing = Bearing(2e-4, 0.01, PowerLaw(7e10, damping=0.1), friction_coefficient=0.2)
    for mechanism in (loaded_journal(bearing), loaded_journal(bearing, lean=math.atan(0.2), rate=10.0)):
        simulation = Simulation(mechanism, RungeKutta(rtol=1e-8))
        before = simulation.state.q[:2].copy()
        simulation.advance(0.05)
        np.testing.assert_allclose(simulation.state.q[:2], before, atol=1e-12)


def test_what_cannot_be_built_is_refused_by_name():
    with pytest.raises(ValueError, match=r"unknown pin 'rod-slider'.*coupler-rocker"):
        four_bar(clearances={"rod-slider": flores_bearing()})
    with pytest.raises(ValueError, match="do not close"):
        four_bar(ground_length=2.0)
    with pytest.raises(ValueError, match="journal_radius"):
        flores_bearing(0.02)
    with pytest.raises(ValueError, match="load"):
        loaded_journal(flores_bearing(), load=0.0)
