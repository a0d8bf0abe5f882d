"""End of a step: its error over the tolerances, and the state moved to where it leads."""

from solar_env.mechanics.arrays.model import MATERIAL_DISSIPATION
from solar_env.mechanics.modal.arrays import CABLE_ROW, REACTION_X_ROW, RIGID_BODY, SECOND, START, UNKNOWNS
from solar_env.mechanics.modal.panel.oscillators import WEIGHT_A, WEIGHT_B
from solar_env.mechanics.modal.panel.tables import AXIAL_EVEN, AXIAL_ODD, BENDING_EVEN, BENDING_ODD, GROUPS, values_of
from solar_env.mechanics.modal.step.bodies import distribute_loads, stage_frames
from solar_env.mechanics.modal.step.cables import distribute_cables
from solar_env.mechanics.modal.step.motion import place_bodies
from solar_env.mechanics.modal.step.rows import load_column
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
def step_error(model, state, work, settings, tables, level, h):
    """Error of a step over the tolerances.

    Of loads: their value at the start against that of the polynomial through the stages, and of reactions whose value
    there is that of a far longer step, how they change between the stages if that is less. Of vibrations that the step
    does not resolve: the rate of the ends against the exact one.
    """
    error = 0.0
    settled = state.clock[0].acceleration_current != 0
    comparable = h >= _COMPARABLE * state.clock[0].last_step
    for j in range(model.joints.size):
        if work.joints[j].torque_unknown < 0:
            deviation = state.loads[j, 2] - 1.5 * work.joints[j].load[0, 2] + 0.5 * work.joints[j].load[1, 2]
            error = max(error, abs(deviation) / work.joints[j].torque_tolerance)
    for c in range(model.cables.size):
        own = work.cables[c]
        deviation = state.cable_loads[c, 0] - 1.5 * own.load[0] + 0.5 * own.load[1]
        error = max(error, abs(deviation) / own.tolerance)
    for r in range(work.counts[UNKNOWNS]):
        kind, j = work.unknowns[r].kind, work.unknowns[r].owner
        if kind != CABLE_ROW and (settled or kind < REACTION_X_ROW):
            c = load_column(kind)
            first, second = work.joints[j].load[0, c], work.joints[j].load[1, c]
            deviation = abs(state.loads[j, c] - 1.5 * first + 0.5 * second)
            if not comparable and kind >= REACTION_X_ROW:
                deviation = min(deviation, abs(second - first))
            error = max(error, deviation / work.unknowns[r].tolerance)
    limit = work.velocity_tolerance[0]
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


@kernel(inner=True)
def move_modes(modes, answers, first_load, second_load, coupled, own, group, q, v):
    """Move the amplitudes of one group over the step, and fill the motion of its ends there, columns 0 and 1.

    Args:
        modes: (modes,) rows of `mode_type`.
        answers: (modes,) rows of `answer_type`.
        first_load, second_load: (VALUES,) of the group's ends, by stage.
        coupled: number of modes that foreshortening couples.
        own: scratch of the panel.
        group: its number.
        q, v: (modes,) amplitudes and rates.

    Returns:
        Mean over the step of the sum of the squares of frequencies times rates.
    """
    force1, moment1, force2, moment2 = first_load[0], first_load[1], second_load[0], second_load[1]
    total = w = w_rate = s = s_rate = 0.0
    for k in range(q.size):
        mode, answer = modes[k], answers[k].coefficient
        across, turning = mode.row[0], mode.row[1]
        first = across * force1 + turning * moment1
        second = across * force2 + turning * moment2
        if k < coupled:
            first += own.coupling[0, group, k]
            second += own.coupling[1, group, k]
        value, rate = q[k], v[k]
        end = answer[2] * value + answer[6] * rate + answer[10] * first + answer[14] * second
        rate1 = answer[1] * value + answer[5] * rate + answer[9] * first + answer[13] * second
        rate2 = answer[3] * value + answer[7] * rate + answer[11] * first + answer[15] * second
        q[k], v[k] = end, rate2
        w += across * end
        w_rate += across * rate2
        s += turning * end
        s_rate += turning * rate2
        if group >= AXIAL_EVEN and k < coupled:
            rate1, rate2 = own.strain_rate[0, group, k], own.strain_rate[1, group, k]
        mean_square = WEIGHT_A * rate1 * rate1 + WEIGHT_B * rate2 * rate2
        total += mode.frequency * mode.frequency * mean_square
    ends = own.ends[group]
    ends[0, 0], ends[0, 1], ends[1, 0], ends[1, 1] = w, w_rate, s, s_rate
    return total


@kernel(inlined=True)
def move_panel(panels, own, answers, d, q, v):
    """Move the amplitudes of a panel; returns the mean power of its damping [W]."""
    total = 0.0
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        total += move_modes(
            panels.modes[d, begin:end],
            answers[begin:end],
            own.load[0, group],
            own.load[1, group],
            panels.coupled[group],
            own,
            group,
            q[begin:end],
            v[begin:end],
        )
    return panels.damping[d] * total


@kernel(inlined=True)
def note_extremes(panels, own, d, spin, extremes):
    """Keep what a panel comes to that is more than before: slope of an end, spin over the lowest frequency."""
    # At one end or the other, the even and the odd part add up.
    slope = abs(own.ends[BENDING_EVEN, 1, 0]) + abs(own.ends[BENDING_ODD, 1, 0])
    even, odd = panels.first[BENDING_EVEN], panels.first[BENDING_ODD]
    lowest = min(panels.modes[d, even].frequency, panels.modes[d, odd].frequency)
    extremes[0] = max(extremes[0], slope)
    extremes[1] = max(extremes[1], abs(spin) / lowest)


@kernel
def commit_step(model, state, work, tables, level, h):
    """Move the workspace's coordinates from the start to the end of the solved step, and fill the motion there."""
    distribute_loads(model, state, work)
    distribute_cables(model, work)
    stage_frames(model, state, work, h)
    power = 0.0
    for b in range(model.bodies.size):
        body, own, first = model.bodies[b], work.bodies[b], model.bodies[b].offset
        for i in range(3):
            work.q[first + i], work.v[first + i] = own.place[SECOND, i], own.speed[SECOND, i]
        if body.panel != RIGID_BODY:
            answers, panel, begin = tables.answers[body.design, level], work.panels[body.panel], first + 3
            end = begin + answers.size
            q, v = work.q[begin:end], work.v[begin:end]
            power += move_panel(model.panels, panel, answers, body.design, q, v)
            note_extremes(model.panels, panel, body.design, own.speed[SECOND, 2], state.extremes)
    work.integrals[work.integrals.size + MATERIAL_DISSIPATION] += h * power
    place_bodies(model, work.q, work.v, work, START)


@kernel(inlined=True)
def keep_loads(state, work, h):
    """Keep the loads at the end of the step and the course they have taken."""
    for j in range(state.joints.size):
        load = work.joints[j].load
        for c in range(3):
            state.loads[j, c] = load[1, c]
            state.load_rates[j, c] = 1.5 * (load[1, c] - load[0, c]) / h
    for c in range(work.cables.size):
        load = work.cables[c].load
        state.cable_loads[c, 0], state.cable_loads[c, 1] = load[1], 1.5 * (load[1] - load[0]) / h
    for p in range(work.panels.size):
        copy_rows(state.coupling[p], work.panels[p].coupling[1])
