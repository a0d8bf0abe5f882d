"""Rigid bodies in natural coordinates, against Newton and Euler and against clouds of point masses."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from helpers import Forces
from mechanisms import Vector, turned

from solar_env.mechanics.bodies.natural_coordinates import (
    inverse_mass_parameters,
    kinetic_energy,
    mass_parameters,
    solve_body,
)
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.equations.system import accelerations
from solar_env.mechanics.mechanism.description import Body, Load, Mechanism

TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


class Example(NamedTuple):
    """A body of arbitrary centroid in an arbitrary motion."""

    body: Body
    rows: np.ndarray
    q: Vector
    v: Vector
    centroid: Vector  # position
    mass_matrix: np.ndarray


def blocks(m11: float, m22: float, m12: float, n12: float) -> np.ndarray:
    coupling = m12 * np.eye(2) + n12 * TURN
    return np.block([[m11 * np.eye(2), coupling], [coupling.T, m22 * np.eye(2)]])


@pytest.fixture(params=range(3))
def example(request: pytest.FixtureRequest) -> Example:
    rng = np.random.default_rng(request.param)
    body = Body(
        "b",
        mass=float(rng.uniform(0.1, 10.0)),
        inertia=float(rng.uniform(0.1, 10.0)),
        length=float(rng.uniform(0.3, 3.0)),
        centroid=tuple(rng.normal(size=2).tolist()),
        position=tuple(rng.normal(size=2).tolist()),
        angle=float(rng.uniform(-3.0, 3.0)),
        velocity=tuple(rng.normal(size=2).tolist()),
        spin=float(rng.normal()),
    )
    model, state = compile_mechanism(Mechanism((body,)))
    centroid = state.q[:2] + turned(body.centroid, body.angle)
    matrix = blocks(*mass_parameters(body.mass, body.inertia, body.length, body.centroid))
    return Example(body, model.bodies, state.q, state.v, centroid, matrix)


def rigid_fields(q: Vector) -> np.ndarray:
    """Velocities (3, 4) of the base points in two translations and a rotation about the origin."""
    return np.array([[1, 0, 1, 0], [0, 1, 0, 1], [-q[1], q[0], -q[3], q[2]]], dtype=float)


def test_the_kinetic_energy_is_that_of_translation_and_rotation(example: Example) -> None:
    body = example.body
    arm = example.centroid - example.q[:2]
    velocity = np.array(body.velocity) + body.spin * TURN @ arm
    expected = 0.5 * body.mass * velocity @ velocity + 0.5 * body.inertia * body.spin**2
    assert kinetic_energy(example.rows[0], example.v) == pytest.approx(expected, rel=1e-13)


def test_the_mass_matrix_times_its_inverse_is_the_identity(example: Example) -> None:
    inverse = blocks(*inverse_mass_parameters(*(example.rows[name][0] for name in ("m11", "m22", "m12", "n12"))))
    assert example.mass_matrix @ inverse == pytest.approx(np.eye(4), abs=1e-13 * np.linalg.cond(example.mass_matrix))


def test_momentum_read_through_the_mass_matrix_is_newtons(example: Example) -> None:
    body = example.body
    p = rigid_fields(example.q) @ example.mass_matrix @ example.v
    velocity = np.array(body.velocity) + body.spin * TURN @ (example.centroid - example.q[:2])
    assert p[:2] == pytest.approx(body.mass * velocity, rel=1e-12)
    moment = body.mass * (example.centroid[0] * velocity[1] - example.centroid[1] * velocity[0])
    assert p[2] == pytest.approx(moment + body.inertia * body.spin, rel=1e-12)


def test_the_solved_acceleration_is_that_of_newton_and_euler(example: Example) -> None:
    body, q = example.body, example.q
    a, force = np.zeros(4), np.random.default_rng(6).normal(size=4)
    solve_body(example.rows[0], q, example.v, force, a, 1.0)
    total = force[:2] + force[2:]
    moment = sum(
        (p - example.centroid)[0] * f[1] - (p - example.centroid)[1] * f[0]
        for p, f in ((q[:2], force[:2]), (q[2:], force[2:]))
    )
    alpha = moment / body.inertia
    # Of the first base point: centroid's, plus rotation about it.
    arm = q[:2] - example.centroid
    expected = total / body.mass + alpha * TURN @ arm - body.spin**2 * arm
    assert a[:2] == pytest.approx(expected, rel=1e-11, abs=1e-12)
    d = q[2:] - q[:2]
    assert a[2:] - a[:2] == pytest.approx(alpha * TURN @ d - body.spin**2 * d, rel=1e-11, abs=1e-12)


def test_a_fixed_body_does_not_accelerate() -> None:
    body = Body("b", 1.0, 1.0, 1.0, (0.5, 0.0), fixed=True)
    forces = Forces(Mechanism((body,), loads=(Load("b", (1.0, 0.3), (2.0, -1.0), 0.4),), gravity=(0.0, -9.81)))
    state, a = forces.state, np.ones(4)
    assert accelerations(forces.model, state.joints, state.q, state.v, 0.0, forces.work, a, state.multipliers)
    assert not a.any()
    assert not state.multipliers.any()
