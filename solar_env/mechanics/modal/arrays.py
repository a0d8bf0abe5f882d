"""Arrays of a mechanism of rigid bodies and modal panels: constants, state, scratch. All quantities are in SI units.

A body's coordinates are its centre of mass, its angle and, for a panel, its amplitudes of bending, then axial modes.
Scratch arrays hold the motion at the three stages of a step. Their last axis is the stage; its fourth element repeats
the third to fill a vector (LANES = 4). The state holds the motion at the start of a step.
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

# Attachment of a joint: a point of the undeformed body, in its frame from the centre of mass; 1 is a panel's far end.
attachment_type = record([("body", np.int64), ("end", np.int64), ("x", np.float64), ("y", np.float64)])

# Further columns of a joint's motion, after the columns of `arrays.columns`.
VELOCITY_X, VELOCITY_Y, LEVER, NORMAL_X, NORMAL_Y, DEPTH, DEPTH_RATE, SLIP, SLIDING_SPEED = range(
    SHARED_COLUMNS, SHARED_COLUMNS + 9
)
MOTION_COLUMNS = SHARED_COLUMNS + 9

# Order of the loads: each joint's torque on its angle, without motor and cable loops; each cable loop's torque on its
# outer joint; each loop's pull on its wheels' centres; each joint's two force components, normal and tangential for a
# contact, x and y for an ideal joint's reaction on its outboard body.
JOINT_LOADS, CABLE_LOADS = 3, 2
# Kinds of unknown: torques, then forces, with reactions last.
TORQUE_ROW, CABLE_ROW, PULL_ROW, NORMAL_ROW, TANGENTIAL_ROW, REACTION_X_ROW, REACTION_Y_ROW = range(7)

# Columns of a cable loop's motion: mismatch of the wheels' angles, rate of the inner wheel's angle, force (x, y) at the
# chord's outer end per unit moment on the chord, and the chord's length. The last three are zero without a chord: where
# the body between the joints is rigid and the loop does not pull.
STRETCH, WHEEL_RATE, ACROSS_X, ACROSS_Y, LENGTH = range(5)
CABLE_COLUMNS = 5
FACES = 4  # greatest number of attachments that a load acts on: two for a joint, four for a cable loop


# Position and direction of an attachment at the present state.
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
    joints: NDArray[np.void]  # rows of `arrays.model.joint_type`; inboard and outboard are attachment indices
    cables: NDArray[np.void]
    folded_angle: Array  # (joints,) difference of the bodies' angles at joint angle zero
    gravity: Array  # (2,)
    panels: Panels
    tables: Tables
    length_scale: float


class ModalState(NamedTuple):
    """Arrays that change in a run; copying them copies the simulation, even in the middle of a contact."""

    q: Array  # (n,) coordinates
    v: Array  # (n,) velocities
    course: Array  # (loads, LANES) loads at the stages of the last step; the last stage is its end
    coupling: Array  # (panels, GROUPS, LOW, LANES) modal forces of foreshortening at the stages of the last step
    damping_power: Array  # (panels,) power that modal damping dissipates at the end of the last step [W]
    turns: Array  # (bodies, 2) cosine and sine of the angle
    placements: NDArray[np.void]  # (attachments,) rows of `placement_type`
    motion: Array  # (joints, MOTION_COLUMNS)
    cable_motion: Array  # (cables, CABLE_COLUMNS)
    views: Array  # (joints, 6) rows of `JointView`
    extremes: Array  # (2,) maxima so far: slope of a panel's end [rad], spin divided by lowest frequency
    integrals: Array
    joints: NDArray[np.void]
    wear_journal: Array  # (joints, bins)
    wear_bearing: Array  # (joints, bins)
    clock: NDArray[np.void]  # (1,)


# Scratch records for each body, attachment, joint, cable loop, load and unknown.
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
        ("angle_by_torque", np.float64),  # greatest angle change in a step per unit torque [rad/(N m)]
        ("arcs", np.float64, (2, 2)),  # slid in the step on journal and on bearing: middle and half angle [rad]
        ("tried", np.float64, (2, LANES)),  # latest negative and latest positive sliding speed in the iteration
    ]
)
cable_scratch = record([("motion", np.float64, (CABLE_COLUMNS, LANES))])
load_scratch = record(
    [
        ("stage", np.float64, LANES),
        ("tolerance", np.float64),
        # Value of the load's law; its slopes by the motion on which the load does work, and by this motion's rate;
        # slope of friction by the normal force, which is the load before.
        ("law", np.float64, LANES),
        ("by_value", np.float64, LANES),
        ("by_rate", np.float64, LANES),
        ("by_normal", np.float64, LANES),
        ("piece", np.float64, LANES),  # branch of its law, by stage
        ("give", np.float64, LANES),  # yielding of a contact's bodies per normal force at the same stage [m/N]
        ("unknown", np.int64),  # whether it is an unknown; otherwise every iteration evaluates its law
    ]
)
unknown_scratch = record(
    [
        ("kind", np.int64),
        ("owner", np.int64),  # joint or cable loop
        ("number", np.int64),  # index among the loads
        ("first", np.int64),  # first unknown of its block in Newton's matrix; `end` follows the last
        ("end", np.int64),
        ("faces", np.int64),  # number of attachments
        # Joint: outboard, inboard. Cable loop: outer wheel, inner wheel, both ends of its chord.
        ("attachment", np.int64, FACES),
        # Unit load on these bodies in their frames: force (along, across), torque, moment about the centre of mass.
        ("load", np.float64, (FACES, 4)),
        # Unit load that reads off the motion on which the unknown works: `load`, except in loops that lose or gain
        # energy.
        ("reading", np.float64, (FACES, 4)),
    ]
)

# Motion on which an unknown does work, per unit of another unknown; COLUMNS for the load at each stage.
mobility_type = record([("response", np.float64, BY_LOAD)])

step_scratch = record(
    [
        ("unknowns", np.int64),  # number of unknowns
        ("velocity_tolerance", np.float64),  # [m/s]
        ("foreseen", np.float64, (STAGES, LANES)),  # weights of last step's loads at this step's stages
    ]
)


class Workspace(NamedTuple):
    """Scratch arrays, whose contents do not outlive a call. In shapes, J counts joints, C cable loops, R unknowns."""

    trial: NDArray[np.void]  # (1,) and (joints,): see `arrays.trial`
    motion: NDArray[np.void]
    bodies: NDArray[np.void]
    attachments: NDArray[np.void]
    joints: NDArray[np.void]
    cables: NDArray[np.void]
    panels: NDArray[np.void]
    loads: NDArray[np.void]  # (3 J + 2 C,)
    unknowns: NDArray[np.void]  # (R,)
    rigid: Array  # (BY_LOAD,) motion of a unit mass per unit load, in the layout of `mobility_type`
    mobility: NDArray[np.void]  # (R, R) rows of `mobility_type`
    matrix: Array  # (STAGES R, R, LANES) Newton's matrix by column: load at a stage, row
    inverses: Array  # (R, STAGES, LANES) inverses of the diagonal blocks
    residual: Array  # (R, LANES)
    correction: Array  # (R, LANES)
    step: NDArray[np.void]  # (1,)
    tables: Tables  # response tables for a single step size that is not tabled
    # Values at the end of a step.
    q: Array
    v: Array
    integrals: Array
    damping_power: Array
    # Values of a sample.
    energies: Array
    sample: Array  # (J, LOAD_COLUMNS)
    sample_load: Array  # (3 J + 2 C,)


def make_workspace(model: ModalModel, state: ModalState) -> Workspace:
    """Allocate the scratch arrays, filled with zeros, for a mechanism."""
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
