"""End of a step: its error over the tolerances, and the state moved to where it leads."""

from solar_env.mechanics.arrays.model import MATERIAL_DISSIPATION
from solar_env.mechanics.modal.arrays import NORMAL_ROW, REACTION_X_ROW, RIGID_BODY, START
from solar_env.mechanics.modal.motion import distribute_loads, look_at, stage_frames
from solar_env.mechanics.modal.tables import (
    AT_START,
    AXIAL_EVEN,
    AXIAL_ODD,
    BENDING_EVEN,
    BENDING_ODD,
    COLUMNS,
    END_RATE,
    END_VALUE,
    FROM_LOAD,
    FROM_RATE,
    FROM_VALUE,
    GROUPS,
    LAST,
    RATE_AT_START,
    STAGES,
    values_of,
)
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into, copy_rows

# A reaction at the end of one step tells less of the error of another that is shorter than this share of it than of its
# own: of the fast vibrations that the longer step does not resolve.
_COMPARABLE = 0.01


@kernel
def at_start(course):
    """Value at the start of a step of a course given at its stages."""
    total = 0.0
    for k in range(STAGES):
        total += AT_START[k] * course[k]
    return total


@kernel
def rate_defect(panels, panel, answers, held, d, h, group):
    """Defect of the rate of a group's ends [m/s]: of its vibration, without what loads and foreshortening hold."""
    defect = panel.defect[group]
    for j in range(values_of(group)):
        defect += held[group, j] * at_start(panel.load[group, j])
    if group >= AXIAL_EVEN:
        for r in range(panels.coupled[group]):
            number, course, rate = panels.first[group] + r, panel.coupling[group, r], 0.0
            mode, answer = panels.modes[d, number], answers[number]
            for k in range(STAGES):
                rate += RATE_AT_START[k] * course[k] / h
            shortened = answer.defect[0] * at_start(course) + answer.defect[1] * rate
            defect -= mode.row[0] * shortened / (mode.frequency * mode.frequency)
    return abs(defect)


@kernel
def deviation(state, work, k):
    """Load at the start of the step less that of the polynomial through its stages there, without sign."""
    return abs(state.loads[k] - at_start(work.loads[k].stage))


@kernel
def step_error(model, state, work, settings, tables, level, h):
    """Error of a step over the tolerances.

    Of loads: their value at the start against that of the polynomial through the stages, and of reactions whose value
    there is that of a far longer step, how they change between the stages if that is less. Of vibrations that the step
    does not resolve: the rate of the ends against the exact one.
    """
    error = 0.0
    settled = state.clock[0].acceleration_current != 0
    comparable = h >= _COMPARABLE * state.clock[0].last_step
    for k in range(model.joints.size + model.cables.size):
        error = max(error, deviation(state, work, k) / work.loads[k].tolerance)
    for r in range(work.step[0].unknowns):
        kind, k = work.unknowns[r].kind, work.unknowns[r].number
        if kind >= NORMAL_ROW and (settled or kind < REACTION_X_ROW):
            apart, stage = deviation(state, work, k), work.loads[k].stage
            if not comparable and kind >= REACTION_X_ROW:
                apart = min(apart, abs(stage[LAST] - stage[0]))
            error = max(error, apart / work.loads[k].tolerance)
    limit = work.step[0].velocity_tolerance
    for b in range(model.bodies.size):
        p, d = model.bodies[b].panel, model.bodies[b].design
        if p != RIGID_BODY:
            own, answers, held = work.panels[p], tables.answers[d, level], tables.responses[d, level].held
            # At one end or the other, the even and the odd part add up.
            across = rate_defect(model.panels, own, answers, held, d, h, BENDING_EVEN)
            across += rate_defect(model.panels, own, answers, held, d, h, BENDING_ODD)
            along = rate_defect(model.panels, own, answers, held, d, h, AXIAL_EVEN)
            along += rate_defect(model.panels, own, answers, held, d, h, AXIAL_ODD)
            error = max(error, max(across, along) / limit)
    return error


@kernel
def move_panel(panels, panel, answers, d, q, v):
    """Move the amplitudes of a panel over the step; returns the power of its damping at the end [W]."""
    total = 0.0
    for group in range(GROUPS):
        begin, end, coupled = panels.first[group], panels.first[group + 1], panels.coupled[group]
        modes, responses, values, rates = panels.modes[d, begin:end], answers[begin:end], q[begin:end], v[begin:end]
        forces, moments = panel.load[group, 0], panel.load[group, 1]
        for k in range(values.size):
            mode, answer = modes[k], responses[k].coefficient
            value = answer[FROM_VALUE + END_VALUE] * values[k] + answer[FROM_RATE + END_VALUE] * rates[k]
            rate = answer[FROM_VALUE + END_RATE] * values[k] + answer[FROM_RATE + END_RATE] * rates[k]
            for s in range(STAGES):
                force = mode.row[0] * forces[s] + mode.row[1] * moments[s]
                if k < coupled:
                    force += panel.coupling[group, k, s]
                value += answer[FROM_LOAD + COLUMNS * s + END_VALUE] * force
                rate += answer[FROM_LOAD + COLUMNS * s + END_RATE] * force
            values[k], rates[k] = value, rate
            if group >= AXIAL_EVEN and k < coupled:
                rate = panel.strain_rate[group, k]
            total += (mode.frequency * rate) ** 2
    return panels.damping[d] * total


@kernel
def note_extremes(model, state, work, v):
    """Keep what panels come to that is more than before: slope of an end, spin over the lowest frequency."""
    panels, extremes = model.panels, state.extremes
    even, odd = panels.first[BENDING_EVEN], panels.first[BENDING_ODD]
    for b in range(model.bodies.size):
        body = model.bodies[b]
        if body.panel != RIGID_BODY:
            # At one end or the other, the even and the odd part add up.
            ends = work.panels[body.panel].ends
            slope = abs(ends[BENDING_EVEN, 1, 0]) + abs(ends[BENDING_ODD, 1, 0])
            lowest = min(panels.modes[body.design, even].frequency, panels.modes[body.design, odd].frequency)
            extremes[0] = max(extremes[0], slope)
            extremes[1] = max(extremes[1], abs(v[body.offset + 2]) / lowest)


@kernel(inlined=False)
def commit_step(model, state, work, tables, level, h):
    """Move the workspace's coordinates from the start to the end of the solved step, and fill the motion there."""
    distribute_loads(model, state, work)
    stage_frames(model, state, work, h)
    for b in range(model.bodies.size):
        body, own, first = model.bodies[b], work.bodies[b], model.bodies[b].offset
        for i in range(3):
            work.q[first + i], work.v[first + i] = own.place[LAST, i], own.speed[LAST, i]
        if body.panel != RIGID_BODY:
            answers, panel, begin = tables.answers[body.design, level], work.panels[body.panel], first + 3
            end = begin + answers.size
            q, v = work.q[begin:end], work.v[begin:end]
            power = move_panel(model.panels, panel, answers, body.design, q, v)
            # Between the ends of a step its modes may vibrate several times: their damping takes what it does on
            # average, of which the ends are samples.
            mean = 0.5 * (state.damping_power[body.panel] + power)
            work.integrals[work.integrals.size + MATERIAL_DISSIPATION] += h * mean
            work.damping_power[body.panel] = power
    look_at(model, work.q, work.v, work, START)
    note_extremes(model, state, work, work.v)


@kernel
def keep_loads(state, work):
    """Keep the course of the loads over the step, and their values at its end."""
    for k in range(work.loads.size):
        copy_into(state.course[k], work.loads[k].stage)
        state.loads[k] = work.loads[k].stage[LAST]
    for p in range(work.panels.size):
        for group in range(GROUPS):
            copy_rows(state.coupling[p, group], work.panels[p].coupling[group])
    copy_into(state.damping_power, work.damping_power)
