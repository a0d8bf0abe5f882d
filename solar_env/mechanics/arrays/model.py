"""Arrays of a compiled mechanism: the constant `Model`, the mutable `State`, status codes.

Parts of one kind, such as joints, are rows of one structured array. A kernel then reads `joint.clearance` by name, and
few arrays cross from Python to a kernel. All quantities are in SI units.

Generalized coordinates `q` are ordered body by body. Only the kinds of body (`bodies/kinds.py`) know the coordinates'
meaning and the record type of bodies.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.numerics.checks import MOST_POINTS
from solar_env.mechanics.numerics.profile import Elimination

# Kinds of accelerations in a state: exact, accurate to a step's tolerance, or made by generalized-alpha.
EXACT, APPROXIMATE, ALGORITHMIC = 1, 2, 3
TABLE_ROWS = MOST_POINTS + 1  # rows of a compiled table of torque against angle
# Joint kinds.
IDEAL, CLEARANCE = 0, 1


def record(members: list[tuple[str, type] | tuple[str, type, int | tuple[int, ...]]]) -> np.dtype[np.void]:
    """Return a NumPy record type whose fields are attributes even in Python, so that kernels also run uncompiled."""
    return np.dtype((np.record, np.dtype(members, align=True)))


joint_type = record(
    [
        ("kind", np.int64),
        ("inboard", np.int64),  # marker with the bearing
        ("outboard", np.int64),  # marker with the journal
        ("row", np.int64),  # first constraint row of an ideal joint
        ("angle_limited", np.int64),  # whether a torque depends on the angle, so that the angle must not wrap
        # Joint angle theta = middle + sign * (angle of the outboard direction from the inboard one turned by `turn`).
        ("sign", np.float64),
        ("middle", np.float64),
        ("turn_cos", np.float64),
        ("turn_sin", np.float64),
        # Torques on the joint angle.
        ("spring_stiffness", np.float64),
        ("spring_preload_angle", np.float64),
        ("spring_points", np.int64),
        ("spring_table", np.float64, (TABLE_ROWS, 3)),  # see `joints/torques/table.py`
        ("harness_points", np.int64),
        ("harness_table", np.float64, (TABLE_ROWS, 3)),
        ("known_stiffness", np.float64),  # greatest slope, by the angle, of the torques that always act
        ("damping", np.float64),
        ("friction_torque", np.float64),
        ("friction_ramp_rate", np.float64),
        ("has_latch", np.int64),
        ("lock_angle", np.float64),
        ("one_sided", np.int64),  # whether the lock angle has a stop that does not latch
        ("is_held", np.int64),  # whether a hold-down holds the joint at t = 0
        ("release_time", np.float64),  # release time of the hold-down, after t = 0 or the latching of `released_by`
        ("released_by", np.int64),  # joint whose latching starts the release time; -1 for t = 0
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
        # Nonzero if wheel angles are measured from a chord, not from the axis of the body between the joints: 1 if that
        # axis runs from joint a to joint b, -1 if it runs from b to a.
        ("chord_sense", np.int64),
        ("first", np.int64),  # markers at the ends of the chord
        ("last", np.int64),
        ("wheel_ratio", np.float64),
        ("torque_ratio", np.float64),
        ("stiffness", np.float64),
        ("preload_torque", np.float64),
        ("wheel_radius", np.float64),  # radius of the outer wheel if the loop pulls on the bearings; else 0
        ("strand_offset", np.float64),  # difference of the wheels' radii, or their sum where the strands cross
        ("rest_distance", np.float64),  # distance of the wheel centres at which the strands have their preload
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

# Constant torque on a marker; constant forces are part of `Model.constant_force`.
load_type = record([("marker", np.int64), ("torque", np.float64)])

joint_state_type = record(
    [
        ("in_contact", np.int64),
        ("impact_speed", np.float64),  # approach speed with which the present contact began
        ("contact_start", np.float64),
        ("contact_duration", np.float64),  # duration predicted at the contact's start
        ("contact_peak", np.float64),
        ("contact_impulse", np.float64),  # this and the next: the joint's integrals when the contact began
        ("contact_sliding_work", np.float64),
        ("contact_starts", np.int64),
        ("peak_force", np.float64),
        ("postlock_peak_force", np.float64),
        ("recent_peak_force", np.float64),  # peak force since the caller last set it to zero
        ("lock_impulse", np.float64),  # this and the next: the joint's integrals at the first latching
        ("lock_sliding_work", np.float64),
        ("lock_peak_force", np.float64),  # greatest force up to the first latching
        ("held", np.int64),  # whether the hold-down holds the joint at the stow angle
        ("release_time", np.float64),  # release time of the hold-down; infinite while unknown
        ("latched", np.int64),
        ("latch_time", np.float64),
        ("latch_rate", np.float64),  # rate of the joint's angle at the latching
        ("peak_latch_torque", np.float64),  # greatest torque at the ends of the steps since the latching
        ("stop_engaged", np.int64),  # whether the latch's or the stow stop's torque is evaluated
        ("motor_torque", np.float64),  # input, set between calls
    ]
)

clock_type = record(
    [
        ("time", np.float64),
        ("step_size", np.float64),
        ("last_error", np.float64),
        ("last_step", np.float64),  # step size for which generalized-alpha's auxiliary accelerations are valid
        ("steps", np.int64),
        ("rejected_steps", np.int64),
        ("evaluations", np.int64),
        ("factorizations", np.int64),
        ("stability_bound_steps", np.int64),  # explicit steps that the flexible bodies' stability limit has bounded
        ("explicit_wait", np.int64),  # explicit steps before the next linearly implicit one is tried
        ("explicit_patience", np.int64),  # latest start value of explicit_wait
        ("latched_joints", np.int64),
        ("initial_energy", np.float64),
        ("energy_scale", np.float64),  # sum of the magnitudes of the initial energies
        ("acceleration_current", np.int64),  # kind of accelerations in State.a; 0 if out of date
        # Time, joint and value at which a call failed.
        ("failure_time", np.float64),
        ("failure_joint", np.int64),
        ("failure_value", np.float64),
    ]
)

# Columns of the running time integrals: nine per joint, joint by joint, then two for the whole mechanism.
NORMAL_DISSIPATION, FRICTION_DISSIPATION, SLIDING_WORK, IMPULSE, MOTOR_WORK, LATCH_DISSIPATION, CABLE_WORK = range(7)
DAMPER_DISSIPATION, HINGE_FRICTION_DISSIPATION = 7, 8
INTEGRALS_PER_JOINT = 9
# Work of drives and load torques; energy dissipated by the material damping of flexible bodies.
EXTERNAL_WORK, MATERIAL_DISSIPATION = -2, -1
GLOBAL_INTEGRALS = 2


def joint_integrals(integrals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the joints' part of time integrals (..., count), reshaped to (..., joints, INTEGRALS_PER_JOINT)."""
    by_joint = integrals[..., :-GLOBAL_INTEGRALS]
    return by_joint.reshape(*by_joint.shape[:-1], -1, INTEGRALS_PER_JOINT)


# Stored energies in the order of their columns; gravity is the potential energy of all constant forces.
KINETIC, SPRING, CABLE, LATCH, CONTACT, ELASTIC, HARNESS, GRAVITY = range(8)
ENERGY_NAMES = ("kinetic", "spring", "cable", "latch", "contact", "elastic", "harness", "gravity")
ENERGIES = len(ENERGY_NAMES)

# Most coordinates that one linear constraint acts on: it joins two points, and each has two coordinate pairs.
ROW_ENTRIES = 8


class Elements(NamedTuple):
    """Cable elements of all beams, in blocks of LANES elements that are computed together (`bodies/cable_element/`)."""

    offset: NDArray[np.int64]  # (blocks, LANES) first coordinate of the element
    inverse_length: NDArray[np.float64]  # (blocks, LANES)
    constants: NDArray[np.float64]  # (blocks, 3 * LANES) E A L, E I / L and retardation time of the elements
    filled: NDArray[np.int64]  # (blocks,) number of elements in use


class Constraints(NamedTuple):
    """Linear constraints; in row r, the sum over k < size[r] of value[r, k] * q[coordinate[r, k]] must be target[r]."""

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
    body_constants: NDArray[np.float64]  # (k,) constants of the bodies; a body's row says where its constants begin
    elimination: Elimination
    error_weight: NDArray[np.float64]  # (n,) weight of a coordinate in error norms: for slopes [m], else 1
    length_scale: float
    stable_step: float  # largest step [s] with which the explicit method is stable on the free bodies
    flexible: int  # whether some body deforms


class State(NamedTuple):
    """Arrays that change during a run; copying them copies the simulation, even in the middle of a contact."""

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
