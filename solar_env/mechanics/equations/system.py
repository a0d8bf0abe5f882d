"""Forces, accelerations and energies of a whole mechanism, as sums over its parts.

The equations of motion are M a + Phi_q^T lambda = Q(q, v, t) with two kinds of constraint. The length of every body in
natural coordinates is eliminated body by body in closed form. Ideal joints and drives give linear rows A(t) q = b
(`constraints.py`).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.model import Model, State
from solar_env.mechanics.bodies import dispatch
from solar_env.mechanics.bodies.cable_element.forces import LANES, TABLE_ROWS
from solar_env.mechanics.bodies.markers import add_point_force, add_torque, direction, spin
from solar_env.mechanics.equations import constraints
from solar_env.mechanics.joints.cable_loop import belt_loads, wheel_motion
from solar_env.mechanics.joints.contact import contact_energy
from solar_env.mechanics.joints.joint import joint_forces
from solar_env.mechanics.joints.torques.hinge import add_torque_energies
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import cholesky_solve, copy_into


class Workspace(NamedTuple):
    """Work arrays of one evaluation of the equations of motion; their contents do not outlive a step."""

    force: NDArray[np.float64]  # (n,)
    loads: NDArray[np.float64]  # (joints, columns.LOAD_COLUMNS)
    power: NDArray[np.float64]  # (integrals,)
    impact_speeds: NDArray[np.float64]  # (joints,)
    row_value: NDArray[np.float64]  # (rows, ROW_ENTRIES) linear constraint rows at the present time
    columns: NDArray[np.float64]  # (rows, n) inverse mass matrix times constraint rows
    free_schur: NDArray[np.float64]  # (rows, rows) constraint rows times columns
    stretch: NDArray[np.float64]  # (rows, 2, 2) stretch of a row's two bodies by the row's column
    pull: NDArray[np.float64]  # (rows, 2) component of the stretch along the body, at the present configuration
    schur: NDArray[np.float64]  # (rows, rows) compliance of the rows, factored
    residual: NDArray[np.float64]  # (rows,)
    row_force: NDArray[np.float64]  # (n,)
    solution: NDArray[np.float64]  # (n,)
    element_table: NDArray[np.float64]  # (TABLE_ROWS * LANES,)


def make_workspace(model: Model, state: State) -> Workspace:
    """Allocate the work arrays for a model, and compute the columns (M^-1 times row) of constant constraint rows."""
    n, rows, joints = state.q.size, model.constraints.size.size, model.joints.size
    work = Workspace(
        force=np.zeros(n),
        loads=np.zeros((joints, columns.LOAD_COLUMNS)),
        power=np.zeros(state.integrals.size),
        impact_speeds=np.zeros(joints),
        row_value=model.constraints.value.copy(),
        columns=np.zeros((rows, n)),
        free_schur=np.zeros((rows, rows)),
        stretch=np.zeros((rows, 2, 2)),
        pull=np.zeros((rows, 2)),
        schur=np.zeros((rows, rows)),
        residual=np.zeros(rows),
        row_force=np.zeros(n),
        solution=np.zeros(n),
        element_table=np.zeros(TABLE_ROWS * LANES),
    )
    constraints.fill_columns(model, work, False)
    return work


@kernel
def apply_linear_constraints(model, q, v, time, work, a, multipliers):
    """Correct accelerations `a` for the linear constraints, write `multipliers`; False if constraints are redundant."""
    bodies, force = model.bodies, work.force
    rows = work.schur.shape[0]
    if model.drives.size > 0:
        constraints.set_drive_rows(model, time, work.row_value)
    if not constraints.build_schur(model, q, work):
        return False
    for r in range(rows):
        multipliers[r] = constraints.row_product(model, work, r, a)
    for k in range(model.drives.size):
        drive = model.drives[k]
        _, bias = constraints.drive_motion(model, drive, time, q, v)
        multipliers[drive.row] += bias
    cholesky_solve(work.schur, rows, multipliers)
    for r in range(rows):
        constraints.add_row(model, work, r, -multipliers[r], force)
    constraints.add_columns(model, work, multipliers, a)
    for b in range(bodies.size):
        if bodies[b].constraints:
            multipliers[rows + b] = dispatch.solve_body(bodies[b], model.body_constants, q, v, force, a, 1.0)
    store_constraint_loads(model, multipliers, time, q, work)
    return True


@kernel
def acceleration_response(model, q, work, force, a):
    """Write the accelerations due to an additional generalized `force` (n,) under all constraints to `a` (n,)."""
    rows = work.schur.shape[0]
    for b in range(model.bodies.size):
        dispatch.solve_body(model.bodies[b], model.body_constants, q, q, force, a, 0.0)
    if rows == 0:
        return
    for r in range(rows):
        work.residual[r] = constraints.row_product(model, work, r, a)
    cholesky_solve(work.schur, rows, work.residual)
    constraints.subtract_response(model, q, work, work.residual, a)


@kernel
def applied_forces(model, joint_states, q, v, work):
    """Write generalized forces, without constraint forces, to `work.force` (n,), and joints' loads to `work.loads`.

    `work.power` gets the rates of change of `State.integrals`: powers [W] of the forces and torques in each joint, of
    load torques and of material damping, and impulse rates [N].
    """
    force, power, loads = work.force, work.power, model.loads
    copy_into(force, model.constant_force)
    external = 0.0
    for k in range(loads.size):
        marker = model.markers[loads[k].marker]
        add_torque(marker, q, loads[k].torque, force)
        external += loads[k].torque * spin(marker, q, v)
    power[power.size + m.EXTERNAL_WORK] = external
    power[power.size + m.MATERIAL_DISSIPATION] = dispatch.add_internal_forces(model, q, v, force, work.element_table)
    joint_forces(model, joint_states, work.impact_speeds, q, v, work.loads, force, power)


@kernel
def inlined_accelerations(model, joint_states, q, v, time, work, a, multipliers):
    """Write accelerations to `a` (n,), joint loads and powers to `work`; return False if constraints are redundant.

    `multipliers` (m + bodies,) gets Lagrange multipliers: m of linear constraints, then one per body. A rigid body's
    multiplier keeps the distance of its two base points constant; it is zero for beams and fixed bodies.
    """
    force = work.force
    rows = work.residual.size
    applied_forces(model, joint_states, q, v, work)
    for b in range(model.bodies.size):
        multipliers[rows + b] = dispatch.solve_body(model.bodies[b], model.body_constants, q, v, force, a, 1.0)
    if rows == 0:
        return True
    return apply_linear_constraints(model, q, v, time, work, a, multipliers)


@kernel(inlined=False)
def accelerations(model, joint_states, q, v, time, work, a, multipliers):
    """Write accelerations to `a` (n,), joint loads and powers to `work`; return False if constraints are redundant.

    `multipliers` (m + bodies,) gets Lagrange multipliers: m of linear constraints, then one per body, which keeps the
    distance of a rigid body's two base points constant. This is `inlined_accelerations`, compiled once for all callers.
    """
    return inlined_accelerations(model, joint_states, q, v, time, work, a, multipliers)


@kernel
def store_constraint_loads(model, multipliers, time, q, work):
    """Store ideal joints' multipliers as joint forces in `work.loads`, and add the drives' power to `work.power`."""
    for j in range(model.joints.size):
        joint = model.joints[j]
        if joint.kind == m.IDEAL and joint.row >= 0:
            fx, fy = -multipliers[joint.row], -multipliers[joint.row + 1]
            work.loads[j, columns.FORCE_X] = fx
            work.loads[j, columns.FORCE_Y] = fy
            work.loads[j, columns.NORMAL] = math.sqrt(fx * fx + fy * fy)
            work.loads[j, columns.TANGENTIAL] = 0.0
            work.power[m.INTEGRALS_PER_JOINT * j + m.IMPULSE] = work.loads[j, columns.NORMAL]
    drive_power = 0.0
    for k in range(model.drives.size):
        drive = model.drives[k]
        dx, dy = direction(model.markers[drive.marker], q)
        psi, rate, _ = constraints.drive_angle(drive, time)
        drive_power -= multipliers[drive.row] * (dx * math.cos(psi) + dy * math.sin(psi)) * rate
    work.power[work.power.size + m.EXTERNAL_WORK] += drive_power


@kernel(inlined=False)
def add_mass_products(model, a, out):
    """Add the mass matrix times the accelerations `a` (n,) to `out` (n,); fixed bodies add nothing."""
    for body in model.bodies:
        dispatch.add_mass_product(body, model.body_constants, a, out)


@kernel(inlined=False)
def stored_energies(model, joint_states, q, v, loads, energies):
    """Write energies [J] in the order of `ENERGY_NAMES` to `energies`; `loads` is the joint-load table at `q`, `v`."""
    energies[:] = 0.0
    for body in model.bodies:
        energies[m.KINETIC] += dispatch.kinetic_energy(body, model.body_constants, v)
    energies[m.ELASTIC] = dispatch.elastic_energy(model.bodies, q)
    for i in range(q.size):
        energies[m.GRAVITY] -= model.constant_force[i] * q[i]
    for j in range(model.joints.size):
        joint = model.joints[j]
        add_torque_energies(joint, joint_states[j], loads[j, columns.ANGLE], energies)
        if joint.kind == m.CLEARANCE:
            depth = math.hypot(loads[j, columns.ECCENTRICITY_X], loads[j, columns.ECCENTRICITY_Y]) - joint.clearance
            if depth > 0.0:
                energies[m.CONTACT] += contact_energy(joint, depth)
    for c in range(model.cables.size):
        cable = model.cables[c]
        angles = loads[cable.joint_a, columns.ANGLE], loads[cable.joint_b, columns.ANGLE]
        stretch, length = wheel_motion(cable, model.joints, model.markers, q, angles[0], angles[1])
        _, _, energy, _, _, _ = belt_loads(cable, stretch, length)
        energies[m.CABLE] += energy


@kernel(inlined=False)
def normal_inverse_mass(model, q, v, j, work):
    """Return the inverse effective mass [1/kg] of joint `j` along its line of centres: acceleration per unit force."""
    joint = model.joints[j]
    total = 0.0
    # An approximation by the two bodies alone: bodies attached to them move only after the contact's onset.
    dx, dy = work.loads[j, columns.ECCENTRICITY_X], work.loads[j, columns.ECCENTRICITY_Y]
    size = math.hypot(dx, dy)
    nx, ny = (dx / size, dy / size) if size > 0.0 else (1.0, 0.0)
    for side in range(2):
        marker = model.markers[joint.outboard if side == 0 else joint.inboard]
        body = model.bodies[marker.body]
        if body.fixed:
            continue
        for i in range(body.offset, body.offset + body.coordinates):
            work.row_force[i] = 0.0
        add_point_force(marker, nx, ny, work.row_force)
        dispatch.solve_body(body, model.body_constants, q, v, work.row_force, work.solution, 0.0)
        for i in range(body.offset, body.offset + body.coordinates):
            total += work.row_force[i] * work.solution[i]
    return total
