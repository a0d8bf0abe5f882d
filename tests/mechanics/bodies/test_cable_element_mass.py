"""Mass, weight, vibration and attachments of beams of cable elements."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from cable_beams import BEAM, RIGID, mass_matrix, quarter_turns, straight, translation
from mechanisms import Vector, turned

from solar_env.mechanics.bodies.cable_element.element import add_mass_product, kinetic_energy, solve_mass
from solar_env.mechanics.bodies.markers import direction, place
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.mechanism.description import GROUND, Drive, Joint, Load, Mechanism, Point


def hermite(elements: int, length: float, points: int) -> tuple[Vector, np.ndarray]:
    """Quadrature weights and shape functions (points, nodal values) of a beam, by polynomial fit."""
    gauss, weights = np.polynomial.legendre.leggauss(points)
    step = length / elements
    quadrature = []
    shapes = np.zeros((elements * points, 2 * (elements + 1)))
    # Cubics whose values and slopes at both ends are the unit vectors.
    conditions = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [1, step, step**2, step**3], [0, 1, 2 * step, 3 * step**2]])
    cubics = np.linalg.inv(conditions)
    for e in range(elements):
        s = 0.5 * step * (gauss + 1.0)
        quadrature.append(0.5 * step * weights)
        powers = np.stack([s**k for k in range(4)], axis=1)
        shapes[e * points : (e + 1) * points, 2 * e : 2 * e + 4] = powers @ cubics
    return np.concatenate(quadrature), shapes


@pytest.mark.parametrize("elements", [1, 2, 5, 12])
def test_the_mass_matrix_is_the_quadrature_of_the_shape_functions(elements: int) -> None:
    scene = straight(replace(BEAM, elements=elements))
    # Products of cubics: four Gauss points are exact.
    weights, shapes = hermite(elements, BEAM.length, 4)
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


@pytest.mark.parametrize("elements", [1, 2, 5, 12])
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
@pytest.mark.parametrize("part", ["bearing", "journal", "drive", "load"])
def test_an_attachment_off_the_nodes_is_refused_with_the_nodes(part: str, place: Point) -> None:
    attached: dict[str, Any] = {
        "bearing": {"joints": (Joint("pin", "beam", "rigid", place, (0.0, 0.0)),)},
        "journal": {"joints": (Joint("pin", GROUND, "beam", (0.0, 0.0), place),)},
        "drive": {"drives": (Drive("beam", 0.0, 1.0, point=place),)},
        "load": {"loads": (Load("beam", place, (1.0, 0.0)),)},
    }[part]
    with pytest.raises(ValueError, match=r"is not a node of flexible body 'beam'; its nodes are \(k \* 0\.566667, 0\)"):
        compile_mechanism(Mechanism((RIGID, BEAM), **attached))
