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
    values_of,
)
from solar_env.mechanics.numerics.jit import kernel


@kernel(inner=True)
def foreshorten(forms, low, column, gradient, shortening):
    """Values and rates of the quadratic forms, with their gradients.

    Args:
        forms: (2, LOW, LOW, FORMS), see `Panels`.
        low: (2, LOW, 4) motion of the lowest modes of the two bending groups.
        column: of it that holds the amplitudes; the next one holds the rates.
        gradient: (2, LOW, FORMS) by amplitude.
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
def move_low(panels, work, tables, level, p, d, group):
    """Motion of the coupled modes of a group at both stages under the loads and the present modal forces."""
    for r in range(panels.coupled[group]):
        k = panels.first[group] + r
        first, second = work.coupling[p, 0, k], work.coupling[p, 1, k]
        for i in range(values_of(group)):
            first += panels.rows[d, k, i] * work.group_load[p, 0, group, i]
            second += panels.rows[d, k, i] * work.group_load[p, 1, group, i]
        for c in range(4):
            work.low[group, r, c] = (
                work.low_free[p, group, r, c]
                + tables.answers[d, level, k, FROM_LOAD + c] * first
                + tables.answers[d, level, k, FROM_LOAD + 4 + c] * second
            )


@kernel(inlined=True)
def axial_form(group, r):
    """Form that projects foreshortening on coupled axial mode `r` of a group."""
    return ODD_FIRST + r if group == AXIAL_ODD else EVEN_FIRST


@kernel(inlined=True)
def push_axial(panels, work, p, d, s):
    """Modal forces of foreshortening on the axial modes of panel `p` at stage `s`."""
    for group in range(AXIAL_EVEN, GROUPS):
        for r in range(panels.coupled[group]):
            k, f = panels.first[group] + r, axial_form(group, r)
            strain = work.shortening[p, s, 0, f] + panels.damping[d] * work.shortening[p, s, 1, f]
            work.coupling[p, s, k] = panels.frequency[d, k] ** 2 * strain


@kernel(inlined=True)
def push_bending(panels, work, p, d, s):
    """Modal forces of the tension on the bending modes of panel `p` at stage `s`."""
    for f in range(FORMS):
        work.tension[f] = 0.0
    work.tension[EVEN_ENDS] = work.group_load[p, s, AXIAL_EVEN, 0]
    work.tension[ODD_ENDS] = work.group_load[p, s, AXIAL_ODD, 0]
    for group in range(AXIAL_EVEN, GROUPS):
        for r in range(panels.coupled[group]):
            k, f = panels.first[group] + r, axial_form(group, r)
            value, rate = work.low[group, r, 2 * s], work.low[group, r, 2 * s + 1]
            work.strain_rate[p, s, k] = rate - work.shortening[p, s, 1, f]
            work.tension[f] = panels.frequency[d, k] ** 2 * (value + panels.damping[d] * rate) - work.coupling[p, s, k]
    for group in range(2):
        for r in range(panels.coupled[group]):
            force = 0.0
            for f in range(FORMS):
                force += work.tension[f] * work.gradient[s, group, r, f]
            work.coupling[p, s, panels.first[group] + r] = force


@kernel(inlined=True)
def couple(panels, work, tables, level, p, d):
    """Modal forces of foreshortening in panel `p` at both stages, the axial ones first: tension is what they leave."""
    for group in range(AXIAL_EVEN):
        move_low(panels, work, tables, level, p, d, group)
    for s in range(2):
        foreshorten(panels.forms[d], work.low, 2 * s, work.gradient[s], work.shortening[p, s])
        push_axial(panels, work, p, d, s)
    for group in range(AXIAL_EVEN, GROUPS):
        move_low(panels, work, tables, level, p, d, group)
    for s in range(2):
        push_bending(panels, work, p, d, s)


@kernel(inlined=True)
def shorten_ends(work, p):
    """Add foreshortening to the axial motion of the ends of panel `p` at both stages."""
    for s in range(2):
        for c in range(2):
            work.ends[p, AXIAL_ODD, 0, 2 * s + c] += work.shortening[p, s, c, ODD_ENDS]
            work.ends[p, AXIAL_EVEN, 0, 2 * s + c] += work.shortening[p, s, c, EVEN_ENDS]
