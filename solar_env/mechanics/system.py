"""Global quantities as sums over the mechanism's parts: accelerations, constraint drift, energies.

The equations of motion are M a + Phi_q^T lambda = Q(q, v, t) with two kinds of constraint: the length of every
rigid body, eliminated body by body in closed form, and linear rows A(t) q = b for ideal joints, guides and drives,
solved through the bodies' compliances (the dual Schur complement A P A^T, one row and column a constraint).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import njit, njit_allocating, njit_inlined
from .joint import (
    ANGLE,
    ECCENTRICITY_X,
    ECCENTRICITY_Y,
    FORCE_X,
    FORCE_Y,
    LOAD_COLUMNS,
    NORMAL,
    TANGENTIAL,
    add_point_force,
    cable_torque,
    direction,
    joint_forces,
    stop_energy,
)
from .linear import cholesky_factor, cholesky_solve, copy_into
from .model import (
    CABLE,
    CLEARANCE,
    CONTACT,
    FIXED,
    GRAVITY,
    IDEAL,
    IMPULSE,
    INTEGRALS_PER_JOINT,
    KINETIC,
    LATCH,
    SPRING,
)
from .rigid import kinetic_energy, project_lengths, solve_body


class Workspace(NamedTuple):
    """Scratch arrays of one evaluation; nothing in them outlives a step."""

    force: NDArray[np.float64]  # (n,)
    loads: NDArray[np.float64]  # (joints, LOAD_COLUMNS)
    power: NDArray[np.float64]  # (integrals,)
    impact_speeds: NDArray[np.float64]  # (joints,)
    rows: NDArray[np.float64]  # (m, n) linear constraint rows at the present time
    columns: NDArray[np.float64]  # (m, n) compliance times rows
    schur: NDArray[np.float64]  # (m, m)
    residual: NDArray[np.float64]  # (m,)
    row_force: NDArray[np.float64]  # (n,)


@njit_allocating
def make_workspace(model, state):
    """Allocate the scratch arrays for a model."""
    n, m, joints = state.q.size, model.constraint_value.size, model.joints.size
    return Workspace(
        np.zeros(n),
        np.zeros((joints, LOAD_COLUMNS)),
        np.zeros(state.integrals.size),
        np.zeros(joints),
        model.constraint_matrix.copy(),
        np.zeros((m, n)),
        np.zeros((m, m)),
        np.zeros(m),
        np.zeros(n),
    )


@njit
def set_drive_rows(model, time, rows):
    """Write the rows of prescribed rotations: the body's direction stays parallel to (cos psi, sin psi)."""
    for k in range(model.drives.size):
        drive = model.drives[k]
        marker = model.markers[drive.marker]
        psi = drive.angle + drive.rate * time
        c, s = math.cos(psi), math.sin(psi)
        row = rows[drive.row]
        row[marker.i1] = -s * marker.c1
        row[marker.i1 + 1] = c * marker.c1
        row[marker.i2] = -s
        row[marker.i2 + 1] = c


@njit
def drive_motion(model, drive, time, q, v):
    """Explicit time derivatives of a drive's constraint: its rate at fixed q, and the acceleration's bias."""
    marker = model.markers[drive.marker]
    psi = drive.angle + drive.rate * time
    c, s = math.cos(psi), math.sin(psi)
    dx, dy = direction(marker, q)
    ux, uy = direction(marker, v)
    rate = -drive.rate * (s * dy + c * dx)
    bias = -2.0 * drive.rate * (s * uy + c * ux) + drive.rate * drive.rate * (s * dx - c * dy)
    return rate, bias


@njit
def build_schur(model, q, v, work):
    """Compliance of the linear constraints, factored; False if they are redundant."""
    bodies, rows, columns, schur, row_force = model.bodies, work.rows, work.columns, work.schur, work.row_force
    m, n = rows.shape
    for r in range(m):
        copy_into(row_force, rows[r])
        column = columns[r]
        for b in range(bodies.size):
            solve_body(bodies[b], q, v, row_force, column, 0.0)
    for r in range(m):
        for s in range(r + 1):
            total = 0.0
            for i in range(n):
                total += rows[r, i] * columns[s, i]
            schur[r, s] = total
    return cholesky_factor(schur, m)


@njit
def apply_linear_constraints(model, q, v, time, work, a, multipliers):
    """Correct the accelerations for the linear constraints; False if they are redundant."""
    bodies, force, rows = model.bodies, work.force, work.rows
    m, n = rows.shape
    if model.drives.size > 0:
        set_drive_rows(model, time, work.rows)
    if not build_schur(model, q, v, work):
        return False
    for r in range(m):
        total = 0.0
        for i in range(n):
            total += rows[r, i] * a[i]
        multipliers[r] = total
    for k in range(model.drives.size):
        drive = model.drives[k]
        _, bias = drive_motion(model, drive, time, q, v)
        multipliers[drive.row] += bias
    cholesky_solve(work.schur, m, multipliers)
    for r in range(m):
        for i in range(n):
            force[i] -= multipliers[r] * rows[r, i]
    for b in range(bodies.size):
        multipliers[m + b] = solve_body(bodies[b], q, v, force, a, 1.0)
    store_constraint_loads(model, multipliers, time, q, work)
    return True


@njit_inlined
def inlined_accelerations(model, joint_states, q, v, time, work, a, multipliers):
    """Accelerations (n,) at a configuration, with loads and powers in ``work``; False if constraints are redundant.

    ``multipliers`` receives those of the linear rows, then one per body for its length.
    """
    bodies, force = model.bodies, work.force
    m = work.residual.size
    copy_into(force, model.gravity_force)
    joint_forces(model, joint_states, work.impact_speeds, q, v, work.loads, force, work.power)
    for b in range(bodies.size):
        multipliers[m + b] = solve_body(bodies[b], q, v, force, a, 1.0)
    if m == 0:
        return True
    return apply_linear_constraints(model, q, v, time, work, a, multipliers)


@njit
def accelerations(model, joint_states, q, v, time, work, a, multipliers):
    """:func:`inlined_accelerations` as a call, for places that are not hot."""
    return inlined_accelerations(model, joint_states, q, v, time, work, a, multipliers)


@njit
def store_constraint_loads(model, multipliers, time, q, work):
    """Enter the multipliers of ideal joints as joint forces and the drives' power."""
    for j in range(model.joints.size):
        joint = model.joints[j]
        if joint.kind == IDEAL and joint.row >= 0:
            fx, fy = -multipliers[joint.row], -multipliers[joint.row + 1]
            work.loads[j, FORCE_X] = fx
            work.loads[j, FORCE_Y] = fy
            work.loads[j, NORMAL] = math.sqrt(fx * fx + fy * fy)
            work.loads[j, TANGENTIAL] = 0.0
            work.power[INTEGRALS_PER_JOINT * j + IMPULSE] = work.loads[j, NORMAL]
    drive_power = 0.0
    for k in range(model.drives.size):
        drive = model.drives[k]
        dx, dy = direction(model.markers[drive.marker], q)
        psi = drive.angle + drive.rate * time
        drive_power -= multipliers[drive.row] * (dx * math.cos(psi) + dy * math.sin(psi)) * drive.rate
    work.power[work.power.size - 1] = drive_power


@njit
def constraint_drift(model, q, time, work):
    """Greatest violation [m] of the linear constraints; leaves it by row in ``work.residual``."""
    m, n = work.rows.shape
    worst = 0.0
    if model.drives.size > 0:
        set_drive_rows(model, time, work.rows)
    for r in range(m):
        total = -model.constraint_value[r]
        for i in range(n):
            total += work.rows[r, i] * q[i]
        work.residual[r] = total
        worst = max(worst, abs(total))
    return worst


@njit
def velocity_drift(model, q, v, time, work):
    """Greatest violation [m/s] of the linear constraints' rates; leaves it by row in ``work.residual``."""
    rows, residual = work.rows, work.residual
    m, n = rows.shape
    if model.drives.size > 0:
        set_drive_rows(model, time, rows)
    worst = 0.0
    for r in range(m):
        residual[r] = 0.0
        for i in range(n):
            residual[r] += rows[r, i] * v[i]
    for k in range(model.drives.size):
        drive = model.drives[k]
        rate, _ = drive_motion(model, drive, time, q, v)
        residual[drive.row] += rate
    for r in range(m):
        worst = max(worst, abs(residual[r]))
    return worst


@njit_inlined
def project(model, q, v, time, work):
    """Return positions and velocities to the constraints by the smallest change in the mass metric."""
    project_lengths(model.bodies, q, v)
    if work.residual.size == 0:
        return True
    return project_linear(model, q, v, time, work)


@njit
def project_linear(model, q, v, time, work):
    """Return positions and velocities to the linear constraints; False if these are redundant."""
    rows, columns, residual = work.rows, work.columns, work.residual
    m, n = rows.shape
    constraint_drift(model, q, time, work)
    # The velocities are corrected with the rows of the same configuration: the position change is tiny.
    if not build_schur(model, q, v, work):
        return False
    for kind in range(2):
        if kind == 1:
            velocity_drift(model, q, v, time, work)
        cholesky_solve(work.schur, m, residual)
        target = q if kind == 0 else v
        for r in range(m):
            for i in range(n):
                target[i] -= residual[r] * columns[r, i]
    # The position change leaves the lengths only to second order.
    project_lengths(model.bodies, q, v)
    return True


@njit
def stored_energies(model, joint_states, q, v, loads, energies):
    """Fill the six stored energies [J] at a configuration whose ``loads`` are current."""
    energies[:] = 0.0
    energies[KINETIC] = kinetic_energy(model.bodies, v)
    for i in range(q.size):
        energies[GRAVITY] -= model.gravity_force[i] * q[i]
    for j in range(model.joints.size):
        joint = model.joints[j]
        stretch = joint.spring_preload_angle - loads[j, ANGLE]
        energies[SPRING] += 0.5 * joint.spring_stiffness * stretch * stretch
        energies[LATCH] += stop_energy(joint, joint_states[j], loads[j, ANGLE])
        if joint.kind == CLEARANCE:
            depth = math.hypot(loads[j, ECCENTRICITY_X], loads[j, ECCENTRICITY_Y]) - joint.clearance
            if depth > 0.0:
                energies[CONTACT] += 0.4 * joint.contact_stiffness * depth * depth * math.sqrt(depth)
    for c in range(model.cables.size):
        cable = model.cables[c]
        stretch = cable.wheel_ratio * loads[cable.joint_a, ANGLE] - loads[cable.joint_b, ANGLE]
        _, _, energy = cable_torque(cable, stretch)
        energies[CABLE] += energy


@njit
def normal_inverse_mass(model, q, v, j, work):
    """Inverse effective mass [1/kg] of joint ``j`` along its line of centres: acceleration per unit normal force."""
    joint = model.joints[j]
    outboard, inboard = model.markers[joint.outboard], model.markers[joint.inboard]
    total = 0.0
    # Approximated by the two bodies alone: what else hangs on them moves only after the contact's onset.
    dx, dy = work.loads[j, ECCENTRICITY_X], work.loads[j, ECCENTRICITY_Y]
    size = math.hypot(dx, dy)
    nx, ny = (dx / size, dy / size) if size > 0.0 else (1.0, 0.0)
    for side in range(2):
        marker = outboard if side == 0 else inboard
        for b in range(model.bodies.size):
            body = model.bodies[b]
            if body.kind == FIXED or not body.offset <= marker.i1 < body.offset + 4:
                continue
            work.row_force[:] = 0.0
            add_point_force(marker, nx, ny, work.row_force)
            work.force[:] = 0.0
            solve_body(body, q, v, work.row_force, work.force, 0.0)
            for i in range(q.size):
                total += work.row_force[i] * work.force[i]
    return total
