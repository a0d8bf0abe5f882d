"""Foreshortening in motion: what bending does to a panel's axis, and tension to its bending, at both stages of a step.

The forms and their source are in `foreshortening`.
"""

from solar_env.mechanics.modal.panel.oscillators import FROM_LOAD
from solar_env.mechanics.modal.panel.tables import (
    AXIAL_EVEN,
    AXIAL_ODD,
    EVEN_ENDS,
    EVEN_FIRST,
    FORMS,
    GROUPS,
    LOW,
    ODD_ENDS,
    ODD_FIRST,
    VALUES,
    values_of,
)
from solar_env.mechanics.numerics.jit import kernel


@kernel(inner=True)
def foreshorten(forms, low, column, gradient, shortening):
    """Values and rates of the quadratic forms, with their gradients.

    Args:
        forms: (2, LOW, LOW, FORMS), see `Panels`.
        low: (2, LOW, 4) motion of the coupled coordinates of the two bending groups.
        column: of it that holds their values; the next one holds the rates.
        gradient: (2, LOW, FORMS) by coordinate.
        shortening: (2, FORMS) values, rates.
    """
    value0 = value1 = value2 = value3 = value4 = 0.0
    rate0 = rate1 = rate2 = rate3 = rate4 = 0.0
    for group in range(2):
        for r in range(LOW):
            g0 = g1 = g2 = g3 = g4 = 0.0
            for c in range(LOW):
                own, other = low[group, c, column], low[1 - group, c, column]
                g0 += forms[group, r, c, 0] * own
                g1 += forms[group, r, c, 1] * own
                g2 += forms[group, r, c, 2] * own
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
def foreshorten_pose(panels, panel, d, q, v):
    """Foreshortening of a panel, as of the first stage, in a pose: amplitudes, their rates, and the ends' values."""
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


@kernel(inlined=True)
def form_of_ends(odd):
    """Form of the foreshortening that the ends feel, alike (0) or opposite (1)."""
    return ODD_ENDS if odd else EVEN_ENDS


@kernel(inlined=True)
def push_axial(panels, panel, d, s):
    """Modal forces of foreshortening on the axial modes of a panel at stage `s`."""
    for group in range(AXIAL_EVEN, GROUPS):
        for r in range(panels.coupled[group]):
            frequency, f = panels.modes[d, panels.first[group] + r].frequency, axial_form(group, r)
            strain = panel.shortening[s, 0, f] + panels.damping[d] * panel.shortening[s, 1, f]
            panel.coupling[s, group, r] = frequency * frequency * strain


@kernel(inlined=True)
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


@kernel(inner=True)
def bend_response(panels, panel, answers, rest, d):
    """Fill what a unit of axial load does through the bent axis of a panel, as of the second stage.

    The load works on the bending coordinates by the gradients of foreshortening, and by these the bending coordinates
    shorten the axis. Forces of the axial modes are left out: they follow their load by a square of the step size.
    """
    panel.bent[:] = 0.0
    panel.shortened[:] = 0.0
    for group in range(AXIAL_EVEN):
        coupled, gradient = panels.coupled[group], panel.gradient[1, group]
        for r in range(coupled):
            k = panels.first[group] + r
            mode, answer = panels.modes[d, k], answers[k].coefficient
            for c in range(8):
                for x in range(2):
                    moved = gradient[r, form_of_ends(x)] * answer[FROM_LOAD + c]
                    for y in range(2):
                        panel.shortened[x, y, c] += gradient[r, form_of_ends(y)] * moved
                    for i in range(VALUES):
                        panel.bent[x, group, i, c] += mode.row[i] * moved
        for i in range(VALUES):
            for j in range(VALUES):
                for c in range(8):
                    for x in range(2):
                        moved = gradient[coupled + j, form_of_ends(x)] * rest[group, i, j, c]
                        panel.bent[x, group, i, c] += moved
                        for y in range(2):
                            panel.shortened[x, y, c] += gradient[coupled + i, form_of_ends(y)] * moved


@kernel(inlined=True)
def shorten_ends(panel):
    """Add foreshortening to the axial motion of the ends of a panel at both stages."""
    for s in range(2):
        for c in range(2):
            panel.ends[AXIAL_ODD, 0, 2 * s + c] += panel.shortening[s, c, ODD_ENDS]
            panel.ends[AXIAL_EVEN, 0, 2 * s + c] += panel.shortening[s, c, EVEN_ENDS]
