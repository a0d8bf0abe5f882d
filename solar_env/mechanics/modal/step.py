"""One step of the two-stage Radau IIA method on the loads of the joints: Newton's iteration, error, acceptance.

Third order, stiffly accurate, L-stable (E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed.,
Springer 1996, section IV.5, doi:10.1007/978-3-642-05221-7). Directions, lever arms and foreshortening are those of the
stages, renewed in every iteration; the matrix takes them from the first one. With ideal joints the relative velocity
vanishes at the stages, less a share that returns the position.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from solar_env.mechanics.arrays.model import IDEAL, MATERIAL_DISSIPATION
from solar_env.mechanics.modal.arrays import (
    ANGLE,
    DEPTH,
    DEPTH_RATE,
    ECCENTRICITY_X,
    ECCENTRICITY_Y,
    LAW_SLIP,
    NORMAL,
    RATE,
    REACTION_X,
    RIGID_BODY,
    SECOND,
    START,
    TANGENTIAL,
    TORQUE,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.bodies import distribute_loads, free_motion, stage_ends, stage_frames
from solar_env.mechanics.modal.laws import contact_force, contact_slopes, friction_share, loop_torque, own_torque
from solar_env.mechanics.modal.motion import move_attachments, move_joints
from solar_env.mechanics.modal.oscillators import FROM_LOAD, FROM_RATE, NODES, WEIGHT_A, WEIGHT_B
from solar_env.mechanics.modal.rows import fill_mobility, list_rows, load_column
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import lu_factor, lu_solve

_MOST_ITERATIONS = 12
# A correction that changes the motion by less than this share of the tolerance is the last one.
_CONVERGED = 0.05
# A load that is off by the deviation of its course from the collocation polynomial moves its body by a twelfth of what
# the same load would if it were constant: the second integral of (1 - 3 t)(1 - t), over one half.
_DEVIATION = 1.0 / 12.0
# Least depth that counts, over the predicted greatest depth of the impact.
_LEAST_DEPTH = 0.05
_HERTZ = 2.943275
# Share of a normal force over rtol by which it may be off whatever the depth says, and the least such load over that
# which the velocity allows.
_LOAD_SHARE = 5.0
_LEAST_LOAD = 0.002
# Least time [s] over which a gap of an ideal joint is closed: at once, it would be felt as a blow.
_RETURN_TIME = 1e-3


class ModalSettings(NamedTuple):
    """Settings as the kernels take them, see ``ModalRadau``."""

    rtol: float
    velocity_scale: float
    depth_tolerance: float
    max_step: float
    impact_resolution: float
    max_steps: int


@kernel(inlined=True)
def copy_rows(target, source):
    """Copy a matrix."""
    for i in range(target.shape[0]):
        for j in range(target.shape[1]):
            target[i, j] = source[i, j]


@kernel(inlined=True)
def start_stages(model, state, work, h):
    """First guess of the stages: directions of the start, loads along the last step's polynomial."""
    for s in range(2):
        for b in range(model.bodies.size):
            # The directions at the stage, but for the loads of the step.
            c, s0 = work.turn[START, b, 0], work.turn[START, b, 1]
            angle = NODES[s] * h * work.speed[START, b, 2]
            work.turn[s, b, 0], work.turn[s, b, 1] = c - s0 * angle, s0 + c * angle
        copy_rows(work.arm[s], work.arm[START])
        copy_rows(work.motion[s], work.motion[START])
        copy_rows(work.bending_coupling[:, s], state.coupling)
        for j in range(model.joints.size):
            own = state.joints[j]
            for c in range(3):
                active = c == 2 or model.joints[j].kind == IDEAL or own.in_contact
                guess = state.loads[j, c] + NODES[s] * h * state.load_rates[j, c]
                work.load[s, j, c] = guess if active else 0.0
            if own.in_contact:
                work.load[s, j, 0] = max(work.load[s, j, 0], 0.0)


@kernel(inlined=True)
def move_stages(model, state, work, tables, level, h):
    """Motion of bodies, attachments and joints at both stages under the present loads."""
    distribute_loads(model, state, work, 0)
    distribute_loads(model, state, work, 1)
    stage_frames(model, state, work, h)
    stage_ends(model, work, tables, level)
    for s in range(2):
        move_attachments(model, work, s)
        move_joints(model, work, s)


@kernel(inlined=True)
def velocity_by_torque(model, work, tables, level, h, j):
    """Velocity [m/s] of the two points that joint ``j`` joins by a unit of its torque over a step, without signs."""
    joint, total = model.joints[j], 0.0
    for side in range(2):
        number = joint.outboard if side == 0 else joint.inboard
        attachment = model.attachments[number]
        body, i = model.bodies[attachment.body], 2 * attachment.end
        lever = math.hypot(work.local[SECOND, number, 0], work.local[SECOND, number, 1])
        total += lever * body.inverse_inertia * h
        if body.panel != RIGID_BODY:
            response = tables.bending_response[body.design, level, i, i + 1]
            total += abs(response[3] + response[7])
    return total


@kernel(inlined=True)
def set_tolerances(model, state, work, settings, tables, level, h, n):
    """Deviation of each load from its polynomial that errors of the size of the tolerances take."""
    limit = settings.rtol * settings.velocity_scale
    for j in range(model.joints.size):
        work.torque_tolerance[j] = limit / (_DEVIATION * velocity_by_torque(model, work, tables, level, h, j))
    for r in range(n):
        j, kind = work.joint[r], work.kind[r]
        # Without signs: a vibration may have turned back by the end of the step.
        gain = _DEVIATION * (abs(work.mobility[r, r, 3]) + abs(work.mobility[r, r, 7]))
        work.tolerance[r] = work.torque_tolerance[j] if kind == TORQUE else limit / gain
        if kind == NORMAL:
            own = state.joints[j]
            least = _LEAST_DEPTH / _HERTZ * own.impact_speed * own.contact_duration
            depth = max(work.motion[SECOND, j, DEPTH], work.motion[START, j, DEPTH], least)
            # A load that is off moves a stiff contact's depth by no more than its own share.
            share = _LOAD_SHARE * settings.rtol * max(work.load[1, j, 0], state.loads[j, 0])
            least_load = max(share, _LEAST_LOAD * work.tolerance[r])
            from_depth = max(settings.depth_tolerance * depth / (h * gain), least_load)
            work.tolerance[r] = min(work.tolerance[r], from_depth)


@kernel(inlined=True)
def fill_torques(model, state, work, s):
    """Torques of the laws at a stage, in place of the corrections' torque rows, with their slopes by angle and rate."""
    joints = model.joints.size
    for j in range(joints):
        motion = work.motion[s, j]
        torque, by_angle, by_rate = own_torque(model.joints[j], state.joints[j], motion[ANGLE], motion[RATE])
        for i in range(joints):
            work.torque_slope[j, i] = 0.0
        work.torque_slope[j, j] = by_angle
        work.torque[j, 0], work.torque[j, 1] = torque, by_rate
    for c in range(model.cables.size):
        cable = model.cables[c]
        a, b, ratio = cable.joint_a, cable.joint_b, cable.wheel_ratio
        torque, slope, _ = loop_torque(cable, ratio * work.motion[s, a, ANGLE] - work.motion[s, b, ANGLE])
        work.torque[a, 0] -= cable.torque_ratio * torque
        work.torque[b, 0] += torque
        work.torque_slope[a, a] -= cable.torque_ratio * slope * ratio
        work.torque_slope[a, b] += cable.torque_ratio * slope
        work.torque_slope[b, a] += slope * ratio
        work.torque_slope[b, b] -= slope


@kernel(inlined=True)
def fill_torque_row(model, work, s, n, r):
    """Row of a joint's torque in Newton's matrix."""
    j, row = work.joint[r], work.matrix[s * n + r]
    for k in range(2):
        for c in range(n):
            row[k * n + c] = -work.torque[j, 1] * work.mobility[r, c, 4 * k + 2 * s + 1]
        for i in range(model.joints.size):
            slope = work.torque_slope[j, i]
            if slope != 0.0 and work.torque_row[i] >= 0:
                for c in range(n):
                    row[k * n + c] -= slope * work.mobility[work.torque_row[i], c, 4 * k + 2 * s]
    row[s * n + r] += 1.0
    work.correction[s * n + r] = work.torque[j, 0] - work.load[s, j, 2]


@kernel(inlined=True)
def fill_contact_rows(model, state, work, s, n, r):
    """Rows of a contact's normal and tangential force in Newton's matrix."""
    j = work.joint[r]
    joint, own, motion, load = model.joints[j], state.joints[j], work.motion[s, j], work.load[s, j]
    force, _ = contact_force(joint, own, motion[DEPTH], motion[DEPTH_RATE])
    by_depth, by_rate = contact_slopes(joint, own, motion[DEPTH], motion[DEPTH_RATE])
    share, by_slip = friction_share(joint, motion[LAW_SLIP])
    pressing = max(load[0], 0.0)
    normal, tangential = work.matrix[s * n + r], work.matrix[s * n + r + 1]
    for k in range(2):
        for c in range(n):
            at = 4 * k + 2 * s
            # The motion that a normal force reads off is minus the depth.
            normal[k * n + c] = by_depth * work.mobility[r, c, at] + by_rate * work.mobility[r, c, at + 1]
            tangential[k * n + c] = -by_slip * pressing * work.mobility[r + 1, c, at + 1]
    normal[s * n + r] += 1.0
    tangential[s * n + r + 1] += 1.0
    tangential[s * n + r] -= share
    work.correction[s * n + r] = force - load[0]
    work.correction[s * n + r + 1] = share * pressing - load[1]


@kernel(inlined=True)
def fill_reaction_row(work, s, n, r, h):
    """Row of a component of an ideal joint's reaction in Newton's matrix: of its relative velocity."""
    j, kind = work.joint[r], work.kind[r]
    row = work.matrix[s * n + r]
    scale = 1.0 / (abs(work.mobility[r, r, 3]) + abs(work.mobility[r, r, 7]))
    for k in range(2):
        for c in range(n):
            row[k * n + c] = scale * work.mobility[r, c, 4 * k + 2 * s + 1]
    rate = work.motion[s, j, VELOCITY_X if kind == REACTION_X else VELOCITY_Y]
    gap = work.motion[START, j, ECCENTRICITY_X if kind == REACTION_X else ECCENTRICITY_Y]
    work.correction[s * n + r] = -scale * (rate + gap / max(h, _RETURN_TIME))


@kernel(inlined=True)
def correct_loads(model, state, work, n, h):
    """One correction of the loads by Newton's method.

    Returns:
        0 if the matrix is singular, 1 if the correction counts, 2 if it does not.
    """
    small = True
    for s in range(2):
        fill_torques(model, state, work, s)
        for r in range(n):
            kind = work.kind[r]
            if kind == TORQUE:
                fill_torque_row(model, work, s, n, r)
            elif kind == NORMAL:
                fill_contact_rows(model, state, work, s, n, r)
            elif kind != TANGENTIAL:
                fill_reaction_row(work, s, n, r, h)
        for j in range(model.joints.size):
            if work.torque_row[j] < 0:
                change = work.torque[j, 0] - work.load[s, j, 2]
                work.load[s, j, 2] += change
                small = small and abs(change) <= _CONVERGED * work.torque_tolerance[j]
    if n > 0:
        if not lu_factor(work.matrix, 2 * n):
            return 0
        lu_solve(work.matrix, 2 * n, work.correction)
    for s in range(2):
        for r in range(n):
            change = work.correction[s * n + r]
            work.load[s, work.joint[r], load_column(work.kind[r])] += change
            # Not a number counts.
            small = small and abs(change) <= _CONVERGED * work.tolerance[r]
    return 2 if small else 1


@kernel
def solve_step(model, state, work, settings, tables, level, h):
    """Solve for the loads of a step ``h`` [s]; False if Newton's iteration does not converge."""
    free_motion(model, state, work, tables, level)
    start_stages(model, state, work, h)
    n = list_rows(model, state, work, tables, level, h)
    work.rows[0] = n
    for iteration in range(_MOST_ITERATIONS):
        work.counts[0] += 1
        move_stages(model, state, work, tables, level, h)
        if iteration == 0:
            fill_mobility(model, work, tables, level, h, n)
        # Anew each time: the depth that a journal would reach freely is no measure of that which it does reach.
        set_tolerances(model, state, work, settings, tables, level, h, n)
        done = correct_loads(model, state, work, n, h)
        if done == 0:
            return False
        # Without contacts and reactions, whose directions are not known before, a first guess may do.
        if done == 2 and (iteration > 0 or n == 0):
            return True
    return False


@kernel(inlined=True)
def vibration_defect(free, held, loads, i):
    """Defect of the rate of end value ``i`` [m/s]: of the free motion, less what the loads at the start hold."""
    defect = free[4 * held.shape[0] + i]
    for j in range(held.shape[0]):
        defect += held[i, j] * (1.5 * loads[0, j] - 0.5 * loads[1, j])
    return defect


@kernel(inlined=True)
def shortening_defect(free, frequencies, coupling, h, i):
    """Part of the defect of the axial rate of end ``i`` [m/s] that is foreshortening, not vibration."""
    defect = 0.0
    for m in range(coupling.shape[1]):
        first, second = coupling[0, m], coupling[1, m]
        shortened = free[m, 0, 8 + i] * (1.5 * first - 0.5 * second) + free[m, 1, 8 + i] * 1.5 * (second - first) / h
        defect += shortened / frequencies[m] ** 2
    return defect


@kernel(inlined=True)
def step_error(model, state, work, settings, tables, level, h):
    """Error of a step over the tolerances.

    Of loads: their value at the start against that of the polynomial through the stages. Of vibrations that the step
    does not resolve: the rate of the ends against the exact one.
    """
    error = 0.0
    settled = state.clock[0].acceleration_current != 0
    for j in range(model.joints.size):
        if work.torque_row[j] < 0:
            deviation = state.loads[j, 2] - 1.5 * work.load[0, j, 2] + 0.5 * work.load[1, j, 2]
            error = max(error, abs(deviation) / work.torque_tolerance[j])
    for r in range(work.rows[0]):
        kind, j = work.kind[r], work.joint[r]
        if settled or kind < REACTION_X:
            c = load_column(kind)
            deviation = state.loads[j, c] - 1.5 * work.load[0, j, c] + 0.5 * work.load[1, j, c]
            error = max(error, abs(deviation) / work.tolerance[r])
    limit = settings.rtol * settings.velocity_scale
    for number in range(model.attachments.size):
        attachment = model.attachments[number]
        body, end = model.bodies[attachment.body], attachment.end
        p, d = body.panel, body.design
        if p != RIGID_BODY:
            held, free = tables.bending_held[d, level], tables.axial_free[d, level]
            across = vibration_defect(work.bending_free[p], held, work.bending_load[p], 2 * end)
            along = vibration_defect(work.axial_free[p], tables.axial_held[d, level], work.axial_load[p], end)
            along -= shortening_defect(free, model.panels.axial_frequency[d], work.axial_coupling[p], h, end)
            error = max(error, max(abs(across), abs(along)) / limit)
    return error


@kernel(inner=True)
def move_family(answers, rows, loads, coupling, q, v, rates):
    """Move the amplitudes of one family of modes over the step; ``rates`` (2, modes) takes those of the stages."""
    for k in range(q.size):
        first, second = 0.0, 0.0
        for i in range(rows.shape[0]):
            first += rows[i, k] * loads[0, i]
            second += rows[i, k] * loads[1, i]
        if k < coupling.shape[1]:
            first += coupling[0, k]
            second += coupling[1, k]
        value, rate = q[k], v[k]
        rates[0, k] = (
            answers[1, k] * value
            + answers[FROM_RATE + 1, k] * rate
            + answers[FROM_LOAD + 1, k] * first
            + answers[FROM_LOAD + 5, k] * second
        )
        q[k] = (
            answers[2, k] * value
            + answers[FROM_RATE + 2, k] * rate
            + answers[FROM_LOAD + 2, k] * first
            + answers[FROM_LOAD + 6, k] * second
        )
        v[k] = (
            answers[3, k] * value
            + answers[FROM_RATE + 3, k] * rate
            + answers[FROM_LOAD + 3, k] * first
            + answers[FROM_LOAD + 7, k] * second
        )
        rates[1, k] = v[k]


@kernel(inner=True)
def dissipated(frequencies, rates, coupled, damping):
    """Mean power [W] that the material damping of one family takes in a step; coupled modes are stretched otherwise."""
    power = 0.0
    for k in range(frequencies.size):
        first, second = rates[0, k], rates[1, k]
        if k < coupled.shape[1]:
            first, second = coupled[0, k], coupled[1, k]
        power += damping * frequencies[k] ** 2 * (WEIGHT_A * first * first + WEIGHT_B * second * second)
    return power


@kernel(inlined=True)
def commit_step(model, state, work, tables, level, h):
    """Move the state to the end of the step that :func:`solve_step` has solved."""
    distribute_loads(model, state, work, 0)
    distribute_loads(model, state, work, 1)
    stage_frames(model, state, work, h)
    panels = model.panels
    modes, axial = panels.bending_frequency.shape[1], panels.axial_frequency.shape[1]
    power = 0.0
    for b in range(model.bodies.size):
        body = model.bodies[b]
        first = body.offset
        for i in range(3):
            state.q[first + i], state.v[first + i] = work.place[SECOND, b, i], work.speed[SECOND, b, i]
        if body.panel == RIGID_BODY:
            continue
        p, d, first, middle = body.panel, body.design, body.offset + 3, body.offset + 3 + axial
        q, v, rates = state.q[first:middle], state.v[first:middle], work.rates[:, :axial]
        rows, answers = panels.axial_rows[d], tables.axial[d, level]
        move_family(answers, rows, work.axial_load[p], work.axial_coupling[p], q, v, rates)
        power += dissipated(panels.axial_frequency[d], rates, work.strain_rate[p], panels.damping[d])
        q, v, rates = state.q[middle : middle + modes], state.v[middle : middle + modes], work.rates[:, :modes]
        rows, answers = panels.bending_rows[d], tables.bending[d, level]
        move_family(answers, rows, work.bending_load[p], work.bending_coupling[p], q, v, rates)
        power += dissipated(panels.bending_frequency[d], rates, rates[:, :0], panels.damping[d])
    state.integrals[state.integrals.size + MATERIAL_DISSIPATION] += h * power


@kernel(inlined=True)
def keep_loads(state, work, h):
    """Keep the loads at the end of the step and the course they have taken."""
    for j in range(state.joints.size):
        for c in range(3):
            state.loads[j, c] = work.load[1, j, c]
            state.load_rates[j, c] = 1.5 * (work.load[1, j, c] - work.load[0, j, c]) / h
    copy_rows(state.coupling, work.bending_coupling[:, 1])
