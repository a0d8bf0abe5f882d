"""Every kind of body of the table keeps the same promises: mass, forces, markers, slopes, energy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers import Forces, central_difference
from mechanisms import ROUND_BEARING, Vector, turned

from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import NORMAL
from solar_env.mechanics.bodies.description import AnyBody, FlexibleBody
from solar_env.mechanics.bodies.kinds import KINDS, code_of
from solar_env.mechanics.bodies.markers import add_point_force, add_torque, direction, place
from solar_env.mechanics.bodies.markers import spin as marker_spin
from solar_env.mechanics.equations.newton import fill_mass
from solar_env.mechanics.equations.system import accelerations, applied_forces
from solar_env.mechanics.equations.tangent import fill_tangents, make_tangent_scratch
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, Rosenbrock, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import GROUND, Body, Joint, Load, Mechanism, Spring
from solar_env.mechanics.numerics.profile import dense, make_profile_matrix
from solar_env.mechanics.running.simulation import simulate

POSITION, ANGLE, VELOCITY, SPIN = (0.3, -0.7), 0.8, (0.5, 0.2), -0.9
MOTION: dict[str, Any] = {"position": POSITION, "angle": ANGLE, "velocity": VELOCITY, "spin": SPIN}
# An example of each kind, in motion; points (0, 0) and (length, 0) must take parts.
EXAMPLES: dict[type[AnyBody], Any] = {
    Body: Body("example", 1.5, 0.3, 0.9, (0.4, 0.1), **MOTION),
    FlexibleBody: FlexibleBody(
        "example", 1.2, 2, 0.8, axial_stiffness=4.0, bending_stiffness=0.6, damping=0.3, **MOTION
    ),
}
ENDS = (0.0, 1.0)
each_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: type(kind).__name__)
each_end = pytest.mark.parametrize("end", ENDS, ids=["origin", "tip"])


def example(kind: Any) -> Any:
    return EXAMPLES[kind.description]


def scene(kind: Any, **parts: Any) -> Forces:
    """The example with loads at both ends, behind another body, so that no index is zero by chance."""
    body = example(kind)
    loads = (Load("example", (0.0, 0.0), (0.7, -0.4), 0.3), Load("example", (body.length, 0.0), (-0.2, 1.1), -0.8))
    first = Body("first", 2.0, 0.5, 1.1, (0.2, 0.3), velocity=(0.1, -0.2), spin=0.4)
    return Forces(Mechanism((first, body), loads=loads, gravity=(0.3, -1.7), **parts))


def disturbed(forces: Forces, seed: int = 0) -> tuple[Vector, Vector]:
    """An arbitrary configuration near the initial one, and arbitrary velocities."""
    rng = np.random.default_rng(seed)
    q = forces.state.q + 0.1 * rng.normal(size=forces.state.q.size)
    return q, rng.normal(size=q.size)


def mass_matrix(forces: Forces) -> Vector:
    return np.stack([forces.mass_product(unit) for unit in np.eye(forces.state.q.size)])


def applied(forces: Forces, q: Vector, v: Vector) -> Vector:
    """(n,) all generalized forces but the constraints'."""
    applied_forces(forces.model, forces.state.joints, q, v, forces.work)
    return np.array(forces.work.force)


def rigid_velocities(kind: Any) -> list[Vector]:
    """Velocities of the example in two translations and a turn about its origin, from where it starts."""
    motions = (((1.0, 0.0), 0.0), ((0.0, 1.0), 0.0), ((0.0, 0.0), 1.0))
    return [kind.initial_motion(replace(example(kind), velocity=v, spin=spin))[1] for v, spin in motions]


def own(forces: Forces) -> slice:
    body = forces.model.bodies[1]
    return slice(int(body["offset"]), int(body["offset"] + body["coordinates"]))


def marker_at(forces: Forces, end: float) -> Any:
    return forces.model.markers[0 if end == 0.0 else 1]


@each_kind
def test_the_kinetic_energy_is_half_the_velocity_times_the_mass_matrix_of_every_method(kind: Any) -> None:
    forces = scene(kind)
    q, v = disturbed(forces)
    matrix, elimination = mass_matrix(forces), forces.model.elimination
    of_implicit = make_profile_matrix(elimination)
    fill_mass(forces.model, of_implicit)
    assert dense(elimination, of_implicit)[: q.size, : q.size] == pytest.approx(matrix, abs=1e-15)
    assert forces.stored(q, v)[m.KINETIC] == pytest.approx(0.5 * v @ matrix @ v, rel=1e-13)
    assert matrix == pytest.approx(matrix.T, abs=1e-15)
    assert np.linalg.eigvalsh(matrix).min() > 0.0


@each_kind
def test_forces_are_minus_the_gradient_of_the_stored_energy(kind: Any) -> None:
    """Of strain, of weight, and of constant forces at the markers; torques have no potential."""
    forces = scene(kind)
    forces.model.loads["torque"] = 0.0
    q, _ = disturbed(forces)
    rest = np.zeros_like(q)

    def potential(x: Vector) -> float:
        energies = forces.stored(x, rest)
        return float(energies[m.ELASTIC] + energies[m.GRAVITY])

    found = applied(forces, q, rest)
    assert found == pytest.approx(-central_difference(potential, q), abs=1e-10 * np.abs(found).max())


@each_kind
def test_a_body_starts_as_described(kind: Any) -> None:
    forces, body = scene(kind), example(kind)
    q, v = forces.state.q, forces.state.v
    for end in ENDS:
        marker, arm = marker_at(forces, end), end * body.length * turned((1.0, 0.0), ANGLE)
        along = np.array(direction(marker, q))
        assert place(marker, q) == pytest.approx(np.array(POSITION) + arm, abs=1e-15)
        assert place(marker, v) == pytest.approx(VELOCITY + SPIN * np.array([-arm[1], arm[0]]), abs=1e-14)
        assert along / np.hypot(*along) == pytest.approx(turned((1.0, 0.0), ANGLE), abs=1e-15)
        assert marker_spin(marker, q, v) == pytest.approx(SPIN, rel=1e-14)


@each_kind
@each_end
def test_rates_of_place_and_direction_are_their_slopes_along_the_motion(kind: Any, end: float) -> None:
    forces = scene(kind)
    marker = marker_at(forces, end)
    q, v = disturbed(forces)

    def rate(function: Callable[..., Any]) -> Vector:
        return central_difference(lambda t: np.array(function(marker, q + t[0] * v)), np.zeros(1))[:, 0]

    assert place(marker, v) == pytest.approx(rate(place), abs=1e-11)
    assert direction(marker, v) == pytest.approx(rate(direction), abs=1e-11)
    turn = rate(lambda marker, x: [np.angle(complex(*direction(marker, x)))])
    assert marker_spin(marker, q, v) == pytest.approx(turn[0], abs=1e-11)


@each_kind
@each_end
def test_a_load_at_a_marker_has_the_power_of_its_generalized_force(kind: Any, end: float) -> None:
    forces = scene(kind)
    marker = marker_at(forces, end)
    q, v = disturbed(forces)
    generalized = np.zeros_like(q)
    add_point_force(marker, 0.7, -1.3, generalized)
    add_torque(marker, q, 0.4, generalized)
    ux, uy = place(marker, v)
    assert generalized @ v == pytest.approx(0.7 * ux - 1.3 * uy + 0.4 * marker_spin(marker, q, v), rel=1e-12)
    assert not generalized[: own(forces).start].any()


@each_kind
def test_weight_and_inertia_belong_to_the_same_mass(kind: Any) -> None:
    """In a uniform field a body falls freely: no part of it feels a force."""
    forces = Forces(Mechanism((example(kind),), gravity=(0.3, -1.7)))
    fall = np.tensordot([0.3, -1.7], rigid_velocities(kind)[:2], axes=1)
    assert forces.mass_product(fall) == pytest.approx(forces.model.constant_force, abs=1e-14)


@each_kind
def test_accelerations_balance_the_applied_forces(kind: Any) -> None:
    forces = scene(kind)
    state, model = forces.state, forces.model
    q, v = (state.q, state.v) if kind.constraints else disturbed(forces)
    a = np.zeros_like(q)
    assert accelerations(model, state.joints, q, v, 0.0, forces.work, a, state.multipliers)
    left = (applied(forces, q, v) - forces.mass_product(a))[own(forces)]
    scale = np.abs(forces.work.force).max()
    # A constraint of its own is ideal: it does no work in a rigid motion.
    directions = rigid_velocities(kind) if kind.constraints else np.eye(left.size)
    assert np.asarray(directions) @ left == pytest.approx(0.0, abs=1e-13 * scale)


@each_kind
def test_internal_forces_change_neither_momentum_nor_spin(kind: Any) -> None:
    forces = Forces(Mechanism((example(kind),)))
    q, v = disturbed(forces)
    assert kind.rigid_motions(q) @ applied(forces, q, v) == pytest.approx(0.0, abs=1e-13)


def coupled(kind: Any) -> Forces:
    """The example's tip pressed against the bearing of another body, with a spring and loads."""
    body = example(kind)
    bearing = replace(ROUND_BEARING, contact=PowerLaw(50.0, damping=0.05), friction_speeds=(0.0, 50.0))
    tip = np.array(POSITION) + turned((body.length, 0.0), ANGLE)
    inboard = tuple((tip - np.array([0.09, 0.08])).tolist())
    joint = Joint("pin", "first", "example", inboard, (body.length, 0.0), bearing=bearing, spring=Spring(1.3, 0.7))
    forces = scene(kind, joints=(joint,))
    forces.work.impact_speeds[:] = 0.5
    return forces


@each_kind
def test_slopes_for_implicit_methods_are_those_of_the_forces(kind: Any) -> None:
    forces = coupled(kind)
    model, elimination, n = forces.model, forces.model.elimination, forces.state.q.size
    q, v = forces.state.q.copy(), 0.2 * disturbed(forces)[1]
    expected = [
        -central_difference(lambda x: applied(forces, x, v), q, 1e-4),
        -central_difference(lambda x: applied(forces, q, x), v, 1e-4),
    ]
    applied(forces, q, v)
    assert forces.work.loads[0, NORMAL] > 0.0
    parts = [make_profile_matrix(elimination) for _ in range(2)]
    fill_tangents(model, forces.state.joints, q, v, make_tangent_scratch(forces.work), *parts)
    for part, reference in zip(parts, expected, strict=True):
        found = dense(elimination, part)[:n, :n]
        assert found == pytest.approx(reference, abs=1e-8 * np.abs(reference).max())


@each_kind
def test_the_centreline_leads_from_one_end_to_the_other(kind: Any) -> None:
    forces = scene(kind)
    q, _ = disturbed(forces)
    line = centreline(forces.model, q, 1)
    for end, point in zip(ENDS, line[[0, -1]], strict=True):
        if kind.constraints == 0:
            assert point == pytest.approx(place(marker_at(forces, end), q), abs=1e-15)
    assert not np.shares_memory(line, q)
    assert centreline(forces.model, np.stack([q, 2.0 * q]), 1)[0] == pytest.approx(line, abs=0.0)


@each_kind
@pytest.mark.parametrize(
    "integrator",
    [RungeKutta(rtol=1e-7), Rosenbrock(rtol=1e-6), GeneralizedAlpha(step=1e-3)],
    ids=lambda integrator: integrator.name,
)
def test_every_method_moves_a_body_that_bounces_in_a_bearing(kind: Any, integrator: Integrator) -> None:
    bearing = replace(ROUND_BEARING, minimum_impact_speed=1e-3)
    body = replace(example(kind), position=(0.0, 0.0))
    joint = Joint("pin", GROUND, "example", (0.0, 0.0), (0.0, 0.0), bearing=bearing, spring=Spring(1.3, 0.7))
    mechanism = Mechanism((body,), (joint,), loads=(Load("example", (body.length, 0.0), (0.2, -0.4), 0.1),))
    reference = simulate(mechanism, 1.0, integrator=RungeKutta(rtol=1e-9), output_step=0.1)
    found = simulate(mechanism, 1.0, integrator=integrator, output_step=0.1)
    assert found.contact_starts[0] >= 1
    assert found.angles == pytest.approx(reference.angles, abs=2e-3)
    assert found.eccentricity == pytest.approx(reference.eccentricity, abs=2e-3)
    assert np.abs(found.energies["residual"]).max() < 3e-3


def test_a_body_of_no_kind_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ValueError, match="body 'ghost' is a AnyBody; describe it as one of Body, FlexibleBody"):
        code_of(AnyBody("ghost"))
