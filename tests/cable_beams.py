"""A beam of cable elements with its forces and matrices, for tests."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from mechanisms import Vector

from solar_env.mechanics.arrays.model import Model
from solar_env.mechanics.bodies.cable_element.element import add_mass_product
from solar_env.mechanics.bodies.cable_element.forces import LANES, TABLE_ROWS, add_elastic_forces
from solar_env.mechanics.bodies.cable_element.tangent import add_elastic_tangents, make_element_slopes
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.mechanism.description import Body, FlexibleBody, Mechanism
from solar_env.mechanics.numerics.profile import dense, make_profile_matrix

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
