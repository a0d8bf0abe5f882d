"""Loads of the joints to the bodies, and the motion of the bodies at the stages of a step, in closed form."""

import math

from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.modal.arrays import LEVER, NORMAL_X, NORMAL_Y, RIGID_BODY
from solar_env.mechanics.modal.oscillators import FROM_LOAD, FROM_RATE, NODES, A, B
from solar_env.mechanics.modal.tables import FORMS
from solar_env.mechanics.numerics.jit import kernel


@kernel(inlined=True)
def add_load(model, work, stage, number, fx, fy, torque):
    """Add a force [N] and a torque [N m] at an attachment to its body's loads at a stage."""
    attachment = model.attachments[number]
    b = attachment.body
    x, y = work.arm[stage, number, 0], work.arm[stage, number, 1]
    work.body_load[stage, b, 0] += fx
    work.body_load[stage, b, 1] += fy
    work.body_load[stage, b, 2] += torque + x * fy - y * fx
    panel = model.bodies[b].panel
    if panel != RIGID_BODY:
        c, s = work.turn[stage, b, 0], work.turn[stage, b, 1]
        end = attachment.end
        work.axial_load[panel, stage, end] += c * fx + s * fy
        work.bending_load[panel, stage, 2 * end] += c * fy - s * fx
        work.bending_load[panel, stage, 2 * end + 1] += torque


@kernel(inlined=True)
def outboard_load(joint, own, load, motion):
    """Load of a joint on its outboard body: force, torque; and the torque on the inboard one."""
    torque = joint.sign * (load[2] + own.motor_torque)
    if joint.kind == IDEAL:
        return load[0], load[1], torque, -torque
    normal, tangential = load[0], load[1]
    nx, ny = motion[NORMAL_X], motion[NORMAL_Y]
    return (
        -normal * nx - tangential * ny,
        -normal * ny + tangential * nx,
        torque + joint.journal_radius * tangential,
        -torque - motion[LEVER] * tangential,
    )


@kernel(inlined=True)
def distribute_loads(model, state, work, stage):
    """Fill the loads of bodies and ends from those of the joints, in the directions that the stage has now."""
    work.body_load[stage, :, :] = 0.0
    work.bending_load[:, stage, :] = 0.0
    work.axial_load[:, stage, :] = 0.0
    for j in range(model.joints.size):
        joint = model.joints[j]
        fx, fy, outboard, inboard = outboard_load(joint, state.joints[j], work.load[stage, j], work.motion[stage, j])
        add_load(model, work, stage, joint.outboard, fx, fy, outboard)
        add_load(model, work, stage, joint.inboard, -fx, -fy, inboard)


@kernel(inlined=True)
def stage_frames(model, state, work, h):
    """Centres of mass and angles of the bodies at both stages, with their rates."""
    for b in range(model.bodies.size):
        body = model.bodies[b]
        for i in range(3):
            inverse = body.inverse_mass if i < 2 else body.inverse_inertia
            first, second = work.body_load[0, b, i] * inverse, work.body_load[1, b, i] * inverse
            if i < 2 and inverse > 0.0:
                first += model.gravity[i]
                second += model.gravity[i]
            x, v = state.q[body.offset + i], state.v[body.offset + i]
            for s in range(2):
                work.place[s, b, i] = x + h * (NODES[s] * v + h * (B[s][0] * first + B[s][1] * second))
                work.speed[s, b, i] = v + h * (A[s][0] * first + A[s][1] * second)
        for s in range(2):
            work.turn[s, b, 0], work.turn[s, b, 1] = math.cos(work.place[s, b, 2]), math.sin(work.place[s, b, 2])


@kernel(inner=True)
def sum_free(free, q, v, ends):
    """Add up the free motion of the ends over the modes."""
    for c in range(ends.size):
        ends[c] = 0.0
    for k in range(q.size):
        by_value, by_rate, value, rate = free[k, 0], free[k, 1], q[k], v[k]
        for c in range(ends.size):
            ends[c] += by_value[c] * value + by_rate[c] * rate


@kernel(inlined=True)
def low_free(answers, q, v, low):
    """Free motion (4, coupled) of the lowest modes at both stages."""
    for c in range(4):
        for r in range(low.shape[1]):
            low[c, r] = answers[c, r] * q[r] + answers[FROM_RATE + c, r] * v[r]


@kernel(inlined=True)
def free_motion(model, state, work, tables, level):
    """Free motion of the ends and of the coupled modes of every panel over a step."""
    modes, axial = model.panels.bending_frequency.shape[1], model.panels.axial_frequency.shape[1]
    for b in range(model.bodies.size):
        body = model.bodies[b]
        if body.panel == RIGID_BODY:
            continue
        p, d, first = body.panel, body.design, body.offset + 3
        middle = first + axial
        q, v = state.q[middle : middle + modes], state.v[middle : middle + modes]
        sum_free(tables.bending_free[d, level], q, v, work.bending_free[p])
        low_free(tables.bending[d, level], q, v, work.bending_low[p])
        q, v = state.q[first:middle], state.v[first:middle]
        sum_free(tables.axial_free[d, level], q, v, work.axial_free[p])
        low_free(tables.axial[d, level], q, v, work.axial_low[p])


@kernel(inner=True)
def forced_ends(free, response, loads, ends):
    """Motion of the ends at both stages: free and by the loads there."""
    count = ends.shape[0]
    for i in range(count):
        out = ends[i]
        for c in range(4):
            out[c] = free[4 * i + c]
        for j in range(count):
            by_load = response[i, j]
            first, second = loads[0, j], loads[1, j]
            for c in range(4):
                out[c] += by_load[c] * first + by_load[4 + c] * second


@kernel(inner=True)
def foreshorten(forms, b, rate, gradient, shortening):
    """Fill the quadratic forms of foreshortening, with their gradients by the coupled amplitudes and their rates."""
    n = b.size
    for f in range(FORMS):
        shortening[0, f] = shortening[1, f] = 0.0
    for r in range(n):
        row = gradient[r]
        for f in range(FORMS):
            row[f] = 0.0
        for c in range(n):
            form, amplitude = forms[r, c], b[c]
            for f in range(FORMS):
                row[f] += form[f] * amplitude
        half, speed = 0.5 * b[r], rate[r]
        for f in range(FORMS):
            shortening[0, f] += row[f] * half
            shortening[1, f] += row[f] * speed


@kernel(inner=True)
def add_answer(rows, answers, forces, ends):
    """Add the motion of the ends by modal forces (2, coupled) of the lowest modes at both stages."""
    for r in range(forces.shape[1]):
        for c in range(4):
            gain = answers[FROM_LOAD + c, r] * forces[0, r] + answers[FROM_LOAD + 4 + c, r] * forces[1, r]
            for i in range(ends.shape[0]):
                ends[i, c] += rows[i, r] * gain


@kernel(inlined=True)
def bend_coupled(model, work, body, answers):
    """Foreshortening of a panel at both stages: its part of the motion of the ends, and its forces on axial modes."""
    panels, p, d = model.panels, body.panel, body.design
    rows, loads, forces = panels.bending_rows[d], work.bending_load[p], work.bending_coupling[p]
    ends, damping, force = work.axial_ends[p], panels.damping[d], work.low_force
    coupled = forces.shape[1]
    for k in range(2):
        for r in range(coupled):
            force[k, r] = forces[k, r]
        for i in range(4):
            load = loads[k, i]
            for r in range(coupled):
                force[k, r] += rows[i, r] * load
    for s in range(2):
        for c in range(2):
            at = 2 * s + c
            first, second = answers[FROM_LOAD + at], answers[FROM_LOAD + 4 + at]
            for r in range(coupled):
                work.low[c, r] = work.bending_low[p, at, r] + first[r] * force[0, r] + second[r] * force[1, r]
        shortening = work.shortening[s]
        foreshorten(panels.forms[d], work.low[0], work.low[1], work.gradient[s], shortening)
        for c in range(2):
            ends[0, 2 * s + c] += shortening[c, FORMS - 2]
            ends[1, 2 * s + c] += shortening[c, FORMS - 1]
        for m in range(work.axial_coupling.shape[2]):
            square = panels.axial_frequency[d, m] ** 2
            work.axial_coupling[p, s, m] = square * (shortening[0, m] + damping * shortening[1, m])


@kernel(inlined=True)
def tension_bending(model, work, body, answers):
    """Modal forces of the tension on the coupled bending modes of a panel, at both stages."""
    panels, p, d = model.panels, body.panel, body.design
    rows, loads, forces = panels.axial_rows[d], work.axial_load[p], work.axial_coupling[p]
    for s in range(2):
        for r in range(work.bending_coupling.shape[2]):
            work.bending_coupling[p, s, r] = (
                loads[s, 0] * work.gradient[s, r, FORMS - 2] + loads[s, 1] * work.gradient[s, r, FORMS - 1]
            )
        for m in range(forces.shape[1]):
            a, rate = work.axial_low[p, 2 * s, m], work.axial_low[p, 2 * s + 1, m]
            for k in range(2):
                force = forces[k, m] + rows[0, m] * loads[k, 0] + rows[1, m] * loads[k, 1]
                a += answers[FROM_LOAD + 4 * k + 2 * s, m] * force
                rate += answers[FROM_LOAD + 4 * k + 2 * s + 1, m] * force
            work.strain_rate[p, s, m] = rate - work.shortening[s, 1, m]
            tension = panels.axial_frequency[d, m] ** 2 * (a + panels.damping[d] * rate) - forces[s, m]
            for r in range(work.bending_coupling.shape[2]):
                work.bending_coupling[p, s, r] += tension * work.gradient[s, r, m]


@kernel(inlined=True)
def stage_ends(model, work, tables, level):
    """Motion of the ends of every panel at both stages under the loads there."""
    for b in range(model.bodies.size):
        body = model.bodies[b]
        if body.panel == RIGID_BODY:
            continue
        p, d = body.panel, body.design
        forced_ends(work.bending_free[p], tables.bending_response[d, level], work.bending_load[p], work.bending_ends[p])
        forced_ends(work.axial_free[p], tables.axial_response[d, level], work.axial_load[p], work.axial_ends[p])
        # The forces on bending belong to amplitudes under those of the iteration before.
        bend_coupled(model, work, body, tables.bending[d, level])
        tension_bending(model, work, body, tables.axial[d, level])
        add_answer(
            model.panels.bending_rows[d], tables.bending[d, level], work.bending_coupling[p], work.bending_ends[p]
        )
        add_answer(model.panels.axial_rows[d], tables.axial[d, level], work.axial_coupling[p], work.axial_ends[p])
