"""Acceptance of a step: error divided by the tolerance, motion at its end, maxima of panels' end slopes and spins."""

import math

from solar_env.mechanics.arrays.model import MATERIAL_DISSIPATION
from solar_env.mechanics.modal.arrays import PULL_ROW, REACTION_X_ROW, RIGID_BODY
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

# Least ratio of a step to the last step at which the previous reactions measure its error. After a far longer last
# step, they show fast vibrations that the longer step did not resolve.
_COMPARABLE = 0.01


@kernel
def at_start(course):
    """Return a polynomial's value at the start of a step, given its values `course` at the step's three stages."""
    total = 0.0
    for k in range(STAGES):
        total += AT_START[k] * course[k]
    return total


@kernel
def vibration_defect(panels, panel, free, held, d, h, kind, group):
    """Return the error [m/s] of a panel's end due to those vibrations that a step `h` [s] cannot resolve.

    It is the error of the free motion minus the errors of the deflections that loads and foreshortening hold at the
    start of the step, since these do not vibrate.

    Args:
        panels: constants of the panel designs, of which this panel has the design with index `d`.
        panel: record of the free motion's error (`defect`), end loads (`load`), and modal forces of foreshortening.
        free: (modes, 16) motion of each mode in the step without loads. Per unit start amplitude it has the values at
            the three stages, the error of `kind` 0, the rates, and the error of `kind` 1; the same per unit start rate.
        held: (kinds, groups, 2) errors, times -1, of the deflection that a unit end force or a unit end moment holds.
        kind: 0 for the error of the end's velocity, 1 for its deflection's error times the modes' frequencies.
        group: index of the mode group, the bending or axial modes that are even, or odd, about the panel's middle.
    """
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
    """Return how far joint or cable load `k` at the step's start lies from the polynomial through its stage values."""
    return abs(state.course[k, LAST] - at_start(work.loads[k].stage))


@kernel
def step_error(model, state, work, settings, tables, level, h):
    """Return the error of a solved step `h` [s] in units of the tolerances: the greatest error of any load or panel.

    Loads are the torques and forces of joints and cable loops. A load's error is its difference, at the step's start,
    from the polynomial through its values at the three stages. If the previous step was over 100 times as long, the
    error of an ideal joint's force is limited to the force's change from the first to the last stage. A panel's error
    is the difference between computed and exact vibration of its ends. `level` is the step size's index in `tables`.
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
                # The even and the odd part add up at one of the two ends.
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
def number_at(array, k):
    """Return element `k` of an array; `load4`, its counterpart for vectors, returns four elements from `k` on."""
    return array[k]


@kernel
def put_number(array, k, number):
    """Set element `k` of an array; `store4`, its counterpart for vectors, sets four elements from `k` on."""
    array[k] = number


@kernel
def move_modes(ends, shapes, frequency, load, q, v, k, take, put):
    """Advance a panel's mode `k`, or the four modes from `k` on, by a step; return (new rate * `frequency`)^2.

    Args:
        ends: (END_ROWS, modes) motion at the step's end. Rows 0 to 4 are the amplitude per unit start amplitude, start
            rate, and load at each of three stages; rows 5 to 9 are the rate per unit of the same.
        shapes: (2, modes) deflection and slope of the panel's first end in each mode.
        frequency, q, v: (modes,) angular frequencies [rad/s], amplitudes and rates; the last two are overwritten.
        load: (2, stages) force and moment on the first end that act on these modes like the loads on both ends: a
            mode's load is its deflection * force + slope * moment.
        take, put: functions that read and write an array from element `k` on: `number_at` and `put_number` for one
            mode, `load4` and `store4` for four.
    """
    value, rate, one, other = take(q, k), take(v, k), take(shapes[0], k), take(shapes[1], k)
    moved = take(ends[0], k) * value + take(ends[1], k) * rate
    gained = take(ends[2 + STAGES], k) * value + take(ends[3 + STAGES], k) * rate
    for s in range(STAGES):
        force = one * load[0, s] + other * load[1, s]
        moved = moved + take(ends[2 + s], k) * force
        gained = gained + take(ends[4 + STAGES + s], k) * force
    put(q, k, moved)
    put(v, k, gained)
    gained = take(frequency, k) * gained
    return gained * gained


@kernel
def move_panel(panels, panel, ends, d, q, v):
    """Advance a panel's modal amplitudes `q` and rates `v` over the step; return its damping power [W] at the end.

    `panel` has the loads at the stages, and `panels` the constants of its design, at index `d`. `ends` (10, modes) has
    the motion at the step's end per unit start amplitude, start rate, and load at each of three stages: amplitudes in
    rows 0 to 4, rates in rows 5 to 9.
    """
    total = 0.0
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        values, rates, frequency = q[begin:end], v[begin:end], panels.frequency[d, begin:end]
        load, shapes, moves = panel.load[group], panels.shapes[d, :, begin:end], ends[:, begin:end]
        whole, power = values.size - values.size % LANES, splat4(0.0)
        for k in range(0, whole, LANES):
            power = power + move_modes(moves, shapes, frequency, load, values, rates, k, load4, store4)
        total += sum_lanes(power)
        for k in range(whole, values.size):
            total += move_modes(moves, shapes, frequency, load, values, rates, k, number_at, put_number)
        for r in range(panels.coupled[group]):
            before = rates[r]
            for s in range(STAGES):
                force = panel.coupling[group, r, s]
                values[r] += ends[2 + s, begin + r] * force
                rates[r] += ends[4 + STAGES + s, begin + r] * force
            # The strain rate of an axial mode is the rate of its amplitude minus foreshortening's rate.
            strain_rate = panel.strain_rate[group, r] if group >= AXIAL_EVEN else rates[r]
            total += frequency[r] ** 2 * (strain_rate * strain_rate - before * before)
    return panels.damping[d] * total


@kernel
def note_extremes(model, state, work, v):
    """Update the maxima, since the run's start, of a panel end's slope [rad] and of a panel's spin / lowest frequency.

    They are the two entries of `state.extremes`. The slopes are read from `work`, the spins from the velocities `v`.
    """
    panels, extremes = model.panels, state.extremes
    even, odd = panels.first[BENDING_EVEN], panels.first[BENDING_ODD]
    for b in range(model.bodies.size):
        body = model.bodies[b]
        if body.panel != RIGID_BODY:
            # The even and the odd part add up at one of the two ends.
            ends = work.panels[body.panel].ends
            slope = abs(ends[BENDING_EVEN, 1, LAST]) + abs(ends[BENDING_ODD, 1, LAST])
            lowest = min(panels.frequency[body.design, even], panels.frequency[body.design, odd])
            extremes[0] = max(extremes[0], slope)
            extremes[1] = max(extremes[1], abs(v[body.offset + 2]) / lowest)


@kernel
def commit_step(model, state, work, tables, level, h):
    """Write motion and damping power at the step's end to `work`; `level` is the step size's index in `tables`."""
    for b in range(model.bodies.size):
        body, frame, first = model.bodies[b], work.bodies[b], model.bodies[b].offset
        for i in range(3):
            work.q[first + i], work.v[first + i] = frame.place[i, LAST], frame.speed[i, LAST]
        if body.panel != RIGID_BODY:
            panel, begin = work.panels[body.panel], first + 3
            end = begin + model.panels.frequency.shape[1]
            q, v = work.q[begin:end], work.v[begin:end]
            power = move_panel(model.panels, panel, tables.ends[body.design, level], body.design, q, v)
            # Modes may vibrate several times in a step: their damping takes its mean power, which the ends sample.
            mean = 0.5 * (state.damping_power[body.panel] + power)
            work.integrals[work.integrals.size + MATERIAL_DISSIPATION] += h * mean
            work.damping_power[body.panel] = power
    note_extremes(model, state, work, work.v)


@kernel
def keep_loads(state, work):
    """Copy loads and foreshortening forces at the stages, and damping power at the end, from `work` to `state`."""
    for k in range(work.loads.size):
        store4(state.course[k], 0, load4(work.loads[k].stage, 0))
    for p in range(work.panels.size):
        for group in range(GROUPS):
            for r in range(LOW):
                store4(state.coupling[p, group, r], 0, load4(work.panels[p].coupling[group, r], 0))
    copy_into(state.damping_power, work.damping_power)
