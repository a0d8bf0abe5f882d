"""One step of the two-stage Radau IIA method on the loads of the joints: Newton's iteration.

Third order, stiffly accurate, L-stable (E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed.,
Springer 1996, section IV.5, doi:10.1007/978-3-642-05221-7). Directions, lever arms and foreshortening are those of the
stages, renewed in every iteration; the matrix takes them from the first one. With ideal joints the relative velocity
vanishes at the stages, less a share that returns the position.
"""

import math
from typing import NamedTuple

from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.modal.arrays import (
    ANGLE,
    DEPTH,
    DEPTH_RATE,
    NORMAL,
    RATE,
    REACTION_X,
    RIGID_BODY,
    SECOND,
    SLIDING_SPEED,
    SLIP,
    START,
    TANGENTIAL,
    TORQUE,
)
from solar_env.mechanics.modal.panel.coupling import couple, shorten_ends
from solar_env.mechanics.modal.panel.ends import add_modal_forces, forced_ends, free_ends
from solar_env.mechanics.modal.panel.oscillators import NODES
from solar_env.mechanics.modal.panel.tables import BENDING_EVEN, BENDING_ODD
from solar_env.mechanics.modal.step.bodies import distribute_loads, stage_frames
from solar_env.mechanics.modal.step.equations import contact_rows, fill_torques, reaction_row, torque_row
from solar_env.mechanics.modal.step.motion import move_attachments, move_joints
from solar_env.mechanics.modal.step.rows import fill_mobility, list_rows, load_column
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_rows, lu_factor, lu_solve

_MOST_ITERATIONS = 12
# Foreshortening is of second order: its forces are renewed in so many iterations.
_COUPLED_ITERATIONS = 2
# Correction over the tolerance after which motion and matrix are not renewed.
_SMALL = 3.0
# Displacement by a correction, over the clearance, above which motion is renewed.
_SHIFT = 1e-3
# The iteration ends where the corrections to come are less than this share of the tolerance.
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
_LEAST_LOAD = 0.03


class ModalSettings(NamedTuple):
    """Settings as the kernels take them, see `ModalRadau`."""

    rtol: float
    velocity_scale: float
    depth_tolerance: float
    max_step: float
    impact_resolution: float
    max_steps: int


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
        copy_rows(work.coupling[:, s], state.coupling)
        for j in range(model.joints.size):
            own = state.joints[j]
            for c in range(3):
                active = c == 2 or model.joints[j].kind == IDEAL or own.in_contact
                guess = state.loads[j, c] + NODES[s] * h * state.load_rates[j, c]
                work.load[s, j, c] = guess if active else 0.0
            if own.in_contact:
                work.load[s, j, 0] = max(work.load[s, j, 0], 0.0)


@kernel(inlined=True)
def move_stages(model, state, work, tables, level, h, coupled):
    """Motion of bodies, attachments and joints at both stages under the present loads.

    The forces of foreshortening are renewed where `coupled`; they belong to amplitudes under those of before.
    """
    for s in range(2):
        distribute_loads(model, state, work, s)
    stage_frames(model, state, work, h)
    for b in range(model.bodies.size):
        p, d = model.bodies[b].panel, model.bodies[b].design
        if p != RIGID_BODY:
            forced_ends(work, tables.response, p, d, level)
            if coupled:
                couple(model.panels, work, tables, level, p, d)
            add_modal_forces(model.panels, work, tables, level, p, d)
            shorten_ends(work, p)
    for s in range(2):
        move_attachments(model, work, s)
        move_joints(model, work, s)


@kernel(inlined=True)
def velocity_by_torque(model, work, tables, level, h, j):
    """Velocity [m/s] of the two points that joint `j` joins by a unit of its torque over a step, without signs."""
    joint, total = model.joints[j], 0.0
    for face in range(2):
        number = joint.outboard if face == 0 else joint.inboard
        attachment = model.attachments[number]
        body = model.bodies[attachment.body]
        lever = math.hypot(work.local[SECOND, number, 0], work.local[SECOND, number, 1])
        total += lever * body.inverse_inertia * h
        if body.panel != RIGID_BODY:
            response = tables.response[body.design, level]
            even, odd = response[BENDING_EVEN, 0, 1], response[BENDING_ODD, 0, 1]
            total += abs(even[3] + odd[3] + even[7] + odd[7])
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
        gain = _DEVIATION * (abs(work.mobility[3, r, r]) + abs(work.mobility[7, r, r]))
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
def correct_loads(model, state, work, n, h, renewed):
    """One correction of the loads by Newton's method, whose matrix is kept unless `renewed`.

    Returns:
        Greatest change of an unknown, and of a torque that is none, over their tolerances; infinite if the matrix is
        singular or a change is not finite.
    """
    size, apart, total = 0.0, 0.0, 0.0
    for s in range(2):
        fill_torques(model, state, work, s)
        for r in range(n):
            kind = work.kind[r]
            if kind == TORQUE:
                torque_row(model, work, s, n, r, renewed)
            elif kind == NORMAL:
                contact_rows(model, state, work, s, n, r, renewed)
            elif kind != TANGENTIAL:
                reaction_row(work, s, n, r, h, renewed)
        for j in range(model.joints.size):
            if work.torque_row[j] < 0:
                change = work.torque[j, 0] - work.load[s, j, 2]
                work.load[s, j, 2] += change
                total += change
                apart = max(apart, abs(change) / work.torque_tolerance[j])
    if n > 0:
        if renewed and not lu_factor(work.matrix, 2 * n):
            return math.inf, math.inf
        lu_solve(work.matrix, 2 * n, work.correction)
    for s in range(2):
        for r in range(n):
            change = work.correction[s * n + r]
            work.load[s, work.joint[r], load_column(work.kind[r])] += change
            total += change
            size = max(size, abs(change) / work.tolerance[r])
    return (size, apart) if math.isfinite(total) else (math.inf, math.inf)


@kernel(inlined=True)
def shift_stages(model, work, n):
    """Change the joints' motion at the stages by what the latest correction of the loads does, to first order.

    It is for joints with clearance: a reaction's correction has no first order that would do.

    Returns:
        Greatest displacement over the clearance, to say how much the first order leaves out.
    """
    greatest = 0.0
    for r in range(n):
        j, kind = work.joint[r], work.kind[r]
        joint = model.joints[j]
        for s in range(2):
            value, rate = 0.0, 0.0
            for k in range(2):
                for c in range(n):
                    value += work.mobility[4 * k + 2 * s, r, c] * work.correction[k * n + c]
                    rate += work.mobility[4 * k + 2 * s + 1, r, c] * work.correction[k * n + c]
            motion = work.motion[s, j]
            if kind == TORQUE:
                motion[ANGLE] += value
                greatest = max(greatest, abs(value) * model.length_scale / joint.clearance)
                motion[RATE] += rate
            elif kind == NORMAL:
                motion[DEPTH] -= value
                greatest = max(greatest, abs(value) / joint.clearance)
                motion[DEPTH_RATE] -= rate
            else:
                motion[SLIP] += rate
                motion[SLIDING_SPEED] += rate
                greatest = max(greatest, abs(value) / joint.clearance)
    return greatest


@kernel
def solve_step(model, state, work, settings, tables, level, h):
    """Solve for the loads of a step `h` [s]; False if Newton's iteration does not converge."""
    for b in range(model.bodies.size):
        body = model.bodies[b]
        if body.panel != RIGID_BODY:
            free_ends(model.panels, state, work, tables, level, body.panel, body.design, body.offset + 3)
    start_stages(model, state, work, h)
    n = list_rows(model, state, work, tables, level, h)
    work.rows[0] = n
    before, renewed, constrained = math.inf, True, False
    for r in range(n):
        constrained = constrained or work.kind[r] >= REACTION_X
    for iteration in range(_MOST_ITERATIONS):
        work.counts[0] += 1
        if not renewed:
            renewed = shift_stages(model, work, n) > _SHIFT
        if renewed:
            move_stages(model, state, work, tables, level, h, iteration < _COUPLED_ITERATIONS)
        if iteration == 0:
            fill_mobility(model, work, tables, level, h, n)
        # Anew each time: the depth that a journal would reach freely is no measure of that which it does reach.
        set_tolerances(model, state, work, settings, tables, level, h, n)
        size, apart = correct_loads(model, state, work, n, h, renewed)
        if size == math.inf:
            return False
        # A small correction leaves the matrix and all directions as they are; a second one in a row does not.
        renewed = constrained or not (renewed and size < _SMALL and apart <= _CONVERGED)
        # Of the corrections to come, by the rate at which they shrink; but a relative velocity that is left in an ideal
        # joint would be a blow in the next step. A first correction may do without contacts and reactions, whose
        # directions are not known before.
        size = max(size, apart)
        left = size * size / (before - size) if size < before < math.inf and not constrained else size
        if min(left, size) <= _CONVERGED and (iteration > 0 or n == 0):
            return True
        before = size
    return False
