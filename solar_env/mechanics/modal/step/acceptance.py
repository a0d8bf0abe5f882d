"""End of a step: its error over the tolerances, and the state moved to where it leads."""

from solar_env.mechanics.arrays.model import MATERIAL_DISSIPATION
from solar_env.mechanics.modal.arrays import REACTION_X, RIGID_BODY, SECOND
from solar_env.mechanics.modal.panel.oscillators import WEIGHT_A, WEIGHT_B
from solar_env.mechanics.modal.panel.tables import AXIAL_EVEN, AXIAL_ODD, BENDING_EVEN, BENDING_ODD, GROUPS, values_of
from solar_env.mechanics.modal.step.bodies import distribute_loads, stage_frames
from solar_env.mechanics.modal.step.rows import load_column
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_rows


@kernel(inlined=True)
def rate_defect(panels, work, tables, level, h, p, d, group):
    """Defect of the rate of a group's ends [m/s]: of its vibration, without what loads and foreshortening hold."""
    defect = work.defect[p, group]
    for j in range(values_of(group)):
        load = 1.5 * work.group_load[p, 0, group, j] - 0.5 * work.group_load[p, 1, group, j]
        defect += tables.held[d, level, group, j] * load
    if group >= AXIAL_EVEN:
        for r in range(panels.coupled[group]):
            k = panels.first[group] + r
            first, second = work.coupling[p, 0, k], work.coupling[p, 1, k]
            value, rate = 1.5 * first - 0.5 * second, 1.5 * (second - first) / h
            shortened = tables.defects[d, level, k, 0] * value + tables.defects[d, level, k, 1] * rate
            defect -= panels.rows[d, k, 0] * shortened / panels.frequency[d, k] ** 2
    return abs(defect)


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
    for b in range(model.bodies.size):
        p, d = model.bodies[b].panel, model.bodies[b].design
        if p != RIGID_BODY:
            # At one end or the other, the even and the odd part add up.
            across = rate_defect(model.panels, work, tables, level, h, p, d, BENDING_EVEN)
            across += rate_defect(model.panels, work, tables, level, h, p, d, BENDING_ODD)
            along = rate_defect(model.panels, work, tables, level, h, p, d, AXIAL_EVEN)
            along += rate_defect(model.panels, work, tables, level, h, p, d, AXIAL_ODD)
            error = max(error, max(across, along) / limit)
    return error


@kernel(inner=True)
def move_modes(answers, rows, square, load, coupling, q, v, strain_rate):
    """Move the amplitudes of one group over the step.

    Args:
        answers: (modes, COEFFICIENTS).
        rows: (modes, VALUES).
        square: (modes,) frequencies.
        load: (2, VALUES) of the group's ends, by stage.
        coupling: (2, modes) modal forces, by stage.
        q, v: (modes,) amplitudes and rates.
        strain_rate: (2, coupled) takes the place of the rates of the lowest modes in what the damping takes.

    Returns:
        Mean over the step of the sum of squared frequencies times rates.
    """
    first_force, first_moment, second_force, second_moment = load[0, 0], load[0, 1], load[1, 0], load[1, 1]
    total = 0.0
    for k in range(q.size):
        first = rows[k, 0] * first_force + rows[k, 1] * first_moment + coupling[0, k]
        second = rows[k, 0] * second_force + rows[k, 1] * second_moment + coupling[1, k]
        value, rate = q[k], v[k]
        rate1 = answers[k, 1] * value + answers[k, 5] * rate + answers[k, 9] * first + answers[k, 13] * second
        q[k] = answers[k, 2] * value + answers[k, 6] * rate + answers[k, 10] * first + answers[k, 14] * second
        rate2 = answers[k, 3] * value + answers[k, 7] * rate + answers[k, 11] * first + answers[k, 15] * second
        v[k] = rate2
        if k < strain_rate.shape[1]:
            rate1, rate2 = strain_rate[0, k], strain_rate[1, k]
        total += square[k] * square[k] * (WEIGHT_A * rate1 * rate1 + WEIGHT_B * rate2 * rate2)
    return total


@kernel(inlined=True)
def move_panel(panels, state, work, tables, level, p, d, offset):
    """Move the amplitudes of panel `p`, which begin at `offset`; returns the mean power of its damping [W]."""
    total = 0.0
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        stretched = panels.coupled[group] if group >= AXIAL_EVEN else 0
        total += move_modes(
            tables.answers[d, level, begin:end],
            panels.rows[d, begin:end],
            panels.frequency[d, begin:end],
            work.group_load[p, :, group],
            work.coupling[p, :, begin:end],
            state.q[offset + begin : offset + end],
            state.v[offset + begin : offset + end],
            work.strain_rate[p, :, begin : begin + stretched],
        )
    return panels.damping[d] * total


@kernel
def commit_step(model, state, work, tables, level, h):
    """Move the state to the end of the step that has been solved."""
    for s in range(2):
        distribute_loads(model, state, work, s)
    stage_frames(model, state, work, h)
    power = 0.0
    for b in range(model.bodies.size):
        body = model.bodies[b]
        first = body.offset
        for i in range(3):
            state.q[first + i], state.v[first + i] = work.place[SECOND, b, i], work.speed[SECOND, b, i]
        if body.panel != RIGID_BODY:
            power += move_panel(model.panels, state, work, tables, level, body.panel, body.design, first + 3)
    state.integrals[state.integrals.size + MATERIAL_DISSIPATION] += h * power


@kernel(inlined=True)
def keep_loads(state, work, h):
    """Keep the loads at the end of the step and the course they have taken."""
    for j in range(state.joints.size):
        for c in range(3):
            state.loads[j, c] = work.load[1, j, c]
            state.load_rates[j, c] = 1.5 * (work.load[1, j, c] - work.load[0, j, c]) / h
    copy_rows(state.coupling, work.coupling[:, 1])
