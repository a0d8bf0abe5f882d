"""Global quantities: constrained accelerations, projection, energies, effective masses; and the linear algebra."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import Forces, central_difference
from mechanisms import ROUND_BEARING, Vector, block, chain, pendulum, turned

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.equations.constraints import (
    constraint_drift,
    drive_angle,
    prepare_response,
    project,
    velocity_drift,
)
from solar_env.mechanics.equations.system import accelerations, normal_inverse_mass
from solar_env.mechanics.mechanism.description import GROUND, Body, Drive, Joint, Mechanism
from solar_env.mechanics.mechanism.textbook import Link, four_bar
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation


def driven_linkage(time: float = 0.3) -> Forces:
    """Four-bar linkage with a crank driven at 2 rad/s, as it stands and moves at a time."""
    links = Link(0.4, 1.0, 0.1), Link(1.1, 2.0, 0.3), Link(0.8, 0.7, 0.05)
    linkage = four_bar(*links, ground_length=1.2, crank_rate=2.0, crank_angle=0.5)
    bodies = tuple(replace(body, centroid=(0.1, 0.05)) for body in linkage.bodies)
    return Forces(replace(linkage, bodies=bodies, drives=(Drive("crank", 0.5 - 2.0 * time, 2.0),)))


def solve(forces: Forces, time: float = 0.3) -> tuple[Vector, Vector]:
    a, multipliers = np.zeros_like(forces.state.a), np.zeros_like(forces.state.multipliers)
    state = forces.state
    assert accelerations(forces.model, state.joints, state.q, state.v, time, forces.work, a, multipliers)
    return a, multipliers


def test_accelerations_hold_the_constraints_second_derivative_at_zero_even_off_the_constraints() -> None:
    forces, q, v = disturbed(0.1)
    forces.state.q[:], forces.state.v[:] = q, v
    a, _ = solve(forces)
    h = 1e-3

    def residual(t: float) -> Vector:
        constraint_drift(forces.model, q + t * v + 0.5 * t * t * a, 0.3 + t, forces.work)
        return forces.work.residual.copy()

    second = (residual(h) - 2.0 * residual(0.0) + residual(-h)) / h**2
    # Truncation of order h^2, rounding of order eps / h^2.
    assert second == pytest.approx(0.0, abs=1e-5 * max(1.0, np.abs(a).max()))


def test_accelerations_keep_the_bodies_lengths() -> None:
    forces = driven_linkage()
    q, v = forces.state.q, forces.state.v
    a, _ = solve(forces)
    for k in range(0, q.size, 4):
        d, u, b = (x[k + 2 : k + 4] - x[k : k + 2] for x in (q, v, a))
        assert d @ b + u @ u == pytest.approx(0.0, abs=1e-12)


def test_the_multipliers_balance_the_equations_of_motion() -> None:
    forces = driven_linkage()
    q, v = forces.state.q, forces.state.v
    a, multipliers = solve(forces)
    rows = forces.constraint_rows()
    residual = forces.mass_product(a) + rows.T @ multipliers[: len(rows)]
    residual -= forces.force(q, v) + forces.model.constant_force
    for k in range(3):
        d = q[4 * k + 2 : 4 * k + 4] - q[4 * k : 4 * k + 2]
        residual[4 * k : 4 * k + 4] += multipliers[len(rows) + k] * np.concatenate([-d, d])
    # The last body is the fixed frame, which takes whatever force it is given.
    assert residual[:12] == pytest.approx(0.0, abs=1e-11 * np.abs(multipliers).max())


def test_the_drive_pays_for_the_growth_of_energy() -> None:
    forces = driven_linkage()
    v = forces.state.v
    a, _ = solve(forces)
    growth = a @ forces.mass_product(v) - forces.model.constant_force @ v
    assert forces.work.power[m.EXTERNAL_WORK] == pytest.approx(growth, rel=1e-11)


RAMPS = [(0.8, 2.0, 0.4), (3.0, -1.1, -0.2)]


def ramped(span: float, rate: float, start: float) -> np.record:
    body = Body("b", 1.0, 1.0, 1.0, (0.0, 0.0))
    return Forces(Mechanism((body,), drives=(Drive("b", start, rate, span),))).model.drives[0]


@pytest.mark.parametrize(("span", "rate", "start"), RAMPS)
def test_rate_and_acceleration_of_a_drive_are_the_slopes_of_its_angle(span: float, rate: float, start: float) -> None:
    drive = ramped(span, rate, start)
    for time in np.array([0.05, 0.3, 0.5, 0.77, 0.95, 1.3]) * span:
        slopes = central_difference(lambda t: np.array(drive_angle(drive, t[0])[:2]), np.array([time]))
        assert drive_angle(drive, time)[1:] == pytest.approx(slopes[:, 0], abs=1e-9 * abs(rate) / span)


@pytest.mark.parametrize(("span", "rate", "start"), RAMPS)
def test_a_ramp_begins_at_rest_and_joins_the_steady_rate_without_a_jump_of_acceleration(
    span: float, rate: float, start: float
) -> None:
    drive = ramped(span, rate, start)
    assert drive_angle(drive, 0.0) == pytest.approx((start, 0.0, 0.0), abs=1e-15)
    assert drive_angle(drive, span) == pytest.approx((start + 0.5 * rate * span, rate, 0.0), rel=1e-14)
    before, after = (np.array(drive_angle(drive, span * (1.0 + e))) for e in (-1e-6, 1e-6))
    # The acceleration rises from zero with the square of the time that is left.
    assert after - before == pytest.approx([2e-6 * span * rate, 0.0, 0.0], abs=1e-10)
    assert drive_angle(drive, 0.5 * span)[2] == pytest.approx(2.0 * rate / span, rel=1e-14)
    assert drive_angle(drive, 3.0 * span)[0] == pytest.approx(start + 2.5 * rate * span, rel=1e-14)


@pytest.mark.parametrize("time", [-0.1, 0.0, 0.7])
def test_a_drive_without_ramp_turns_at_its_rate_at_any_time(time: float) -> None:
    # Generalized-alpha looks before the first instant.
    assert drive_angle(ramped(0.0, 2.0, 0.4), time) == pytest.approx((0.4 + 2.0 * time, 2.0, 0.0), rel=1e-14)


def test_an_ideal_joint_carries_the_weight_that_hangs_on_it() -> None:
    body = Body("weight", 2.0, 0.3, 1.0, (0.5, 0.0), angle=-math.pi / 2)
    pin = Joint("pin", GROUND, "weight", (0.0, 0.0), (0.0, 0.0))
    loads = Simulation(Mechanism((body,), (pin,), gravity=(0.0, -9.81))).joint_loads()[0]
    assert loads[columns.FORCE_X : columns.FORCE_Y + 1] == pytest.approx([0.0, 2.0 * 9.81], abs=1e-13)
    assert loads[columns.NORMAL] == pytest.approx(2.0 * 9.81, rel=1e-14)


def test_redundant_constraints_are_reported_not_solved() -> None:
    (pin,) = pendulum().joints
    mechanism = replace(pendulum(), joints=(pin, replace(pin, name="again")))
    with pytest.raises(SimulationError, match="constraints are redundant") as caught:
        Simulation(mechanism).advance(0.1)
    assert caught.value.reason == "constraints"


def test_an_initial_position_or_velocity_off_its_constraint_is_refused_with_its_distance() -> None:
    body = Body("arm", 1.0, 1.0, 1.0, (0.5, 0.0), position=(0.1, 0.0))
    pin = Joint("pin", GROUND, "arm", (0.0, 0.0), (0.0, 0.0))
    with pytest.raises(ValueError, match=r"initial position violates a constraint by 0\.1 m"):
        Simulation(Mechanism((body,), (pin,)))
    moving = replace(body, position=(0.0, 0.0), velocity=(0.0, 0.2))
    with pytest.raises(ValueError, match=r"initial velocity violates a constraint by 0\.2 m/s"):
        Simulation(Mechanism((moving,), (pin,)))
    with pytest.raises(ValueError, match=r"initial velocity violates a constraint by 2 m/s"):
        Simulation(Mechanism((replace(moving, velocity=(0.0, 0.0)),), (pin,), drives=(Drive("arm", 0.0, 2.0),)))


def disturbed(size: float) -> tuple[Forces, Vector, Vector]:
    forces = driven_linkage()
    rng = np.random.default_rng(0)
    moving = slice(0, 12)
    q, v = forces.state.q.copy(), forces.state.v.copy()
    q[moving] += size * rng.normal(size=12)
    v[moving] += size * rng.normal(size=12)
    return forces, q, v


def project_onto_constraints(forces: Forces, q: Vector, v: Vector) -> None:
    assert prepare_response(forces.model, q, 0.3, forces.work)
    project(forces.model, q, v, 0.3, forces.work)


def test_projection_leaves_a_second_order_error() -> None:
    def remainder(size: float) -> float:
        forces, q, v = disturbed(size)
        project_onto_constraints(forces, q, v)
        lengths = [np.hypot(*(q[k + 2 : k + 4] - q[k : k + 2])) for k in (0, 4, 8)]
        stretch = np.abs(np.array(lengths) - forces.model.bodies["length"][:3]).max()
        return max(constraint_drift(forces.model, q, 0.3, forces.work), stretch)

    assert remainder(1e-4) < 1e-6
    assert remainder(1e-5) == pytest.approx(remainder(1e-4) / 100.0, rel=0.1)


def test_projected_velocities_meet_the_constraints_rates() -> None:
    forces, q, v = disturbed(1e-10)
    v[:12] += np.random.default_rng(1).normal(size=12)
    project_onto_constraints(forces, q, v)
    # Rates are met with the rows and directions of positions 1e-10 off.
    assert velocity_drift(forces.model, q, v, 0.3, forces.work) < 1e-8
    for k in (0, 4, 8):
        assert (q[k + 2 : k + 4] - q[k : k + 2]) @ (v[k + 2 : k + 4] - v[k : k + 2]) == pytest.approx(0.0, abs=1e-8)


def test_projection_is_the_smallest_change_in_the_mass_metric() -> None:
    forces, before_q, before_v = disturbed(1e-6)
    q, v = before_q.copy(), before_v.copy()
    project_onto_constraints(forces, q, v)
    # The change is orthogonal in the mass metric to every motion that the constraints allow.
    gradients = [forces.constraint_rows()]
    for k in range(3):
        d = q[4 * k + 2 : 4 * k + 4] - q[4 * k : 4 * k + 2]
        row = np.zeros((1, q.size))
        row[0, 4 * k : 4 * k + 4] = np.concatenate([-d, d])
        gradients.append(row)
    jacobian = np.vstack(gradients)[:, :12]
    _, singular, right = np.linalg.svd(jacobian)
    allowed = right[np.count_nonzero(singular > 1e-9) :]
    for change in (q - before_q, v - before_v):
        weighted = forces.mass_product(change)
        # To first order in the disturbance, 1e-6.
        assert allowed @ weighted[:12] == pytest.approx(0.0, abs=1e-5 * np.abs(weighted).max())


def test_stored_energies_are_those_of_the_textbook() -> None:
    angle = 0.7
    mechanism = pendulum(angle)
    energies = dict(zip(m.ENERGY_NAMES, Simulation(mechanism).stored_energies(), strict=True))
    height = 0.6 * math.sin(angle) + 0.1 * math.cos(angle)
    assert energies["gravity"] == pytest.approx(2.0 * 9.81 * height, rel=1e-13)
    assert energies["spring"] == pytest.approx(0.5 * 0.7 * (angle + 0.4) ** 2, rel=1e-13)
    assert [energies[name] for name in ("kinetic", "cable", "latch", "contact", "elastic")] == [0.0] * 5


def test_a_pressed_contact_stores_its_elastic_work() -> None:
    forces = Forces(block(position=(0.2, 0.0), bearing=ROUND_BEARING), impact_speed=1.0)
    assert forces.stored(forces.state.q, forces.state.v)[m.CONTACT] == pytest.approx(0.4 * 50.0 * 0.1**2.5, rel=1e-13)
    gap = Forces(block(position=(0.05, 0.0), bearing=ROUND_BEARING))
    assert gap.stored(gap.state.q, gap.state.v)[m.CONTACT] == 0.0


@pytest.mark.parametrize("seed", range(3))
def test_the_inverse_effective_mass_is_the_approach_per_unit_force_along_the_centres(seed: int) -> None:
    rng = np.random.default_rng(seed)
    direction = turned((1.0, 0.0), rng.uniform(-3.0, 3.0))
    mechanism = chain(
        rng, angles=np.array([0.4]), eccentricities=0.12 * direction[None], spring=None, stop=None, rates=0.0
    )
    forces = Forces(mechanism, impact_speed=1.0)
    q, v = forces.state.q, forces.state.v
    forces.force(q, v)
    found = normal_inverse_mass(forces.model, q, v, 0, forces.work)
    expected = 0.0
    for body, point in zip(
        mechanism.bodies, (mechanism.joints[0].inboard_point, mechanism.joints[0].outboard_point), strict=True
    ):
        arm = turned(np.array(point) - np.array(body.centroid), body.angle)
        moment = arm[0] * direction[1] - arm[1] * direction[0]
        expected += 1.0 / body.mass + moment**2 / body.inertia
    assert found == pytest.approx(expected, rel=1e-12)


def test_the_ground_has_no_compliance() -> None:
    forces = Forces(block(position=(0.2, 0.0), bearing=ROUND_BEARING), impact_speed=1.0)
    forces.force(forces.state.q, forces.state.v)
    assert normal_inverse_mass(forces.model, forces.state.q, forces.state.v, 0, forces.work) == pytest.approx(1.0)
