"""Beams in motion, alone and among rigid bodies, with both integrators: momentum, energy, order, saving."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mechanisms import turned

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ANGLE
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import (
    GROUND,
    Bearing,
    Body,
    FlexibleBody,
    Joint,
    Mechanism,
    Spring,
    Stop,
)
from solar_env.mechanics.running.simulation import Simulation, simulate

EXPLICIT_AND_IMPLICIT: dict[str, Integrator] = {
    "runge-kutta": RungeKutta(rtol=1e-8),
    "generalized-alpha": GeneralizedAlpha(step=1e-3, rho_inf=1.0),
}
# With rho_inf = 1, which conserves energy, the constraint forces alternate, as the library tells; here motion counts.
pytestmark = pytest.mark.filterwarnings("ignore:.* the constraint forces of the integrator")
both_integrators = pytest.mark.parametrize(
    "integrator", EXPLICIT_AND_IMPLICIT.values(), ids=EXPLICIT_AND_IMPLICIT.keys()
)

BEAM = FlexibleBody("beam", 1.2, 2, linear_density=0.8, axial_stiffness=400.0, bending_stiffness=0.6)
WIDE = Bearing(
    0.02,
    0.1,
    PowerLaw(300.0, damping=0.2),
    minimum_impact_speed=1e-3,
    friction_coefficient=0.2,
    friction_speeds=(0.01, 0.1),
)
CONNECTIONS: dict[str, Bearing | None] = {"ideal joints": None, "clearance joints": WIDE}


def flight(bearing: Bearing | None, damping: float = 0.0) -> Mechanism:
    """Rigid body, beam and another rigid body, joined end to end; they fly through gravity and turn as one body."""
    spin, speed = 1.3, np.array([0.4, 0.2])
    angles = (0.3, 1.0, -0.4)
    pins = [np.zeros(2)]
    for angle, length in zip(angles, (0.9, BEAM.length), strict=False):
        pins.append(pins[-1] + length * turned((1.0, 0.0), angle))
    place = [
        {
            "position": tuple(pin.tolist()),
            "angle": angle,
            "velocity": tuple((speed + spin * np.array([-pin[1], pin[0]])).tolist()),
            "spin": spin,
        }
        for pin, angle in zip(pins, angles, strict=True)
    ]
    bodies = (
        Body("first", 1.5, 0.2, 0.9, (0.4, 0.1), **place[0]),
        replace(BEAM, damping=damping, **place[1]),
        Body("last", 0.7, 0.1, 0.8, (0.3, -0.1), **place[2]),
    )
    spring = Spring(0.8, 0.2)
    joints = (
        Joint("a", "first", "beam", (0.9, 0.0), (0.0, 0.0), bearing=bearing, spring=spring),
        Joint("b", "beam", "last", (BEAM.length, 0.0), (0.0, 0.0), bearing=bearing, spring=spring),
    )
    return Mechanism(bodies, joints, gravity=(0.0, -0.5))


@both_integrators
@pytest.mark.parametrize("bearing", CONNECTIONS.values(), ids=CONNECTIONS.keys())
def test_bodies_that_are_joined_exchange_momentum_and_lose_none(
    bearing: Bearing | None, integrator: Integrator
) -> None:
    mechanism = replace(flight(bearing, damping=0.01), gravity=(0.0, 0.0))
    simulation = Simulation(mechanism, integrator)
    before, q = simulation.momenta(), simulation.state.q.copy()
    simulation.advance(2.0)
    # They have moved, bent, and if they could struck each other.
    assert simulation.stored_energies()[m.ELASTIC] > 1e-6
    assert bearing is None or simulation.state.joints["contact_starts"].min() > 0
    after = simulation.momenta()
    assert after[:2] == pytest.approx(before[:2], abs=1e-11)
    # Generalized-alpha keeps angular momentum to the second order of its step.
    assert after[2] == pytest.approx(before[2], abs=1e-9 if integrator.name == "runge-kutta" else 1e-4)
    assert np.abs(simulation.state.q - q).max() > 0.5


@both_integrators
@pytest.mark.parametrize("bearing", CONNECTIONS.values(), ids=CONNECTIONS.keys())
@pytest.mark.parametrize("damping", [0.0, 0.01])
def test_the_energy_book_of_rigid_and_flexible_bodies_closes(
    bearing: Bearing | None, damping: float, integrator: Integrator
) -> None:
    simulation = Simulation(flight(bearing, damping), integrator)
    start = simulation.stored_energies()
    simulation.advance(2.0)
    moved = np.abs(simulation.stored_energies() - start)
    assert moved[[m.KINETIC, m.SPRING, m.ELASTIC, m.GRAVITY]].min() > 1e-4
    exact = integrator.name == "runge-kutta"
    assert simulation.energy_residual() == pytest.approx(0.0, abs=(1e-6 if exact else 2e-3) * np.abs(start).sum())
    lost = simulation.state.integrals[m.MATERIAL_DISSIPATION]
    assert lost > 1e-4 if damping else lost == 0.0
    assert simulation.state.integrals[m.EXTERNAL_WORK] == 0.0


@pytest.mark.parametrize("damping", [0.0, 0.01])
def test_both_integrators_agree_on_the_motion(damping: float) -> None:
    states = []
    # Fixed steps resolve the undamped stretching of an element, of 1600 rad/s, to some (h omega)^2 / 12.
    for integrator in (RungeKutta(rtol=1e-9), GeneralizedAlpha(step=2.5e-4, rho_inf=1.0)):
        simulation = Simulation(flight(None, damping), integrator)
        simulation.advance(1.0)
        states.append(simulation.state.q.copy())
    assert states[1] == pytest.approx(states[0], abs=1e-5 if damping else 2e-3)


def test_a_trajectory_books_elastic_energy_and_what_damping_took() -> None:
    run = simulate(flight(None, 0.01), 1.0, integrator=RungeKutta(rtol=1e-8), output_step=0.05)
    assert run.energies["elastic"].max() > 1e-4
    assert run.energies["elastic"].min() >= 0.0
    assert np.all(np.diff(run.energies["material_dissipation"]) >= 0.0)
    assert run.energies["material_dissipation"][-1] > 1e-4
    assert run.energy_residual < 1e-6 * run.energy_put_in
    assert run.coordinates.shape == (21, 4 + 12 + 4)


def test_a_soft_stop_latches_a_beam() -> None:
    # A spring swings a beam about a pin; the stop of its root catches it and the vibration dies out in the stop.
    stop = Stop(gap=0.01, stiffness=200.0, exponent=1.0, ramp_depth=1e-3, damping=2.0)
    pin = Joint("pin", GROUND, "beam", (0.0, 0.0), (0.0, 0.0), spring=Spring(0.5, 1.0), stop=stop, lock_angle=0.6)
    simulation = Simulation(Mechanism((replace(BEAM, damping=0.4),), (pin,)), GeneralizedAlpha(step=5e-4))
    simulation.advance(30.0)
    assert simulation.state.joints["latched"][0] == 1
    # At rest where spring and stop balance: 0.5 (1 - angle) = 200 (angle - 0.61).
    assert simulation.joint_loads()[0, ANGLE] == pytest.approx(122.5 / 200.5, abs=1e-6)
    assert simulation.energy_residual() == pytest.approx(0.0, abs=1e-4)
