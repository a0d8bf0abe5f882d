import math

import numpy as np
import pytest

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, RungeKutta
from solar_env.mechanics.mechanism.beams import (
    BEAM,
    PANEL,
    PENDULUM_BEAM,
    SPIN_UP_BEAM,
    Beam,
    cantilever,
    flexible_pendulum,
    free_beam,
    spin_up_beam,
)
from solar_env.mechanics.mechanism.description import Load
from solar_env.mechanics.running.simulation import Simulation

EXPLICIT_AND_IMPLICIT = [RungeKutta(), GeneralizedAlpha(step=1e-3)]


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


@pytest.mark.parametrize("integrator", EXPLICIT_AND_IMPLICIT, ids=lambda i: i.name)
@pytest.mark.parametrize(
    "mechanism",
    [
        cantilever(elements=2, tip_force=(0.0, 1.0), tip_torque=0.1, angle=0.3, gravity=(0.0, -1.0)),
        spin_up_beam(elements=2),
        flexible_pendulum(elements=3, angle=-0.5),
        free_beam(elements=2, velocity=(1.0, 2.0), spin=3.0, angle=1.0, loads=(Load(BEAM, torque=1.0),)),
    ],
    ids=["cantilever", "spin-up", "pendulum", "free"],
)
def test_every_beam_moves_with_both_integrators(mechanism, integrator):
    simulation = Simulation(mechanism, integrator)
    start = simulation.state.q.copy()
    simulation.advance(0.02)
    assert np.isfinite(simulation.state.q).all()
    assert np.abs(simulation.state.q - start).max() > 0.0


def test_cantilever_keeps_its_root_and_the_root_of_the_spin_up_follows_the_drive():
    simulation = Simulation(cantilever(elements=2, tip_force=(0.0, 1.0), angle=0.3), GeneralizedAlpha(step=1e-3))
    simulation.advance(0.1)
    assert simulation.state.q[:2] == pytest.approx((0.0, 0.0), abs=1e-12)
    assert math.atan2(simulation.state.q[3], simulation.state.q[2]) == pytest.approx(0.3, abs=1e-12)
    turning = Simulation(spin_up_beam(SPIN_UP_BEAM, 4, rate=3.0, ramp_time=1.0), GeneralizedAlpha(step=1e-3))
    turning.advance(1.5)
    assert math.atan2(turning.state.q[3], turning.state.q[2]) == pytest.approx(3.0 * (1.5 - 0.5), abs=1e-9)
