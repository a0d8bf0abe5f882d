"""Beams of cable elements: elastic forces against their energy, slopes against differences, mass against shapes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest
from helpers import Vector, central_difference, orders, turned
from scipy.linalg import eigh

from solar_env.mechanics.arrays.model import Model
from solar_env.mechanics.bodies.cable_element.element import (
    add_mass_matrix,
    add_mass_product,
    kinetic_energy,
    solve_mass,
)
from solar_env.mechanics.bodies.cable_element.forces import LANES, TABLE_ROWS, add_elastic_forces
from solar_env.mechanics.bodies.cable_element.matrices import stiffness_matrix
from solar_env.mechanics.bodies.cable_element.tangent import add_elastic_tangents, make_element_slopes
from solar_env.mechanics.bodies.dispatch import elastic_energy
from solar_env.mechanics.bodies.markers import direction, place
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.mechanism.description import (
    GROUND,
    Body,
    Drive,
    FlexibleBody,
    Guide,
    Joint,
    Load,
    Mechanism,
    Point,
)
from solar_env.mechanics.numerics.profile import dense, make_profile_matrix

SEEDS = range(4)
# Lengths, stiffnesses and speeds of the order of one: differences lose no digits to scale.
BEAM = FlexibleBody("beam", 1.7, 3, linear_density=0.8, axial_stiffness=5.0, bending_stiffness=0.6, damping=0.3)
RIGID = Body("rigid", 1.0, 0.1, 1.0, (0.3, 0.1), angle=0.2)


class Scene(NamedTuple):
    """A beam in a state of motion; a rigid body comes before it in the arrays, so that no offset is zero."""

    model: Model
    beam: np.record
    q: Vector
    v: Vector

    @property
    def own(self) -> slice:
        return slice(self.beam.offset, len(self.q))


def straight(beam: FlexibleBody = BEAM) -> Scene:
    model, state = compile_mechanism(Mechanism((RIGID, beam)))
    return Scene(model, model.bodies[1], state.q, state.v)


def deformed(seed: int, beam: FlexibleBody = BEAM) -> Scene:
    """A beam somewhere, stretched and bent by some ten percent, in an arbitrary motion."""
    rng = np.random.default_rng(seed)
    scene = straight(replace(beam, position=tuple(rng.normal(size=2).tolist()), angle=float(rng.uniform(-3.0, 3.0))))
    size = len(scene.q) - scene.beam.offset
    scene.q[scene.own] += 0.1 * rng.normal(size=size)
    scene.v[scene.own] = rng.normal(size=size)
    return scene


def elastic_forces(model: Model, q: Vector, v: Vector, force: Vector) -> float:
    """Add all internal forces to `force`; returns the power of damping. The scratch holds what came before."""
    return float(add_elastic_forces(model.cable_elements, q, v, force, np.full(TABLE_ROWS * LANES, 7.0)))


def internal_force(scene: Scene, q: Vector | None = None, v: Vector | None = None) -> Vector:
    """Generalized force on the beam's own coordinates."""
    force = np.zeros_like(scene.q)
    elastic_forces(scene.model, scene.q if q is None else q, scene.v if v is None else v, force)
    assert not force[: scene.beam.offset].any()
    return force[scene.own]


def damping_power(scene: Scene) -> float:
    return elastic_forces(scene.model, scene.q, scene.v, np.zeros_like(scene.q))


def quarter_turns(x: Vector) -> Vector:
    """Every pair of coordinates turned by a right angle."""
    return np.stack([-x[1::2], x[0::2]], axis=1).ravel()


def translation(scene: Scene, axis: int) -> Vector:
    """Velocities of all the beam's coordinates when it moves along an axis: the slopes stay."""
    field = np.zeros_like(scene.q)
    field[scene.beam.offset + axis :: 4] = 1.0
    return field


def mass_matrix(scene: Scene) -> np.ndarray:
    """Of the beam's own coordinates, column by column from the product."""
    columns = []
    for unit in np.eye(len(scene.q))[scene.own]:
        out = np.zeros_like(unit)
        add_mass_product(scene.beam, scene.model.body_constants, unit, out)
        assert not out[: scene.beam.offset].any()
        columns.append(out[scene.own])
    return np.array(columns).T


def tangent(scene: Scene, stiffness_weight: float, damping_weight: float) -> np.ndarray:
    """Weighted slopes of the internal force (which resists) of the beam's own coordinates."""
    elimination = scene.model.elimination
    parts = [make_profile_matrix(elimination) for _ in range(2)]
    slopes = make_element_slopes()
    for array in slopes:
        array[:] = math.nan
    add_elastic_tangents(scene.model.cable_elements, scene.q, scene.v, slopes, elimination, *parts)
    stiffness, damping = (dense(elimination, part)[scene.own, scene.own] for part in parts)
    return stiffness_weight * stiffness + damping_weight * damping


def hermite(elements: int, length: float, points: int) -> tuple[Vector, Vector, np.ndarray]:
    """Arc lengths, quadrature weights and shape functions (points, nodal values) of a beam, by polynomial fit."""
    gauss, weights = np.polynomial.legendre.leggauss(points)
    step = length / elements
    arcs, quadrature = [], []
    shapes = np.zeros((elements * points, 2 * (elements + 1)))
    # Cubics whose values and slopes at both ends are the unit vectors.
    conditions = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [1, step, step**2, step**3], [0, 1, 2 * step, 3 * step**2]])
    cubics = np.linalg.inv(conditions)
    for e in range(elements):
        s = 0.5 * step * (gauss + 1.0)
        arcs.append(e * step + s)
        quadrature.append(0.5 * step * weights)
        powers = np.stack([s**k for k in range(4)], axis=1)
        shapes[e * points : (e + 1) * points, 2 * e : 2 * e + 4] = powers @ cubics
    return np.concatenate(arcs), np.concatenate(quadrature), shapes


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("elements", [1, 2, 5])
def test_the_elastic_force_is_minus_the_slope_of_the_elastic_energy(elements: int, seed: int) -> None:
    scene = deformed(seed, replace(BEAM, elements=elements, damping=0.0))
    slope = central_difference(lambda q: elastic_energy(scene.model.bodies, q), scene.q)
    assert np.abs(slope[scene.own]).max() > 0.1
    assert internal_force(scene) == pytest.approx(-slope[scene.own], abs=1e-9 * np.abs(slope).max())
    assert not slope[: scene.beam.offset].any()


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("elements", [1, 2, 5])
def test_the_tangent_of_a_body_is_the_slope_of_its_force(elements: int, seed: int) -> None:
    scene = deformed(seed, replace(BEAM, elements=elements))
    by_q = central_difference(lambda q: internal_force(scene, q=q), scene.q)[:, scene.own]
    by_v = central_difference(lambda v: internal_force(scene, v=v), scene.v)[:, scene.own]
    scale = max(np.abs(by_q).max(), np.abs(by_v).max())
    assert tangent(scene, 1.0, 0.0) == pytest.approx(-by_q, abs=1e-8 * scale)
    assert tangent(scene, 0.0, 1.0) == pytest.approx(-by_v, abs=1e-8 * scale)
    assert tangent(scene, 0.3, -2.0) == pytest.approx(-0.3 * by_q + 2.0 * by_v, abs=1e-8 * scale)


def test_the_tangent_of_the_straight_beam_is_its_stiffness_matrix() -> None:
    scene = straight(replace(BEAM, angle=0.0))
    found = tangent(scene, 1.0, 0.0)
    shape = (BEAM.elements, BEAM.length / BEAM.elements)
    axial = stiffness_matrix(*shape, BEAM.axial_stiffness, 0.0)
    bending = stiffness_matrix(*shape, 0.0, BEAM.bending_stiffness)
    scale = np.abs(found).max()
    assert found[0::2, 0::2] == pytest.approx(axial, abs=1e-14 * scale)
    assert found[1::2, 1::2] == pytest.approx(bending, abs=1e-14 * scale)
    assert not np.abs(found[0::2, 1::2]).max() > 1e-15 * scale
    assert stiffness_matrix(*shape, BEAM.axial_stiffness, BEAM.bending_stiffness) == pytest.approx(
        axial + bending, abs=1e-14 * scale
    )


@pytest.mark.parametrize("angle", [0.0, 0.8, 2.0, -3.0])
@pytest.mark.parametrize("spin", [0.0, 40.0])
def test_no_rigid_motion_however_large_strains_the_beam(angle: float, spin: float) -> None:
    beam = replace(BEAM, position=(30.0, -20.0), angle=angle, velocity=(5.0, 7.0), spin=spin)
    scene = straight(beam)
    # Node positions of some 30 are known to 4e-15, strains to 2e-14, damped strain rates to 40 times that.
    rounding = 1e-12
    assert elastic_energy(scene.model.bodies, scene.q) == pytest.approx(0.0, abs=BEAM.axial_stiffness * rounding**2)
    assert internal_force(scene) == pytest.approx(0.0, abs=3.0 * BEAM.axial_stiffness * rounding)
    assert damping_power(scene) == pytest.approx(0.0, abs=BEAM.axial_stiffness * rounding**2)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("angle", [0.3, -2.5])
def test_a_bent_beam_that_is_turned_and_carried_along_feels_the_same(angle: float, seed: int) -> None:
    scene = deformed(seed)
    q, v = scene.q.copy(), scene.v.copy()
    for x in (q, v):
        for k in range(0, len(x), 2):
            x[k : k + 2] = turned(x[k : k + 2], angle)
    q += 0.4 * translation(scene, 0) - 0.9 * translation(scene, 1)
    # On top of the beam's own motion, a rotation about the origin and a translation.
    v += 1.7 * quarter_turns(q) + 0.6 * translation(scene, 0)
    moved = scene._replace(q=q, v=v)
    energy = elastic_energy(scene.model.bodies, scene.q)
    assert elastic_energy(scene.model.bodies, q) == pytest.approx(energy, rel=1e-12)
    assert damping_power(moved) == pytest.approx(damping_power(scene), rel=1e-12)
    expected = np.array([turned(f, angle) for f in internal_force(scene).reshape(-1, 2)]).ravel()
    assert internal_force(moved) == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("seed", SEEDS)
def test_internal_forces_change_neither_linear_nor_angular_momentum(seed: int) -> None:
    scene = deformed(seed)
    force = internal_force(scene)
    for field in (translation(scene, 0), translation(scene, 1), quarter_turns(scene.q)):
        rounding = 1e-14 * float(np.abs(force) @ np.abs(field[scene.own]))
        assert force @ field[scene.own] == pytest.approx(0.0, abs=rounding)


@pytest.mark.parametrize("seed", range(10))
def test_damping_takes_the_power_of_its_force_and_never_gives(seed: int) -> None:
    damped = deformed(seed)
    undamped = deformed(seed, replace(BEAM, damping=0.0))
    assert np.array_equal(damped.v, undamped.v)
    viscous = internal_force(damped) - internal_force(undamped)
    power = damping_power(damped)
    assert power == pytest.approx(-viscous @ damped.v[damped.own], rel=1e-12)
    assert power > 0.0
    assert damping_power(undamped) == 0.0


def test_a_uniform_stretch_stores_half_the_stiffness_times_strain_squared() -> None:
    scene = straight()
    origin = np.tile([*BEAM.position, 0.0, 0.0], BEAM.elements + 1)
    scene.q[scene.own] = origin + 1.2 * (scene.q[scene.own] - origin)
    expected = 0.5 * BEAM.axial_stiffness * 0.2**2 * BEAM.length
    assert elastic_energy(scene.model.bodies, scene.q) == pytest.approx(expected, rel=1e-13)
    # Held by the end forces alone: E A times the strain.
    force = internal_force(scene)
    assert force[0] == pytest.approx(0.2 * BEAM.axial_stiffness, rel=1e-13)
    assert force[4:8] == pytest.approx(0.0, abs=1e-14)


def ring_energy(elements: int) -> float:
    """Of a beam whose nodes lie on a circle of circumference four times its length, unstretched."""
    beam = replace(BEAM, elements=elements)
    scene = straight(beam)
    turn = np.linspace(0.0, math.pi / 2, elements + 1)
    radius = beam.length / (math.pi / 2)
    nodes = [radius * np.sin(turn), radius * (1.0 - np.cos(turn)), np.cos(turn), np.sin(turn)]
    scene.q[scene.own] = np.stack(nodes, axis=1).ravel()
    return float(elastic_energy(scene.model.bodies, scene.q))


def test_a_beam_bent_to_an_arc_stores_half_the_stiffness_times_curvature_squared() -> None:
    expected = 0.5 * BEAM.bending_stiffness * (math.pi / 2 / BEAM.length) ** 2 * BEAM.length
    errors = [abs(ring_energy(n) / expected - 1.0) for n in (2, 4, 8, 16)]
    assert errors[-1] < 1e-5
    # Cubics miss the curvature of an arc by h^2, its square integrated by h^4.
    assert np.all(np.abs(orders(errors)[1:] - 4.0) < 0.2)


@pytest.mark.parametrize("elements", [1, 2, 4])
def test_a_cantilever_bends_as_eulers_and_bernoullis(elements: int) -> None:
    scene = straight(replace(BEAM, elements=elements, angle=0.0))
    # The wall holds position and direction, not the stretch.
    free = np.array([2, *range(4, 4 * (elements + 1))])
    compliance = np.linalg.inv(tangent(scene, 1.0, 0.0)[np.ix_(free, free)])
    tip = compliance[-4:, -4:]
    L, EA, EI = BEAM.length, BEAM.axial_stiffness, BEAM.bending_stiffness
    # Cubics solve a beam without distributed load exactly: x, y, slope's length and direction at the tip.
    assert tip[0, 0] == pytest.approx(L / EA, rel=1e-11)
    assert tip[1, 1] == pytest.approx(L**3 / (3.0 * EI), rel=1e-11)
    assert tip[3, 1] == pytest.approx(L**2 / (2.0 * EI), rel=1e-11)
    assert tip[3, 3] == pytest.approx(L / EI, rel=1e-11)


@pytest.mark.parametrize("elements", range(1, 13))
def test_the_mass_matrix_is_the_quadrature_of_the_shape_functions(elements: int) -> None:
    scene = straight(replace(BEAM, elements=elements))
    # Products of cubics: four Gauss points are exact.
    _, weights, shapes = hermite(elements, BEAM.length, 4)
    expected = np.kron(BEAM.linear_density * shapes.T @ (weights[:, None] * shapes), np.eye(2))
    assert mass_matrix(scene) == pytest.approx(expected, abs=1e-14 * np.abs(expected).max())
    assert kinetic_energy(scene.beam, scene.model.body_constants, scene.v) == 0.0
    scene.v[:] = np.random.default_rng(elements).normal(size=scene.v.size)
    v = scene.v[scene.own]
    assert kinetic_energy(scene.beam, scene.model.body_constants, scene.v) == pytest.approx(
        0.5 * v @ expected @ v, rel=1e-13
    )


def test_a_beam_that_moves_rigidly_has_the_momenta_and_energy_of_a_rod() -> None:
    beam = replace(BEAM, position=(0.4, -1.0), angle=0.7, velocity=(0.3, -0.8), spin=2.1)
    scene = straight(beam)
    mass, inertia = beam.linear_density * beam.length, beam.linear_density * beam.length**3 / 12.0
    arm = 0.5 * beam.length * turned((1.0, 0.0), beam.angle)
    centre = np.array(beam.position) + arm
    velocity = np.array(beam.velocity) + beam.spin * np.array([-arm[1], arm[0]])
    momentum = mass_matrix(scene) @ scene.v[scene.own]
    found = [momentum @ field[scene.own] for field in (translation(scene, 0), translation(scene, 1))]
    assert found == pytest.approx(mass * velocity, rel=1e-13)
    spin = mass * (centre[0] * velocity[1] - centre[1] * velocity[0]) + inertia * beam.spin
    assert momentum @ quarter_turns(scene.q)[scene.own] == pytest.approx(spin, rel=1e-12)
    energy = 0.5 * mass * velocity @ velocity + 0.5 * inertia * beam.spin**2
    assert kinetic_energy(scene.beam, scene.model.body_constants, scene.v) == pytest.approx(energy, rel=1e-13)


@pytest.mark.parametrize("elements", range(1, 13))
def test_solving_the_mass_matrix_inverts_its_product(elements: int) -> None:
    scene = straight(replace(BEAM, elements=elements))
    rng = np.random.default_rng(elements)
    a, force = rng.normal(size=scene.q.size), np.zeros_like(scene.q)
    add_mass_product(scene.beam, scene.model.body_constants, a, force)
    solved = np.full_like(a, 7.0)
    solve_mass(scene.beam, scene.model.body_constants, force, solved)
    rounding = 1e-15 * np.linalg.cond(mass_matrix(scene))
    assert solved[scene.own] == pytest.approx(a[scene.own], abs=rounding)
    # Other bodies' coordinates are left alone.
    assert np.all(solved[: scene.beam.offset] == 7.0)


def test_products_are_added_to_what_is_there() -> None:
    scene = deformed(0)
    out, force = np.ones_like(scene.q), np.ones_like(scene.q)
    add_mass_product(scene.beam, scene.model.body_constants, scene.v, out)
    assert out[scene.own] == pytest.approx(1.0 + mass_matrix(scene) @ scene.v[scene.own], rel=1e-13)
    elastic_forces(scene.model, scene.q, scene.v, force)
    assert force[scene.own] == pytest.approx(1.0 + internal_force(scene), rel=1e-13)


def test_the_mass_part_of_newtons_matrix_is_the_weighted_mass_matrix() -> None:
    scene = straight()
    elimination = scene.model.elimination
    matrix = make_profile_matrix(elimination)
    add_mass_matrix(scene.beam, scene.model.body_constants, 0.7, elimination, matrix)
    found = dense(elimination, matrix)
    assert found[scene.own, scene.own] == pytest.approx(0.7 * mass_matrix(scene), rel=1e-14)
    found[scene.own, scene.own] = 0.0
    assert not found.any()


def test_two_beams_keep_to_their_own_rows() -> None:
    other = replace(BEAM, name="other", elements=5, linear_density=3.0, position=(0.0, 4.0))
    model, state = compile_mechanism(Mechanism((BEAM, other)))
    alone, _ = compile_mechanism(Mechanism((other,)))
    a = np.random.default_rng(0).normal(size=state.q.size)
    first = model.bodies["offset"][1]
    expected, found = np.zeros(len(a) - first), np.zeros_like(a)
    add_mass_product(alone.bodies[0], alone.body_constants, a[first:].copy(), expected)
    add_mass_product(model.bodies[1], model.body_constants, a, found)
    assert found[first:].tolist() == expected.tolist()
    solve_mass(alone.bodies[0], alone.body_constants, a[first:].copy(), expected)
    solve_mass(model.bodies[1], model.body_constants, a, found)
    assert found[first:].tolist() == expected.tolist()
    assert not found[:first].any()


@pytest.mark.parametrize(
    "counts", [(1, 2), (LANES - 1, 3), (LANES, 1), (1, 2 * LANES + 1, 5)], ids=lambda counts: "+".join(map(str, counts))
)
def test_the_forces_of_many_elements_are_those_of_each_beam_alone(counts: tuple[int, ...]) -> None:
    # Elements are worked out in blocks, across the borders of bodies.
    beams = [
        replace(BEAM, name=str(n), elements=n, axial_stiffness=3.0 + n, bending_stiffness=1.0 / n, damping=0.1 * n)
        for n in counts
    ]
    model, state = compile_mechanism(Mechanism((RIGID, *beams)))
    rng = np.random.default_rng(0)
    q, v = state.q + 0.01 * rng.normal(size=state.q.size), rng.normal(size=state.q.size)
    found, power = np.zeros_like(q), 0.0
    total = elastic_forces(model, q, v, found)
    assert not found[:4].any()
    for beam, body in zip(beams, model.bodies[1:], strict=True):
        alone, _ = compile_mechanism(Mechanism((beam,)))
        own = slice(body["offset"], body["offset"] + 4 * (beam.elements + 1))
        expected = np.zeros(4 * (beam.elements + 1))
        power += elastic_forces(alone, q[own].copy(), v[own].copy(), expected)
        assert found[own] == pytest.approx(expected, abs=1e-13 * np.abs(expected).max())
    assert total == pytest.approx(power, rel=1e-13)


# Roots of cos x cosh x = 1.
FREE_FREE = (4.730040744862704, 7.853204624095838, 10.995607838001671)


@pytest.mark.parametrize("elements", [6, 12])
def test_a_free_beam_vibrates_at_the_frequencies_of_the_textbook(elements: int) -> None:
    beam = replace(BEAM, elements=elements)
    scene = straight(beam)
    squares = eigh(tangent(scene, 1.0, 0.0), mass_matrix(scene), eigvals_only=True)
    # Two translations and a turn cost nothing.
    assert squares[:3] == pytest.approx(0.0, abs=1e-13 * squares[-1])
    L, density = beam.length, beam.linear_density
    bending = np.square(FREE_FREE) * math.sqrt(beam.bending_stiffness / density) / L**2
    axial = np.arange(1, 3) * math.pi * math.sqrt(beam.axial_stiffness / density) / L
    found = np.sqrt(squares[3:])
    for expected in (*bending, *axial):
        # An error of (wave number * element length)^4 / 720 and less.
        number = max(FREE_FREE) / elements
        assert np.abs(found / expected - 1.0).min() < number**4 / 720.0


@pytest.mark.parametrize("angle", [0.0, 1.0, -2.5])
def test_nodes_stand_and_move_as_described(angle: float) -> None:
    beam = replace(BEAM, position=(1.0, -1.0), angle=angle, velocity=(0.1, 0.2), spin=3.0)
    scene = straight(beam)
    along, across = turned((1.0, 0.0), angle), turned((0.0, 1.0), angle)
    nodes, rates = scene.q[scene.own].reshape(-1, 4), scene.v[scene.own].reshape(-1, 4)
    for k, arc in enumerate(np.linspace(0.0, beam.length, beam.elements + 1)):
        assert nodes[k] == pytest.approx([*(np.array(beam.position) + arc * along), *along], abs=1e-15)
        assert rates[k] == pytest.approx([*(np.array(beam.velocity) + 3.0 * arc * across), *(3.0 * across)], abs=2e-15)


@pytest.mark.parametrize("node", range(BEAM.elements + 1))
def test_a_part_attached_to_a_node_moves_and_turns_with_it(node: int) -> None:
    spot = (node * BEAM.length / BEAM.elements, 0.0)
    model, state = compile_mechanism(Mechanism((RIGID, BEAM), loads=(Load("beam", spot, torque=1.0),)))
    q = np.random.default_rng(node).normal(size=state.q.size)
    marker = model.markers[0]
    own = q[4 + 4 * node : 8 + 4 * node]
    assert [*place(marker, q), *direction(marker, q)] == own.tolist()


STEP = BEAM.length / BEAM.elements
OFF_NODE: dict[str, Point] = {
    "between nodes": (0.5 * STEP, 0.0),
    "beside a node": (STEP, 1e-6),
    "before the first": (-STEP, 0.0),
    "behind the last": (BEAM.length + STEP, 0.0),
    "almost at a node": (STEP * (1.0 + 1e-6), 0.0),
}


@pytest.mark.parametrize("place", OFF_NODE.values(), ids=OFF_NODE.keys())
@pytest.mark.parametrize("part", ["bearing", "journal", "guide", "drive", "load"])
def test_an_attachment_off_the_nodes_is_refused_with_the_nodes(part: str, place: Point) -> None:
    attached: dict[str, Any] = {
        "bearing": {"joints": (Joint("pin", "beam", "rigid", place, (0.0, 0.0)),)},
        "journal": {"joints": (Joint("pin", GROUND, "beam", (0.0, 0.0), place),)},
        "guide": {"guides": (Guide("beam", place, (0.0, 1.0)),)},
        "drive": {"drives": (Drive("beam", 0.0, 1.0, point=place),)},
        "load": {"loads": (Load("beam", place, (1.0, 0.0)),)},
    }[part]
    with pytest.raises(ValueError, match=r"is not a node of flexible body 'beam'; its nodes are \(k \* 0\.566667, 0\)"):
        compile_mechanism(Mechanism((RIGID, BEAM), **attached))


def test_the_weight_of_a_beam_is_that_of_its_shape_functions() -> None:
    model, _ = compile_mechanism(Mechanism((RIGID, BEAM), gravity=(0.3, -9.81)))
    _, weights, shapes = hermite(BEAM.elements, BEAM.length, 4)
    expected = np.outer(BEAM.linear_density * shapes.T @ weights, (0.3, -9.81)).ravel()
    assert model.constant_force[4:] == pytest.approx(expected, abs=1e-14)
