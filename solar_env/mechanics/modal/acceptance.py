"""End of a step: its error over the tolerances, and the state moved to where it leads."""

from solar_env.mechanics.arrays.model import MATERIAL_DISSIPATION
from solar_env.mechanics.modal.arrays import NORMAL_ROW, REACTION_X_ROW, RIGID_BODY, SECOND, START
from solar_env.mechanics.modal.motion import distribute_loads, place_bodies, stage_frames
from solar_env.mechanics.modal.tables import (
    AXIAL_EVEN,
    AXIAL_ODD,
    BENDING_EVEN,
    BENDING_ODD,
    GROUPS,
    WEIGHT_A,
    WEIGHT_B,
    values_of,
)
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_rows

# A reaction at the end of one step tells less of the error of another that is shorter than this share of it than of its
# own: of the fast vibrations that the longer step does not resolve.
_COMPARABLE = 0.01


@kernel(inlined=True)
def rate_defect(panels, own, answers, held, d, h, group):
    """Defect of the rate of a group's ends [m/s]: of its vibration, without what loads and foreshortening hold."""
    defect = own.defect[group]
    for j in range(values_of(group)):
        defect += held[group, j] * (1.5 * own.load[0, group, j] - 0.5 * own.load[1, group, j])
    if group >= AXIAL_EVEN:
        for r in range(panels.coupled[group]):
            k = panels.first[group] + r
            mode, first, second = panels.modes[d, k], own.coupling[0, group, r], own.coupling[1, group, r]
            value, rate = 1.5 * first - 0.5 * second, 1.5 * (second - first) / h
            shortened = answers[k].defect[0] * value + answers[k].defect[1] * rate
            defect -= mode.row[0] * shortened / (mode.frequency * mode.frequency)
    return abs(defect)


@kernel(inlined=True)
def deviation(state, work, k):
    """Load at the start of the step less that of the polynomial through its stages there, without sign."""
    return abs(state.loads[k] - 1.5 * work.loads[k].stage[0] + 0.5 * work.loads[k].stage[1])


@kernel(inlined=True)
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
                apart = min(apart, abs(stage[1] - stage[0]))
            error = max(error, apart / work.loads[k].tolerance)
    limit = work.step[0].velocity_tolerance
    for b in range(model.bodies.size):
        p, d = model.bodies[b].panel, model.bodies[b].design
        if p != RIGID_BODY:
            panel, answers, held = work.panels[p], tables.answers[d, level], tables.responses[d, level].held
            # At one end or the other, the even and the odd part add up.
            across = rate_defect(model.panels, panel, answers, held, d, h, BENDING_EVEN)
            across += rate_defect(model.panels, panel, answers, held, d, h, BENDING_ODD)
            along = rate_defect(model.panels, panel, answers, held, d, h, AXIAL_EVEN)
            along += rate_defect(model.panels, panel, answers, held, d, h, AXIAL_ODD)
            error = max(error, max(across, along) / limit)
    return error


@kernel(single_caller=True)
def move_panel(panels, own, answers, d, q, v):
    """Move the amplitudes of a panel over the step, and its ends; returns the mean power of its damping [W]."""
    total = 0.0
    for group in range(GROUPS):
        begin, end, coupled = panels.first[group], panels.first[group + 1], panels.coupled[group]
        modes, responses, values, rates = panels.modes[d, begin:end], answers[begin:end], q[begin:end], v[begin:end]
        force1, moment1 = own.load[0, group, 0], own.load[0, group, 1]
        force2, moment2 = own.load[1, group, 0], own.load[1, group, 1]
        w = w_rate = s = s_rate = 0.0
        for k in range(values.size):
            mode, answer = modes[k], responses[k].coefficient
            across, turning = mode.row[0], mode.row[1]
            first = across * force1 + turning * moment1
            second = across * force2 + turning * moment2
            if k < coupled:
                first += own.coupling[0, group, k]
                second += own.coupling[1, group, k]
            value, rate = values[k], rates[k]
            moved = answer[2] * value + answer[6] * rate + answer[10] * first + answer[14] * second
            rate1 = answer[1] * value + answer[5] * rate + answer[9] * first + answer[13] * second
            rate2 = answer[3] * value + answer[7] * rate + answer[11] * first + answer[15] * second
            values[k], rates[k] = moved, rate2
            w += across * moved
            w_rate += across * rate2
            s += turning * moved
            s_rate += turning * rate2
            if group >= AXIAL_EVEN and k < coupled:
                rate1, rate2 = own.strain_rate[0, group, k], own.strain_rate[1, group, k]
            mean_square = WEIGHT_A * rate1 * rate1 + WEIGHT_B * rate2 * rate2
            total += mode.frequency * mode.frequency * mean_square
        ends = own.ends[group]
        ends[0, 0], ends[0, 1], ends[1, 0], ends[1, 1] = w, w_rate, s, s_rate
    return panels.damping[d] * total


@kernel(inlined=True)
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


@kernel
def commit_step(model, state, work, tables, level, h):
    """Move the workspace's coordinates from the start to the end of the solved step, and fill the motion there."""
    distribute_loads(model, state, work)
    stage_frames(model, state, work, h)
    power = 0.0
    for b in range(model.bodies.size):
        body, frame, first = model.bodies[b], work.bodies[b], model.bodies[b].offset
        for i in range(3):
            work.q[first + i], work.v[first + i] = frame.place[SECOND, i], frame.speed[SECOND, i]
        if body.panel != RIGID_BODY:
            answers, panel, begin = tables.answers[body.design, level], work.panels[body.panel], first + 3
            end = begin + answers.size
            q, v = work.q[begin:end], work.v[begin:end]
            power += move_panel(model.panels, panel, answers, body.design, q, v)
    work.integrals[work.integrals.size + MATERIAL_DISSIPATION] += h * power
    place_bodies(model, work.q, work.v, work, START)
    note_extremes(model, state, work, work.v)


@kernel(single_caller=True)
def keep_loads(state, work, h):
    """Keep the loads at the end of the step and the course they have taken."""
    for k in range(work.loads.size):
        stage = work.loads[k].stage
        state.loads[k], state.load_rates[k] = stage[1], 1.5 * (stage[1] - stage[0]) / h
    for p in range(work.panels.size):
        copy_rows(state.coupling[p], work.panels[p].coupling[1])
