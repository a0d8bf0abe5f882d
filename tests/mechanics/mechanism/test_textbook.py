import math

import numpy as np
import pytest

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, RungeKutta
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.mechanism.textbook import (
    FOUR_BAR_PINS,
    SLIDER_CRANK_PINS,
    Link,
    bouncing_block,
    double_pendulum,
    flores_bearing,
    four_bar,
    loaded_journal,
    pendulum,
    slider_crank,
)
from solar_env.mechanics.running.simulation import Simulation, simulate

ANGLES = np.linspace(-math.pi, math.pi, 13)


@pytest.mark.parametrize("angle", ANGLES)
def test_initial_states_meet_the_constraints_at_every_crank_angle(angle):
    # Simulation refuses a state that does not.
    Simulation(slider_crank(crank_angle=angle))
    Simulation(four_bar(crank_angle=angle))
    Simulation(pendulum(angle=angle))
    Simulation(double_pendulum(angles=(angle, 2.0 * angle), spins=(1.0, -3.0)))


@pytest.mark.parametrize(
    ("build", "pins"),
    [(slider_crank, SLIDER_CRANK_PINS), (four_bar, FOUR_BAR_PINS)],
    ids=["slider-crank", "four-bar"],
)
def test_any_pin_can_be_a_clearance_joint(build, pins):
    turn = 2.0 * math.pi / (2.0 * math.pi if build is four_bar else 5000.0 * 2.0 * math.pi / 60.0)
    for joint, pin in enumerate(pins):
        motion = simulate(build(clearances={pin: flores_bearing(1e-4)}), 0.5 * turn, integrator=RungeKutta(rtol=1e-6))
        assert motion.contact_starts[joint] > 0
        assert np.count_nonzero(motion.clearance) == 1
        assert motion.penetration[:, joint].max() < 1e-4


def test_all_pins_can_be_clearance_joints_at_once():
    bearings = {pin: flores_bearing(1e-4) for pin in FOUR_BAR_PINS}
    motion = simulate(four_bar(clearances=bearings), 0.2, integrator=RungeKutta(rtol=1e-6))
    assert (motion.contact_starts > 0).all()
    assert motion.energy_residual < 1e-5 * motion.energy_put_in


def test_both_integrators_agree_on_the_first_impacts_of_a_clearance_pin():
    mechanism = slider_crank(clearances={"rod-slider": flores_bearing()})
    runs = [simulate(mechanism, 1e-3, integrator=i) for i in (RungeKutta(rtol=1e-8), GeneralizedAlpha(step=1e-7))]
    assert runs[0].contact_starts[2] == runs[1].contact_starts[2] == 4
    speeds = [run.contacts["impact_speed"][:4] for run in runs]
    np.testing.assert_allclose(*speeds, rtol=1e-2)


def test_crank_turns_at_its_prescribed_rate():
    simulation = Simulation(four_bar(crank_angle=0.3, crank_rate=4.0))
    simulation.advance(0.5)
    q = simulation.state.q
    assert math.atan2(q[3] - q[1], q[2] - q[0]) == pytest.approx(0.3 + 4.0 * 0.5, abs=1e-12)


def test_default_four_bar_is_a_crank_rocker():
    motion = simulate(four_bar(), 1.0, integrator=RungeKutta(rtol=1e-8))
    rocker = motion.angles[:, 3]
    assert rocker[-1] == pytest.approx(rocker[0], abs=1e-9)
    assert np.ptp(rocker) < math.pi


def test_slider_stays_on_its_guide_and_does_not_turn():
    motion = simulate(slider_crank(), 0.02, integrator=RungeKutta(rtol=1e-8))
    np.testing.assert_allclose(motion.coordinates[:, [9, 11]], 0.0, atol=1e-12)


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


def test_unknown_pin_is_named_with_the_known_ones():
    with pytest.raises(ValueError, match=r"unknown pin 'piston'.*rod-slider"):
        slider_crank(clearances={"piston": flores_bearing()})
    with pytest.raises(ValueError, match=r"unknown pin 'rod-slider'.*coupler-rocker"):
        four_bar(clearances={"rod-slider": flores_bearing()})


def test_links_that_do_not_close_are_refused():
    with pytest.raises(ValueError, match="do not close"):
        four_bar(ground_length=2.0)
    with pytest.raises(ValueError, match=r"rod\.length .* too short"):
        slider_crank(crank=Link.slender(0.2, 0.3), crank_angle=math.pi / 2)


def test_impossible_parts_are_refused_by_name():
    with pytest.raises(ValueError, match="journal_radius"):
        flores_bearing(0.02)
    with pytest.raises(ValueError, match="load"):
        loaded_journal(flores_bearing(), load=0.0)
