"""Construction of the array's mechanism, folded or deployed, and the outline of the main body."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array.level import ModelLevel
from solar_env.array.parameters import ArrayParameters
from solar_env.array.parameters.parameters import MAIN_BODY, JointRow
from solar_env.mechanics.bodies.description import Point
from solar_env.mechanics.mechanism.description import AnyBody, Body, CableLoop, Joint, Mechanism, Spring


def _turning(spin: float, arm: Point) -> Point:
    """Return the velocity [m/s] of an arm's free end; the arm [m] turns about its other end at `spin` [rad/s]."""
    return (-spin * arm[1], spin * arm[0])


def _outward(row: JointRow) -> float:
    """Return the angle [rad] from the inboard body's x axis to a panel that extends straight away from this body.

    The angle is pi for the first panel on the main body's -x side, and 0 for every other panel.
    """
    return math.pi if row.side < 0 and row.inboard == MAIN_BODY else 0.0


def build_deployed(parameters: ArrayParameters, model: str | ModelLevel) -> Mechanism:
    """Build the deployed array at rest; a linear spring, as stiff as the latch, holds every joint at its lock angle.

    The joints are ideal, without play and friction, because the mechanism serves to study small vibrations.
    """
    p = parameters.with_changes({"initial_spin": 0.0, "initial_rate": 0.0, "gravity": 0.0})
    opened = _build(p, ModelLevel.of(model), [row.lock_angle for row in p.joints])
    ideal = dict.fromkeys(("stop", "lock_angle", "stow_angle", "release_time", "release_after", "bearing"))
    bare: dict[str, Any] = {**ideal, "spring_table": (), "harness": (), "damping": 0.0, "friction_torque": 0.0}
    joints = tuple(
        replace(joint, **bare, spring=Spring(p.by_joint("latch_stiffness", row.index), row.lock_angle))
        for row, joint in zip(p.joints, opened.joints, strict=True)
    )
    return replace(opened, joints=joints)


def build(parameters: ArrayParameters, model: str | ModelLevel = "rigid-clearance") -> Mechanism:
    """Build the mechanism of the folded array, which starts with the initial spin and joint rates of `parameters`.

    Args:
        parameters: parameters of the array.
        model: level of model fidelity or its name, see `ModelLevel`.

    Raises:
        ValueError: if the level is unknown or does not fit a parameter.
    """
    return _build(parameters, ModelLevel.of(model), [0.0] * parameters.joint_count)


def _build(p: ArrayParameters, level: ModelLevel, joint_angles: Sequence[float]) -> Mechanism:
    """Build the array's mechanism at the given joint angles [rad], one per joint; 0 is the folded position."""
    bodies, joints, cables = [_main_body(p)], [], []
    for row, opened in zip(p.joints, joint_angles, strict=True):
        if row.inboard == MAIN_BODY:
            hinge, spin, angle = (row.side * p.hinge_x, p.hinge_y), p.initial_spin, _outward(row)
            velocity = _turning(spin, hinge)
        angle -= row.sign * (row.fold_angle - opened)
        length = p.by_joint("panel_length", row.index)
        spin += row.sign * p.by_joint("initial_rate", row.index)
        motion = {"position": hinge, "angle": angle, "velocity": velocity, "spin": spin}
        bodies.append(level.body(p.panel(row.index), f"panel {row.index + 1}", motion))
        joints.append(_joint(p, level, row, bodies))
        if row.inboard != MAIN_BODY:
            cables.append(_cable(p, p.joints[row.index - 1], row))
        along = (length * round(math.cos(angle), 15), length * math.sin(angle))
        turning = _turning(spin, along)
        hinge = (hinge[0] + along[0], hinge[1] + along[1])
        velocity = (velocity[0] + turning[0], velocity[1] + turning[1])
    parts = tuple(bodies), tuple(joints), tuple(cables)
    return Mechanism(*parts, gravity=p.unsupported_gravity, wear_bins=p.wear_bins)


def _main_body(p: ArrayParameters) -> AnyBody:
    """Return the main body, whose generalized coordinates are the positions of two points, the base points.

    From its centroid, they lie at (0, hinge_y) and (hinge_x, hinge_y) [m]; body_size replaces a hinge_x near zero.
    """
    return Body(
        "main body",
        p.body_mass,
        p.body_inertia,
        length=p.body_length,
        centroid=(0.0, -p.hinge_y),
        position=(0.0, p.hinge_y),
        velocity=_turning(p.initial_spin, (0.0, p.hinge_y)),
        spin=p.initial_spin,
        fixed=p.body_fixed,
    )


def _joint(p: ArrayParameters, level: ModelLevel, row: JointRow, bodies: Sequence[AnyBody]) -> Joint:
    root, k, after = row.inboard == MAIN_BODY, row.index, int(p.by_joint("release_after", row.index))
    return Joint(
        name=row.name,
        inboard=bodies[row.inboard].name,
        outboard=bodies[row.panel].name,
        inboard_point=(row.side * p.hinge_x if root else p.by_joint("panel_length", k - 1), 0.0),
        outboard_point=(0.0, 0.0),
        sign=row.sign,
        folded_angle=_outward(row) - row.sign * row.fold_angle,
        middle=row.lock_angle / 2,
        bearing=p.bearing(k) if level.clearance else None,
        spring=Spring(p.by_joint("spring_stiffness", k), p.by_joint("spring_preload_angle", k)),
        stop=p.stop(k),
        lock_angle=row.lock_angle,
        stow_angle=0.0,
        latches=p.by_joint("latching", k) == 1.0,
        release_time=p.by_joint("release_time", k) if after or p.by_joint("release_time", k) else None,
        release_after=p.joints[after - 1].name if after else None,
        spring_table=p.table("spring_torque", k),
        harness=p.table("harness_torque", k),
        damping=p.by_joint("hinge_damping", k),
        friction_torque=p.friction_torque(k),
        friction_ramp_rate=p.friction_rate(k),
    )


def _cable(p: ArrayParameters, inner: JointRow, outer: JointRow) -> CableLoop:
    ratio = outer.lock_angle / inner.lock_angle
    return CableLoop(
        inner.name,
        outer.name,
        p.by_joint("cable_stiffness", inner.index),
        wheel_ratio=ratio,
        torque_ratio=ratio if p.cable_torque_ratio is None else p.cable_torque_ratio,
        preload_torque=p.cable_preload_force * p.cable_wheel_radius,
        wheel_radius=p.cable_wheel_radius if p.cable_bearing_forces else None,
    )


def main_body_corners(parameters: ArrayParameters, base_points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the main body's corners (..., 4, 2) [m], in counter-clockwise order.

    `base_points` (..., 2, 2) [m] are positions of the two points that describe the main body, see `_main_body`.
    """
    centroid, along, across = main_body_frame(parameters, base_points)
    half, corners = parameters.body_size / 2, ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return np.stack([centroid + half * (i * along + j * across) for i, j in corners], axis=-2)


def main_body_frame(parameters: ArrayParameters, base_points: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Compute (centroid [m], unit x axis, unit y axis) of the main body, (..., 2) each.

    `base_points` (..., 2, 2) [m] are positions of the two points that describe the main body, see `_main_body`.
    """
    along = base_points[..., 1, :] - base_points[..., 0, :]
    along = along / np.hypot(along[..., :1], along[..., 1:])
    across = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    return base_points[..., 0, :] - parameters.hinge_y * across, along, across
