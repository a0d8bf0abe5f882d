"""End of a step: its error over the tolerances, and the state moved to where it leads."""

from solar_env.mechanics.arrays.model import MATERIAL_DISSIPATION
from solar_env.mechanics.modal.arrays import REACTION_X, RIGID_BODY, SECOND
from solar_env.mechanics.modal.bodies import distribute_loads, stage_frames
from solar_env.mechanics.modal.oscillators import FROM_LOAD, FROM_RATE, WEIGHT_A, WEIGHT_B
from solar_env.mechanics.modal.rows import load_column
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_rows


@kernel(inlined=True)
def vibration_defect(free, held, loads, i):
    """Defect of the rate of end value `i` [m/s]: of the free motion, less what the loads at the start hold."""
    defect = free[4 * held.shape[0] + i]
    for j in range(held.shape[0]):
        defect += held[i, j] * (1.5 * loads[0, j] - 0.5 * loads[1, j])
    return defect


@kernel(inlined=True)
def shortening_defect(free, frequencies, coupling, h, i):
    """Part of the defect of the axial rate of end `i` [m/s] that is foreshortening, not vibration."""
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
    """Move the amplitudes of one family of modes over the step; `rates` (2, modes) takes those of the stages."""
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
    """Move the state to the end of the step that `solve_step` has solved."""
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
