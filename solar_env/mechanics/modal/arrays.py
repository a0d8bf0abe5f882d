"""Arrays of a mechanism of rigid bodies and modal panels: constants, state, scratch. All quantities in SI units.

Coordinates of a body are centre of mass, angle, then for a panel its amplitudes by group of modes. Motion at the stages
of a step is scratch, whose last axes of LANES are the stages; motion at its start belongs to the state, where every
step leaves the motion at its end.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.columns import LOAD_COLUMNS, SHARED_COLUMNS
from solar_env.mechanics.arrays.model import ENERGIES, record
from solar_env.mechanics.arrays.trial import joint_motion_type, trial_type
from solar_env.mechanics.modal.tables import (
    BY_LOAD,
    LANES,
    STAGES,
    Panels,
    Tables,
    make_tables,
    panel_scratch,
)

Array = NDArray[np.float64]

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

# Further columns of a joint's motion, behind the columns of `arrays.columns`.
VELOCITY_X, VELOCITY_Y, LEVER, NORMAL_X, NORMAL_Y, DEPTH, DEPTH_RATE, SLIP, SLIDING_SPEED = range(
    SHARED_COLUMNS, SHARED_COLUMNS + 9
)
MOTION_COLUMNS = SHARED_COLUMNS + 9

# Loads in order: each joint's torque on its angle, without the motor's and the loops'; each cable loop's torque on its
# outer joint; each loop's pull on its wheels' centres; each joint's normal and tangential contact force, or the two
# components of an ideal joint's reaction on its outboard body.
JOINT_LOADS, CABLE_LOADS = 3, 2
# Kinds of unknown; the forces are last, and of them the reactions.
TORQUE_ROW, CABLE_ROW, PULL_ROW, NORMAL_ROW, TANGENTIAL_ROW, REACTION_X_ROW, REACTION_Y_ROW = range(7)

# Columns of a cable loop's motion: mismatch of the wheels' angles, rate of the inner wheel's, force at the chord's
# outer end per unit moment on the chord, and the chord's length. The latter are zero without a chord: where the body
# between the joints is rigid and the loop does not pull.
STRETCH, WHEEL_RATE, ACROSS_X, ACROSS_Y, LENGTH = range(5)
CABLE_COLUMNS = 5
# Most attachments that a load works on: a joint's on two, a cable loop's on four.
FACES = 4


# Where an attachment is at the present state.
placement_type = record(
    [
        ("local", np.float64, 2),  # from the centre of mass in the body's frame
        ("arm", np.float64, 2),  # the same in inertial axes
        ("arm_rate", np.float64, 2),
        ("direction", np.float64, 2),  # angle of the body at the attachment, and its rate
    ]
)


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
    course: Array  # (loads, LANES) loads at the stages of the last step, of which the last is its end
    coupling: Array  # (panels, GROUPS, LOW, LANES) modal forces of foreshortening at the stages of the last step
    damping_power: Array  # (panels,) [W] that the modes' damping takes at the end of the last step
    turns: Array  # (bodies, 2) cosine and sine of the angle
    placements: NDArray[np.void]  # (attachments,) rows of `placement_type`
    motion: Array  # (joints, MOTION_COLUMNS)
    cable_motion: Array  # (cables, CABLE_COLUMNS)
    views: Array  # (joints, 6) rows of `JointView`
    extremes: Array  # (2,) greatest slope of a panel's end [rad] and spin per lowest frequency, of all steps
    integrals: Array
    joints: NDArray[np.void]
    wear_journal: Array  # (joints, bins)
    wear_bearing: Array  # (joints, bins)
    clock: NDArray[np.void]  # (1,)


# Scratch by body, attachment, joint, cable loop and unknown.
body_scratch = record(
    [
        ("place", np.float64, (3, LANES)),  # centre of mass and angle
        ("speed", np.float64, (3, LANES)),
        ("turn", np.float64, (2, LANES)),  # cosine and sine of the angle
        ("load", np.float64, (3, LANES)),  # force and moment about the centre of mass
    ]
)
attachment_scratch = record(
    [
        ("local", np.float64, (2, LANES)),  # from the centre of mass in the body's frame
        ("arm", np.float64, (2, LANES)),  # the same in inertial axes
        ("point", np.float64, (2, LANES)),  # position
        ("point_rate", np.float64, (2, LANES)),
        ("direction", np.float64, (2, LANES)),  # angle of the body at the attachment, and its rate
    ]
)
joint_scratch = record(
    [
        ("motion", np.float64, (MOTION_COLUMNS, LANES)),
        ("angle_by_torque", np.float64),  # greatest change over a step [rad/(N m)]
        ("arcs", np.float64, (2, 2)),  # of journal and bearing that have slid in the step: middle and half [rad]
        ("tried", np.float64, (2, LANES)),  # latest sliding speeds in the iteration: negative, positive
    ]
)
cable_scratch = record([("motion", np.float64, (CABLE_COLUMNS, LANES))])
load_scratch = record(
    [
        ("stage", np.float64, LANES),
        ("tolerance", np.float64),
        # Value by the load's law, and its slopes by the motion that the load works on; friction's slope by the normal
        # force, which is the load before.
        ("law", np.float64, LANES),
        ("by_value", np.float64, LANES),
        ("by_rate", np.float64, LANES),
        ("by_normal", np.float64, LANES),
        ("piece", np.float64, LANES),  # piece of its law in which the load is
        ("give", np.float64, LANES),  # [m/N] of a contact's bodies to its normal force, at a stage by the force there
        ("unknown", np.int64),  # whether it is an unknown; else it follows the iterations
    ]
)
unknown_scratch = record(
    [
        ("kind", np.int64),
        ("owner", np.int64),  # joint or cable loop
        ("number", np.int64),  # among the loads
        ("first", np.int64),  # unknown of its block in Newton's matrix, and the one behind its last
        ("end", np.int64),
        ("faces", np.int64),  # number of attachments
        # Outboard and inboard; of a cable loop both with the wheels, then both ends of its chord.
        ("attachment", np.int64, FACES),
        # A unit of it on these bodies, in their frames: force, torque, moment about the centre of mass.
        ("load", np.float64, (FACES, 4)),
        # The loads that read off the motion it works on: the same, except for a loop that does not conserve energy.
        ("reading", np.float64, (FACES, 4)),
    ]
)

# Motion that an unknown works on by a unit of another, COLUMNS for the load at each stage.
mobility_type = record([("response", np.float64, BY_LOAD)])

step_scratch = record(
    [
        ("unknowns", np.int64),  # number
        ("velocity_tolerance", np.float64),  # [m/s]
        ("foreseen", np.float64, (STAGES, LANES)),  # weight of each load of the last step at each stage of this one
    ]
)


class Workspace(NamedTuple):
    """Scratch arrays; nothing in them outlives a call. J joints, C cable loops, R unknowns.

    Rows of records have the same layout for every mechanism, which spares the kernels the shapes of a dozen arrays.
    """

    trial: NDArray[np.void]  # (1,) and (joints,): see `arrays.trial`
    motion: NDArray[np.void]
    bodies: NDArray[np.void]
    attachments: NDArray[np.void]
    joints: NDArray[np.void]
    cables: NDArray[np.void]
    panels: NDArray[np.void]
    loads: NDArray[np.void]  # (3 J + 2 C,)
    unknowns: NDArray[np.void]  # (R,)
    rigid: Array  # (BY_LOAD,) motion of a unit mass by a unit load, as the columns of the mobility
    mobility: NDArray[np.void]  # (R, R) rows of `mobility_type`
    matrix: Array  # (STAGES R, R, LANES) by column: load at a stage, row
    inverses: Array  # (R, STAGES, LANES) of the unknowns' own blocks
    residual: Array  # (R, LANES)
    correction: Array  # (R, LANES)
    step: NDArray[np.void]  # (1,)
    tables: Tables  # of an off-table step size
    # At the end of a step.
    q: Array
    v: Array
    integrals: Array
    damping_power: Array
    # Of a sample.
    energies: Array
    sample: Array  # (J, LOAD_COLUMNS)
    sample_load: Array  # (3 J + 2 C,)


def make_workspace(model: ModalModel, state: ModalState) -> Workspace:
    """Allocate scratch arrays for a mechanism."""
    joints, cables, zeros = model.joints.size, model.cables.size, np.zeros
    loads = JOINT_LOADS * joints + CABLE_LOADS * cables
    return Workspace(
        trial=np.zeros(1, trial_type),
        motion=np.zeros(joints, joint_motion_type),
        bodies=zeros(model.bodies.size, body_scratch),
        attachments=zeros(model.attachments.size, attachment_scratch),
        joints=zeros(joints, joint_scratch),
        cables=zeros(cables, cable_scratch),
        panels=zeros(len(state.coupling), panel_scratch),
        loads=zeros(loads, load_scratch),
        unknowns=zeros(loads, unknown_scratch),
        rigid=zeros(BY_LOAD),
        mobility=zeros((loads, loads), mobility_type),
        matrix=zeros((STAGES * loads, loads, LANES)),
        inverses=zeros((loads, STAGES, LANES)),
        residual=zeros((loads, LANES)),
        correction=zeros((loads, LANES)),
        step=zeros(1, step_scratch),
        tables=make_tables(model.panels, 1),
        q=np.zeros_like(state.q),
        v=np.zeros_like(state.v),
        integrals=np.zeros_like(state.integrals),
        damping_power=np.zeros_like(state.damping_power),
        energies=zeros(ENERGIES),
        sample=zeros((joints, LOAD_COLUMNS)),
        sample_load=zeros(loads),
    )
