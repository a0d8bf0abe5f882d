"""Motion of the ends of a panel by groups of modes: over a step, free and under the loads at its stages; in a pose.

With it goes foreshortening, whose forms and their source are in `foreshortening`: what bending does to a panel's axis,
and tension to its bending, at both stages.
"""

from solar_env.mechanics.modal.tables import (
    AXIAL_EVEN,
    AXIAL_ODD,
    EVEN_ENDS,
    EVEN_FIRST,
    FORMS,
    FROM_LOAD,
    FROM_RATE,
    GROUPS,
    LOW,
    ODD_ENDS,
    ODD_FIRST,
    VALUES,
    values_of,
)
from solar_env.mechanics.numerics.jit import kernel


@kernel(inner=True)
def free_ends(panels, panel, answers, d, q, v):
    """Free motion over a step of the ends and of the coupled modes of a panel of design `d`."""
    for group in range(GROUPS):
        begin, end, coupled = panels.first[group], panels.first[group + 1], panels.coupled[group]
        # Of slices: indices that cannot be negative are spared a test.
        modes, of_group, values, rates = panels.modes[d, begin:end], answers[begin:end], q[begin:end], v[begin:end]
        w0 = w1 = w2 = w3 = s0 = s1 = s2 = s3 = defect = 0.0
        for k in range(values.size):
            a, b, answer = values[k], rates[k], of_group[k].coefficient
            y0 = answer[0] * a + answer[FROM_RATE] * b
            y1 = answer[1] * a + answer[FROM_RATE + 1] * b
            y2 = answer[2] * a + answer[FROM_RATE + 2] * b
            y3 = answer[3] * a + answer[FROM_RATE + 3] * b
            if k < coupled:
                low = panel.low_free[group, k]
                low[0], low[1], low[2], low[3] = y0, y1, y2, y3
            first, second = modes[k].row[0], modes[k].row[1]
            w0 += first * y0
            w1 += first * y1
            w2 += first * y2
            w3 += first * y3
            s0 += second * y0
            s1 += second * y1
            s2 += second * y2
            s3 += second * y3
            defect += first * (of_group[k].defect[0] * a + of_group[k].defect[1] * b)
        free = panel.free[group]
        free[0, 0], free[0, 1], free[0, 2], free[0, 3] = w0, w1, w2, w3
        free[1, 0], free[1, 1], free[1, 2], free[1, 3] = s0, s1, s2, s3
        panel.defect[group] = defect


@kernel(inlined=True)
def forced_ends(panel, response, groups):
    """Motion of the ends of a panel at both stages in the first `groups` groups, free and by the loads there."""
    for group in range(groups):
        for i in range(values_of(group)):
            for c in range(4):
                total = panel.free[group, i, c]
                for j in range(values_of(group)):
                    total += response[group, i, j, c] * panel.load[0, group, j]
                    total += response[group, i, j, 4 + c] * panel.load[1, group, j]
                panel.ends[group, i, c] = total


@kernel(inlined=True)
def add_modal_forces(panels, panel, answers, d):
    """Add what the modal forces of foreshortening do to the ends of a panel."""
    for group in range(GROUPS):
        for r in range(panels.coupled[group]):
            k = panels.first[group] + r
            first, second = panel.coupling[0, group, r], panel.coupling[1, group, r]
            mode, answer = panels.modes[d, k], answers[k].coefficient
            for c in range(4):
                gain = answer[FROM_LOAD + c] * first + answer[FROM_LOAD + 4 + c] * second
                for i in range(values_of(group)):
                    panel.ends[group, i, c] += mode.row[i] * gain


@kernel(inner=True)
def foreshorten(forms, low, column, gradient, shortening):
    """Fill the quadratic forms' values and rates, and their gradients, from a `column` of `low` and the next one."""
    value0 = value1 = value2 = value3 = value4 = 0.0
    rate0 = rate1 = rate2 = rate3 = rate4 = 0.0
    for group in range(2):
        for r in range(LOW):
            g0 = g1 = g2 = g3 = g4 = 0.0
            for c in range(LOW):
                same, other = low[group, c, column], low[1 - group, c, column]
                g0 += forms[group, r, c, 0] * same
                g1 += forms[group, r, c, 1] * same
                g2 += forms[group, r, c, 2] * same
                g3 += forms[group, r, c, 3] * other
                g4 += forms[group, r, c, 4] * other
            half, speed = 0.5 * low[group, r, column], low[group, r, column + 1]
            value0 += g0 * half
            value1 += g1 * half
            value2 += g2 * half
            value3 += g3 * half
            value4 += g4 * half
            rate0 += g0 * speed
            rate1 += g1 * speed
            rate2 += g2 * speed
            rate3 += g3 * speed
            rate4 += g4 * speed
            row = gradient[group, r]
            row[0], row[1], row[2], row[3], row[4] = g0, g1, g2, g3, g4
    for c, value in enumerate((value0, value1, value2, value3, value4)):
        shortening[0, c] = value
    for c, rate in enumerate((rate0, rate1, rate2, rate3, rate4)):
        shortening[1, c] = rate


@kernel(inlined=True)
def shorten_ends(panel, s):
    """Add foreshortening to the axial motion of the ends of a panel at stage `s`."""
    for c in range(2):
        panel.ends[AXIAL_ODD, 0, 2 * s + c] += panel.shortening[s, c, ODD_ENDS]
        panel.ends[AXIAL_EVEN, 0, 2 * s + c] += panel.shortening[s, c, EVEN_ENDS]


@kernel(inner=True)
def sum_ends(panels, panel, d, q, v):
    """Motion of the ends of a panel in a pose, as of the first stage, without foreshortening."""
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        modes, values, rates = panels.modes[d, begin:end], q[begin:end], v[begin:end]
        w, w_rate, s, s_rate = 0.0, 0.0, 0.0, 0.0
        for k in range(values.size):
            first, second = modes[k].row[0], modes[k].row[1]
            w += first * values[k]
            w_rate += first * rates[k]
            s += second * values[k]
            s_rate += second * rates[k]
        ends = panel.ends[group]
        ends[0, 0], ends[0, 1], ends[1, 0], ends[1, 1] = w, w_rate, s, s_rate


@kernel(inlined=True)
def shorten_pose(panels, panel, d, q, v):
    """Add foreshortening to the motion of the ends of a panel in a pose, as of the first stage."""
    for group in range(AXIAL_EVEN):
        coupled = panels.coupled[group]
        for i in range(VALUES):
            for c in range(2):
                panel.low[group, coupled + i, c] = panel.ends[group, i, c]
        for r in range(coupled):
            k = panels.first[group] + r
            panel.low[group, r, 0], panel.low[group, r, 1] = q[k], v[k]
            for i in range(VALUES):
                panel.low[group, coupled + i, 0] -= panels.modes[d, k].row[i] * q[k]
                panel.low[group, coupled + i, 1] -= panels.modes[d, k].row[i] * v[k]
    foreshorten(panels.forms[d], panel.low, 0, panel.gradient[0], panel.shortening[0])
    shorten_ends(panel, 0)


@kernel(inlined=True)
def move_low(panels, panel, answers, d, group):
    """Motion of the coupled coordinates of a group at both stages under the loads and the present modal forces."""
    coupled = panels.coupled[group]
    if group < AXIAL_EVEN:
        for i in range(VALUES):
            for c in range(4):
                panel.low[group, coupled + i, c] = panel.ends[group, i, c]
    for r in range(coupled):
        k = panels.first[group] + r
        mode, answer, first, second = panels.modes[d, k], answers[k].coefficient, 0.0, 0.0
        for i in range(values_of(group)):
            first += mode.row[i] * panel.load[0, group, i]
            second += mode.row[i] * panel.load[1, group, i]
        for c in range(4):
            by_first, by_second = answer[FROM_LOAD + c], answer[FROM_LOAD + 4 + c]
            moved = panel.low_free[group, r, c] + by_first * first + by_second * second
            if group < AXIAL_EVEN:
                # The ends have moved by the loads, not yet by the modal forces.
                for i in range(VALUES):
                    panel.low[group, coupled + i, c] -= mode.row[i] * moved
            moved += by_first * panel.coupling[0, group, r] + by_second * panel.coupling[1, group, r]
            panel.low[group, r, c] = moved


@kernel(inlined=True)
def axial_form(group, r):
    """Form that projects foreshortening on coupled axial mode `r` of a group."""
    return ODD_FIRST + r if group == AXIAL_ODD else EVEN_FIRST


@kernel(single_caller=True)
def push_axial(panels, panel, d, s):
    """Modal forces of foreshortening on the axial modes of a panel at stage `s`."""
    for group in range(AXIAL_EVEN, GROUPS):
        for r in range(panels.coupled[group]):
            frequency, f = panels.modes[d, panels.first[group] + r].frequency, axial_form(group, r)
            strain = panel.shortening[s, 0, f] + panels.damping[d] * panel.shortening[s, 1, f]
            panel.coupling[s, group, r] = frequency * frequency * strain


@kernel(single_caller=True)
def push_bending(panels, panel, d, s):
    """Forces of the tension on the bending coordinates of a panel at stage `s`."""
    for f in range(FORMS):
        panel.tension[f] = 0.0
    panel.tension[EVEN_ENDS] = panel.load[s, AXIAL_EVEN, 0]
    panel.tension[ODD_ENDS] = panel.load[s, AXIAL_ODD, 0]
    for group in range(AXIAL_EVEN, GROUPS):
        for r in range(panels.coupled[group]):
            frequency, f = panels.modes[d, panels.first[group] + r].frequency, axial_form(group, r)
            value, rate = panel.low[group, r, 2 * s], panel.low[group, r, 2 * s + 1]
            panel.strain_rate[s, group, r] = rate - panel.shortening[s, 1, f]
            force = frequency * frequency * (value + panels.damping[d] * rate)
            panel.tension[f] = force - panel.coupling[s, group, r]
    for group in range(AXIAL_EVEN):
        coupled = panels.coupled[group]
        for r in range(coupled + VALUES):
            force = 0.0
            for f in range(FORMS):
                force += panel.tension[f] * panel.gradient[s, group, r, f]
            if r >= coupled:
                panel.load[s, group, r - coupled] += force - panel.coupling[s, group, r]
            panel.coupling[s, group, r] = force
        for r in range(coupled):
            for i in range(VALUES):
                share = panels.modes[d, panels.first[group] + r].row[i]
                panel.coupling[s, group, r] -= share * panel.coupling[s, group, coupled + i]


@kernel(inlined=True)
def couple(panels, panel, answers, d):
    """Forces of foreshortening in a panel at both stages, the axial ones first: tension is what they leave.

    The ends must have moved by their loads, among which are the forces on the rest of their values: these change here.
    """
    for group in range(AXIAL_EVEN):
        move_low(panels, panel, answers, d, group)
    for s in range(2):
        foreshorten(panels.forms[d], panel.low, 2 * s, panel.gradient[s], panel.shortening[s])
        push_axial(panels, panel, d, s)
    for group in range(AXIAL_EVEN, GROUPS):
        move_low(panels, panel, answers, d, group)
    for s in range(2):
        push_bending(panels, panel, d, s)
