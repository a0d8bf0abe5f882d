"""Mechanisms for tests, with every quantity of the order of one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import (
    GROUND,
    Bearing,
    Body,
    CableLoop,
    FlexibleBody,
    Joint,
    Load,
    Mechanism,
    Point,
    Spring,
    Stop,
)

Vector = NDArray[np.float64]

# Every length, stiffness and speed of the order of one: finite differences then lose no digits to scale.
ROUND_BEARING = Bearing(
    clearance=0.1,
    journal_radius=0.3,
    contact=PowerLaw(50.0, damping=0.7),
    minimum_impact_speed=0.01,
    friction_coefficient=0.4,
    friction_speeds=(0.2, 3.0),
    wear_coefficient=1e-3,
    width=0.8,
)
ROUND_SPRING = Spring(1.3, 0.7)
PENDULUM_SPRING = Spring(0.7, -0.4)
ROUND_STOP = Stop(gap=0.05, stiffness=3.0, exponent=1.5, ramp_depth=0.3, damping=2.0)


def turned(vector: Point | Vector, angle: float) -> Vector:
    """The vector turned counter-clockwise."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def chain(
    rng: np.random.Generator,
    *,
    angles: Vector,
    eccentricities: Vector,
    bearing: Bearing | None = ROUND_BEARING,
    spring: Spring | None = ROUND_SPRING,
    stop: Stop | None = ROUND_STOP,
    lock_angle: float | None = 0.9,
    stow_angle: float | None = 0.0,
    cables: tuple[CableLoop, ...] = (),
    rates: float = 1.0,
) -> Mechanism:
    """A chain of bodies of random shape in a random motion, with given joint angles and eccentricities (joints, 2).

    Joint `k` is called "joint k"; signs alternate, so that both senses of a joint angle occur.
    """
    bodies, joints = [], []
    position, angle = rng.normal(size=2), float(rng.uniform(-3.0, 3.0))
    for k in range(len(angles) + 1):
        length = float(rng.uniform(0.8, 1.5))
        inboard_point, outboard_point = (tuple(rng.uniform(-1.0, 1.0, 2).tolist()) for _ in range(2))
        if k:
            sign, folded = 1 if k % 2 else -1, float(rng.uniform(-3.0, 3.0))
            wall = position + turned(inboard_point, angle) + eccentricities[k - 1]
            angle += folded + sign * float(angles[k - 1])
            position = wall - turned(outboard_point, angle)
            joints.append(
                Joint(
                    f"joint {k - 1}",
                    f"body {k - 1}",
                    f"body {k}",
                    inboard_point,
                    outboard_point,
                    sign=sign,
                    folded_angle=folded,
                    middle=0.4,
                    bearing=bearing,
                    spring=spring,
                    stop=stop,
                    lock_angle=lock_angle if stop else None,
                    stow_angle=stow_angle if stop else None,
                )
            )
        bodies.append(
            Body(
                f"body {k}",
                mass=float(rng.uniform(0.5, 2.0)),
                inertia=float(rng.uniform(0.1, 1.0)),
                length=length,
                centroid=tuple(rng.uniform(-0.5, 1.0, 2).tolist()),
                position=tuple(position.tolist()),
                angle=angle,
                velocity=tuple((rates * rng.normal(size=2)).tolist()),
                spin=rates * float(rng.normal()),
            )
        )
    return Mechanism(tuple(bodies), tuple(joints), cables)


def pendulum(angle: float = -0.5, spring: Spring | None = PENDULUM_SPRING) -> Mechanism:
    """A body on an ideal pin, with gravity and a torsion spring, at rest: smooth for all time, and constrained."""
    body = Body("arm", 2.0, 0.3, length=1.0, centroid=(0.6, 0.1), angle=angle)
    pin = Joint("pin", GROUND, "arm", (0.0, 0.0), (0.0, 0.0), spring=spring)
    return Mechanism((body,), (pin,), gravity=(0.0, -9.81))


def floating_pair() -> Mechanism:
    """Two spinning bodies coupled by a torsion spring while a wide bearing leaves their pins apart: smooth and free."""
    bearing = replace(ROUND_BEARING, clearance=10.0, journal_radius=20.0)
    bodies = (
        Body("a", 1.0, 0.2, length=1.0, centroid=(0.4, 0.2), velocity=(0.3, -0.2), spin=0.8),
        Body("b", 2.0, 0.5, length=1.5, centroid=(0.7, -0.3), angle=0.5, velocity=(-0.1, 0.4), spin=-0.6),
    )
    joint = Joint("pin", "a", "b", (1.0, 0.0), (0.0, 0.0), bearing=bearing, spring=Spring(2.0, 0.3))
    return Mechanism(bodies, (joint,), gravity=(0.0, -1.0))


def block(
    velocity: Point = (0.3, 0.0),
    *,
    position: Point = (0.0, 0.0),
    gravity: Point = (0.0, 0.0),
    bearing: Bearing | None = None,
    spin: float = 0.0,
    journal: Point = (0.0, 0.0),
) -> Mechanism:
    """A body of 1 kg whose pin flies in a bearing of the ground, 1 mm wide; its base point is its centroid."""
    pin = bearing or Bearing(1e-3, 0.01, PowerLaw(1e9, damping=0.2), friction_coefficient=0.1)
    body = Body("block", 1.0, 0.1, 1.0, (0.0, 0.0), position=position, velocity=velocity, spin=spin)
    return Mechanism((body,), (Joint("gap", GROUND, "block", (0.0, 0.0), journal, bearing=pin),), gravity=gravity)


def towards_walls(*clearances: float) -> Mechanism:
    """A block that flies, at 0.3 m/s, in as many bearings at once; 0 stands for a wheel on a pin without clearance."""
    ends = (0.0, 0.0), (0.0, 0.0)
    body = Body("block", 1.0, 0.1, 1.0, (0.0, 0.0), velocity=(0.3, 0.0))
    wheel = Body("wheel", 1.0, 2.0, 1.0, (0.0, 0.0))
    pins = (
        Joint(f"{k}", GROUND, "block", *ends, bearing=Bearing(clearance, 0.01, PowerLaw(1e9, damping=0.2)))
        if clearance
        else Joint(f"{k}", GROUND, "wheel", *ends)
        for k, clearance in enumerate(clearances)
    )
    return Mechanism((body, wheel) if 0.0 in clearances else (body,), tuple(pins))


def rotor(torque_angle: float = 1.0) -> Mechanism:
    """A wheel of 2 kg m2 about its centroid on an ideal pin, at rest, with a latch at `torque_angle`."""
    wheel = Body("wheel", 1.0, 2.0, length=1.0, centroid=(0.0, 0.0))
    stop = Stop(gap=0.01, stiffness=100.0, exponent=1.0, ramp_depth=1e-3, damping=10.0)
    pin = Joint("pin", GROUND, "wheel", (0.0, 0.0), (0.0, 0.0), stop=stop, lock_angle=torque_angle)
    return Mechanism((wheel,), (pin,))


def beam_rotor(lock_angle: float) -> Mechanism:
    """A beam on an ideal pin at its end, at rest, with a latch."""
    beam = FlexibleBody("beam", 1.0, 2, 0.8, axial_stiffness=400.0, bending_stiffness=2.0, damping=1e-3)
    stop = Stop(gap=0.01, stiffness=100.0, exponent=1.5, ramp_depth=1e-3, damping=0.1)
    pin = Joint("pin", GROUND, "beam", (0.0, 0.0), (0.0, 0.0), stop=stop, lock_angle=lock_angle)
    return Mechanism((beam,), (pin,), loads=(Load("beam", (1.0, 0.0), (0.1, 0.3), 0.2),), gravity=(0.0, -1.0))


def double_pendulum(angle: float = 0.0) -> Mechanism:
    """Two slender rods of 1 m and 1 kg in a row, at rest at an angle from the x axis, under 9.81 m/s2."""
    end = turned((1.0, 0.0), angle)
    upper = Body("upper", 1.0, 1.0 / 12.0, 1.0, (0.5, 0.0), angle=angle)
    lower = replace(upper, name="lower", position=tuple(end.tolist()))
    joints = (
        Joint("shoulder", GROUND, "upper", (0.0, 0.0), (0.0, 0.0)),
        Joint("elbow", "upper", "lower", (1.0, 0.0), (0.0, 0.0)),
    )
    return Mechanism((upper, lower), joints, gravity=(0.0, -9.81))
