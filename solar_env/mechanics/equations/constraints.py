"""Linear constraints A(t) q = b of a mechanism: rows, drives, compliance, drift and projection.

Each row of A belongs to an ideal joint or a drive. The multipliers solve a linear system whose matrix is the
constraints' compliance A P A^T, where P gives the accelerations of the unconnected bodies per generalized force. P is
the inverse mass matrix minus a rank-one matrix for each length constraint, a rigid body's fixed distance between two
points. Without length constraints, the compliance changes with time only in the rows and columns of drives.
"""

import math

from solar_env.mechanics.bodies.dispatch import project_bodies, solve_body, solve_free
from solar_env.mechanics.bodies.markers import direction
from solar_env.mechanics.bodies.natural_coordinates import length_compliance, stretch_along
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import cholesky_factor, cholesky_solve


@kernel
def add_row(model, work, r, weight, x):
    """Add `weight` times constraint row `r` to `x` (n,)."""
    coordinate, value = model.constraints.coordinate, work.row_value
    for k in range(model.constraints.size[r]):
        x[coordinate[r, k]] += weight * value[r, k]


@kernel
def row_product(model, work, r, x):
    """Return the product of constraint row `r` and the vector `x` (n,)."""
    coordinate, value = model.constraints.coordinate, work.row_value
    total = 0.0
    for k in range(model.constraints.size[r]):
        total += value[r, k] * x[coordinate[r, k]]
    return total


@kernel
def fill_column(model, work, r):
    """Write M^-1 times the gradient of constraint `r` to `work.columns[r]` (n,).

    A rigid body's coordinates are the positions of two base points p1 and p2. `work.stretch[r, side]` (2,) gets, for
    each of the constraint's two bodies that is rigid, this vector's entries at p2 minus the entries at p1.
    """
    bodies, row_force, column = model.bodies, work.row_force, work.columns[r]
    for side in range(2):
        b = model.constraints.bodies[r, side]
        if b >= 0:
            for i in range(bodies[b].offset, bodies[b].offset + bodies[b].coordinates):
                row_force[i] = 0.0
    for k in range(model.constraints.size[r]):
        row_force[model.constraints.coordinate[r, k]] = 0.0
    add_row(model, work, r, 1.0, row_force)
    for side in range(2):
        b = model.constraints.bodies[r, side]
        if b >= 0:
            body = bodies[b]
            solve_free(body, model.body_constants, row_force, column)
            if body.constraints:
                for axis in range(2):
                    i = body.offset + axis
                    work.stretch[r, side, axis] = column[i + 2] - column[i]


@kernel
def fill_columns(model, work, driven):
    """Write M^-1 a_r to `work.columns[r]` for constraint rows a_r of drives (`driven` true) or ideal joints (false).

    Their products a_s M^-1 a_r with all constraint rows a_s go to entries [r, s] and [s, r] of `work.free_schur`.
    """
    m = work.columns.shape[0]
    for r in range(m):
        if model.constraints.driven[r] == driven:
            fill_column(model, work, r)
    for r in range(m):
        if model.constraints.driven[r] == driven:
            for s in range(m):
                work.free_schur[r, s] = work.free_schur[s, r] = row_product(model, work, s, work.columns[r])


@kernel
def drive_angle(drive, time):
    """Return a drive's prescribed angle [rad], rate [rad/s] and angular acceleration [rad/s2] at `time` [s]."""
    span = drive.ramp_time
    if span <= 0.0 or time >= span:
        return drive.angle + drive.rate * (time - 0.5 * span), drive.rate, 0.0
    phase = 2.0 * math.pi * time / span
    angle = 0.5 * time * time + (span / (2.0 * math.pi)) ** 2 * (math.cos(phase) - 1.0)
    rate = time - span / (2.0 * math.pi) * math.sin(phase)
    scale = drive.rate / span
    return drive.angle + scale * angle, scale * rate, scale * (1.0 - math.cos(phase))


@kernel
def set_drive_rows(model, time, row_value):
    """Write the coefficients of drives' constraints at `time` [s] to the drives' rows of `row_value` (m, ROW_ENTRIES).

    A drive fixes a marker's direction. Its row's first four entries become factors of the marker's four coordinates.
    """
    for k in range(model.drives.size):
        drive = model.drives[k]
        marker = model.markers[drive.marker]
        psi, _, _ = drive_angle(drive, time)
        c, s, row = math.cos(psi), math.sin(psi), row_value[drive.row]
        row[0], row[1], row[2], row[3] = -s * marker.c1, c * marker.c1, -s, c


@kernel
def drive_motion(model, drive, time, q, v):
    """Return a drive constraint's rate at fixed q, and its second time derivative without the acceleration term."""
    marker = model.markers[drive.marker]
    psi, turn, turn_up = drive_angle(drive, time)
    c, s = math.cos(psi), math.sin(psi)
    dx, dy = direction(marker, q)
    ux, uy = direction(marker, v)
    rate = -turn * (s * dy + c * dx)
    bias = -2.0 * turn * (s * uy + c * ux) + turn * turn * (s * dx - c * dy) - turn_up * (c * dx + s * dy)
    return rate, bias


@kernel
def build_schur(model, q, work):
    """Compute and factor the linear constraints' compliance in `work.schur`; return False if they are redundant."""
    schur, free_schur, pull, row_bodies = work.schur, work.free_schur, work.pull, model.constraints.bodies
    m = schur.shape[0]
    driven = model.drives.size > 0
    if driven:
        fill_columns(model, work, driven)
    for r in range(m):
        for s in range(r + 1):
            schur[r, s] = free_schur[r, s]
        for side in range(2):
            b = row_bodies[r, side]
            if b < 0 or model.bodies[b].constraints == 0:
                continue
            body = model.bodies[b]
            pull[r, side] = stretch_along(body, q, work.stretch[r, side, 0], work.stretch[r, side, 1])
            weight = pull[r, side] / length_compliance(body, q)
            for s in range(r + 1):
                for other in range(2):
                    if row_bodies[s, other] == b and (s < r or other <= side):
                        schur[r, s] -= weight * pull[s, other]
    return cholesky_factor(schur, m)


@kernel
def add_columns(model, work, multipliers, x):
    """Subtract M^-1 A^T `multipliers` (A: constraint rows) from `x` (n,), except in the entries of rigid bodies."""
    bodies, columns = model.bodies, work.columns
    for r in range(columns.shape[0]):
        for side in range(2):
            b = model.constraints.bodies[r, side]
            if b >= 0 and bodies[b].constraints == 0:
                body = bodies[b]
                for i in range(body.offset, body.offset + body.coordinates):
                    x[i] -= multipliers[r] * columns[r, i]


@kernel
def subtract_response(model, q, work, multipliers, x):
    """Subtract the bodies' response P A^T `multipliers` to the constraint forces of joints and drives from `x` (n,).

    A (m, n) is the matrix of the linear constraints A q = b of ideal joints and drives. P gives the accelerations at
    `q` per generalized force, without joints but with lengths of rigid bodies kept. `work` has A and scratch arrays.
    """
    bodies, row_force, solution = model.bodies, work.row_force, work.solution
    for i in range(row_force.size):
        row_force[i] = 0.0
    for r in range(work.residual.size):
        add_row(model, work, r, multipliers[r], row_force)
    for b in range(bodies.size):
        body = bodies[b]
        if body.constraints:
            solve_body(body, model.body_constants, q, q, row_force, solution, 0.0)
            for i in range(body.offset, body.offset + body.coordinates):
                x[i] -= solution[i]
    add_columns(model, work, multipliers, x)


@kernel
def prepare_response(model, q, time, work):
    """Factor joints' and drives' compliance (acceleration per multiplier) in `work.schur`; return False if singular."""
    if model.drives.size > 0:
        set_drive_rows(model, time, work.row_value)
    return work.schur.shape[0] == 0 or build_schur(model, q, work)


@kernel
def constraint_drift(model, q, time, work):
    """Return the greatest violation [m] of the linear constraints; store all violations in `work.residual`."""
    worst = 0.0
    if model.drives.size > 0:
        set_drive_rows(model, time, work.row_value)
    for r in range(work.residual.size):
        work.residual[r] = row_product(model, work, r, q) - model.constraints.target[r]
        worst = max(worst, abs(work.residual[r]))
    return worst


@kernel
def velocity_drift(model, q, v, time, work):
    """Return the greatest violation [m/s] of the linear constraints' rates; store all violations in `work.residual`."""
    residual = work.residual
    if model.drives.size > 0:
        set_drive_rows(model, time, work.row_value)
    worst = 0.0
    for r in range(residual.size):
        residual[r] = row_product(model, work, r, v)
    for k in range(model.drives.size):
        drive = model.drives[k]
        rate, _ = drive_motion(model, drive, time, q, v)
        residual[drive.row] += rate
    for r in range(residual.size):
        worst = max(worst, abs(residual[r]))
    return worst


@kernel
def project(model, q, v, time, work):
    """Project positions and velocities in place onto all constraints by the smallest change in the mass metric.

    `work.schur` must hold the factored compliance (acceleration per multiplier) of joints and drives near `q`, which
    `prepare_response` or `accelerations` writes.
    """
    project_bodies(model.bodies, q, v)
    if work.residual.size > 0:
        project_linear(model, q, v, time, work)


@kernel
def project_linear(model, q, v, time, work):
    """Project positions and velocities in place onto the linear constraints, as part of `project`."""
    residual = work.residual
    constraint_drift(model, q, time, work)
    # The velocity correction uses the same compliance, because the position correction is tiny.
    for kind in range(2):
        if kind == 1:
            velocity_drift(model, q, v, time, work)
        cholesky_solve(work.schur, residual.size, residual)
        target = q if kind == 0 else v
        subtract_response(model, q, work, residual, target)
    # The position change violates the lengths, but only to second order.
    project_bodies(model.bodies, q, v)
