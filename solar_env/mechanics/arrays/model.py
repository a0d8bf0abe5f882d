"""Arrays of a compiled mechanism: the constant `Model`, the mutable `State`, status codes.

Elements of one kind are rows of one structured array, so that a kernel reads `joint.clearance` by name
and the number of arrays that cross from Python to a kernel stays small. All quantities are in SI units.

Generalized coordinates `q` come body by body. Only the kind of body (`bodies/kinds.py`) knows their meaning; it also
makes the rows for bodies.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.numerics.checks import MOST_POINTS
from solar_env.mechanics.numerics.profile import Elimination

# Kinds of accelerations: exact solutions, solutions to a step's tolerance, and generalized-alpha's own.
EXACT, APPROXIMATE, ALGORITHMIC = 1, 2, 3
TABLE_ROWS = MOST_POINTS + 1  # rows of a torque's table over the angle
# Joint kinds.
IDEAL, CLEARANCE = 0, 1


def record(members: list[tuple[str, type] | tuple[str, type, int | tuple[int, ...]]]) -> np.dtype[np.void]:
    """Return a record type whose members are attributes also outside compiled code, so that kernels run uncompiled."""
    return np.dtype((np.record, np.dtype(members, align=True)))


joint_type = record(
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
        ("spring_points", np.int64),
        ("spring_table", np.float64, (TABLE_ROWS, 3)),  # see `joints/torques/table.py`
        ("harness_points", np.int64),
        ("harness_table", np.float64, (TABLE_ROWS, 3)),
        ("known_stiffness", np.float64),  # greatest slope of the torques that always act
        ("damping", np.float64),
        ("friction_torque", np.float64),
        ("friction_ramp_rate", np.float64),
        ("has_latch", np.int64),
        ("lock_angle", np.float64),
        ("one_sided", np.int64),  # whether the lock angle has only a stop, which does not latch
        ("is_held", np.int64),  # whether a hold-down holds the joint at t = 0
        ("release_time", np.float64),  # of the hold-down, since t = 0 or since `released_by` has latched
        ("released_by", np.int64),  # joint whose latching starts the release time; -1: t = 0
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
        ("contact", np.float64, 4),  # parameters of `laws.PowerLaw`
        ("minimum_impact_speed", np.float64),
        ("friction_coefficient", np.float64),
        ("friction_speed_zero", np.float64),
        ("friction_speed_full", np.float64),
        ("sliding", np.int64),
        ("wear_coefficient", np.float64),
        ("bearing_width", np.float64),
    ]
)

cable_type = record(
    [
        ("joint_a", np.int64),
        ("joint_b", np.int64),
        # Whether the wheels turn against a chord, not against the axis of the body between the joints:
        # 1 if that axis runs from joint a to joint b, -1 if back; else 0.
        ("chord_sense", np.int64),
        ("first", np.int64),  # markers at the ends of the chord
        ("last", np.int64),
        ("wheel_ratio", np.float64),
        ("torque_ratio", np.float64),
        ("stiffness", np.float64),
        ("preload_torque", np.float64),
        ("wheel_radius", np.float64),  # of the outer wheel, if the loop pulls on the bearings; else 0
        ("strand_offset", np.float64),  # difference of the wheels' radii, or their sum where the strands cross
        ("rest_distance", np.float64),  # of the wheels' centres, at which the strands have their preload
    ]
)

# Prescribed rotation of a marker's direction, see `description.Drive`.
drive_type = record(
    [
        ("row", np.int64),
        ("marker", np.int64),
        ("angle", np.float64),
        ("rate", np.float64),
        ("ramp_time", np.float64),
    ]
)

# Constant torque on a marker; generalized forces of constant forces are constant.
load_type = record([("marker", np.int64), ("torque", np.float64)])

joint_state_type = record(
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
        ("lock_peak_force", np.float64),  # greatest force up to the first latching
        ("held", np.int64),  # whether the hold-down holds the joint at the stow angle
        ("release_time", np.float64),  # of the hold-down; infinite while it is not known
        ("latched", np.int64),
        ("latch_time", np.float64),
        ("latch_rate", np.float64),  # rate of the joint's angle at the latching
        ("peak_latch_torque", np.float64),  # at the ends of the steps since the latching
        ("stop_engaged", np.int64),  # whether the latch's or the stow stop's torque is evaluated
        ("motor_torque", np.float64),  # input, set between calls
    ]
)

clock_type = record(
    [
        ("time", np.float64),
        ("step_size", np.float64),
        ("last_error", np.float64),
        ("last_step", np.float64),  # step for which the auxiliary accelerations of generalized-alpha stand
        ("steps", np.int64),
        ("rejected_steps", np.int64),
        ("evaluations", np.int64),
        ("factorizations", np.int64),
        ("stability_bound_steps", np.int64),  # explicit steps that the flexible bodies' stability limit has bounded
        ("explicit_wait", np.int64),  # explicit steps before the next linearly implicit one is tried
        ("explicit_patience", np.int64),  # last start value of explicit_wait
        ("latched_joints", np.int64),
        ("initial_energy", np.float64),
        ("energy_scale", np.float64),  # sum of the magnitudes of the initial energies
        ("acceleration_current", np.int64),  # kind of accelerations in State.a; 0 if out of date
        # Where and with what value a failed call stopped.
        ("failure_time", np.float64),
        ("failure_joint", np.int64),
        ("failure_value", np.float64),
    ]
)

# Running time integrals: first these of every joint, joint by joint, then two of the whole mechanism.
NORMAL_DISSIPATION, FRICTION_DISSIPATION, SLIDING_WORK, IMPULSE, MOTOR_WORK, LATCH_DISSIPATION, CABLE_WORK = range(7)
DAMPER_DISSIPATION, HINGE_FRICTION_DISSIPATION = 7, 8
INTEGRALS_PER_JOINT = 9
# Work of drives and load torques; energy that the material damping of flexible bodies took.
EXTERNAL_WORK, MATERIAL_DISSIPATION = -2, -1
GLOBAL_INTEGRALS = 2


def joint_integrals(integrals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the (..., joints, INTEGRALS_PER_JOINT) view of the integrals (..., count) by joint."""
    by_joint = integrals[..., :-GLOBAL_INTEGRALS]
    return by_joint.reshape(*by_joint.shape[:-1], -1, INTEGRALS_PER_JOINT)


# Stored energies, in this order; the last one is the potential of all constant forces.
KINETIC, SPRING, CABLE, LATCH, CONTACT, ELASTIC, HARNESS, GRAVITY = range(8)
ENERGY_NAMES = ("kinetic", "spring", "cable", "latch", "contact", "elastic", "harness", "gravity")
ENERGIES = len(ENERGY_NAMES)

# Most coordinates that one linear constraint acts on: two points, of two coordinate pairs each.
ROW_ENTRIES = 8


class Elements(NamedTuple):
    """The cable elements of all beams, in blocks (`bodies/cable_element/`)."""

    offset: NDArray[np.int64]  # (blocks, LANES) first coordinate
    inverse_length: NDArray[np.float64]  # (blocks, LANES)
    constants: NDArray[np.float64]  # (blocks, 3 * LANES)
    filled: NDArray[np.int64]  # (blocks,) number of elements


class Constraints(NamedTuple):
    """Linear constraints: row r is the sum over k < size[r] of value[r, k] * q[coordinate[r, k]] = target[r]."""

    size: NDArray[np.int64]  # (m,)
    coordinate: NDArray[np.int64]  # (m, ROW_ENTRIES)
    value: NDArray[np.float64]  # (m, ROW_ENTRIES); drives set their rows at run time
    target: NDArray[np.float64]  # (m,)
    bodies: NDArray[np.int64]  # (m, 2) the bodies that a row acts on; -1 for no body
    driven: NDArray[np.int64]  # (m,) whether the row belongs to a drive


class Model(NamedTuple):
    """Constant arrays of a compiled mechanism with n coordinates and m linear constraint rows."""

    bodies: NDArray[np.void]
    markers: NDArray[np.void]
    joints: NDArray[np.void]
    cables: NDArray[np.void]
    drives: NDArray[np.void]
    loads: NDArray[np.void]
    constant_force: NDArray[np.float64]  # (n,) generalized force of weight and constant loads
    constraints: Constraints
    cable_elements: Elements
    body_constants: NDArray[np.float64]  # (k,) constants of the bodies, whose rows say where theirs begin
    elimination: Elimination
    error_weight: NDArray[np.float64]  # (n,) weight of a coordinate in error norms: for slopes [m], else 1
    length_scale: float
    stable_step: float  # largest step [s] with which the explicit method is stable on the free bodies
    flexible: int  # whether some body deforms


class State(NamedTuple):
    """Everything that changes; copying these arrays copies the simulation, mid-contact included."""

    q: NDArray[np.float64]  # (n,) generalized coordinates
    v: NDArray[np.float64]  # (n,) velocities
    a: NDArray[np.float64]  # (n,) accelerations
    algorithmic_a: NDArray[np.float64]  # (n,) auxiliary accelerations of generalized-alpha
    multipliers: NDArray[np.float64]  # (m + bodies,) of the linear constraints, then of the body lengths
    integrals: NDArray[np.float64]  # (INTEGRALS_PER_JOINT * joints + GLOBAL_INTEGRALS,)
    power: NDArray[np.float64]  # time derivatives of the integrals
    joints: NDArray[np.void]
    wear_journal: NDArray[np.float64]  # (joints, bins) depth
    wear_bearing: NDArray[np.float64]  # (joints, bins) depth
    clock: NDArray[np.void]  # (1,)


# Status codes of the kernels; `errors.py` turns them into exceptions.
(
    DONE,
    STEP_TOO_SMALL,
    NOT_FINITE,
    SINGULAR_CONSTRAINTS,
    NEWTON_FAILED,
    JOINT_ANGLE_RANGE,
    CONTACT_TOO_DEEP,
    TOO_MANY_STEPS,
    PAUSED,
    EVENTS_PILE_UP,
    NEWTON_STALLED,
) = range(11)
