"""One step of the two-stage Radau IIA method on the loads of the joints: Newton's iteration.

Third order, stiffly accurate, L-stable (E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed.,
Springer 1996, section IV.5, doi:10.1007/978-3-642-05221-7). Directions, lever arms and foreshortening are those of the
stages, renewed in every iteration; the matrix takes them from the first one. With ideal joints the relative velocity
vanishes at the stages, less a share that returns the position.
"""

import math
from typing import NamedTuple

from solar_env.mechanics.arrays.columns import ANGLE, RATE
from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.joints.contact import sliding_share
from solar_env.mechanics.modal.arrays import (
    CABLE_ROW,
    DEPTH,
    DEPTH_RATE,
    ITERATIONS,
    MOTION_COLUMNS,
    NORMAL_ROW,
    REACTION_X_ROW,
    RIGID_BODY,
    SECOND,
    SLIDING_SPEED,
    SLIP,
    START,
    STRETCH,
    STUCK,
    TANGENTIAL_ROW,
    TORQUE_ROW,
    UNKNOWNS,
)
from solar_env.mechanics.modal.panel.coupling import couple, shorten_ends
from solar_env.mechanics.modal.panel.ends import add_modal_forces, forced_ends, free_ends
from solar_env.mechanics.modal.panel.oscillators import NODES
from solar_env.mechanics.modal.panel.tables import AXIAL_EVEN, GROUPS
from solar_env.mechanics.modal.step.bodies import distribute_loads, stage_frames
from solar_env.mechanics.modal.step.cables import (
    cable_row,
    distribute_cables,
    move_cables,
    set_cable_tolerances,
    start_cables,
)
from solar_env.mechanics.modal.step.equations import contact_rows, fill_torques, reaction_row, torque_row
from solar_env.mechanics.modal.step.motion import move_attachments, move_joints
from solar_env.mechanics.modal.step.rows import fill_mobility, list_rows, load_column, velocity_by_torque
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_rows, lu_factor, lu_solve

_MOST_ITERATIONS = 30
# Foreshortening is of second order: its forces are renewed in so many iterations.
_COUPLED_ITERATIONS = 2
# With reactions, after so many iterations the matrix is that of bent panels.
_STRAIGHT_ITERATIONS = 3
# Correction over the tolerance after which motion and matrix are not renewed.
_SMALL = 30.0
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
# With clearance in every joint the velocity scale shrinks with the speed of the hinges, to this share at most: slow
# impacts are those of vibrations that an error of the size of the full scale would damp.
_LEAST_SCALE = 0.01


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
    for b in range(model.bodies.size):
        own = work.bodies[b]
        # The directions at the stage, but for the loads of the step.
        c, s0 = own.turn[START, 0], own.turn[START, 1]
        for s in range(2):
            angle = NODES[s] * h * own.speed[START, 2]
            own.turn[s, 0], own.turn[s, 1] = c - s0 * angle, s0 + c * angle
    for number in range(model.attachments.size):
        arm = work.attachments[number].arm
        for s in range(2):
            arm[s, 0], arm[s, 1] = arm[START, 0], arm[START, 1]
    for p in range(work.panels.size):
        for s in range(2):
            copy_rows(work.panels[p].coupling[s], state.coupling[p])
    for j in range(model.joints.size):
        own, new, ideal = state.joints[j], work.joints[j], model.joints[j].kind == IDEAL
        for s in range(2):
            for c in range(MOTION_COLUMNS):
                new.motion[s, c] = new.motion[START, c]
            for c in range(3):
                guess = state.loads[j, c] + NODES[s] * h * state.load_rates[j, c]
                new.load[s, c] = guess if c == 2 or ideal or own.in_contact else 0.0
            if own.in_contact:
                new.load[s, 0] = max(new.load[s, 0], 0.0)
            new.tried[s, 0] = new.tried[s, 1] = 0.0
    start_cables(state, work, h)


@kernel(inlined=True)
def move_stages(model, state, work, tables, level, h, coupled):
    """Motion of bodies, attachments and joints at both stages under the present loads.

    The forces of foreshortening are renewed `coupled` times; they belong to amplitudes under those of before.
    """
    distribute_loads(model, state, work)
    distribute_cables(model, work)
    stage_frames(model, state, work, h)
    for b in range(model.bodies.size):
        p, d = model.bodies[b].panel, model.bodies[b].design
        if p != RIGID_BODY:
            own, answers = work.panels[p], tables.answers[d, level]
            forced_ends(own, tables.responses[d, level].response, GROUPS)
            for _ in range(coupled):
                couple(model.panels, own, answers, d)
                # The forces on the rest of the end values are among the loads.
                forced_ends(own, tables.responses[d, level].response, AXIAL_EVEN)
            add_modal_forces(model.panels, own, answers, d)
            shorten_ends(own)
    for s in range(2):
        move_attachments(model, work, s)
        move_joints(model, work, s)
        move_cables(model, work, s)


@kernel(inlined=True)
def velocity_tolerance(model, work, settings):
    """Tolerance of velocities [m/s] at the start of a step: of the scale, or of the hinges' speed if that is less."""
    scale, fastest = settings.velocity_scale, 0.0
    for j in range(model.joints.size):
        if model.joints[j].kind == IDEAL:
            return settings.rtol * scale
        fastest = max(fastest, abs(work.joints[j].motion[START, RATE]))
    return settings.rtol * min(scale, max(fastest * model.length_scale, _LEAST_SCALE * scale))


@kernel(inlined=True)
def set_tolerances(model, state, work, settings, tables, level, h, n):
    """Deviation of each load from its polynomial that errors of the size of the tolerances take."""
    limit = work.velocity_tolerance[0]
    for j in range(model.joints.size):
        work.joints[j].torque_tolerance = limit / (_DEVIATION * velocity_by_torque(model, work, tables, level, h, j))
    set_cable_tolerances(model, work)
    for r in range(n):
        j, kind = work.unknowns[r].owner, work.unknowns[r].kind
        if kind in (TORQUE_ROW, CABLE_ROW):
            tolerance = work.joints[j].torque_tolerance if kind == TORQUE_ROW else work.cables[j].tolerance
            work.unknowns[r].tolerance = tolerance
            continue
        # Without signs: a vibration may have turned back by the end of the step.
        own = work.mobility[r, r].response
        gain = _DEVIATION * (abs(own[3]) + abs(own[7]))
        work.unknowns[r].tolerance = limit / gain
        if kind == NORMAL_ROW:
            own = state.joints[j]
            least = _LEAST_DEPTH / _HERTZ * own.impact_speed * own.contact_duration
            depth = max(work.joints[j].motion[SECOND, DEPTH], work.joints[j].motion[START, DEPTH], least)
            # A load that is off moves a stiff contact's depth by no more than its own share.
            share = _LOAD_SHARE * settings.rtol * max(work.joints[j].load[1, 0], state.loads[j, 0])
            least_load = max(share, _LEAST_LOAD * work.unknowns[r].tolerance)
            from_depth = max(settings.depth_tolerance * depth / (h * gain), least_load)
            work.unknowns[r].tolerance = min(work.unknowns[r].tolerance, from_depth)


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
            kind = work.unknowns[r].kind
            if kind == TORQUE_ROW:
                torque_row(work, s, n, r, renewed)
            elif kind == CABLE_ROW:
                cable_row(work, s, n, r, renewed)
            elif kind == NORMAL_ROW:
                contact_rows(model, state, work, s, n, r, renewed)
            elif kind != TANGENTIAL_ROW:
                reaction_row(work, s, n, r, h, renewed)
        for j in range(model.joints.size):
            if work.joints[j].torque_unknown < 0:
                change = work.joints[j].torque - work.joints[j].load[s, 2]
                work.joints[j].load[s, 2] += change
                total += change
                apart = max(apart, abs(change) / work.joints[j].torque_tolerance)
        for c in range(model.cables.size):
            own = work.cables[c]
            if own.unknown < 0:
                change = own.torque - own.load[s]
                own.load[s] += change
                total += change
                apart = max(apart, abs(change) / own.tolerance)
    if n > 0:
        if renewed and not lu_factor(work.matrix, 2 * n):
            return math.inf, math.inf
        lu_solve(work.matrix, 2 * n, work.correction)
    for s in range(2):
        for r in range(n):
            change, owner, kind = work.correction[s * n + r], work.unknowns[r].owner, work.unknowns[r].kind
            if kind == CABLE_ROW:
                work.cables[owner].load[s] += change
            else:
                work.joints[owner].load[s, load_column(kind)] += change
            total += change
            size = max(size, abs(change) / work.unknowns[r].tolerance)
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
        j, kind = work.unknowns[r].owner, work.unknowns[r].kind
        joint = model.joints[model.cables[j].joint_b if kind == CABLE_ROW else j]
        for s in range(2):
            value, rate = 0.0, 0.0
            for c in range(n):
                own = work.mobility[r, c].response
                for k in range(2):
                    value += own[4 * k + 2 * s] * work.correction[k * n + c]
                    rate += own[4 * k + 2 * s + 1] * work.correction[k * n + c]
            if kind == CABLE_ROW:
                work.cables[j].motion[s, STRETCH] -= value
                greatest = max(greatest, abs(value) * model.length_scale / joint.clearance)
                continue
            motion = work.joints[j].motion[s]
            if kind == TORQUE_ROW:
                motion[ANGLE] += value
                greatest = max(greatest, abs(value) * model.length_scale / joint.clearance)
                motion[RATE] += rate
            elif kind == NORMAL_ROW:
                motion[DEPTH] -= value
                greatest = max(greatest, abs(value) / joint.clearance)
                motion[DEPTH_RATE] -= rate
            else:
                motion[SLIP] += rate
                motion[SLIDING_SPEED] += rate * sliding_share(joint, motion[DEPTH])
                greatest = max(greatest, abs(value) / joint.clearance)
    return greatest


@kernel(inlined=True)
def furthest_off(model, work, n):
    """Joint whose load the latest correction has changed most, over its tolerance, or -1."""
    joint, greatest = -1, 0.0
    for r in range(n):
        owner, kind = work.unknowns[r].owner, work.unknowns[r].kind
        for s in range(2):
            change = abs(work.correction[s * n + r]) / work.unknowns[r].tolerance
            if change > greatest:
                joint, greatest = model.cables[owner].joint_b if kind == CABLE_ROW else owner, change
    return joint


@kernel
def solve_step(model, state, work, settings, tables, level, h):
    """Solve for the loads of a step `h` [s]; False if Newton's iteration does not converge."""
    for b in range(model.bodies.size):
        body = model.bodies[b]
        if body.panel != RIGID_BODY:
            answers, first = tables.answers[body.design, level], body.offset + 3
            last = first + answers.size
            own, d = work.panels[body.panel], body.design
            free_ends(model.panels, own, answers, d, state.q[first:last], state.v[first:last])
    work.velocity_tolerance[0] = velocity_tolerance(model, work, settings)
    start_stages(model, state, work, h)
    n = list_rows(model, state, work, tables, level, h)
    work.counts[UNKNOWNS], work.counts[STUCK] = n, -1
    before, renewed, constrained = math.inf, True, False
    for r in range(n):
        constrained = constrained or work.unknowns[r].kind >= REACTION_X_ROW
    for iteration in range(_MOST_ITERATIONS):
        work.counts[ITERATIONS] += 1
        bent = constrained and iteration >= _STRAIGHT_ITERATIONS
        if not renewed:
            renewed = shift_stages(model, work, n) > _SHIFT
        if renewed:
            # A reaction holds the joint where foreshortening has it: it must not be left behind.
            coupled = (2 if bent else 1) if constrained else int(iteration < _COUPLED_ITERATIONS)
            move_stages(model, state, work, tables, level, h, coupled)
        if iteration == 0 or (bent and iteration == _STRAIGHT_ITERATIONS):
            fill_mobility(model, work, tables, level, h, n, bent)
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
    work.counts[STUCK] = furthest_off(model, work, n)
    return False
