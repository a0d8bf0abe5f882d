"""Time integrals, force maxima and stored energies of an accepted step, and samples inside a step."""

import math

import numpy as np

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ANGLE, RATE
from solar_env.mechanics.joints.cable_loop import belt_loads
from solar_env.mechanics.joints.contact import contact_energy, friction_share, normal_force
from solar_env.mechanics.joints.torques.hinge import (
    add_cable_power,
    add_resistance_powers,
    add_torque_energies,
    enter_cable,
    enter_torques,
    hinge_torques,
    may_be_stiff,
)
from solar_env.mechanics.joints.torques.stop import stop_energy
from solar_env.mechanics.modal.arrays import (
    DEPTH,
    DEPTH_RATE,
    LENGTH,
    LEVER,
    NORMAL_X,
    NORMAL_Y,
    RIGID_BODY,
    SLIDING_SPEED,
    SLIP,
    STRETCH,
    WHEEL_RATE,
)
from solar_env.mechanics.modal.ends import axial_form
from solar_env.mechanics.modal.motion import force_of, look_at, outboard_load
from solar_env.mechanics.modal.tables import AXIAL_EVEN, GROUPS, LAST, NODES, POLYNOMIAL, STAGES, WEIGHTS
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import load4, square_roots, sum_lanes, where_less
from solar_env.mechanics.records.history import note_force

_SHORT = 1e-6  # s, greatest short step: velocities hardly change, rounding shows in difference quotients
_NO_TORQUE = 1e-12  # N m, greatest torque of a stop that has let go of its joint
_WEIGHTS = np.array([*WEIGHTS, 0.0])  # weights of the stages in an integral over the step, in vector lanes


@kernel
def note_arcs(work, joint, scratch, slid):
    """Store in `scratch.arcs` the arc (middle, half angle) [rad] along which a contact slid on journal and on bearing.

    Row 0 is the journal's, row 1 the bearing's. The middle is the mean of the contact's angle over the stages, weighted
    by their sliding work `slid` [J]; the half angle is sqrt(3) standard deviations.
    """
    motion, total = scratch.motion, sum_lanes(slid)
    if total > 0.0:
        nx, ny, share = load4(motion[NORMAL_X], 0), load4(motion[NORMAL_Y], 0), slid * (1.0 / total)
        x, y = sum_lanes(share * nx), sum_lanes(share * ny)
        size = math.sqrt(x * x + y * y)
        apart, angle = (x * ny - y * nx) * (1.0 / size), math.atan2(y, x)
        for side in range(2):
            arc, number = scratch.arcs[side], joint.outboard if side == 0 else joint.inboard
            direction = load4(work.attachments[number].direction[0], 0)
            turn = sum_lanes(share * direction)
            off = apart - (direction - turn)
            arc[0], arc[1] = angle - turn, math.sqrt(3.0 * sum_lanes(share * off * off))


@kernel
def add_integrals(model, state, work, h):
    """Add all joints' works, losses and impulses in the step `h` [s], which `work` describes, to `work.integrals`.

    A stop's loss is the work done on it minus the increase of its stored energy. Both are sums over the stages. If the
    stop lets go in the step, however, its stored energies at the step's start and end give the increase.
    """
    integrals, weights = work.integrals, h * load4(_WEIGHTS, 0)
    for j in range(model.joints.size):
        joint, joint_state, first = model.joints[j], state.joints[j], m.INTEGRALS_PER_JOINT * j
        motion, force, before = work.joints[j].motion, force_of(model, j), state.motion[j]
        start, end = before[ANGLE], motion[ANGLE, LAST]
        integrals[first + m.MOTOR_WORK] += joint_state.motor_torque * (end - start)
        if may_be_stiff(joint, joint_state):
            rate = load4(motion[RATE], 0)
            torques = hinge_torques(joint, joint_state, load4(motion[ANGLE], 0), rate)
            add_resistance_powers(torques, rate, weights, j, integrals)
            let_go = sum_lanes(where_less(abs(torques.latch), _NO_TORQUE, 1.0, 0.0)) > 0.0
            if let_go:
                stored = stop_energy(joint, joint_state, end) - stop_energy(joint, joint_state, start)
            else:
                stored = -sum_lanes(weights * torques.latch_elastic * rate)
            integrals[first + m.LATCH_DISSIPATION] -= sum_lanes(weights * torques.latch * rate) + stored
        normal, tangential = load4(work.loads[force].stage, 0), load4(work.loads[force + 1].stage, 0)
        if joint.kind == m.IDEAL:
            reaction = square_roots(normal * normal + tangential * tangential)
            integrals[first + m.IMPULSE] += sum_lanes(weights * reaction)
        elif joint_state.in_contact:
            normal, depth_rate = where_less(0.0, normal, normal, 0.0), load4(motion[DEPTH_RATE], 0)
            _, elastic, _, _ = normal_force(joint, load4(motion[DEPTH], 0), depth_rate, joint_state.impact_speed)
            integrals[first + m.NORMAL_DISSIPATION] += sum_lanes(weights * (normal - elastic) * depth_rate)
            integrals[first + m.FRICTION_DISSIPATION] -= sum_lanes(weights * tangential * load4(motion[SLIP], 0))
            integrals[first + m.IMPULSE] += sum_lanes(weights * normal)
            slid = weights * normal * abs(load4(motion[SLIDING_SPEED], 0))
            integrals[first + m.SLIDING_WORK] += sum_lanes(slid)
            if joint.wear_coefficient > 0.0:
                note_arcs(work, joint, work.joints[j], slid)
    for c in range(model.cables.size):
        cable, motion = model.cables[c], work.cables[c].motion
        torque = load4(work.loads[model.joints.size + c].stage, 0)
        add_cable_power(cable, torque, load4(motion[WHEEL_RATE], 0), weights, integrals)


@kernel
def note_peaks(model, state, work, h, share):
    """Raise the joints' force maxima to the step's greatest contact forces.

    If the force is greatest at a stage before the step's end, the maximum of the parabola through this value and both
    neighbours counts. The arguments `h` and `share`, which other methods need, are ignored.
    """
    postlock = state.clock[0].latched_joints > 0
    for j in range(model.joints.size):
        joint_state, force = state.joints[j], force_of(model, j)
        if joint_state.in_contact:
            start, stage = state.course[force, LAST], work.loads[force].stage
            peak, top = start, -1
            for s in range(STAGES):
                if stage[s] > peak:
                    peak, top = stage[s], s
            if 0 <= top < LAST:
                before = stage[top - 1] if top > 0 else start
                left = NODES[top] - (NODES[top - 1] if top > 0 else 0.0)
                right = NODES[top + 1] - NODES[top]
                fall, rise = (stage[top + 1] - peak) / right, (peak - before) / left
                curvature, slope = (fall - rise) / (left + right), (rise * right + fall * left) / (left + right)
                peak -= 0.25 * slope * slope / curvature
            note_force(joint_state, peak, postlock)


@kernel
def panel_energies(model, body, q, v, work, energies):
    """Add a panel's modal energies [J] to the kinetic and elastic `energies`; `work` holds the motion at `q`, `v`."""
    panels, d, first, panel = model.panels, body.design, body.offset + 3, work.panels[body.panel]
    for group in range(GROUPS):
        for k in range(panels.first[group], panels.first[group + 1]):
            stretch, r = q[first + k], k - panels.first[group]
            if group >= AXIAL_EVEN and r < panels.coupled[group]:
                stretch -= panel.shortening[axial_form(group, r), 0]
            energies[m.ELASTIC] += 0.5 * (panels.frequency[d, k] * stretch) ** 2
            energies[m.KINETIC] += 0.5 * v[first + k] ** 2


@kernel(inlined=False)
def stored_energies(model, state, q, v, work, energies):
    """Write energies [J] to `energies` in the order of `ENERGY_NAMES`; call `look_at` first with `q`, `v`, `work`."""
    energies[:] = 0.0
    for b in range(model.bodies.size):
        body = model.bodies[b]
        k = body.offset
        if body.inverse_mass > 0.0:
            energies[m.KINETIC] += 0.5 * body.mass * (v[k] * v[k] + v[k + 1] * v[k + 1])
            energies[m.KINETIC] += 0.5 * body.inertia * v[k + 2] * v[k + 2]
            energies[m.GRAVITY] -= body.mass * (model.gravity[0] * q[k] + model.gravity[1] * q[k + 1])
        if body.panel != RIGID_BODY:
            panel_energies(model, body, q, v, work, energies)
    for j in range(model.joints.size):
        joint, joint_state, motion = model.joints[j], state.joints[j], work.joints[j].motion
        add_torque_energies(joint, joint_state, motion[ANGLE, 0], energies)
        if joint.kind == m.CLEARANCE:
            energies[m.CONTACT] += contact_energy(joint, motion[DEPTH, 0])
    for c in range(model.cables.size):
        motion = work.cables[c].motion
        _, _, energy, _, _, _ = belt_loads(model.cables[c], motion[STRETCH, 0], motion[LENGTH, 0])
        energies[m.CABLE] += energy


@kernel
def cubic(share, x0, r0, x1, r1):
    """Return a Hermite cubic at the fraction `share` of a step, from values x0, x1, rates * step r0, r1 at its ends."""
    rest = 1.0 - share
    return rest * rest * ((1.0 + 2.0 * share) * x0 + share * r0) + share * share * (
        (3.0 - 2.0 * share) * x1 - rest * r1
    )


@kernel(inlined=False)
def fill_load_table(model, state, work, loads, table):
    """Write motion, forces and torques of all joints to `table` (joints, LOAD_COLUMNS).

    The motion is in `work`, and torques follow from it. Forces are the last entries of `loads`, two for each joint.
    """
    for j in range(model.joints.size):
        joint, joint_state, motion, row = model.joints[j], state.joints[j], work.joints[j].motion, table[j]
        first, second = loads[force_of(model, j)], loads[force_of(model, j) + 1]
        for column in range(columns.SHARED_COLUMNS):
            row[column] = motion[column, 0]
        nx, ny, lever = motion[NORMAL_X, 0], motion[NORMAL_Y, 0], motion[LEVER, 0]
        fx, fy, _, _ = outboard_load(joint, nx, ny, lever, first, second, 0.0)
        row[columns.FORCE_X], row[columns.FORCE_Y] = fx, fy
        row[columns.NORMAL], row[columns.TANGENTIAL] = first, second
        if joint.kind == m.IDEAL:
            row[columns.ECCENTRICITY_X], row[columns.ECCENTRICITY_Y] = 0.0, 0.0
            row[columns.NORMAL], row[columns.TANGENTIAL] = math.sqrt(fx * fx + fy * fy), 0.0
        enter_torques(hinge_torques(joint, joint_state, motion[ANGLE, 0], motion[RATE, 0]), j, table)
    for c in range(model.cables.size):
        cable, motion = model.cables[c], work.cables[c].motion
        torque, _, _, _, _, _ = belt_loads(cable, motion[STRETCH, 0], motion[LENGTH, 0])
        enter_cable(cable, torque, table)


@kernel
def course_at(stage, share):
    """Return a polynomial's value at a fraction `share` of a step, given its values `stage` at the step's stages."""
    total = 0.0
    for k in range(STAGES):
        value = 0.0
        for down in range(STAGES):
            value = value * share + POLYNOMIAL[k][LAST - down]
        total += value * stage[k]
    return total


@kernel
def sample_modal(model, state, settings, work, recorder, h, share):
    """Store motion, loads, energies and time integrals at a fraction `share` of a step in a row of `recorder.samples`.

    The step `h` [s] runs from `state` to the motion in `work`. Coordinates are cubics, whose slopes are the velocities
    of bodies. Forces are polynomials through their values at the stages; torques and friction follow from the motion.
    Modal velocities, and works, losses and impulses, are interpolated linearly.
    """
    n, rest = state.q.size, 1.0 - share
    row = recorder.samples[recorder.filled[0]]
    for i in range(n):
        x0, v0, x1, v1 = state.q[i], state.v[i], work.q[i], work.v[i]
        row[i] = cubic(share, x0, h * v0, x1, h * v1)
        row[n + i] = v0 + share * (v1 - v0)
    if h > _SHORT:
        for b in range(model.bodies.size):
            for i in range(model.bodies[b].offset, model.bodies[b].offset + 3):
                rise, v0, v1 = (work.q[i] - state.q[i]) / h, state.v[i], work.v[i]
                row[n + i] = rest * (6.0 * share * rise + (1.0 - 3.0 * share) * v0) + share * (3.0 * share - 2.0) * v1
    look_at(model, row[:n], row[n : 2 * n], work)
    for k in range(work.loads.size):
        work.sample_load[k] = course_at(work.loads[k].stage, share)
    for j in range(model.joints.size):
        joint, motion, k = model.joints[j], work.joints[j].motion, force_of(model, j)
        if joint.kind == m.CLEARANCE:
            # A polynomial shows neither the moment at which surfaces part nor the moment at which sliding reverses.
            normal = max(work.sample_load[k], 0.0) if motion[DEPTH, 0] > 0.0 else 0.0
            slip, _ = friction_share(joint, motion[SLIDING_SPEED, 0])
            work.sample_load[k], work.sample_load[k + 1] = normal, -joint.friction_coefficient * slip * normal
    fill_load_table(model, state, work, work.sample_load, work.sample)
    stored_energies(model, state, row[:n], row[n : 2 * n], work, work.energies)
    k = 2 * n
    for j in range(model.joints.size):
        for c in range(columns.LOAD_COLUMNS):
            row[k] = work.sample[j, c]
            k += 1
    for e in range(work.energies.size):
        row[k] = work.energies[e]
        k += 1
    for i in range(state.integrals.size):
        row[k] = state.integrals[i] + share * (work.integrals[i] - state.integrals[i])
        k += 1
    recorder.filled[0] += 1
