"""One step of the two-stage Radau IIA method on the loads of the joints: Newton's iteration.

Third order, stiffly accurate, L-stable (E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed.,
Springer 1996, section IV.5, doi:10.1007/978-3-642-05221-7). Directions, lever arms and foreshortening are those of the
stages, renewed in every iteration; the matrix takes them from the first one. With ideal joints the relative velocity
vanishes at the stages, less a share that returns the position.
"""

import math
from typing import NamedTuple

from solar_env.mechanics.arrays.columns import ANGLE, RATE
from solar_env.mechanics.arrays.model import CLEARANCE, IDEAL
from solar_env.mechanics.joints.contact import sliding_share
from solar_env.mechanics.modal.arrays import (
    CABLE_COLUMNS,
    CABLE_ROW,
    DEPTH,
    DEPTH_RATE,
    MOTION_COLUMNS,
    NORMAL_ROW,
    REACTION_X_ROW,
    RIGID_BODY,
    SECOND,
    SLIDING_SPEED,
    SLIP,
    START,
    STRETCH,
    TANGENTIAL_ROW,
    TORQUE_ROW,
)
from solar_env.mechanics.modal.ends import add_modal_forces, couple, forced_ends, free_ends, shorten_ends
from solar_env.mechanics.modal.equations import contact_rows, fill_torques, reaction_row, torque_row
from solar_env.mechanics.modal.motion import (
    distribute_loads,
    force_of,
    move_attachments,
    move_cables,
    move_joints,
    stage_frames,
)
from solar_env.mechanics.modal.tables import AXIAL_EVEN, GROUPS, NODES
from solar_env.mechanics.modal.unknowns import DEVIATION, fill_mobility, list_rows
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_rows, lu_factor, lu_solve

_MOST_ITERATIONS = 30
# Foreshortening is of second order: its forces are renewed in so many iterations.
_COUPLED_ITERATIONS = 2
# Correction over the tolerance after which motion and matrix are not renewed.
_SMALL = 30.0
# Displacement by a correction, over the clearance, above which motion is renewed.
_SHIFT = 1e-3
# The iteration ends where the corrections to come are less than this share of the tolerance.
_CONVERGED = 0.05
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


@kernel(single_caller=True)
def start_stages(model, state, work, h):
    """First guess of the stages: directions of the start, loads along the last step's polynomial."""
    for b in range(model.bodies.size):
        frame = work.bodies[b]
        # The directions at the stage, but for the loads of the step.
        c, s0 = frame.turn[START, 0], frame.turn[START, 1]
        for s in range(2):
            angle = NODES[s] * h * frame.speed[START, 2]
            frame.turn[s, 0], frame.turn[s, 1] = c - s0 * angle, s0 + c * angle
    for number in range(model.attachments.size):
        arm = work.attachments[number].arm
        for s in range(2):
            arm[s, 0], arm[s, 1] = arm[START, 0], arm[START, 1]
    for p in range(work.panels.size):
        for s in range(2):
            copy_rows(work.panels[p].coupling[s], state.coupling[p])
    for s in range(2):
        for k in range(work.loads.size):
            work.loads[k].stage[s] = state.loads[k] + NODES[s] * h * state.load_rates[k]
        for j in range(model.joints.size):
            motion, tried = work.joints[j].motion, work.joints[j].tried[s]
            for c in range(MOTION_COLUMNS):
                motion[s, c] = motion[START, c]
            tried[0] = tried[1] = 0.0
            if model.joints[j].kind == CLEARANCE:
                normal = work.loads[force_of(model, j)].stage
                normal[s] = max(normal[s], 0.0)
        for c in range(model.cables.size):
            motion = work.cables[c].motion
            for k in range(CABLE_COLUMNS):
                motion[s, k] = motion[START, k]


@kernel(single_caller=True)
def move_stages(model, state, work, tables, level, h, coupled):
    """Motion of bodies, attachments and joints at both stages under the present loads.

    Where `coupled`, the forces of foreshortening are renewed; they belong to amplitudes under those of before.
    """
    distribute_loads(model, state, work)
    stage_frames(model, state, work, h)
    for b in range(model.bodies.size):
        p, d = model.bodies[b].panel, model.bodies[b].design
        if p != RIGID_BODY:
            panel, answers = work.panels[p], tables.answers[d, level]
            forced_ends(panel, tables.responses[d, level].response, GROUPS)
            if coupled:
                couple(model.panels, panel, answers, d)
                # The forces on the rest of the end values are among the loads.
                forced_ends(panel, tables.responses[d, level].response, AXIAL_EVEN)
            add_modal_forces(model.panels, panel, answers, d)
            for s in range(2):
                shorten_ends(panel, s)
    for s in range(2):
        move_attachments(model, work, s)
        move_joints(model, work, s)
        move_cables(model, work, s)


@kernel(single_caller=True)
def velocity_tolerance(model, work, settings):
    """Tolerance of velocities [m/s] at the start of a step: of the scale, or of the hinges' speed if that is less."""
    scale, fastest = settings.velocity_scale, 0.0
    for j in range(model.joints.size):
        if model.joints[j].kind == IDEAL:
            return settings.rtol * scale
        fastest = max(fastest, abs(work.joints[j].motion[START, RATE]))
    return settings.rtol * min(scale, max(fastest * model.length_scale, _LEAST_SCALE * scale))


@kernel(single_caller=True)
def set_tolerances(state, work, settings, h, n):
    """Deviation of each force from its polynomial that errors of the size of the tolerances take."""
    limit = work.step[0].velocity_tolerance
    for r in range(n):
        j, kind, load = work.unknowns[r].owner, work.unknowns[r].kind, work.loads[work.unknowns[r].number]
        if kind in (TORQUE_ROW, CABLE_ROW):
            continue
        # Without signs: a vibration may have turned back by the end of the step.
        response = work.mobility[r, r].response
        gain = DEVIATION * (abs(response[3]) + abs(response[7]))
        load.tolerance = limit / gain
        if kind == NORMAL_ROW:
            joint_state = state.joints[j]
            least = _LEAST_DEPTH / _HERTZ * joint_state.impact_speed * joint_state.contact_duration
            depth = max(work.joints[j].motion[SECOND, DEPTH], work.joints[j].motion[START, DEPTH], least)
            # A load that is off moves a stiff contact's depth by no more than its share.
            share = _LOAD_SHARE * settings.rtol * max(load.stage[1], state.loads[work.unknowns[r].number])
            least_load = max(share, _LEAST_LOAD * load.tolerance)
            from_depth = max(settings.depth_tolerance * depth / (h * gain), least_load)
            load.tolerance = min(load.tolerance, from_depth)


@kernel(single_caller=True)
def correct_loads(model, state, work, n, h, renewed):
    """One correction of the loads by Newton's method, whose matrix is kept unless `renewed`.

    Returns the greatest change of an unknown, and of a torque that is none, over their tolerances; infinite if the
    matrix is singular or a change is not finite.
    """
    size, apart, total = 0.0, 0.0, 0.0
    for s in range(2):
        fill_torques(model, state, work, s)
        for r in range(n):
            kind = work.unknowns[r].kind
            if kind in (TORQUE_ROW, CABLE_ROW):
                torque_row(work, s, n, r, renewed)
            elif kind == NORMAL_ROW:
                contact_rows(model, state, work, s, n, r, renewed)
            elif kind != TANGENTIAL_ROW:
                reaction_row(work, s, n, r, h, renewed)
        for k in range(model.joints.size + model.cables.size):
            load = work.loads[k]
            if not load.unknown:
                change = load.law - load.stage[s]
                load.stage[s] += change
                total += change
                apart = max(apart, abs(change) / load.tolerance)
    if n > 0:
        if renewed and not lu_factor(work.matrix, 2 * n):
            return math.inf, math.inf
        lu_solve(work.matrix, 2 * n, work.correction)
    for s in range(2):
        for r in range(n):
            change, load = work.correction[s * n + r], work.loads[work.unknowns[r].number]
            load.stage[s] += change
            total += change
            size = max(size, abs(change) / load.tolerance)
    return (size, apart) if math.isfinite(total) else (math.inf, math.inf)


@kernel(single_caller=True)
def shift_stages(model, work, n):
    """Change the joints' motion at the stages by what the latest correction of the loads does, to first order.

    It is for joints with clearance: a reaction's correction has no first order that would do. Returns the greatest
    displacement over the clearance, to say how much the first order leaves out.
    """
    greatest = 0.0
    for r in range(n):
        j, kind = work.unknowns[r].owner, work.unknowns[r].kind
        joint = model.joints[model.cables[j].joint_b if kind == CABLE_ROW else j]
        for s in range(2):
            value, rate = 0.0, 0.0
            for c in range(n):
                response = work.mobility[r, c].response
                for k in range(2):
                    value += response[4 * k + 2 * s] * work.correction[k * n + c]
                    rate += response[4 * k + 2 * s + 1] * work.correction[k * n + c]
            motion = work.joints[j].motion[s]
            if kind == CABLE_ROW:
                work.cables[j].motion[s, STRETCH] -= value
            elif kind == TORQUE_ROW:
                motion[ANGLE] += value
                motion[RATE] += rate
            elif kind == NORMAL_ROW:
                motion[DEPTH] -= value
                motion[DEPTH_RATE] -= rate
            else:
                motion[SLIP] += rate
                motion[SLIDING_SPEED] += rate * sliding_share(joint, motion[DEPTH])
            lever = model.length_scale if kind in (TORQUE_ROW, CABLE_ROW) else 1.0
            greatest = max(greatest, abs(value) * lever / joint.clearance)
    return greatest


@kernel(single_caller=True)
def furthest_off(model, work, n):
    """Joint whose load the latest correction has changed most, over its tolerance, or -1."""
    joint, greatest = -1, 0.0
    for r in range(n):
        owner, kind = work.unknowns[r].owner, work.unknowns[r].kind
        for s in range(2):
            change = abs(work.correction[s * n + r]) / work.loads[work.unknowns[r].number].tolerance
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
            panel, d = work.panels[body.panel], body.design
            free_ends(model.panels, panel, answers, d, state.q[first:last], state.v[first:last])
    work.step[0].velocity_tolerance = velocity_tolerance(model, work, settings)
    start_stages(model, state, work, h)
    n = list_rows(model, state, work, tables, level, h)
    work.step[0].unknowns, work.trial[0].joint = n, -1
    before, renewed, constrained = math.inf, True, False
    for r in range(n):
        constrained = constrained or work.unknowns[r].kind >= REACTION_X_ROW
    for iteration in range(_MOST_ITERATIONS):
        state.clock[0].evaluations += 1
        if not renewed:
            renewed = shift_stages(model, work, n) > _SHIFT
        if renewed:
            # A reaction holds the joint where foreshortening has it: it must not be left behind.
            move_stages(model, state, work, tables, level, h, constrained or iteration < _COUPLED_ITERATIONS)
        if iteration == 0:
            fill_mobility(model, work, tables, level, h, n)
        # Anew each time: the depth that a journal would reach freely is no measure of that which it does reach.
        set_tolerances(state, work, settings, h, n)
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
    work.trial[0].joint = furthest_off(model, work, n)
    return False
