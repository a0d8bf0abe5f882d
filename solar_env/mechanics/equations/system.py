"""Global quantities as sums over the mechanism's parts: accelerations, constraint drift, energies.

The equations of motion are M a + Phi_q^T lambda = Q(q, v, t) with two kinds of constraint: the length of every body in
natural coordinates, eliminated body by body in closed form, and linear rows A(t) q = b for ideal joints, guides and
drives, solved through the bodies' compliances (the dual Schur complement A P A^T, one row and column a constraint).
Those of other bodies are constant.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import (
    CABLE,
    CLEARANCE,
    CONTACT,
    ELASTIC,
    EXTERNAL_WORK,
    GRAVITY,
    IDEAL,
    IMPULSE,
    INTEGRALS_PER_JOINT,
    KINETIC,
    LATCH,
    MATERIAL_DISSIPATION,
    SPRING,
    Model,
    State,
)
from solar_env.mechanics.bodies.cable_element.forces import LANES, TABLE_ROWS
from solar_env.mechanics.bodies.dispatch import (
    add_internal_forces,
    add_mass_product,
    elastic_energy,
    kinetic_energy,
    project_bodies,
    solve_body,
    solve_free,
)
from solar_env.mechanics.bodies.linear_marker import set_direction_row
from solar_env.mechanics.bodies.markers import add_point_force, add_torque, direction, direction_rate, place, spin
from solar_env.mechanics.bodies.natural_coordinates import length_compliance, stretch_along
from solar_env.mechanics.joints.contact.normal_force import contact_energy
from solar_env.mechanics.joints.joint import (
    ANGLE,
    ECCENTRICITY_X,
    ECCENTRICITY_Y,
    FORCE_X,
    FORCE_Y,
    LOAD_COLUMNS,
    NORMAL,
    TANGENTIAL,
    cable_torque,
    joint_forces,
    stop_energy,
)
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import cholesky_factor, cholesky_solve, copy_into


class Workspace(NamedTuple):
    """Scratch arrays of one evaluation; nothing in them outlives a step."""

    force: NDArray[np.float64]  # (n,)
    loads: NDArray[np.float64]  # (joints, LOAD_COLUMNS)
    power: NDArray[np.float64]  # (integrals,)
    impact_speeds: NDArray[np.float64]  # (joints,)
    row_value: NDArray[np.float64]  # (m, ROW_ENTRIES) linear constraint rows at the present time
    columns: NDArray[np.float64]  # (m, n) inverse mass matrix times rows
    free_schur: NDArray[np.float64]  # (m, m) rows times columns
    stretch: NDArray[np.float64]  # (m, 2, 2) stretch of a row's two bodies by its column
    pull: NDArray[np.float64]  # (m, 2) that stretch along the body, at the present configuration
    schur: NDArray[np.float64]  # (m, m) compliance of the rows, factored
    residual: NDArray[np.float64]  # (m,)
    row_force: NDArray[np.float64]  # (n,)
    solution: NDArray[np.float64]  # (n,)
    element_table: NDArray[np.float64]  # (TABLE_ROWS * LANES,)


def make_workspace(model: Model, state: State) -> Workspace:
    """Allocate the scratch arrays for a model."""
    n, m, joints = state.q.size, model.constraints.size.size, model.joints.size
    work = Workspace(
        force=np.zeros(n),
        loads=np.zeros((joints, LOAD_COLUMNS)),
        power=np.zeros(state.integrals.size),
        impact_speeds=np.zeros(joints),
        row_value=model.constraints.value.copy(),
        columns=np.zeros((m, n)),
        free_schur=np.zeros((m, m)),
        stretch=np.zeros((m, 2, 2)),
        pull=np.zeros((m, 2)),
        schur=np.zeros((m, m)),
        residual=np.zeros(m),
        row_force=np.zeros(n),
        solution=np.zeros(n),
        element_table=np.zeros(TABLE_ROWS * LANES),
    )
    fill_columns(model, work, False)
    return work


@kernel(inlined=True)
def add_row(model, work, r, weight, x):
    """Add `weight` times constraint row `r` to `x` (n,)."""
    coordinate, value = model.constraints.coordinate, work.row_value
    for k in range(model.constraints.size[r]):
        x[coordinate[r, k]] += weight * value[r, k]


@kernel(inner=True, inlined=True)
def row_product(model, work, r, x):
    """Constraint row `r` times `x` (n,)."""
    coordinate, value = model.constraints.coordinate, work.row_value
    total = 0.0
    for k in range(model.constraints.size[r]):
        total += value[r, k] * x[coordinate[r, k]]
    return total


@kernel(inner=True)
def fill_column(model, work, r):
    """Inverse mass matrix times constraint row `r`, into its column, with the stretch of lengths by it."""
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
    """Fill the columns of the driven rows, which change, or of all others, with their products."""
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
    """Prescribed angle [rad], rate and angular acceleration of a drive."""
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
    """Write the rows of prescribed rotations: the body's direction stays parallel to (cos psi, sin psi)."""
    for k in range(model.drives.size):
        drive = model.drives[k]
        marker = model.markers[drive.marker]
        psi, _, _ = drive_angle(drive, time)
        c, s = math.cos(psi), math.sin(psi)
        set_direction_row(marker, c, s, row_value[drive.row])


@kernel(inner=True)
def drive_motion(model, drive, time, q, v):
    """Explicit time derivatives of a drive's constraint: its rate at fixed q, and the acceleration's bias."""
    marker = model.markers[drive.marker]
    psi, turn, turn_up = drive_angle(drive, time)
    c, s = math.cos(psi), math.sin(psi)
    dx, dy = direction(marker, q)
    ux, uy = direction_rate(marker, q, v)
    rate = -turn * (s * dy + c * dx)
    bias = -2.0 * turn * (s * uy + c * ux) + turn * turn * (s * dx - c * dy) - turn_up * (c * dx + s * dy)
    return rate, bias


@kernel(inner=True)
def build_schur(model, q, work):
    """Compliance of the linear constraints, factored; False if they are redundant.

    A row's compliance at free lengths is constant; a body's own length takes a rank-one part from it.
    """
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


@kernel(inner=True)
def add_columns(model, work, multipliers, x):
    """Subtract the columns times `multipliers` from `x` (n,), for bodies without a constraint of their own."""
    bodies, columns = model.bodies, work.columns
    for r in range(columns.shape[0]):
        for side in range(2):
            b = model.constraints.bodies[r, side]
            if b >= 0 and bodies[b].constraints == 0:
                body = bodies[b]
                for i in range(body.offset, body.offset + body.coordinates):
                    x[i] -= multipliers[r] * columns[r, i]


@kernel(inner=True)
def subtract_response(model, q, work, multipliers, x):
    """Subtract from `x` (n,) the accelerations by `multipliers` of the linear constraints, lengths kept."""
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


@kernel(inner=True)
def apply_linear_constraints(model, q, v, time, work, a, multipliers):
    """Correct the accelerations for the linear constraints; False if they are redundant."""
    bodies, force = model.bodies, work.force
    m = work.schur.shape[0]
    if model.drives.size > 0:
        set_drive_rows(model, time, work.row_value)
    if not build_schur(model, q, work):
        return False
    for r in range(m):
        multipliers[r] = row_product(model, work, r, a)
    for k in range(model.drives.size):
        drive = model.drives[k]
        _, bias = drive_motion(model, drive, time, q, v)
        multipliers[drive.row] += bias
    cholesky_solve(work.schur, m, multipliers)
    for r in range(m):
        add_row(model, work, r, -multipliers[r], force)
    add_columns(model, work, multipliers, a)
    for b in range(bodies.size):
        if bodies[b].constraints:
            multipliers[m + b] = solve_body(bodies[b], model.body_constants, q, v, force, a, 1.0)
    store_constraint_loads(model, multipliers, time, q, work)
    return True


@kernel
def prepare_response(model, q, time, work):
    """Fill the compliance of the linear constraints at a configuration; False if they are redundant."""
    if model.drives.size > 0:
        set_drive_rows(model, time, work.row_value)
    return work.schur.shape[0] == 0 or build_schur(model, q, work)


@kernel(inner=True)
def acceleration_response(model, q, work, force, a):
    """Write to `a` (n,) what a generalized `force` (n,) adds to the accelerations."""
    m = work.schur.shape[0]
    for b in range(model.bodies.size):
        solve_body(model.bodies[b], model.body_constants, q, q, force, a, 0.0)
    if m == 0:
        return
    for r in range(m):
        work.residual[r] = row_product(model, work, r, a)
    cholesky_solve(work.schur, m, work.residual)
    subtract_response(model, q, work, work.residual, a)


@kernel(inlined=True)
def applied_forces(model, joint_states, q, v, work):
    """Fill `work` with all generalized forces but the constraints', with loads and powers."""
    force, power, loads = work.force, work.power, model.loads
    copy_into(force, model.constant_force)
    external = 0.0
    for k in range(loads.size):
        marker = model.markers[loads[k].marker]
        add_point_force(marker, q, loads[k].force_x, loads[k].force_y, force)
        add_torque(marker, q, loads[k].torque, force)
        external += loads[k].torque * spin(marker, q, v)
    power[power.size + EXTERNAL_WORK] = external
    power[power.size + MATERIAL_DISSIPATION] = add_internal_forces(model, q, v, force, work.element_table)
    joint_forces(model, joint_states, work.impact_speeds, q, v, work.loads, force, power)


@kernel(inner=True, inlined=True)
def inlined_accelerations(model, joint_states, q, v, time, work, a, multipliers):
    """Accelerations (n,) at a configuration, with loads and powers in `work`; False if constraints are redundant.

    `multipliers` receives those of the linear rows, then one per body for its length.
    """
    force = work.force
    m = work.residual.size
    applied_forces(model, joint_states, q, v, work)
    for b in range(model.bodies.size):
        multipliers[m + b] = solve_body(model.bodies[b], model.body_constants, q, v, force, a, 1.0)
    if m == 0:
        return True
    return apply_linear_constraints(model, q, v, time, work, a, multipliers)


@kernel
def accelerations(model, joint_states, q, v, time, work, a, multipliers):
    """`inlined_accelerations` as a call, for places that are not hot."""
    return inlined_accelerations(model, joint_states, q, v, time, work, a, multipliers)


@kernel(inner=True)
def store_constraint_loads(model, multipliers, time, q, work):
    """Enter the multipliers of ideal joints as joint forces, and add the drives' power."""
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
        psi, rate, _ = drive_angle(drive, time)
        drive_power -= multipliers[drive.row] * (dx * math.cos(psi) + dy * math.sin(psi)) * rate
    work.power[work.power.size + EXTERNAL_WORK] += drive_power


@kernel
def constraint_drift(model, q, time, work):
    """Greatest violation [m] of the linear constraints; leaves it by row in `work.residual`."""
    worst = 0.0
    if model.drives.size > 0:
        set_drive_rows(model, time, work.row_value)
    for r in range(work.residual.size):
        work.residual[r] = row_product(model, work, r, q) - model.constraints.target[r]
        worst = max(worst, abs(work.residual[r]))
    return worst


@kernel
def velocity_drift(model, q, v, time, work):
    """Greatest violation [m/s] of the linear constraints' rates; leaves it by row in `work.residual`."""
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


@kernel(inlined=True)
def project(model, q, v, time, work):
    """Return positions and velocities to the constraints by the smallest change in the mass metric.

    `work` must hold the compliance of the linear constraints hereabouts, from `prepare_response` or from an
    evaluation of the accelerations.
    """
    project_bodies(model.bodies, q, v)
    if work.residual.size > 0:
        project_linear(model, q, v, time, work)


@kernel(inner=True)
def project_linear(model, q, v, time, work):
    """`project` for the linear constraints."""
    residual = work.residual
    constraint_drift(model, q, time, work)
    # The velocities are corrected with the rows of the same configuration: the position change is tiny.
    for kind in range(2):
        if kind == 1:
            velocity_drift(model, q, v, time, work)
        cholesky_solve(work.schur, residual.size, residual)
        target = q if kind == 0 else v
        subtract_response(model, q, work, residual, target)
    # The position change leaves the lengths only to second order.
    project_bodies(model.bodies, q, v)


@kernel
def add_mass_products(model, a, out):
    """Add M a to `out` (n,); nothing for fixed bodies."""
    for body in model.bodies:
        add_mass_product(body, model.body_constants, a, out)


@kernel
def stored_energies(model, joint_states, q, v, loads, energies):
    """Fill the stored energies [J] at a configuration whose `loads` are current."""
    energies[:] = 0.0
    for body in model.bodies:
        energies[KINETIC] += kinetic_energy(body, model.body_constants, v)
    energies[ELASTIC] = elastic_energy(model.bodies, q)
    for i in range(q.size):
        energies[GRAVITY] -= model.constant_force[i] * q[i]
    for load in model.loads:
        x, y = place(model.markers[load.marker], q)
        energies[GRAVITY] -= load.force_x * x + load.force_y * y
    for j in range(model.joints.size):
        joint = model.joints[j]
        stretch = joint.spring_preload_angle - loads[j, ANGLE]
        energies[SPRING] += 0.5 * joint.spring_stiffness * stretch * stretch
        energies[LATCH] += stop_energy(joint, joint_states[j], loads[j, ANGLE])
        if joint.kind == CLEARANCE:
            depth = math.hypot(loads[j, ECCENTRICITY_X], loads[j, ECCENTRICITY_Y]) - joint.clearance
            if depth > 0.0:
                energies[CONTACT] += contact_energy(joint, depth)
    for c in range(model.cables.size):
        cable = model.cables[c]
        stretch = cable.wheel_ratio * loads[cable.joint_a, ANGLE] - loads[cable.joint_b, ANGLE]
        _, _, energy = cable_torque(cable, stretch)
        energies[CABLE] += energy


@kernel
def normal_inverse_mass(model, q, v, j, work):
    """Inverse effective mass [1/kg] of joint `j` along its line of centres: acceleration per unit normal force."""
    joint = model.joints[j]
    total = 0.0
    # Approximated by the two bodies alone: what else hangs on them moves only after the contact's onset.
    dx, dy = work.loads[j, ECCENTRICITY_X], work.loads[j, ECCENTRICITY_Y]
    size = math.hypot(dx, dy)
    nx, ny = (dx / size, dy / size) if size > 0.0 else (1.0, 0.0)
    for side in range(2):
        marker = model.markers[joint.outboard if side == 0 else joint.inboard]
        body = model.bodies[marker.body]
        if body.fixed:
            continue
        for i in range(body.offset, body.offset + body.coordinates):
            work.row_force[i] = 0.0
        add_point_force(marker, q, nx, ny, work.row_force)
        solve_body(body, model.body_constants, q, v, work.row_force, work.solution, 0.0)
        for i in range(body.offset, body.offset + body.coordinates):
            total += work.row_force[i] * work.solution[i]
    return total
