"""Arrays of a mechanism of rigid bodies and modal panels: constants, state, scratch. All quantities in SI units.

Coordinates of a body are centre of mass, angle, then for a panel its axial and its bending amplitudes. `slots` of the
scratch arrays: the two stages of a step, its start, and any other configuration that is looked at.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import ENERGIES, record
from solar_env.mechanics.joints.joint import LOAD_COLUMNS
from solar_env.mechanics.modal.tables import FORMS, Panels, Tables, make_tables

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
    coupling: Array  # (panels, coupled) modal forces of foreshortening at the end of the last step
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
    bending_load: Array  # (P, 2, 4) transverse force and moment at the two ends
    axial_load: Array  # (P, 2, 2)
    bending_coupling: Array  # (P, 2, coupled) modal forces of foreshortening
    axial_coupling: Array  # (P, 2, coupled)
    strain_rate: Array  # (P, 2, coupled) rates of the coupled axial amplitudes less those of foreshortening
    # Free motion of the ends, then the whole: columns value and rate at the first stage, value and rate at the second.
    bending_free: Array  # (P, 20), last four: defects of the rates at the end
    axial_free: Array  # (P, 10), last two: defects
    bending_ends: Array  # (P, 4, 4)
    axial_ends: Array  # (P, 2, 4)
    bending_low: Array  # (P, 4, coupled) free motion of the modes that foreshortening couples
    axial_low: Array  # (P, 4, coupled)
    low: Array  # (2, coupled) amplitudes and rates of one panel's coupled bending modes
    # Foreshortening of one panel, by stage.
    gradient: Array  # (2, coupled, FORMS)
    shortening: Array  # (2, 2, FORMS) values of the forms and their rates
    low_force: Array  # (2, coupled) modal forces
    # Newton's iteration.
    kind: NDArray[np.int64]  # (R,)
    joint: NDArray[np.int64]  # (R,)
    torque_row: NDArray[np.int64]  # (J,) or -1
    torque_tolerance: Array  # (J,)
    rigid: Array  # (8,) motion of a unit mass by a unit load, as the columns of the mobility
    row_load: Array  # (R, 2, 4) on outboard and inboard body, in their frames: force, torque, moment about the centre
    mobility: Array  # (R, R, 8) [4 load stage + 2 stage + (value or rate)]
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
    rates: Array  # (2, modes) of one family at the stages
    energies: Array
    sample: Array  # (J, columns) table of loads
    sample_load: Array  # (J, LOADS)
    start_integrals: Array  # at the start of the step


def make_workspace(model: ModalModel, state: ModalState) -> Workspace:
    """Allocate scratch arrays for a mechanism."""
    bodies, attachments, joints = model.bodies.size, model.attachments.size, model.joints.size
    panels = int((model.bodies["panel"] >= 0).sum())
    coupled_axial, coupled = model.panels.project.shape[1:3]
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
        bending_load=zeros((panels, 2, 4)),
        axial_load=zeros((panels, 2, 2)),
        bending_coupling=zeros((panels, 2, coupled)),
        axial_coupling=zeros((panels, 2, coupled_axial)),
        strain_rate=zeros((panels, 2, coupled_axial)),
        bending_free=zeros((panels, 20)),
        axial_free=zeros((panels, 10)),
        bending_ends=zeros((panels, 4, 4)),
        axial_ends=zeros((panels, 2, 4)),
        bending_low=zeros((panels, 4, coupled)),
        axial_low=zeros((panels, 4, coupled_axial)),
        low=zeros((2, coupled)),
        gradient=zeros((2, coupled, FORMS)),
        shortening=zeros((2, 2, FORMS)),
        low_force=zeros((2, coupled)),
        kind=zeros(rows, np.int64),
        joint=zeros(rows, np.int64),
        torque_row=zeros(joints, np.int64),
        torque_tolerance=zeros(joints),
        rigid=zeros(8),
        row_load=zeros((rows, 2, 4)),
        mobility=zeros((rows, rows, 8)),
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
        rates=zeros((2, max(model.panels.bending_frequency.shape[1], model.panels.axial_frequency.shape[1]))),
        energies=zeros(ENERGIES),
        sample=zeros((joints, LOAD_COLUMNS)),
        sample_load=zeros((joints, LOADS)),
        start_integrals=np.zeros_like(state.integrals),
    )
