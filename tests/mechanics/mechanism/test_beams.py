import math

import pytest

from solar_env.mechanics.integrators.settings import GeneralizedAlpha
from solar_env.mechanics.mechanism.beams import (
    PANEL,
    PENDULUM_BEAM,
    SPIN_UP_BEAM,
    Beam,
    cantilever,
    spin_up_beam,
)
from solar_env.mechanics.running.simulation import Simulation


def test_panel_is_the_papers():
    assert PANEL.bending_stiffness == pytest.approx(186.667, abs=5e-4)
    assert PANEL.linear_density == pytest.approx(4.0)
    assert PANEL.mass == pytest.approx(6.0)


def test_solid_multiplies_section_and_material():
    beam = Beam.solid(1.2, 0.0018, 1.215e-8, 5540.0, 0.7e6)
    assert beam == PENDULUM_BEAM
    assert beam.axial_stiffness == pytest.approx(1260.0)
    assert beam.bending_stiffness == pytest.approx(8.505e-3)
    assert beam.linear_density == pytest.approx(9.972)


def test_cantilever_keeps_its_root_and_the_root_of_the_spin_up_follows_the_drive():
    simulation = Simulation(cantilever(elements=2, tip_force=(0.0, 1.0), angle=0.3), GeneralizedAlpha(step=1e-3))
    simulation.advance(0.1)
    assert simulation.state.q[:2] == pytest.approx((0.0, 0.0), abs=1e-12)
    assert math.atan2(simulation.state.q[3], simulation.state.q[2]) == pytest.approx(0.3, abs=1e-12)
    turning = Simulation(spin_up_beam(SPIN_UP_BEAM, 4, rate=3.0, ramp_time=1.0), GeneralizedAlpha(step=1e-3))
    turning.advance(1.5)
    assert math.atan2(turning.state.q[3], turning.state.q[2]) == pytest.approx(3.0 * (1.5 - 0.5), abs=1e-9)
