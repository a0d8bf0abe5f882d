"""Rigid bodies in reference point coordinates, against closed forms and against natural coordinates."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from helpers import orders
from mechanisms import floating_pair, turned

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.bodies.description import ReferencePointBody
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.mechanism.description import GROUND, Bearing, Joint, Load, Mechanism
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.mechanics.running.trajectory import Trajectory

BODY = ReferencePointBody("body", 1.5, 0.3, 0.9, (0.4, 0.1), position=(0.2, -0.3), velocity=(0.3, 0.1), spin=1.7)


def by_reference_points(mechanism: Mechanism) -> Mechanism:
    """The same mechanism with its rigid bodies in other coordinates."""
    names = [item.name for item in fields(ReferencePointBody)]
    bodies = [ReferencePointBody(**{name: getattr(body, name) for name in names}) for body in mechanism.bodies]
    return replace(mechanism, bodies=tuple(bodies))


def test_a_free_body_turns_evenly_about_a_centroid_that_moves_straight() -> None:
    simulation = Simulation(Mechanism((BODY,)))
    start = simulation.state.q.copy()
    simulation.advance(5.0)
    arm = np.array(BODY.centroid)
    assert start == pytest.approx([*(np.array(BODY.position) + arm), 0.0], abs=1e-15)
    velocity = np.array(BODY.velocity) + BODY.spin * np.array([-arm[1], arm[0]])
    assert simulation.state.q == pytest.approx(start + 5.0 * np.array([*velocity, BODY.spin]), abs=1e-12)


def test_a_torque_and_a_force_off_the_centroid_turn_it_by_eulers_law() -> None:
    """A force that keeps its direction makes a pendulum of the body: its energy is the force times the way."""
    place, force = (0.9, 0.0), (0.4, -0.7)
    mechanism = Mechanism((replace(BODY, velocity=(0.0, 0.0), spin=0.0),), loads=(Load("body", place, force),))
    motion = simulate(mechanism, 3.0, integrator=RungeKutta(rtol=1e-9), output_step=0.1)
    x, y, angle = motion.coordinates.T
    centroid = 0.5 * np.outer(motion.time**2, force) / BODY.mass
    assert np.stack([x - x[0], y - y[0]], axis=1) == pytest.approx(centroid, abs=1e-12)
    arms = np.array([turned(np.subtract(place, BODY.centroid), phi) for phi in angle])
    turning = 0.5 * BODY.inertia * motion.velocities[:, 2] ** 2
    assert turning == pytest.approx((arms - arms[0]) @ force, abs=1e-8)
    assert np.abs(motion.energies["residual"]).max() < 1e-8


def momenta(mechanism: Mechanism, motion: Trajectory) -> np.ndarray:
    """(times, 3) linear and angular momentum about the origin, of bodies in reference point coordinates."""
    mass, inertia = (np.array([getattr(body, name) for body in mechanism.bodies]) for name in ("mass", "inertia"))
    place, velocity = (x.reshape(len(x), -1, 3) for x in (motion.coordinates, motion.velocities))
    linear = np.einsum("b,tbk->tk", mass, velocity[..., :2])
    moment = place[..., 0] * velocity[..., 1] - place[..., 1] * velocity[..., 0]
    return np.column_stack([linear, moment @ mass + velocity[..., 2] @ inertia])


def test_the_array_deploys_as_it_does_in_natural_coordinates() -> None:
    """The first impacts to nine digits; later ones, which errors of every size disturb, within a share of the path."""
    natural = build(ArrayParameters(), "rigid-clearance")
    other = by_reference_points(natural)
    settings = RungeKutta(rtol=1e-9, impact_resolution=12.0)
    reference, found = (simulate(mechanism, 12.35, integrator=settings) for mechanism in (natural, other))
    impacts = [np.sort(motion.contacts["start_s"])[:4] for motion in (found, reference)]
    assert impacts[0] == pytest.approx(impacts[1], abs=5e-9)
    for end, tolerance in ((0.3, 5e-9), (0.5, 1e-6), (12.2, 1e-4)):
        times = found.time < end
        assert found.angles[times] == pytest.approx(reference.angles[times], abs=tolerance)
        assert found.eccentricity[times] == pytest.approx(reference.eccentricity[times], abs=tolerance)
    assert found.latch_times == pytest.approx(reference.latch_times, abs=1e-5)
    # Nothing acts from outside; contact, friction and latch act in pairs, at the same point.
    assert np.ptp(momenta(other, found), axis=0) == pytest.approx(0.0, abs=1e-12)
    assert np.abs(found.energies["residual"]).max() < 1e-8 * found.energies["spring"][0]


def test_a_journal_meets_the_wall_where_its_body_stands_when_it_lands() -> None:
    """The wall is met along a circular path, which no interpolant of the eccentricity alone describes exactly."""
    bearing = Bearing(clearance=0.01, journal_radius=0.1, contact=PowerLaw(1e6, damping=0.1))
    spinning = ReferencePointBody("arm", 1.0, 0.1, 1.0, (0.0, 0.0), position=(-0.5, 0.0), spin=0.5)
    pin = Joint("pin", GROUND, "arm", (0.0, 0.0), (0.5, 0.0), bearing=bearing)
    simulation = Simulation(Mechanism((spinning,), (pin,)), RungeKutta(rtol=1e-9))
    # The chord 2 * 0.5 * sin(phi / 2) reaches the clearance.
    touch = 2.0 * math.asin(0.01) / 0.5
    simulation.advance(touch - 1e-9)
    assert not simulation.state.joints["in_contact"][0]
    simulation.advance(touch + 1e-9)
    assert simulation.state.joints["contact_start"][0] == pytest.approx(touch, abs=1e-12)
    assert simulation.state.joints["impact_speed"][0] == pytest.approx(0.25 * math.cos(math.asin(0.01)), rel=1e-10)


def test_its_implicit_motion_converges_to_the_explicit_one_with_order_two() -> None:
    mechanism = by_reference_points(floating_pair())

    def angles(integrator: Integrator) -> np.ndarray:
        return simulate(mechanism, 1.0, integrator=integrator, output_step=0.25).angles

    exact = angles(RungeKutta(rtol=1e-10))
    errors = [np.abs(angles(GeneralizedAlpha(step=h)) - exact).max() for h in (2e-2, 1e-2, 5e-3)]
    assert orders(errors) == pytest.approx(2.0, abs=0.05)
