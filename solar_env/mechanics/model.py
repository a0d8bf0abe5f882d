"""Arrays of a compiled mechanism: the constant :class:`Model`, the mutable :class:`State`, status codes.

Elements of one kind are rows of one structured array, so that a kernel reads ``joint.contact_stiffness`` by name
and the number of arrays that cross from Python to a kernel stays small. All quantities are in SI units.

Generalized coordinates ``q`` hold point positions (x, y, x, y, ...). A rigid body owns two base points, that is
four natural coordinates (Garcia de Jalon and Bayo, Kinematic and Dynamic Simulation of Multibody Systems,
Springer 1994, doi:10.1007/978-1-4612-2600-0).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# Body kinds.
FIXED, RIGID = 0, 1
# Joint kinds.
IDEAL, CLEARANCE = 0, 1
# Reading of the sliding speed in the friction law.
MATERIAL_POINTS, JOINT_CENTRES = 0, 1


def _record(members: list[tuple[str, type]]) -> np.dtype[np.void]:
    """Rows whose members are also attributes outside compiled code, so that the kernels run uncompiled too."""
    return np.dtype((np.record, np.dtype(members, align=True)))


body_type = _record(
    [
        ("kind", np.int64),
        ("offset", np.int64),  # first generalized coordinate
        ("length", np.float64),  # distance of the base points
        # Mass matrix [[m11 I, m12 + n12 J], [m12 - n12 J, m22 I]], J the quarter turn, and its inverse (w..).
        ("m11", np.float64),
        ("m22", np.float64),
        ("m12", np.float64),
        ("n12", np.float64),
        ("w11", np.float64),
        ("w22", np.float64),
        ("w12", np.float64),
        ("x12", np.float64),
    ]
)

# A marker is a point of a body with the body's direction there:
# position = (a1 + b1 J) p1 + (a2 + b2 J) p2, direction = c1 p1 + p2, with p1, p2 two coordinate pairs.
marker_type = _record(
    [
        ("i1", np.int64),
        ("i2", np.int64),
        ("a1", np.float64),
        ("b1", np.float64),
        ("a2", np.float64),
        ("b2", np.float64),
        ("c1", np.float64),
    ]
)

joint_type = _record(
    [
        ("kind", np.int64),
        ("inboard", np.int64),  # marker with the bearing
        ("outboard", np.int64),  # marker with the journal
        ("row", np.int64),  # first constraint row of an ideal joint
        ("angle_limited", np.int64),  # whether a torque depends on the angle, which must then not wrap
        # Joint angle: theta = middle + sign * (angle from the inboard direction turned by `turn` to the outboard one).
        ("sign", np.float64),
        ("middle", np.float64),
        ("turn_cos", np.float64),
        ("turn_sin", np.float64),
        # Torques about the joint angle.
        ("spring_stiffness", np.float64),
        ("spring_preload_angle", np.float64),
        ("has_latch", np.int64),
        ("lock_angle", np.float64),
        ("has_stow_stop", np.int64),
        ("stow_angle", np.float64),
        ("stop_gap", np.float64),
        ("stop_stiffness", np.float64),
        ("stop_exponent", np.float64),
        ("stop_ramp_depth", np.float64),
        ("stop_damping", np.float64),
        # Journal in bearing.
        ("clearance", np.float64),
        ("journal_radius", np.float64),
        ("contact_stiffness", np.float64),
        ("damping_factor", np.float64),  # d of F = K depth^1.5 (1 + d rate / impact speed)
        ("minimum_impact_speed", np.float64),
        ("friction_coefficient", np.float64),
        ("friction_speed_zero", np.float64),
        ("friction_speed_full", np.float64),
        ("sliding_speed", np.int64),
        ("wear_coefficient", np.float64),
        ("bearing_width", np.float64),
    ]
)

cable_type = _record(
    [
        ("joint_a", np.int64),
        ("joint_b", np.int64),
        ("wheel_ratio", np.float64),
        ("torque_ratio", np.float64),
        ("stiffness", np.float64),
        ("preload_torque", np.float64),
    ]
)

# Prescribed rotation: the direction of a body follows angle + rate * t.
drive_type = _record([("row", np.int64), ("marker", np.int64), ("angle", np.float64), ("rate", np.float64)])

joint_state_type = _record(
    [
        ("in_contact", np.int64),
        ("impact_speed", np.float64),  # approach speed with which the present contact began
        ("contact_start", np.float64),
        ("contact_duration", np.float64),  # predicted at its start
        ("contact_peak", np.float64),
        ("contact_impulse", np.float64),  # values of the joint's integrals when the contact began
        ("contact_sliding_work", np.float64),
        ("contact_starts", np.int64),
        ("peak_force", np.float64),
        ("postlock_peak_force", np.float64),
        ("recent_peak_force", np.float64),  # since the caller last set it to zero
        ("lock_impulse", np.float64),  # values of the joint's integrals at the first latching
        ("lock_sliding_work", np.float64),
        ("latched", np.int64),
        ("latch_time", np.float64),
        ("stop_engaged", np.int64),  # whether the latch's or the stow stop's torque is evaluated
        ("motor_torque", np.float64),  # input, set between calls
    ]
)

clock_type = _record(
    [
        ("time", np.float64),
        ("step_size", np.float64),
        ("last_error", np.float64),
        ("last_step", np.float64),  # step for which the auxiliary accelerations of generalized-alpha stand
        ("steps", np.int64),
        ("rejected_steps", np.int64),
        ("evaluations", np.int64),
        ("factorizations", np.int64),
        ("latched_joints", np.int64),
        ("initial_energy", np.float64),
        ("energy_scale", np.float64),  # sum of the magnitudes of the initial energies
        ("acceleration_current", np.int64),  # whether State.a belongs to the present q, v and inputs
        # Where and with what value a failed call stopped.
        ("failure_time", np.float64),
        ("failure_joint", np.int64),
        ("failure_value", np.float64),
    ]
)

# Running time integrals of one joint, in this order, are rows of `integrals`; the last entry is the drives' work.
NORMAL_DISSIPATION, FRICTION_DISSIPATION, SLIDING_WORK, IMPULSE, MOTOR_WORK, STOP_DISSIPATION, CABLE_WORK = range(7)
INTEGRALS_PER_JOINT = 7

# Stored energies, in this order.
KINETIC, SPRING, CABLE, LATCH, CONTACT, GRAVITY = range(6)
ENERGY_NAMES = ("kinetic", "spring", "cable", "latch", "contact", "gravity")


class Model(NamedTuple):
    """Constant arrays of a compiled mechanism with n coordinates and m linear constraint rows."""

    bodies: NDArray[np.void]
    markers: NDArray[np.void]
    joints: NDArray[np.void]
    cables: NDArray[np.void]
    drives: NDArray[np.void]
    gravity_force: NDArray[np.float64]  # (n,) constant generalized force of the weight
    constraint_matrix: NDArray[np.float64]  # (m, n); the rows of drives are set at run time
    constraint_value: NDArray[np.float64]  # (m,)
    length_scale: float


class State(NamedTuple):
    """Everything that changes; copying these arrays copies the simulation, mid-contact included."""

    q: NDArray[np.float64]  # (n,) generalized coordinates
    v: NDArray[np.float64]  # (n,) velocities
    a: NDArray[np.float64]  # (n,) accelerations
    algorithmic_a: NDArray[np.float64]  # (n,) auxiliary accelerations of generalized-alpha
    multipliers: NDArray[np.float64]  # (m + bodies,) of the linear constraints, then of the body lengths
    integrals: NDArray[np.float64]  # (INTEGRALS_PER_JOINT * joints + 1,)
    power: NDArray[np.float64]  # time derivatives of the integrals
    joints: NDArray[np.void]
    wear_journal: NDArray[np.float64]  # (joints, bins) depth
    wear_bearing: NDArray[np.float64]  # (joints, bins) depth
    clock: NDArray[np.void]  # (1,)


def copy_state(state: State) -> State:
    """Return an independent copy of ``state``."""
    return State._make(array.copy() for array in state)


# Status codes of the kernels; ``errors.py`` turns them into exceptions.
(
    DONE,
    STEP_TOO_SMALL,
    NOT_FINITE,
    SINGULAR_CONSTRAINTS,
    NEWTON_FAILED,
    JOINT_ANGLE_RANGE,
    CONTACT_TOO_DEEP,
    TOO_MANY_STEPS,
    CONTACT_BUFFER_FULL,
) = range(9)
