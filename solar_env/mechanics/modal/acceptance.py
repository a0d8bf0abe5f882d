"""End of a step: its error over the tolerances, and the state moved to where it leads."""

import math

from solar_env.mechanics.arrays.model import MATERIAL_DISSIPATION
from solar_env.mechanics.modal.arrays import PULL_ROW, REACTION_X_ROW, RIGID_BODY
from solar_env.mechanics.modal.solve import move_stages
from solar_env.mechanics.modal.tables import (
    AT_START,
    AXIAL_EVEN,
    BENDING_EVEN,
    BENDING_ODD,
    COLUMNS,
    DEFECT_LANES,
    DEFECTS,
    GROUPS,
    LANES,
    LAST,
    LOW,
    RATE_AT_START,
    STAGES,
    values_of,
)
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.vectors import load4, splat4, store4, sum_lanes

# A reaction at the end of one step tells little of the error of another that is shorter than this share of it. It tells
# of the fast vibrations that the longer step does not resolve.
_COMPARABLE = 0.01


@kernel
def at_start(course):
    """Value at the start of a step of a course given at its stages."""
    total = 0.0
    for k in range(STAGES):
        total += AT_START[k] * course[k]
    return total


@kernel
def vibration_defect(panels, panel, free, held, d, h, kind, group):
    """Defect of the motion of a group's ends [m/s]: of its vibration, without what loads and foreshortening hold."""
    defect = panel.defect[kind, group]
    for j in range(values_of(group)):
        defect += held[kind, group, j] * at_start(panel.load[group, j])
    if group >= AXIAL_EVEN:
        for r in range(panels.coupled[group]):
            number, course, rate = panels.first[group] + r, panel.coupling[group, r], 0.0
            for k in range(STAGES):
                rate += RATE_AT_START[k] * course[k] / h
            column, held_there = DEFECT_LANES[kind], panels.shapes[d, 0, number] / panels.frequency[d, number] ** 2
            shortened = free[number, column] * at_start(course) + free[number, COLUMNS + column] * rate
            defect -= held_there * shortened
    return abs(defect)


@kernel
def deviation(state, work, k):
    """Load at the start of the step less that of the polynomial through its stages there, without sign."""
    return abs(state.course[k, LAST] - at_start(work.loads[k].stage))


@kernel
def step_error(model, state, work, settings, tables, level, h):
    """Error of a step over the tolerances.

    Of loads: their value at the start against that of the polynomial through the stages, and of reactions whose value
    there is that of a far longer step, how they change between the stages if that is less. Of vibrations that the step
    does not resolve: the motion of the ends against the exact one.
    """
    error = 0.0
    settled = state.clock[0].acceleration_current != 0
    comparable = h >= _COMPARABLE * state.clock[0].last_step
    for k in range(model.joints.size + model.cables.size):
        error = max(error, deviation(state, work, k) / work.loads[k].tolerance)
    for r in range(work.step[0].unknowns):
        kind, k = work.unknowns[r].kind, work.unknowns[r].number
        if kind >= PULL_ROW and (settled or kind < REACTION_X_ROW):
            apart, stage = deviation(state, work, k), work.loads[k].stage
            if not comparable and kind >= REACTION_X_ROW:
                apart = min(apart, abs(stage[LAST] - stage[0]))
            error = max(error, apart / work.loads[k].tolerance)
    limit = work.step[0].velocity_tolerance
    for b in range(model.bodies.size):
        p, d = model.bodies[b].panel, model.bodies[b].design
        if p != RIGID_BODY and tables.responses[d, level].unresolved > 0:
            panel, free, held = work.panels[p], tables.free[d, level], tables.responses[d, level].held
            total = 0.0
            for kind in range(DEFECTS):
                # At one end or the other, the even and the odd part add up.
                across = along = 0.0
                for group in range(GROUPS):
                    defect = vibration_defect(model.panels, panel, free, held, d, h, kind, group)
                    if group < AXIAL_EVEN:
                        across += defect
                    else:
                        along += defect
                total += max(across, along) ** 2
            error = max(error, math.sqrt(total) / limit)
    return error


@kernel
def move_group(ends, shapes, frequency, forces, moments, q, v):
    """Move the amplitudes of a group of modes over the step, by their start and the loads of the ends at the stages.

    Returns the sum of the squares of their rates by `frequency` (modes,).
    """
    by_value, by_rate, rate_by_value, rate_by_rate = ends[0], ends[1], ends[2 + STAGES], ends[3 + STAGES]
    first, second, third = ends[2], ends[3], ends[4]
    rate_first, rate_second, rate_third = ends[4 + STAGES], ends[5 + STAGES], ends[6 + STAGES]
    whole, sums = q.size - q.size % LANES, splat4(0.0)
    for k in range(0, whole, LANES):
        value, rate = load4(q, k), load4(v, k)
        one, other = load4(shapes[0], k), load4(shapes[1], k)
        force1 = one * forces[0] + other * moments[0]
        force2 = one * forces[1] + other * moments[1]
        force3 = one * forces[2] + other * moments[2]
        moved = load4(by_value, k) * value + load4(by_rate, k) * rate
        moved = moved + load4(first, k) * force1 + load4(second, k) * force2 + load4(third, k) * force3
        gained = load4(rate_by_value, k) * value + load4(rate_by_rate, k) * rate
        gained = gained + load4(rate_first, k) * force1 + load4(rate_second, k) * force2 + load4(rate_third, k) * force3
        store4(q, k, moved)
        store4(v, k, gained)
        gained = load4(frequency, k) * gained
        sums = sums + gained * gained
    total = sum_lanes(sums)
    for k in range(whole, q.size):
        value, rate = q[k], v[k]
        force1 = shapes[0, k] * forces[0] + shapes[1, k] * moments[0]
        force2 = shapes[0, k] * forces[1] + shapes[1, k] * moments[1]
        force3 = shapes[0, k] * forces[2] + shapes[1, k] * moments[2]
        q[k] = by_value[k] * value + by_rate[k] * rate + first[k] * force1 + second[k] * force2 + third[k] * force3
        moved = rate_by_value[k] * value + rate_by_rate[k] * rate
        v[k] = moved + rate_first[k] * force1 + rate_second[k] * force2 + rate_third[k] * force3
        total += (frequency[k] * v[k]) ** 2
    return total


@kernel
def move_panel(panels, panel, ends, d, q, v):
    """Move the amplitudes of a panel over the step; returns the power of its damping at the end [W]."""
    total = 0.0
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        values, rates, frequency = q[begin:end], v[begin:end], panels.frequency[d, begin:end]
        load, shapes = panel.load[group], panels.shapes[d, :, begin:end]
        total += move_group(ends[:, begin:end], shapes, frequency, load[0], load[1], values, rates)
        for r in range(panels.coupled[group]):
            before = rates[r]
            for s in range(STAGES):
                force = panel.coupling[group, r, s]
                values[r] += ends[2 + s, begin + r] * force
                rates[r] += ends[4 + STAGES + s, begin + r] * force
            # What strains an axial mode is not the rate of the amplitude but that less foreshortening's.
            strain_rate = panel.strain_rate[group, r] if group >= AXIAL_EVEN else rates[r]
            total += frequency[r] ** 2 * (strain_rate * strain_rate - before * before)
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
            slope = abs(ends[BENDING_EVEN, 1, LAST]) + abs(ends[BENDING_ODD, 1, LAST])
            lowest = min(panels.frequency[body.design, even], panels.frequency[body.design, odd])
            extremes[0] = max(extremes[0], slope)
            extremes[1] = max(extremes[1], abs(v[body.offset + 2]) / lowest)


@kernel
def commit_step(model, state, work, tables, level, h):
    """Move the workspace's coordinates to the end of the solved step, and fill the motion under its loads."""
    # The next step takes out what velocity it finds in ideal joints: it must be that of the coordinates.
    move_stages(model, state, work, tables, level, h, work.step[0].constrained != 0, False)
    for b in range(model.bodies.size):
        body, frame, first = model.bodies[b], work.bodies[b], model.bodies[b].offset
        for i in range(3):
            work.q[first + i], work.v[first + i] = frame.place[i, LAST], frame.speed[i, LAST]
        if body.panel != RIGID_BODY:
            panel, begin = work.panels[body.panel], first + 3
            end = begin + model.panels.frequency.shape[1]
            q, v = work.q[begin:end], work.v[begin:end]
            power = move_panel(model.panels, panel, tables.ends[body.design, level], body.design, q, v)
            # Between the ends of a step its modes may vibrate several times: their damping takes what it does on
            # average, of which the ends are samples.
            mean = 0.5 * (state.damping_power[body.panel] + power)
            work.integrals[work.integrals.size + MATERIAL_DISSIPATION] += h * mean
            work.damping_power[body.panel] = power
    note_extremes(model, state, work, work.v)


@kernel
def keep_loads(state, work):
    """Keep the course of the loads over the step, and what damping takes at its end."""
    for k in range(work.loads.size):
        store4(state.course[k], 0, load4(work.loads[k].stage, 0))
    for p in range(work.panels.size):
        for group in range(GROUPS):
            for r in range(LOW):
                store4(state.coupling[p, group, r], 0, load4(work.panels[p].coupling[group, r], 0))
    copy_into(state.damping_power, work.damping_power)
