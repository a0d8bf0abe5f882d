"""Responses of a panel's modes to a step of the three-stage Radau IIA method, for one mode and in tables by step size.

A mode obeys y'' + 2 delta y' + omega^2 y = f. The stages are from E. Hairer and G. Wanner, Solving Ordinary
Differential Equations II, 2nd ed., Springer 1996, section IV.5, doi:10.1007/978-3-642-05221-7; the last stage is the
step's end. A load's course over a step is the polynomial through its values at the stages. A mode with omega h < 2 in a
step h responds exactly; so does, up to a greater limit, a mode with over 2 % of critical damping, in which errors fade.
Other modes respond as the Radau method integrates them. Steps meet fast vibrations at arbitrary phases, so that loads
that follow them could grow from step to step; the method's numerical damping prevents this.

A mode is even or odd about the panel's middle: both ends deflect alike, or oppositely. One end's motion thus gives the
other end's. Bending and axial modes form four groups; the sum or the difference of the ends' loads acts on a group.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import record
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import load8, store8

Array = NDArray[np.float64]

STAGES = 3
LAST = STAGES - 1
NODES = ((4.0 - math.sqrt(6.0)) / 10.0, (4.0 + math.sqrt(6.0)) / 10.0, 1.0)


def _polynomial(stage: int) -> Polynomial:
    """Return the polynomial in the fraction of the step that is one at a stage and zero at the other stages."""
    others = [node for k, node in enumerate(NODES) if k != stage]
    whole = Polynomial.fromroots(others)
    return whole / whole(NODES[stage])


_POLYNOMIALS = [_polynomial(stage) for stage in range(STAGES)]
# POLYNOMIAL[k][p]: coefficient of power p of the fraction of the step, in the polynomial that is one at stage k.
POLYNOMIAL = tuple(tuple(float(c) for c in one.coef) for one in _POLYNOMIALS)
# Weights of the values at the stages for a course's value and rate at the start of the step, and rate at the end.
AT_START = tuple(row[0] for row in POLYNOMIAL)
RATE_AT_START = tuple(row[1] for row in POLYNOMIAL)
RATE_AT_END = tuple(float(one.deriv()(1.0)) for one in _POLYNOMIALS)
# Radau coefficients: load f_k of stage k adds h A[s][k] f_k to velocity, h^2 B[s][k] f_k to position at s; B = A A.
_A = np.array([[one.integ()(node) for one in _POLYNOMIALS] for node in NODES])
A = tuple(map(tuple, _A.tolist()))
B = tuple(map(tuple, (_A @ _A).tolist()))
WEIGHTS = A[LAST]  # weights of the stages in an integral over the step

# Columns of a motion at the stages: LANES values, then LANES rates. The column without a stage repeats the last stage.
LANES = 4
COLUMNS = 2 * LANES
END_VALUE, END_RATE = LAST, LANES + LAST
# Offsets of a mode's coefficients, COLUMNS for each cause: start value, start rate, and the load at each stage.
FROM_VALUE, FROM_RATE, FROM_LOAD = 0, COLUMNS, 2 * COLUMNS
COEFFICIENTS = (2 + STAGES) * COLUMNS
BY_LOAD = STAGES * COLUMNS

RESOLVED = 2.0  # greatest omega h of a mode that the step resolves
# Least damping ratio of modes exact beyond RESOLVED, up to omega h = `Panels.exact`, if 2 delta h < RESOLVED.
_DAMPED = 0.02
_SERIES = 3.0  # greatest omega h of the Taylor series; beyond, the series loses digits and the closed form has them
_TERMS = 26
_NEGLIGIBLE = 1e-20  # greatest negligible term of the series, relative to the first terms
_SHARES = np.array([1.0 / ((n + 2) * (n + 1)) for n in range(_TERMS)])
# Causes in lanes of a vector: unit start value, unit start rate, and courses of unit loads at the stages, by power.
_UNIT_VALUE, _UNIT_RATE = np.eye(2, COLUMNS)
_UNIT_LOADS = np.zeros((STAGES, COLUMNS))
_UNIT_LOADS[:, 2 : 2 + STAGES] = np.transpose(POLYNOMIAL)

# Tabled step sizes: greatest size [s] and number of sizes (levels). Each size is the previous one divided by sqrt(2).
GREATEST_STEP = 0.032
LEVELS = 50
_SIZES = GREATEST_STEP * 2.0 ** (-0.5 * np.arange(LEVELS))

# Defects: errors of an unresolved vibration's rate, and of its value times its frequency. Either defect vanishes at
# some phases. Tables of free motion hold them in lanes without a stage.
DEFECTS = 2
DEFECT_LANES = (STAGES, LANES + STAGES)

# Groups of modes. An end has two values in bending, deflection and slope, and one in stretching, displacement.
BENDING_EVEN, BENDING_ODD, AXIAL_EVEN, AXIAL_ODD = range(4)
GROUPS = 4
VALUES = 2
# Greatest number of coupled coordinates of a group, on which foreshortening acts: its lowest modes and, in bending,
# what its other modes contribute to the end values.
LOW = 4
# Quadratic forms of foreshortening: projections on odd and even coupled axial modes, and the remainder, which moves the
# ends oppositely (odd) or alike (even).
ODD_FIRST, ODD_SECOND, ODD_ENDS, EVEN_FIRST, EVEN_ENDS = range(5)
FORMS = 5

# Response of a mode to a step of one size.
answer_type = record(
    [
        ("coefficient", np.float64, COEFFICIENTS),  # see COEFFICIENTS
        # Defects of the end rate by start value and by start rate; then defects of the end value, times the frequency.
        ("defect", np.float64, 2 * DEFECTS),
        ("series", np.float64, (2 * STAGES, COLUMNS)),  # scratch: values and rates at the stages, by cause
    ]
)

# Responses of an end to a load at an end: displacement along by force along, deflection by force across, deflection by
# moment, slope by moment.
ALONG_ALONG, ACROSS_ACROSS, ACROSS_TURNING, TURNING_TURNING = range(4)
PRODUCTS = 4

# Rows of the factors that give modes at the end of a step: values, then rates, by start value, start rate and loads.
END_ROWS = 2 * (2 + STAGES)

# Response of a panel's ends to the groups' loads in a step of one size.
response_type = record(
    [
        # Response of end value i to load j of a group, COLUMNS for the load at each stage.
        ("response", np.float64, (GROUPS, VALUES, VALUES, BY_LOAD)),
        # Responses, by PRODUCTS, of the loaded end and of the other end to a unit load at the first end.
        # `unknowns.add_shared` has the signs of ACROSS_TURNING for other combinations.
        ("ends", np.float64, (2, PRODUCTS, BY_LOAD)),
        # Correction of the first value's defect by load j at the start: the deflection that the load holds is at rest.
        ("held", np.float64, (DEFECTS, GROUPS, VALUES)),
        ("unresolved", np.int64),  # number of modes with a defect
    ]
)

# Scratch of a panel in a step. Last axes of LANES are stages; last axes of COLUMNS are values and rates at the stages.
panel_scratch = record(
    [
        # Loads of the ends at the stages: transverse force and moment, or axial force.
        ("load", np.float64, (GROUPS, VALUES, LANES)),
        # Foreshortening's forces at the stages: on the coupled modes, and on the end values of the other modes. The
        # latter load all modes; the former cancel this effect on the coupled modes.
        ("coupling", np.float64, (GROUPS, LOW, LANES)),
        # Strain rates of the coupled axial modes at the end: rates of amplitudes minus foreshortening's rates.
        ("strain_rate", np.float64, (GROUPS, LOW)),
        ("free", np.float64, (GROUPS, VALUES, COLUMNS)),  # free motion of the ends
        ("defect", np.float64, (DEFECTS, GROUPS)),  # defect of the first end value, in free motion
        ("ends", np.float64, (GROUPS, VALUES, COLUMNS)),  # motion of the ends
        ("low_free", np.float64, (GROUPS, LOW, COLUMNS)),  # free motion of the modes that foreshortening couples
        ("low", np.float64, (GROUPS, LOW, COLUMNS)),  # motion of the coupled coordinates
        ("gradient", np.float64, (2, LOW, FORMS, LANES)),  # gradients of the forms by the bending coordinates
        ("shortening", np.float64, (FORMS, COLUMNS)),  # values of the forms and their rates
        ("tension", np.float64, (FORMS, LANES)),  # tension that does work on each form
    ]
)


class Panels(NamedTuple):
    """Constants of D panel designs with the same number of modes."""

    first: NDArray[np.int64]  # (GROUPS + 1,) first mode of each group
    kept: NDArray[np.int64]  # (2,) number of true bending modes; pseudo-modes come after them
    coupled: NDArray[np.int64]  # (GROUPS,) number of lowest modes that foreshortening couples
    damping: Array  # (D,) retardation time [s]
    exact: float  # greatest omega h of a damped mode with exact response
    frequency: Array  # (D, modes) natural frequencies [rad/s]
    # (D, 2, LOW, LOW, FORMS) forms by coordinate of a bending group and of its partner: the same group for odd forms,
    # the other group for even forms.
    forms: Array
    shapes: Array  # (D, VALUES, modes) first end's values at unit amplitude, see `beam_modes`


class Tables(NamedTuple):
    """Motion of modes and panel ends in a time step, for D panel designs and L step sizes (levels).

    It is tabled per unit start amplitude and start rate of a mode, and per unit load at each of the three stages.
    """

    answers: NDArray[np.void]  # (1,) scratch, of `answer_type`
    free: Array  # (D, L, modes, 2 COLUMNS) motion at the stages by start value and start rate, and DEFECT_LANES of both
    forced: Array  # (D, L, GROUPS, LOW, BY_LOAD) motion at the stages of the coupled modes by their loads
    ends: Array  # (D, L, END_ROWS, modes) motion at the end, see END_ROWS
    responses: NDArray[np.void]  # (D, L) rows of `response_type`


def make_tables(panels: Panels, levels: int) -> Tables:
    """Allocate tables, filled with zeros, of panels' motion due to start values and loads, for `levels` step sizes."""
    designs, modes = panels.frequency.shape
    shape = (designs, levels)
    return Tables(
        answers=np.zeros(1, answer_type),
        free=np.zeros((*shape, modes, 2 * COLUMNS)),
        forced=np.zeros((*shape, GROUPS, LOW, BY_LOAD)),
        ends=np.zeros((*shape, END_ROWS, modes)),
        responses=np.zeros(shape, response_type),
    )


@kernel
def exact_coefficients(frequency, damping_rate, h, answer):
    """Write a mode's exact motion at the stages of a step `h` [s], by Taylor series, to `answer.coefficient` (40,).

    The array has eight places for each cause in turn: unit start value, unit start rate, and a unit load at the first,
    second and third stage. Places 0 to 2 of the eight take the values at the stages, and 4 to 6 the rates.
    """
    square, damping = (frequency * h) ** 2, 2.0 * damping_rate * h
    first, second, largest = load8(_UNIT_VALUE, 0), load8(_UNIT_RATE, 0), 1.0
    rate0 = rate1 = rate2 = second
    value0, value1, value2 = first + NODES[0] * second, first + NODES[1] * second, first + second
    power0, power1 = NODES[0], NODES[1]
    # The terms of powers n and n + 1 give the term of power n + 2.
    for n in range(_TERMS):
        share = _SHARES[n]
        following = share * (-(damping * (n + 1)) * second - square * first)
        if n < STAGES:
            following = following + share * load8(_UNIT_LOADS[n], 0)
        rate = (n + 2) * following
        rate0, rate1, rate2 = rate0 + power0 * rate, rate1 + power1 * rate, rate2 + rate
        power0, power1 = power0 * NODES[0], power1 * NODES[1]
        value0, value1, value2 = value0 + power0 * following, value1 + power1 * following, value2 + following
        first, second = second, following
        largest *= (frequency * h + damping) * (n + 1) * share
        if n > STAGES and largest < _NEGLIGIBLE:
            break
    inverse = 1.0 / h
    store8(answer.series[0], 0, value0)
    store8(answer.series[1], 0, value1)
    store8(answer.series[2], 0, value2)
    store8(answer.series[3], 0, inverse * rate0)
    store8(answer.series[4], 0, inverse * rate1)
    store8(answer.series[5], 0, inverse * rate2)
    for case in range(2 + STAGES):
        scale = 1.0 if case == 0 else (h if case == 1 else h * h)
        for s in range(STAGES):
            answer.coefficient[COLUMNS * case + s] = scale * answer.series[s, case]
            answer.coefficient[COLUMNS * case + LANES + s] = scale * answer.series[STAGES + s, case]


@kernel
def closed_coefficients(frequency, damping_rate, h, coefficients):
    """Write an underdamped mode's exact motion at the three stages of a step `h` [s] to `coefficients` (40,).

    The array has eight places for each cause in turn: unit start value, unit start rate, and a unit load at the first,
    second and third stage. Places 0 to 2 of the eight take the values at the stages, and 4 to 6 the rates.
    """
    square, inverse = frequency * frequency, 1.0 / h
    damped = math.sqrt(square - damping_rate * damping_rate)
    for s in range(STAGES):
        share = NODES[s]
        decay = math.exp(-damping_rate * share * h)
        cosine, sine = decay * math.cos(damped * share * h), decay * math.sin(damped * share * h) / damped
        value_by_value, value_by_rate = cosine + damping_rate * sine, sine
        rate_by_value, rate_by_rate = -square * sine, cosine - damping_rate * sine
        coefficients[FROM_VALUE + s], coefficients[FROM_VALUE + LANES + s] = value_by_value, rate_by_value
        coefficients[FROM_RATE + s], coefficients[FROM_RATE + LANES + s] = value_by_rate, rate_by_rate
        for k in range(STAGES):
            # The particular solution is a polynomial in the fraction, computed from the highest power down.
            held = held_rate = next_power = next_but_one = 0.0
            for down in range(STAGES):
                p = LAST - down
                term = POLYNOMIAL[k][p] - 2.0 * damping_rate * (p + 1) * next_power * inverse
                term = (term - (p + 2) * (p + 1) * next_but_one * inverse * inverse) / square
                held_rate = held_rate * share + held
                held = held * share + term
                next_power, next_but_one = term, next_power
            start, start_rate = -next_power, -next_but_one * inverse
            row = FROM_LOAD + COLUMNS * k + s
            coefficients[row] = value_by_value * start + value_by_rate * start_rate + held
            coefficients[row + LANES] = rate_by_value * start + rate_by_rate * start_rate + held_rate * inverse


@kernel
def rational_coefficients(frequency, damping_rate, h, coefficients):
    """Write a mode's motion at the three stages of a step `h` [s], by the Radau IIA method, to `coefficients` (40,).

    The array has eight places for each cause in turn: unit start value, unit start rate, and a unit load at the first,
    second and third stage. Places 0 to 2 of the eight take the values at the stages, and 4 to 6 the rates.
    """
    square, damping = frequency * frequency, 2.0 * damping_rate
    (a11, a12, a13), (a21, a22, a23), (a31, a32, a33) = A
    (b11, b12, b13), (b21, b22, b23), (b31, b32, b33) = B
    d, k = damping * h, square * h * h
    m11, m12, m13 = 1.0 + d * a11 + k * b11, d * a12 + k * b12, d * a13 + k * b13
    m21, m22, m23 = d * a21 + k * b21, 1.0 + d * a22 + k * b22, d * a23 + k * b23
    m31, m32, m33 = d * a31 + k * b31, d * a32 + k * b32, 1.0 + d * a33 + k * b33
    c11, c12, c13 = m22 * m33 - m23 * m32, m13 * m32 - m12 * m33, m12 * m23 - m13 * m22
    c21, c22, c23 = m23 * m31 - m21 * m33, m11 * m33 - m13 * m31, m13 * m21 - m11 * m23
    c31, c32, c33 = m21 * m32 - m22 * m31, m12 * m31 - m11 * m32, m11 * m22 - m12 * m21
    inverse = 1.0 / (m11 * c11 + m12 * c21 + m13 * c31)
    for case in range(2 + STAGES):
        y0 = 1.0 if case == 0 else 0.0
        v0 = 1.0 if case == 1 else 0.0
        f1 = (1.0 if case == 2 else 0.0) - damping * v0 - square * (y0 + h * v0 * NODES[0])
        f2 = (1.0 if case == 3 else 0.0) - damping * v0 - square * (y0 + h * v0 * NODES[1])
        f3 = (1.0 if case == 4 else 0.0) - damping * v0 - square * (y0 + h * v0 * NODES[2])
        g1 = (c11 * f1 + c12 * f2 + c13 * f3) * inverse
        g2 = (c21 * f1 + c22 * f2 + c23 * f3) * inverse
        g3 = (c31 * f1 + c32 * f2 + c33 * f3) * inverse
        row = COLUMNS * case
        for s in range(STAGES):
            moved = B[s][0] * g1 + B[s][1] * g2 + B[s][2] * g3
            coefficients[row + s] = y0 + h * (v0 * NODES[s] + h * moved)
            coefficients[row + LANES + s] = v0 + h * (A[s][0] * g1 + A[s][1] * g2 + A[s][2] * g3)


@kernel(inlined=False)
def fill_answer(frequency, damping_rate, exact, h, answer):
    """Compute a mode's motion in a step `h` [s] for five causes: unit start value, start rate, and load at each stage.

    `answer.coefficient` (40,) takes eight numbers for each cause in turn: the values at the three stages, the third one
    repeated, then the rates alike. The motion is exact if `frequency` [rad/s] times h is below 2. With a damping ratio
    above 0.02, it is exact if the product is below the limit `exact`. Otherwise, or if `damping_rate` [1/s] is 1 / h or
    more, the Radau method gives it. `answer.defect` (4,) then takes errors of an underdamped mode's free motion at the
    step's end: of the rate by start value and by start rate, and of the value alike, multiplied by `frequency`.
    """
    coefficients, phase = answer.coefficient, frequency * h
    for c in range(2 * DEFECTS):
        answer.defect[c] = 0.0
    short, underdamped = 2.0 * damping_rate * h < RESOLVED, frequency > damping_rate
    if short and (phase < RESOLVED or (underdamped and phase < exact and damping_rate > _DAMPED * frequency)):
        if phase < _SERIES:
            exact_coefficients(frequency, damping_rate, h, answer)
        else:
            closed_coefficients(frequency, damping_rate, h, coefficients)
    else:
        rational_coefficients(frequency, damping_rate, h, coefficients)
        if underdamped:
            damped = math.sqrt(frequency * frequency - damping_rate * damping_rate)
            decay = math.exp(-damping_rate * h)
            sine, cosine = decay * math.sin(damped * h) / damped, decay * math.cos(damped * h)
            answer.defect[0] = -frequency * frequency * sine - coefficients[FROM_VALUE + END_RATE]
            answer.defect[1] = cosine - damping_rate * sine - coefficients[FROM_RATE + END_RATE]
            answer.defect[2] = frequency * (cosine + damping_rate * sine - coefficients[FROM_VALUE + END_VALUE])
            answer.defect[3] = frequency * (sine - coefficients[FROM_RATE + END_VALUE])
    for column in range(STAGES, COEFFICIENTS, LANES):
        coefficients[column] = coefficients[column - 1]


@kernel
def values_of(group):
    """Return the number of values of an end's motion in a mode `group`: 2 in bending (deflection, slope), 1 axially."""
    return 2 if group < AXIAL_EVEN else 1


@kernel
def side(end):
    """Return the sign of antisymmetric motion at a panel's `end`: 1 at the first end (0), -1 at the second end (1)."""
    return 1.0 - 2.0 * end


@kernel
def add_mode(shapes, frequency, answer, group, k, responses):
    """Add mode `k` to the motion of a panel's first end per unit load there, in the record `responses`.

    `group` is the mode's kind: even or odd, bending or axial. `shapes[:, k]` are its end values, deflection and slope
    or axial displacement. `answer` has the mode's motion in a step per unit modal load. Times `shapes[i, k]` and
    `shapes[j, k]`, this motion is added to `responses.response[group, i, j]` (24,), end value i due to load j.

    `answer` also has the errors that the step makes in the mode's free vibration; they are 0 if the step resolves the
    vibration. `responses.unresolved` counts the modes with errors. The static deflection under a constant load, load /
    `frequency`^2, does not vibrate: its share of the errors is subtracted in `responses.held[:, group, j]`, per unit
    load j.
    """
    for i in range(values_of(group)):
        for j in range(values_of(group)):
            product, row = shapes[i, k] * shapes[j, k], responses.response[group, i, j]
            for stage in range(STAGES):
                moved = load8(answer.coefficient, FROM_LOAD + COLUMNS * stage)
                store8(row, COLUMNS * stage, load8(row, COLUMNS * stage) + product * moved)
        for kind in range(DEFECTS):
            held = answer.defect[2 * kind] * shapes[0, k] / (frequency * frequency)
            responses.held[kind, group, i] -= held * shapes[i, k]
    responses.unresolved += answer.defect[0] != 0.0


@kernel
def join_groups(responses):
    """Compute a panel's motion at both ends from its even and odd modes, and write it to `responses.ends`.

    A unit load acts on the first end. There the motions of even and odd modes in `responses.response` are added; at
    the second end, by symmetry, they are subtracted. The axes of `ends` (2, 4, 24) are: the end; the kind of response,
    displacement along or across the panel, slope due to a force, or slope due to a moment; and for a load at each of
    the three stages in turn, four values and four rates at the stages (the last one twice).
    """
    for product, group, i, j in (
        (ALONG_ALONG, AXIAL_EVEN, 0, 0),
        (ACROSS_ACROSS, BENDING_EVEN, 0, 0),
        (ACROSS_TURNING, BENDING_EVEN, 0, 1),
        (TURNING_TURNING, BENDING_EVEN, 1, 1),
    ):
        even, odd = responses.response[group, i, j], responses.response[group + 1, i, j]
        # The slopes of even modes are opposite at the ends.
        sign = -1.0 if product == TURNING_TURNING else 1.0
        for c in range(BY_LOAD):
            responses.ends[0, product, c] = even[c] + odd[c]
            responses.ends[1, product, c] = sign * (even[c] - odd[c])


@kernel
def keep_answer(tables, d, level, k, answer):
    """Copy mode `k`'s motion in a time step to `tables`, at the indices `d` of panel design and `level` of step size.

    `answer` is the record of the motion, filled by `fill_answer`. `tables.free` gets the motion at the three stages,
    and its errors, per unit start value and rate. `tables.ends` gets the end's motion, also per unit load at a stage.
    """
    coefficients = answer.coefficient
    for c in range(2 * COLUMNS):
        tables.free[d, level, k, c] = coefficients[c]
    for case in range(2 + STAGES):
        tables.ends[d, level, case, k] = coefficients[COLUMNS * case + END_VALUE]
        tables.ends[d, level, 2 + STAGES + case, k] = coefficients[COLUMNS * case + END_RATE]
    for kind in range(DEFECTS):
        for case in range(2):
            tables.free[d, level, k, COLUMNS * case + DEFECT_LANES[kind]] = answer.defect[2 * kind + case]


@kernel(inlined=False)
def fill_level(panels, tables, level, h):
    """Compute the motion of all panel designs in a step of the size `h` [s].

    Write it to `tables` at this size's index, `level`, per unit start value, start rate, and load at each stage.
    """
    answer = tables.answers[0]
    for d in range(panels.damping.size):
        responses = tables.responses[d, level]
        responses.unresolved = 0
        for group in range(GROUPS):
            for i in range(VALUES):
                for kind in range(DEFECTS):
                    responses.held[kind, group, i] = 0.0
                for j in range(VALUES):
                    for c in range(BY_LOAD):
                        responses.response[group, i, j, c] = 0.0
            for k in range(panels.first[group], panels.first[group + 1]):
                frequency, r = panels.frequency[d, k], k - panels.first[group]
                fill_answer(frequency, 0.5 * panels.damping[d] * frequency * frequency, panels.exact, h, answer)
                keep_answer(tables, d, level, k, answer)
                if r < panels.coupled[group]:
                    for c in range(BY_LOAD):
                        tables.forced[d, level, group, r, c] = answer.coefficient[FROM_LOAD + c]
                add_mode(panels.shapes[d], frequency, answer, group, k, responses)
        join_groups(responses)


@kernel
def level_size(level):
    """Return the step size [s] of a level, an index of the tabled step sizes."""
    return _SIZES[level]


@kernel
def level_below(h):
    """Return the level of the greatest tabled step size that does not exceed `h` [s]; LEVELS if all exceed it."""
    level = 0
    while level < LEVELS and _SIZES[level] > h * (1.0 + 1e-12):
        level += 1
    return level


def filled_tables(panels: Panels) -> Tables:
    """Return tables of panels' motion due to start values and loads, filled for all tabled time-step sizes."""
    tables = make_tables(panels, LEVELS)
    for level in range(LEVELS):
        fill_level(panels, tables, level, level_size(level))
    return tables
