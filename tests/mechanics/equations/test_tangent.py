"""Analytic tangents against finite differences of the forces, element by element."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import belts
import numpy as np
import pytest
from helpers import Forces, central_difference
from mechanisms import ROUND_BEARING, ROUND_SPRING, ROUND_STOP, Vector, chain, pendulum

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.equations.newton import assemble, linearize_forces
from solar_env.mechanics.equations.tangent import fill_tangents, make_tangent_scratch
from solar_env.mechanics.integrators.methods.generalized_alpha import fill_residual, make_iteration
from solar_env.mechanics.joints.laws import SLIDING_READINGS, PowerLaw
from solar_env.mechanics.mechanism.description import (
    Bearing,
    Body,
    CableLoop,
    Drive,
    FlexibleBody,
    Joint,
    Load,
    Mechanism,
    Spring,
    Stop,
)
from solar_env.mechanics.numerics.profile import dense, make_profile_matrix

SEEDS = range(3)
LOOP = CableLoop("joint 0", "joint 1", 1.7, 2.0, 1.0)


def tangents(forces: Forces) -> tuple[Vector, Vector]:
    """dQ/dq and dQ/dv at the state of `forces`."""
    model, state = forces.model, forces.state
    forces.force(state.q, state.v)
    parts = [make_profile_matrix(model.elimination) for _ in range(2)]
    for part in parts:
        for array in part:
            array[:] = math.nan  # to be overwritten
    fill_tangents(model, state.joints, state.q, state.v, make_tangent_scratch(forces.work), *parts)
    n = state.q.size
    stiffness, damping = (dense(model.elimination, part)[:n, :n] for part in parts)
    return -stiffness, -damping


def check(forces: Forces) -> None:
    """Compare both tangents with extrapolated central differences, whose error is about 1e-11 of the forces' scale."""
    q, v = forces.state.q, forces.state.v
    by_q, by_v = tangents(forces)
    differences = (
        central_difference(lambda x: forces.force(x, v), q),
        central_difference(lambda x: forces.force(q, x), v),
    )
    # Those of fixed bodies are no unknowns.
    moving = np.flatnonzero(forces.model.elimination.position[: q.size] >= 0)
    for found, difference in zip((by_q, by_v), differences, strict=True):
        found, expected = (x[np.ix_(moving, moving)] for x in (found, difference))
        assert found == pytest.approx(expected, abs=1e-8 * max(np.abs(by_q).max(), np.abs(by_v).max(), 1.0))


def scene(
    seed: int,
    *,
    angles: tuple[float, float] = (0.4, 0.5),
    depths: tuple[float, float] = (-0.03, -0.05),
    bearing: Bearing = ROUND_BEARING,
    spring: Spring | None = None,
    stop: Stop | None = None,
    latched: bool = False,
    cables: tuple[CableLoop, ...] = (),
    motor: tuple[float, float] = (0.0, 0.0),
    rates: float = 1.0,
) -> Forces:
    rng = np.random.default_rng(seed)
    directions = rng.uniform(-math.pi, math.pi, 2)
    radii = bearing.clearance + np.array(depths)
    eccentricities = radii[:, None] * np.stack([np.cos(directions), np.sin(directions)], axis=1)
    mechanism = chain(
        rng,
        angles=np.array(angles),
        eccentricities=eccentricities,
        bearing=bearing,
        spring=spring,
        stop=stop,
        cables=cables,
        rates=rates,
    )
    forces = Forces(mechanism, impact_speed=0.5)
    forces.state.joints["stop_engaged"] = 1
    forces.state.joints["latched"] = latched
    forces.state.joints["motor_torque"] = motor
    return forces


CABLES = [(replace(LOOP, preload_torque=p, torque_ratio=r),) for p in (math.inf, 0.05) for r in (1.0, 2.0)]
PRESSED = replace(ROUND_BEARING, contact=PowerLaw(50.0, damping=0.05), friction_speeds=(0.0, 50.0))
SCENES: list[dict[str, Any]] = [
    {"spring": Spring(1.3, 0.7)},
    {"motor": (0.8, -0.5)},
    *({"cables": cables} for cables in CABLES),
    {
        "angles": (1.1, 1.3),
        "depths": (0.02, 0.06),
        "bearing": PRESSED,
        "spring": Spring(1.3, 0.7),
        "stop": ROUND_STOP,
        "latched": True,
        "cables": (LOOP,),
        "motor": (0.8, -0.5),
        "rates": 0.05,
    },
]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("parts", SCENES, ids="-".join)
def test_the_torques_about_hinges_and_everything_at_once(seed: int, parts: dict[str, Any]) -> None:
    forces = scene(seed, **parts)
    check(forces)
    assert tangents(forces)[0].any()


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    ("angles", "latched"),
    [((1.1, 0.7), True), ((1.5, 0.2), True), ((-0.2, -0.6), False)],
    ids=["in the damping ramp", "beyond the ramp", "stow stop"],
)
def test_stop(seed: int, angles: tuple[float, float], latched: bool) -> None:
    # Slow enough that the damping does not cancel the elastic torque.
    forces = scene(seed, angles=angles, latched=latched, stop=ROUND_STOP, rates=0.05)
    forces.force(forces.state.q, forces.state.v)
    assert np.all(forces.work.loads[:, columns.LATCH_TORQUE] != 0.0)
    check(forces)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("loop", [belts.LOOP, belts.PULLING], ids=["chord", "pulling"])
@pytest.mark.parametrize("torque_ratio", [1.0, 2.0])
def test_cable_along_a_beam(seed: int, loop: CableLoop, torque_ratio: float) -> None:
    loop = replace(loop, torque_ratio=torque_ratio)
    forces = belts.belt(seed, reverse=bool(seed % 2), cable=loop)
    # Of the beam itself, which is no force of a joint.
    slack = belts.belt(seed, reverse=bool(seed % 2), cable=replace(loop, stiffness=1e-300, preload_torque=0.0))
    q, v = forces.state.q, forces.state.v
    found = tangents(forces)[0] - tangents(slack)[0]
    expected = central_difference(lambda x: forces.force(x, v), q)
    assert found == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("friction", [0.0, 0.4], ids=["smooth", "rough"])
@pytest.mark.parametrize("sliding", SLIDING_READINGS)
@pytest.mark.parametrize("speeds", [(0.0, 50.0), (1e-4, 2e-4)])
@pytest.mark.parametrize("exponent", [1.2, 1.5])
def test_contact(seed: int, friction: float, sliding: str, speeds: tuple[float, float], exponent: float) -> None:
    bearing = replace(
        ROUND_BEARING,
        contact=PowerLaw(50.0, exponent, 0.05),
        friction_coefficient=friction,
        friction_speeds=speeds,
        sliding=sliding,
    )
    forces = scene(seed, depths=(0.02, 0.06), bearing=bearing)
    forces.force(forces.state.q, forces.state.v)
    assert np.all(forces.work.loads[:, columns.NORMAL] > 0.0)
    check(forces)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_contact_that_parts_too_fast_to_press_has_no_tangent(seed: int) -> None:
    # Parting at ten times the speed at which the bracket 1 + d rate / impact speed vanishes.
    parting = replace(ROUND_BEARING, contact=PowerLaw(50.0, damping=2.0))
    forces = scene(seed, depths=(0.02, 0.06), bearing=parting, rates=0.0)
    joint, q = forces.model.joints[0], forces.state.q
    for side, sign in ((joint.outboard, -1.0), (joint.inboard, 1.0)):
        marker = forces.model.markers[side]
        eccentricity = forces.work.loads[0, :2]
        forces.force(q, forces.state.v)
        for i in (marker.i1, marker.i2):
            forces.state.v[i : i + 2] += sign * 30.0 * eccentricity
    forces.force(q, forces.state.v)
    assert forces.work.loads[0, columns.NORMAL] == 0.0
    check(forces)


def test_a_joint_of_the_ground() -> None:
    # At rest in the fixed frame: only the arm's own columns matter, and all must be right.
    check(Forces(pendulum()))


def everything() -> Mechanism:
    """Rigid and flexible bodies, fixed ones, and every kind of part that acts on them."""
    beam = FlexibleBody("beam", 1.2, 3, 0.8, axial_stiffness=4.0, bending_stiffness=0.6, damping=0.3)
    bodies = (
        Body("fixed", 1.0, 1.0, 1.0, (0.0, 0.0), fixed=True),
        Body("arm", 1.5, 0.2, 0.9, (0.4, 0.1)),
        beam,
        replace(beam, name="other", elements=1),
        Body("last", 0.7, 0.1, 0.8, (0.3, -0.1)),
    )
    joints = (
        Joint("joint 0", "fixed", "arm", (0.3, 0.2), (0.0, 0.1), spring=ROUND_SPRING, stop=ROUND_STOP, stow_angle=4.0),
        Joint("joint 1", "arm", "beam", (0.9, 0.0), (0.4, 0.0), sign=-1, spring=ROUND_SPRING),
        Joint("joint 2", "beam", "other", (1.2, 0.0), (0.0, 0.0), bearing=PRESSED),
        Joint("joint 3", "other", "last", (1.2, 0.0), (0.1, 0.2), bearing=PRESSED, spring=ROUND_SPRING),
    )
    cables = (replace(LOOP, joint_a="joint 1", joint_b="joint 2"), replace(LOOP, joint_a="joint 2", joint_b="joint 3"))
    return Mechanism(
        bodies,
        joints,
        cables,
        (Drive("arm", 0.1, 1.2, 0.5), Drive("other", -0.3, 0.4, point=(1.2, 0.0))),
        (Load("beam", (0.4, 0.0), (1.0, -2.0), 0.7), Load("last", (0.2, 0.3), torque=-0.4)),
        gravity=(0.2, -1.0),
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_newtons_matrix_is_the_slope_of_the_residual(seed: int) -> None:
    rng = np.random.default_rng(seed)
    forces = Forces(everything(), impact_speed=0.5)
    model, state = forces.model, forces.state
    state.joints["motor_torque"] = rng.normal(size=4)
    state.joints["stop_engaged"] = 1
    n, unknowns, time, scale = state.q.size, state.q.size + state.multipliers.size, 0.3, 0.7
    mass_weight, damping_weight = 1.3, 0.4
    it = make_iteration(model, state, forces.work)
    moving = np.flatnonzero(model.elimination.position >= 0)
    free = moving[moving < n]
    start = [state.q.copy(), state.v.copy(), np.zeros(n), np.zeros(unknowns - n)]
    start[0][free] += 0.15 * rng.normal(size=free.size)
    for x in start[1:3]:
        x[free] = 0.1 * rng.normal(size=free.size)
    start[3][:] = rng.normal(size=unknowns - n)

    def residual(x: Vector) -> Vector:
        it.q[:], it.v[:], it.a[:], it.multipliers[:] = start
        it.q[:] += x[:n]
        it.v[:] += damping_weight * x[:n]
        it.a[:] += mass_weight * x[:n]
        it.multipliers[:] += x[n:] / scale
        fill_residual(model, state, it, forces.work, time, scale)
        return -it.rhs.copy()

    expected = central_difference(residual, np.zeros(unknowns))[np.ix_(moving, moving)]
    residual(np.zeros(unknowns))
    assert np.all(forces.work.loads[2:, columns.NORMAL] > 0.0)
    assert forces.work.loads[0, columns.LATCH_TORQUE] != 0.0
    linearize_forces(model, state.joints, it.q, it.v, it.newton)
    weights = (scale * mass_weight, scale * damping_weight, scale)
    assemble(model, it.q, it.multipliers, forces.work.row_value, it.newton, weights)
    found = dense(model.elimination, it.newton.matrix)[np.ix_(moving, moving)]
    assert found == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())
