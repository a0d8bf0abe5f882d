"""Beams of cable elements: elastic forces against their energy, slopes against differences, many beams side by side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cable_beams import (
    BEAM,
    RIGID,
    damping_power,
    deformed,
    elastic_forces,
    internal_force,
    quarter_turns,
    straight,
    tangent,
    translation,
)
from mechanisms import turned

from solar_env.mechanics.bodies.cable_element.forces import LANES
from solar_env.mechanics.bodies.cable_element.matrices import stiffness_matrix
from solar_env.mechanics.bodies.dispatch import elastic_energy
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.mechanism.description import Mechanism

SEEDS = range(3)


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
