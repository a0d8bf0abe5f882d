"""Motion of a panel's ends as a sum over even and odd modes: at the stages of a step, or in a pose (one configuration).

Foreshortening is included: bending shortens a panel's axis, and tension acts on bending. The module `foreshortening`
derives its quadratic forms. Vectors have one lane for each stage of a step; in a pose all lanes are equal.
"""

from solar_env.mechanics.modal.tables import (
    AXIAL_EVEN,
    AXIAL_ODD,
    COLUMNS,
    DEFECT_LANES,
    DEFECTS,
    END_RATE,
    EVEN_ENDS,
    EVEN_FIRST,
    FORMS,
    GROUPS,
    LOW,
    ODD_ENDS,
    ODD_FIRST,
    STAGES,
    VALUES,
    values_of,
)
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import (
    joined,
    lane,
    load4,
    load8,
    lower_half,
    splat4,
    splat8,
    store4,
    store8,
    third_repeated,
    upper_half,
)


@kernel
def free_ends(panels, panel, tables, d, level, q, v):
    """Compute a panel's motion without loads at a step's stages, from amplitudes `q` and rates `v` at the step's start.

    Write the ends' motion to `panel.free`, and the lowest modes' motion to `panel.low_free`. Write to `panel.defect`
    the error of an end's motion at the step's end, exact minus computed, due to vibrations that the step does not
    resolve. `d` is the index of the panel's design in `panels`, `level` the index of the step size in `tables`.
    """
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        # Slices avoid tests for negative indices.
        moves, values, rates = tables.free[d, level, begin:end], q[begin:end], v[begin:end]
        one, other = panels.shapes[d, 0, begin:end], panels.shapes[d, 1, begin:end]
        first, second = splat8(0.0), splat8(0.0)
        for k in range(values.size):
            moved = load8(moves[k], 0) * values[k] + load8(moves[k], COLUMNS) * rates[k]
            first = first + one[k] * moved
            second = second + other[k] * moved
        for kind in range(DEFECTS):
            panel.defect[kind, group] = lane(first, DEFECT_LANES[kind])
        store8(panel.free[group, 0], 0, third_repeated(first))
        store8(panel.free[group, 1], 0, third_repeated(second))
        for r in range(panels.coupled[group]):
            moved = load8(moves[r], 0) * values[r] + load8(moves[r], COLUMNS) * rates[r]
            store8(panel.low_free[group, r], 0, third_repeated(moved))


@kernel
def forced_ends(panel, response, groups):
    """Write the motion of a panel's ends under the end loads `panel.load`, at a step's stages, to `panel.ends`.

    It is the motion without loads, `panel.free`, plus the loads times `response`, the motion per unit load. Treat only
    the first `groups` of the mode groups even bending, odd bending, even axial and odd axial.
    """
    for group in range(groups):
        for i in range(values_of(group)):
            total = load8(panel.free[group, i], 0)
            for j in range(values_of(group)):
                for k in range(STAGES):
                    total = total + load8(response[group, i, j], COLUMNS * k) * panel.load[group, j, k]
            store8(panel.ends[group, i], 0, total)


@kernel
def add_modal_forces(panels, panel, forced, d):
    """Add to `panel.ends` the motion caused by the forces that foreshortening exerts on the panel's lowest modes.

    These forces are `panel.coupling`. `forced` (mode groups, modes, 24) has each mode's motion per unit force at each
    of a step's three stages in turn: four amplitudes, at the stages and again at the last one, then four rates. `d` is
    the panel's design, an index into the constants `panels`.
    """
    for group in range(GROUPS):
        for r in range(panels.coupled[group]):
            k, by_load, gain = panels.first[group] + r, forced[group, r], splat8(0.0)
            for s in range(STAGES):
                gain = gain + load8(by_load, COLUMNS * s) * panel.coupling[group, r, s]
            for i in range(values_of(group)):
                store8(panel.ends[group, i], 0, load8(panel.ends[group, i], 0) + panels.shapes[d, i, k] * gain)


@kernel
def foreshorten(forms, panel):
    """Compute a panel's shortening by bending at a step's stages, and its gradient in bending coordinates, `panel.low`.

    The shortening has five parts, each a quadratic form of the coordinates. Parts 0, 1 and 3 are its amplitudes in the
    two lowest odd axial modes and in the lowest even one. Parts 2 and 4 are the remainder, which moves the ends
    oppositely or alike. Write the parts and their rates to `panel.shortening`, their gradients to `panel.gradient`. The
    matrix `forms[group, :, :, part]` gives the gradient in the coordinates of even (group 0) or odd bending (group 1).
    """
    value0 = value1 = value2 = value3 = value4 = splat4(0.0)
    rate0 = rate1 = rate2 = rate3 = rate4 = splat4(0.0)
    for group in range(2):
        for r in range(LOW):
            g0 = g1 = g2 = g3 = g4 = splat4(0.0)
            for c in range(LOW):
                form = forms[group, r, c]
                same, partner = load4(panel.low[group, c], 0), load4(panel.low[1 - group, c], 0)
                g0 = g0 + form[0] * same
                g1 = g1 + form[1] * same
                g2 = g2 + form[2] * same
                g3 = g3 + form[3] * partner
                g4 = g4 + form[4] * partner
            moved = load8(panel.low[group, r], 0)
            half, speed = 0.5 * lower_half(moved), upper_half(moved)
            value0, rate0 = value0 + g0 * half, rate0 + g0 * speed
            value1, rate1 = value1 + g1 * half, rate1 + g1 * speed
            value2, rate2 = value2 + g2 * half, rate2 + g2 * speed
            value3, rate3 = value3 + g3 * half, rate3 + g3 * speed
            value4, rate4 = value4 + g4 * half, rate4 + g4 * speed
            gradient = panel.gradient[group, r]
            store4(gradient[0], 0, g0)
            store4(gradient[1], 0, g1)
            store4(gradient[2], 0, g2)
            store4(gradient[3], 0, g3)
            store4(gradient[4], 0, g4)
    store8(panel.shortening[0], 0, joined(value0, rate0))
    store8(panel.shortening[1], 0, joined(value1, rate1))
    store8(panel.shortening[2], 0, joined(value2, rate2))
    store8(panel.shortening[3], 0, joined(value3, rate3))
    store8(panel.shortening[4], 0, joined(value4, rate4))


@kernel
def shorten_ends(panel):
    """Add foreshortening, `panel.shortening`, to the axial motion of a panel's ends in `panel.ends`."""
    odd, even = panel.ends[AXIAL_ODD, 0], panel.ends[AXIAL_EVEN, 0]
    store8(odd, 0, load8(odd, 0) + load8(panel.shortening[ODD_ENDS], 0))
    store8(even, 0, load8(even, 0) + load8(panel.shortening[EVEN_ENDS], 0))


@kernel
def in_all_lanes(value, rate):
    """Return a vector of `value` four times and `rate` four times: a motion equal at all stages of a step."""
    return joined(splat4(value), splat4(rate))


@kernel
def sum_ends(panels, panel, d, q, v):
    """Write the motion of a panel's ends at mode amplitudes `q` and rates `v` to `panel.ends`, equal at all stages.

    It has deflections, slopes, displacements and rates. `d` is the panel's design, an index into constants `panels`.
    """
    for group in range(GROUPS):
        begin, end = panels.first[group], panels.first[group + 1]
        values, rates = q[begin:end], v[begin:end]
        for i in range(VALUES):
            shape, value, rate = panels.shapes[d, i, begin:end], 0.0, 0.0
            for k in range(values.size):
                value += shape[k] * values[k]
                rate += shape[k] * rates[k]
            store8(panel.ends[group, i], 0, in_all_lanes(value, rate))


@kernel
def take_rest(panels, panel, d, group, r, moved):
    """Subtract bending mode `r`'s part from the end deflection and slope that `panel.low[group]` holds.

    `panel.low[group]`, with `group` 0 for even and 1 for odd bending, has a row of amplitudes for each of the lowest
    modes, then a row of deflections and a row of slopes. Once all lowest modes are subtracted, these two rows hold the
    part of the higher modes. `moved` (8,) has mode `r`'s amplitudes, then its rates, at a step's stages. `d` is the
    panel's design, an index into `panels`.
    """
    for i in range(VALUES):
        rest = panel.low[group, panels.coupled[group] + i]
        store8(rest, 0, load8(rest, 0) - panels.shapes[d, i, panels.first[group] + r] * moved)


@kernel
def shorten_pose(panels, panel, d, q, v):
    """Add a panel's shortening by bending to its ends' axial displacements and velocities in `panel.ends`.

    Modal amplitudes are `q`, rates `v`. Before, `sum_ends` must write the ends' motion without shortening. `panel` is
    the panel's scratch record; `d` is the index of its design in the constants `panels`.
    """
    for group in range(AXIAL_EVEN):
        coupled = panels.coupled[group]
        for i in range(VALUES):
            store8(panel.low[group, coupled + i], 0, load8(panel.ends[group, i], 0))
        for r in range(coupled):
            k = panels.first[group] + r
            moved = in_all_lanes(q[k], v[k])
            store8(panel.low[group, r], 0, moved)
            take_rest(panels, panel, d, group, r, moved)
    foreshorten(panels.forms[d], panel)
    shorten_ends(panel)


@kernel
def move_low(panels, panel, forced, d, group):
    """Write the amplitudes and rates of the lowest modes of a `group`, at a step's stages, to `panel.low[group]`.

    A bending group has two more rows: the end deflection and slope due to its higher modes. All follow from free
    motion, end loads and the modal forces of foreshortening, `panel.coupling`. `forced` (mode groups, modes, 24) has
    each mode's motion per unit modal force at each of the three stages in turn: four amplitudes, the last stage's
    twice, then four rates. End loads act as such forces, too. `d` is the panel's design, an index into `panels`.
    """
    coupled, bending = panels.coupled[group], group < AXIAL_EVEN
    if bending:
        for i in range(VALUES):
            store8(panel.low[group, coupled + i], 0, load8(panel.ends[group, i], 0))
    for r in range(coupled):
        number = panels.first[group] + r
        moved, pushed = load8(panel.low_free[group, r], 0), splat8(0.0)
        for k in range(STAGES):
            gain = load8(forced[group, r], COLUMNS * k)
            force = panels.shapes[d, 0, number] * panel.load[group, 0, k]
            if bending:
                force += panels.shapes[d, 1, number] * panel.load[group, 1, k]
            moved = moved + gain * force
            pushed = pushed + gain * panel.coupling[group, r, k]
        if bending:
            # The ends' motion includes the loads, but not yet the modal forces.
            take_rest(panels, panel, d, group, r, moved)
        store8(panel.low[group, r], 0, moved + pushed)


@kernel
def axial_form(group, r):
    """Return the index of axial mode `r`'s quadratic form in `Panels.forms`; `group` is AXIAL_EVEN or AXIAL_ODD."""
    return ODD_FIRST + r if group == AXIAL_ODD else EVEN_FIRST


@kernel
def push_axial(panels, panel, d):
    """Write to `panel.coupling` the forces that shortening by bending exerts on a panel's lowest axial modes.

    They follow from `panel.shortening`. `d` is the panel's design, an index into the constants `panels`.
    """
    for group in range(AXIAL_EVEN, GROUPS):
        for r in range(panels.coupled[group]):
            frequency = panels.frequency[d, panels.first[group] + r]
            shortening = load8(panel.shortening[axial_form(group, r)], 0)
            strain = lower_half(shortening) + panels.damping[d] * upper_half(shortening)
            store4(panel.coupling[group, r], 0, frequency * frequency * strain)


@kernel
def push_bending(panels, panel, d):
    """Write to `panel.coupling` the forces that tension in a panel exerts on its bending coordinates, at the stages.

    The coordinates are the lowest modes' amplitudes, and the end deflections and slopes due to higher modes. Forces on
    the latter are also part of the end loads `panel.load`, and are updated there. Also write `panel.tension` and the
    axial modes' `panel.strain_rate`. `d` is the panel's design, an index into the constants `panels`.
    """
    for f in range(FORMS):
        store4(panel.tension[f], 0, splat4(0.0))
    store4(panel.tension[EVEN_ENDS], 0, load4(panel.load[AXIAL_EVEN, 0], 0))
    store4(panel.tension[ODD_ENDS], 0, load4(panel.load[AXIAL_ODD, 0], 0))
    for group in range(AXIAL_EVEN, GROUPS):
        for r in range(panels.coupled[group]):
            frequency, f = panels.frequency[d, panels.first[group] + r], axial_form(group, r)
            moved = load8(panel.low[group, r], 0)
            panel.strain_rate[group, r] = panel.low[group, r, END_RATE] - panel.shortening[f, END_RATE]
            force = frequency * frequency * (lower_half(moved) + panels.damping[d] * upper_half(moved))
            store4(panel.tension[f], 0, force - load4(panel.coupling[group, r], 0))
    for group in range(AXIAL_EVEN):
        coupled = panels.coupled[group]
        for r in range(coupled + VALUES):
            force, before = splat4(0.0), panel.coupling[group, r]
            for f in range(FORMS):
                force = force + load4(panel.tension[f], 0) * load4(panel.gradient[group, r, f], 0)
            if r >= coupled:
                load = panel.load[group, r - coupled]
                store4(load, 0, load4(load, 0) + force - load4(before, 0))
            store4(before, 0, force)
        for r in range(coupled):
            taken, number = panel.coupling[group, r], panels.first[group] + r
            force = load4(taken, 0)
            for i in range(VALUES):
                force = force - panels.shapes[d, i, number] * load4(panel.coupling[group, coupled + i], 0)
            store4(taken, 0, force)


@kernel
def bend(panels, panel, forced, d):
    """Compute a panel's shortening by bending at a step's stages, and write it to `panel.shortening`.

    It follows from the motion of ends and lowest modes. `forced` has these modes' amplitudes and rates at the stages
    per unit force at each stage. `d` is the panel's design, an index into `panels`.
    """
    for group in range(AXIAL_EVEN):
        move_low(panels, panel, forced, d, group)
    foreshorten(panels.forms[d], panel)


@kernel
def couple(panels, panel, forced, d):
    """Compute the forces that bending and axial motion of a panel exert on each other in `panel.coupling`.

    Shortening by bending (call `bend` before, with the same arguments) exerts forces on axial modes. Their motion gives
    the tension, which exerts forces on bending. If these act on the end deflections and slopes due to higher modes,
    they also go to the end loads `panel.load`. `forced` has each mode's amplitudes and rates at the stages per unit
    force at each stage. `d` is the panel's design, an index into `panels`.
    """
    push_axial(panels, panel, d)
    for group in range(AXIAL_EVEN, GROUPS):
        move_low(panels, panel, forced, d, group)
    push_bending(panels, panel, d)
