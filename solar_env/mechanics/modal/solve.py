"""One step of the three-stage Radau IIA method: Newton's iteration for the joint loads at the stages.

The method is of fifth order, stiffly accurate and L-stable (E. Hairer and G. Wanner, Solving Ordinary Differential
Equations II, 2nd ed., Springer 1996, section IV.5, doi:10.1007/978-3-642-05221-7). Every iteration updates directions
and lever arms at the stages; panels' shortening by bending is updated after large corrections. Newton's matrix uses the
first iteration's directions, and is reused while all loads stay on the same smooth parts of their laws. In ideal joints
the relative velocity at the stages vanishes, except for a small part that closes the position gap.
"""

import math
from typing import NamedTuple

from solar_env.mechanics.arrays.columns import RATE
from solar_env.mechanics.arrays.model import CLEARANCE, IDEAL
from solar_env.mechanics.modal.arrays import (
    ACROSS_X,
    ACROSS_Y,
    CABLE_ROW,
    DEPTH,
    LENGTH,
    LEVER,
    NORMAL_ROW,
    NORMAL_X,
    NORMAL_Y,
    PULL_ROW,
    REACTION_X_ROW,
    RIGID_BODY,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.elimination import eliminate, substitute
from solar_env.mechanics.modal.ends import add_modal_forces, bend, couple, forced_ends, free_ends, shorten_ends
from solar_env.mechanics.modal.equations import contact_laws, enter_row, reaction_law, torque_laws
from solar_env.mechanics.modal.motion import (
    NODES_IN_LANES,
    distribute_loads,
    force_of,
    move_attachments,
    move_cables,
    move_joints,
    stage_frames,
)
from solar_env.mechanics.modal.tables import (
    AXIAL_EVEN,
    COLUMNS,
    END_RATE,
    GROUPS,
    LANES,
    LAST,
    LOW,
    NODES,
    POLYNOMIAL,
    RATE_AT_END,
    STAGES,
)
from solar_env.mechanics.modal.unknowns import DEVIATION, fill_mobility, list_rows
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import lane, load4, splat4, square_roots, store4, where_less

_MOST_ITERATIONS = 30
# Least correction, in tolerances, after which the next iteration updates foreshortening's forces; these are of second
# order and start from the last step's course. The first iteration, or any with ideal joints, also updates them.
_COARSE = 10.0
# Fraction of the previous correction below which Newton's matrix is reused, and greatest number of such iterations.
_SHRINKING = 0.1
_KEPT_ITERATIONS = 8
_CONVERGED, _CONVERGED_REACTIONS = 0.01, 0.05  # end at remaining corrections below this part of the tolerance
_HOPELESS = 1e12
_FOLLOWED = 1.6  # greatest ratio to the last step at which loads follow their polynomials; beyond it, tangents
_GREATEST_TURN = 0.5  # rad, greatest predicted turn of a line of centres
_LEAST_DEPTH = 0.05  # least depth for the depth tolerance, divided by the predicted greatest depth of the impact
# The depth never requires a normal force's tolerance below _LOAD_SHARE times rtol times the force, nor below
# _LEAST_LOAD times the tolerance that the velocity requires.
_LOAD_SHARE = 5.0
_LEAST_LOAD = 0.03
# With clearance in every joint the velocity scale shrinks with the hinges' speed, down to this fraction: slow impacts
# come from vibrations, which errors of the size of the full scale would damp.
_LEAST_SCALE = 0.01


class ModalSettings(NamedTuple):
    """Settings of the integration method `ModalRadau` in the types that kernels take."""

    rtol: float
    velocity_scale: float
    depth_tolerance: float
    max_step: float
    impact_resolution: float


@kernel
def foresee(state, work, h):
    """Compute weights `work.step[0].foreseen` that extrapolate loads from the last step's stages to a step `h` [s]."""
    last = state.clock[0].last_step
    for s in range(LANES):
        later = NODES[min(s, LAST)] * h / last if last > 0.0 else 0.0
        for k in range(STAGES):
            if h <= _FOLLOWED * last:
                value, share = 0.0, 1.0 + later
                for down in range(STAGES):
                    value = value * share + POLYNOMIAL[k][LAST - down]
            else:
                value = (1.0 if k == LAST else 0.0) + RATE_AT_END[k] * later
            work.step[0].foreseen[k, s] = value


@kernel
def continue_course(foreseen, course, stage):
    """Extrapolate a load to a new step: write first guesses at its three stages, the last one twice, to `stage` (4,).

    `course` (3,) has the load at the stages of the step before, `foreseen` (3, 4) the weight of each old stage.
    """
    total = course[0] * load4(foreseen[0], 0)
    for k in range(1, STAGES):
        total = total + course[k] * load4(foreseen[k], 0)
    store4(stage, 0, total)


@kernel
def start_stages(model, state, work, h):
    """Write first guesses for a step to `work`: extrapolated loads, and bodies and contacts turned at present rates."""
    foreseen, times = work.step[0].foreseen, h * load4(NODES_IN_LANES, 0)
    for b in range(model.bodies.size):
        turn, c, s = work.bodies[b].turn, state.turns[b, 0], state.turns[b, 1]
        angle = state.v[model.bodies[b].offset + 2] * times
        store4(turn[0], 0, c - s * angle)
        store4(turn[1], 0, s + c * angle)
    for number in range(model.attachments.size):
        arm, placement = work.attachments[number].arm, state.placements[number]
        for i in range(2):
            store4(arm[i], 0, placement.arm[i] + placement.arm_rate[i] * times)
    for p in range(work.panels.size):
        for group in range(GROUPS):
            for r in range(LOW):
                continue_course(foreseen, state.coupling[p, group, r], work.panels[p].coupling[group, r])
    for k in range(work.loads.size):
        continue_course(foreseen, state.course[k], work.loads[k].stage)
    for j in range(model.joints.size):
        joint, start, scratch = model.joints[j], state.motion[j], work.joints[j]
        if joint.kind == CLEARANCE:
            nx, ny = start[NORMAL_X], start[NORMAL_Y]
            radius = start[LEVER] - joint.journal_radius
            spin = (start[VELOCITY_Y] * nx - start[VELOCITY_X] * ny) / radius if radius > 0.0 else 0.0
            limit, turn = splat4(_GREATEST_TURN), spin * times
            turn = where_less(turn, limit, where_less(-limit, turn, turn, -limit), limit)
            size = 1.0 / square_roots(1.0 + turn * turn)
            store4(scratch.motion[NORMAL_X], 0, (nx - ny * turn) * size)
            store4(scratch.motion[NORMAL_Y], 0, (ny + nx * turn) * size)
            store4(scratch.motion[LEVER], 0, splat4(start[LEVER]))
            normal = work.loads[force_of(model, j)].stage
            store4(normal, 0, where_less(splat4(0.0), load4(normal, 0), load4(normal, 0), splat4(0.0)))
            store4(scratch.tried[0], 0, splat4(0.0))
            store4(scratch.tried[1], 0, splat4(0.0))
    for c in range(model.cables.size):
        motion = work.cables[c].motion
        for column in (ACROSS_X, ACROSS_Y, LENGTH):
            store4(motion[column], 0, splat4(state.cable_motion[c, column]))


@kernel
def move_stages(model, state, work, tables, level, h, shaped, coupled):
    """Compute in `work` the motion of bodies, attachments and joints at the stages under the present loads.

    If `shaped`, update foreshortening, the shortening of panels by bending. If `coupled`, also update the forces that
    foreshortening exerts on the modes. `tables` hold, at index `level`, the panel modes' responses to the step `h` [s].
    """
    distribute_loads(model, state, work)
    stage_frames(model, state, work, h)
    for b in range(model.bodies.size):
        p, d = model.bodies[b].panel, model.bodies[b].design
        if p != RIGID_BODY:
            panel, forced = work.panels[p], tables.forced[d, level]
            forced_ends(panel, tables.responses[d, level].response, GROUPS)
            if shaped:
                bend(model.panels, panel, forced, d)
            if coupled:
                couple(model.panels, panel, forced, d)
                # The end loads include foreshortening's forces on the end values of the other modes.
                forced_ends(panel, tables.responses[d, level].response, AXIAL_EVEN)
            add_modal_forces(model.panels, panel, forced, d)
            shorten_ends(panel)
    move_attachments(model, work)
    move_joints(model, work)
    move_cables(model, work)


@kernel
def velocity_tolerance(model, state, settings):
    """Return the tolerance of velocities [m/s]: rtol times the settings' velocity scale.

    Without ideal joints, the scale shrinks to the fastest joint rate times the longest body's length, at most by 99 %.
    """
    scale, fastest = settings.velocity_scale, 0.0
    for j in range(model.joints.size):
        if model.joints[j].kind == IDEAL:
            return settings.rtol * scale
        fastest = max(fastest, abs(state.motion[j, RATE]))
    return settings.rtol * min(scale, max(fastest * model.length_scale, _LEAST_SCALE * scale))


@kernel
def set_tolerances(model, state, work, settings, h, n):
    """Write the tolerance [N] of every force among the `n` unknowns to `work.loads[k].tolerance`.

    Newton's iteration stops at corrections that are small against it. The error test of the step `h` [s] uses it, too.
    """
    limit = work.step[0].velocity_tolerance
    for r in range(n):
        j, kind, load = work.unknowns[r].owner, work.unknowns[r].kind, work.loads[work.unknowns[r].number]
        if kind < PULL_ROW:
            continue
        # Magnitudes are summed, since a vibration may have turned back by the end of the step.
        response = work.mobility[r, r].response
        gain = 0.0
        for k in range(STAGES):
            gain += DEVIATION * abs(response[COLUMNS * k + END_RATE])
        load.tolerance = limit / gain
        if kind == NORMAL_ROW:
            joint_state = state.joints[j]
            greatest = joint_state.impact_speed * joint_state.contact_duration / model.joints[j].contact[3]
            depth = max(work.joints[j].motion[DEPTH, LAST], state.motion[j, DEPTH], _LEAST_DEPTH * greatest)
            # A relative error of the load causes at most the same relative error of a stiff contact's depth.
            share = _LOAD_SHARE * settings.rtol * max(load.stage[LAST], state.course[work.unknowns[r].number, LAST])
            least_load = max(share, _LEAST_LOAD * load.tolerance)
            from_depth = max(settings.depth_tolerance * depth / (h * gain), least_load)
            load.tolerance = min(load.tolerance, from_depth)


@kernel
def greatest_lane(vector):
    """Return the greatest of a vector's first three numbers, which belong to the three stages of a step."""
    return max(max(lane(vector, 0), lane(vector, 1)), lane(vector, 2))


@kernel
def factor_matrix(state, work, n, h, renewed):
    """Write the residuals of the `n` unknowns' equations to `work.residual`; return False if the matrix is singular.

    If `renewed`, also compute Newton's matrix for the step `h` [s] and factor it, in `work.matrix` and `work.inverses`.
    """
    for r in range(n):
        load, constraint = work.loads[work.unknowns[r].number], work.unknowns[r].kind >= REACTION_X_ROW
        if constraint:
            reaction_law(state, work, r, h)
        else:
            store4(work.residual[r], 0, load4(load.law, 0) - load4(load.stage, 0))
        if renewed:
            enter_row(work, r, load, 0.0 if constraint else 1.0)
    for r in range(n):
        begins = renewed and work.unknowns[r].first == r
        if begins and not eliminate(work.matrix, work.inverses, r, work.unknowns[r].end):
            return False
    return True


@kernel
def correct_loads(model, state, work, n, h, renewed):
    """Correct the loads at the stages of a step `h` [s], in `work.loads`, by one iteration of Newton's method.

    If `renewed`, or if a load has moved to another smooth part of its law, Newton's matrix is first computed anew.
    Torques that depend weakly on the motion are not among the `n` unknowns, and take their laws' values. Return two
    numbers: the greatest change of an unknown, and the greatest change of another torque, each divided by its load's
    tolerance. Both are infinite if the matrix is singular or a change is not finite.
    """
    size = apart = total = splat4(0.0)
    changed = greatest_lane(torque_laws(model, state, work) + contact_laws(model, state, work, n))
    if not factor_matrix(state, work, n, h, renewed or changed > 0.0):
        return math.inf, math.inf
    for k in range(model.joints.size + model.cables.size):
        load = work.loads[k]
        if not load.unknown:
            change = load4(load.law, 0) - load4(load.stage, 0)
            total, off = total + change, abs(change) / load.tolerance
            apart = where_less(apart, off, off, apart)
            store4(load.stage, 0, load4(load.law, 0))
    for r in range(n):
        if work.unknowns[r].first == r:
            substitute(work.matrix, work.inverses, r, work.unknowns[r].end, work.residual, work.correction)
    for r in range(n):
        load, correction = work.loads[work.unknowns[r].number], load4(work.correction[r], 0)
        store4(load.stage, 0, load4(load.stage, 0) + correction)
        total, off = total + correction, abs(correction) * (1.0 / load.tolerance)
        size = where_less(size, off, off, size)
    finite = math.isfinite(lane(total, 0) + lane(total, 1) + lane(total, 2))
    return (greatest_lane(size), greatest_lane(apart)) if finite else (math.inf, math.inf)


@kernel
def furthest_off(model, work, n):
    """Return the index of the joint whose load the last iteration changed most, relative to the load's tolerance.

    `n` is the number of unknown loads. A cable loop counts for its outer joint. Return -1 if no load changed.
    """
    joint, greatest = -1, 0.0
    for r in range(n):
        owner, kind = work.unknowns[r].owner, work.unknowns[r].kind
        for s in range(STAGES):
            change = abs(work.correction[r, s]) / work.loads[work.unknowns[r].number].tolerance
            if change > greatest:
                joint, greatest = model.cables[owner].joint_b if kind in (CABLE_ROW, PULL_ROW) else owner, change
    return joint


@kernel
def solve_step(model, state, work, settings, tables, level, h):
    """Solve for the joint and cable loads at the stages of a step `h` [s] in `work.loads`; return False on failure.

    `tables` hold, at the index `level` of this step size, the panel modes' motion per unit start value and unit load.
    """
    for b in range(model.bodies.size):
        body = model.bodies[b]
        if body.panel != RIGID_BODY:
            panel, first = work.panels[body.panel], body.offset + 3
            last = first + model.panels.frequency.shape[1]
            free_ends(model.panels, panel, tables, body.design, level, state.q[first:last], state.v[first:last])
    work.step[0].velocity_tolerance = velocity_tolerance(model, state, settings)
    foresee(state, work, h)
    start_stages(model, state, work, h)
    n = list_rows(model, state, work, tables, level, h)
    work.step[0].unknowns, work.trial[0].joint = n, -1
    before, renewed, constrained = math.inf, True, False
    for r in range(n):
        constrained = constrained or work.unknowns[r].kind >= REACTION_X_ROW
    done = False
    for iteration in range(_MOST_ITERATIONS):
        # A reaction holds the joint where foreshortening puts it: foreshortening must be current. At the end velocities
        # must fit the coordinates: the next step removes any velocity that it finds in ideal joints.
        coupled = not done and (constrained or iteration == 0 or before > _COARSE)
        move_stages(model, state, work, tables, level, h, coupled or constrained, coupled)
        if done:
            return True
        state.clock[0].evaluations += 1
        if iteration == 0:
            fill_mobility(model, work, tables, level, h, n)
        # Updated in every iteration: the depth of a journal in free flight would not measure its depth in contact.
        set_tolerances(model, state, work, settings, h, n)
        size, apart = correct_loads(model, state, work, n, h, renewed)
        shrinking = size < _SHRINKING * before
        size = max(size, apart)
        if not size < _HOPELESS:
            return False
        # Sum of the remaining corrections by their rate of shrinking; with ideal joints the last correction instead:
        # any relative velocity left would be an impact in the next step. A first correction suffices only without
        # unknowns: the directions of contacts and reactions are not known before.
        left = size * size / (before - size) if size < before < math.inf and not constrained else size
        enough = _CONVERGED_REACTIONS if constrained else _CONVERGED
        done = min(left, size) <= enough and (iteration > 0 or n == 0)
        renewed = (iteration > 0 and not shrinking) or iteration >= _KEPT_ITERATIONS
        before = size
    work.trial[0].joint = furthest_off(model, work, n)
    return False
