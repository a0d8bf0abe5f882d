"""Arrays of a mechanism of rigid bodies and modal panels: constants, state, scratch. All quantities in SI units.

Coordinates of a body are centre of mass, angle, then for a panel its amplitudes by group of modes. `slots` of the
scratch arrays: the two stages of a step, its start, and any other configuration that is looked at.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import ENERGIES, record
from solar_env.mechanics.joints.joint import LOAD_COLUMNS
from solar_env.mechanics.modal.panel.tables import FORMS, GROUPS, LOW, VALUES, Panels, Tables, make_tables

Array = NDArray[np.float64]

FIRST, SECOND, START, OTHER = range(4)
SLOTS = 4
RIGID_BODY = -1

body_type = record(
    [
        ("offset", np.int64),  # first coordinate
        ("panel", np.int64),  # index among the panels, or RIGID_BODY
        ("design", np.int64),  # index among the designs of panels
        ("mass", np.float64),
        ("inertia", np.float64),
        ("inverse_mass", np.float64),  # zero if the body is held in place
        ("inverse_inertia", np.float64),
        ("length", np.float64),
        ("centroid_x", np.float64),  # in the body frame
        ("centroid_y", np.float64),
    ]
)

# Where a joint attaches: a point of a body's frame, from the centre of mass and undeformed.
attachment_type = record([("body", np.int64), ("end", np.int64), ("x", np.float64), ("y", np.float64)])

# Columns of a joint's motion.
(
    ECCENTRICITY_X,
    ECCENTRICITY_Y,
    VELOCITY_X,
    VELOCITY_Y,
    ANGLE,
    RATE,
    OUTBOARD_SPIN,
    INBOARD_SPIN,
    LEVER,
    NORMAL_X,
    NORMAL_Y,
    DEPTH,
    DEPTH_RATE,
    SLIP,
    SLIDING_SPEED,
) = range(15)
MOTION_COLUMNS = 15

# Loads of a joint: normal and tangential force of a contact, or the two components of an ideal joint's reaction on its
# outboard body; then the torque on the joint angle, without the motor's.
LOADS = 3
# Kinds of unknown.
TORQUE, NORMAL, TANGENTIAL, REACTION_X, REACTION_Y = range(5)


class ModalModel(NamedTuple):
    """Constant arrays of a mechanism of rigid bodies and modal panels."""

    bodies: NDArray[np.void]
    attachments: NDArray[np.void]
    joints: NDArray[np.void]  # rows of `arrays.model.joint_type`; inboard and outboard count attachments
    cables: NDArray[np.void]
    folded_angle: Array  # (joints,) difference of the bodies' angles at joint angle zero
    gravity: Array  # (2,)
    panels: Panels
    tables: Tables
    length_scale: float


class ModalState(NamedTuple):
    """Everything that changes; copying these arrays copies the simulation, mid-contact included."""

    q: Array  # (n,) coordinates
    v: Array  # (n,) velocities
    loads: Array  # (joints, LOADS) at the end of the last step
    load_rates: Array  # (joints, LOADS) of the last step's collocation polynomial
    coupling: Array  # (panels, modes) modal forces of foreshortening at the end of the last step
    integrals: Array
    joints: NDArray[np.void]
    wear_journal: Array  # (joints, bins)
    wear_bearing: Array  # (joints, bins)
    clock: NDArray[np.void]  # (1,)


class Workspace(NamedTuple):
    """Scratch arrays; nothing in them outlives a call. J joints, B bodies, P panels, A attachments, R unknowns."""

    # By slot.
    place: Array  # (SLOTS, B, 3) centre of mass and angle
    speed: Array  # (SLOTS, B, 3)
    turn: Array  # (SLOTS, B, 2) cosine and sine of the angle
    local: Array  # (SLOTS, A, 2) attachment from the centre of mass in the body's frame
    arm: Array  # (SLOTS, A, 2) the same in inertial axes
    point: Array  # (SLOTS, A, 2) position
    point_rate: Array  # (SLOTS, A, 2)
    direction: Array  # (SLOTS, A, 2) angle of the body at the attachment, and its rate
    motion: Array  # (SLOTS, J, MOTION_COLUMNS)
    # By stage.
    load: Array  # (2, J, LOADS)
    body_load: Array  # (2, B, 3) force and moment about the centre of mass
    group_load: Array  # (P, 2, GROUPS, VALUES) of the ends: transverse force and moment, or axial force
    coupling: Array  # (P, 2, modes) modal forces of foreshortening
    strain_rate: Array  # (P, 2, modes) rates of the coupled axial amplitudes less those of foreshortening
    # Of the ends; columns value and rate at the first stage, value and rate at the second.
    free: Array  # (P, GROUPS, VALUES, 4) free motion
    defect: Array  # (P, GROUPS) defect of the first value's rate at the end of the step
    ends: Array  # (P, GROUPS, VALUES, 4)
    low_free: Array  # (P, GROUPS, LOW, 4) free motion of the modes that foreshortening couples
    low: Array  # (GROUPS, LOW, 4) motion of these modes of one panel
    gradient: Array  # (2, 2, LOW, FORMS) of the forms by the bending amplitudes of one panel, by stage
    shortening: Array  # (P, 2, 2, FORMS) values of the forms and their rates
    tension: Array  # (FORMS,) that works on the forms
    # Newton's iteration.
    kind: NDArray[np.int64]  # (R,)
    joint: NDArray[np.int64]  # (R,)
    torque_row: NDArray[np.int64]  # (J,) or -1
    torque_tolerance: Array  # (J,)
    rigid: Array  # (8,) motion of a unit mass by a unit load, as the columns of the mobility
    row_load: Array  # (R, 2, 4) on outboard and inboard body, in their frames: force, torque, moment about the centre
    row_motion: Array  # (R, 2, 2, 3, 8) of both ends of a panel by it: along, across, turning; without the frame's
    shared: Array  # (8,) of one pair of unknowns
    mobility: Array  # (8, R, R) first index: 4 load stage + 2 stage + (value or rate)
    torque: Array  # (J, 2) of the laws, and its slope by the rate
    torque_slope: Array  # (J, J) slopes by the angles
    matrix: Array  # (2 R, 2 R)
    correction: Array  # (2 R,)
    tolerance: Array  # (R,) of a load
    rows: NDArray[np.int64]  # (1,) number of unknowns
    counts: NDArray[np.int64]  # (2,) iterations, and events that have followed each other without time between them
    # Of an off-table step size.
    tables: Tables
    coefficients: Array  # (16,)
    # At the start of a step.
    q: Array
    v: Array
    depth: Array  # (J,)
    sliding_work: Array  # (J,) of the step
    energies: Array
    sample: Array  # (J, columns) table of loads
    sample_load: Array  # (J, LOADS)
    start_integrals: Array  # at the start of the step


def make_workspace(model: ModalModel, state: ModalState) -> Workspace:
    """Allocate scratch arrays for a mechanism."""
    bodies, attachments, joints = model.bodies.size, model.attachments.size, model.joints.size
    panels = int((model.bodies["panel"] >= 0).sum())
    modes = model.panels.frequency.shape[1]
    rows = 3 * joints
    zeros = np.zeros
    return Workspace(
        place=zeros((SLOTS, bodies, 3)),
        speed=zeros((SLOTS, bodies, 3)),
        turn=zeros((SLOTS, bodies, 2)),
        local=zeros((SLOTS, attachments, 2)),
        arm=zeros((SLOTS, attachments, 2)),
        point=zeros((SLOTS, attachments, 2)),
        point_rate=zeros((SLOTS, attachments, 2)),
        direction=zeros((SLOTS, attachments, 2)),
        motion=zeros((SLOTS, joints, MOTION_COLUMNS)),
        load=zeros((2, joints, LOADS)),
        body_load=zeros((2, bodies, 3)),
        group_load=zeros((panels, 2, GROUPS, VALUES)),
        coupling=zeros((panels, 2, modes)),
        strain_rate=zeros((panels, 2, modes)),
        free=zeros((panels, GROUPS, VALUES, 4)),
        defect=zeros((panels, GROUPS)),
        ends=zeros((panels, GROUPS, VALUES, 4)),
        low_free=zeros((panels, GROUPS, LOW, 4)),
        low=zeros((GROUPS, LOW, 4)),
        gradient=zeros((2, 2, LOW, FORMS)),
        shortening=zeros((panels, 2, 2, FORMS)),
        tension=zeros(FORMS),
        kind=zeros(rows, np.int64),
        joint=zeros(rows, np.int64),
        torque_row=zeros(joints, np.int64),
        torque_tolerance=zeros(joints),
        rigid=zeros(8),
        row_load=zeros((rows, 2, 4)),
        row_motion=zeros((rows, 2, 2, 3, 8)),
        shared=zeros(8),
        mobility=zeros((8, rows, rows)),
        torque=zeros((joints, 2)),
        torque_slope=zeros((joints, joints)),
        matrix=zeros((2 * rows, 2 * rows)),
        correction=zeros(2 * rows),
        tolerance=zeros(rows),
        rows=zeros(1, np.int64),
        counts=zeros(2, np.int64),
        tables=make_tables(model.panels, 1),
        coefficients=zeros(16),
        q=np.zeros_like(state.q),
        v=np.zeros_like(state.v),
        depth=zeros(joints),
        sliding_work=zeros(joints),
        energies=zeros(ENERGIES),
        sample=zeros((joints, LOAD_COLUMNS)),
        sample_load=zeros((joints, LOADS)),
        start_integrals=np.zeros_like(state.integrals),
    )
