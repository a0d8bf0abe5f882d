"""How the modes of a panel answer a step of the two-stage Radau IIA method: one mode, and tables over step sizes.

y'' + 2 delta y' + omega^2 y = f. The stages are at a third of the step and at its end (E. Hairer and G. Wanner, Solving
Ordinary Differential Equations II, 2nd ed., Springer 1996, section IV.5, doi:10.1007/978-3-642-05221-7). A mode that
the step resolves answers the load's collocation polynomial exactly. The others answer as the method makes them, which
dampens what it cannot follow; exact values there, at arbitrary phases, would be unstable with ideal joints.

A mode is even or odd about the panel's middle: both ends deflect alike, or oppositely. So the modes form four groups,
each of which sees the sum or the difference of the loads at the two ends, and one end's values tell the other's.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import record
from solar_env.mechanics.numerics.jit import kernel

Array = NDArray[np.float64]

# Stage s, load k: velocities gain h A[s][k] f_k, positions h^2 B[s][k] f_k, with B = A A.
A = ((5.0 / 12.0, -1.0 / 12.0), (3.0 / 4.0, 1.0 / 4.0))
B = ((1.0 / 9.0, -1.0 / 18.0), (1.0 / 2.0, 0.0))
NODES = (1.0 / 3.0, 1.0)
# Weights of the stages in an integral over the step.
WEIGHT_A, WEIGHT_B = 0.75, 0.25

# Rows of the coefficients of a mode: from its start value, from its start rate, and from the loads of the two stages.
FROM_VALUE, FROM_RATE, FROM_LOAD = 0, 4, 8
# Each has four: value and rate at the first stage, then at the second.
COEFFICIENTS = 16
# A step resolves a mode whose omega h is below this.
RESOLVED = 2.0
_TERMS = 26
_NEGLIGIBLE = 1e-20  # part of what a term is added to

# Tabled step sizes: the greatest [s], and their number; each is the one before over the square root of two.
GREATEST_STEP = 0.032
LEVELS = 50

# Groups of modes. Values of an end: deflection and slope in bending, axial displacement (and nothing) in stretching.
BENDING_EVEN, BENDING_ODD, AXIAL_EVEN, AXIAL_ODD = range(4)
GROUPS = 4
VALUES = 2
# Most coordinates of a group that foreshortening couples: modes and, in bending, what the others add to the end values.
LOW = 4
# Quadratic forms of foreshortening: projections on the coupled axial modes, odd and even ones, and the rest that the
# ends feel, opposite and alike.
ODD_FIRST, ODD_SECOND, ODD_ENDS, EVEN_FIRST, EVEN_ENDS = range(5)
FORMS = 5

mode_type = record(
    [
        ("frequency", np.float64),  # [rad/s]
        ("row", np.float64, VALUES),  # values of the first end by unit amplitude, see `beam_modes`
    ]
)

# How a mode answers a step of one size.
answer_type = record(
    [
        ("coefficient", np.float64, COEFFICIENTS),  # see COEFFICIENTS
        ("defect", np.float64, 2),  # of the rate at the end by start value and by start rate
    ]
)

# How the ends answer the groups' loads in a step of one size.
response_type = record(
    [
        # Of value i by load j of a group: [4 load stage + 2 stage + (value or rate)].
        ("response", np.float64, (GROUPS, VALUES, VALUES, 8)),
        # Defect of the rate of the first value by load j at the start: what the load holds in place does not vibrate.
        ("held", np.float64, (GROUPS, VALUES)),
    ]
)

# Scratch of a panel in a step. Columns of four: value and rate at the first stage, then at the second.
panel_scratch = record(
    [
        ("load", np.float64, (2, GROUPS, VALUES)),  # of the ends, by stage: transverse force and moment, or axial force
        # Forces of foreshortening by stage: on the coupled modes, and on the rest of the end values, whose forces load
        # all modes, the coupled ones too, where the former take them back.
        ("coupling", np.float64, (2, GROUPS, LOW)),
        # Rates of the coupled axial amplitudes less those of foreshortening, by stage.
        ("strain_rate", np.float64, (2, GROUPS, LOW)),
        ("free", np.float64, (GROUPS, VALUES, 4)),  # free motion of the ends
        ("defect", np.float64, GROUPS),  # of the first value's rate at the end of the step
        ("ends", np.float64, (GROUPS, VALUES, 4)),  # motion of the ends
        ("low_free", np.float64, (GROUPS, LOW, 4)),  # free motion of the modes that foreshortening couples
        ("low", np.float64, (GROUPS, LOW, 4)),  # motion of the coupled coordinates
        ("gradient", np.float64, (2, 2, LOW, FORMS)),  # of the forms by those of bending, by stage
        ("shortening", np.float64, (2, 2, FORMS)),  # values of the forms and their rates, by stage
        ("tension", np.float64, FORMS),  # that works on the forms
    ]
)


class Panels(NamedTuple):
    """Constants of D designs of panels, each with the same number of modes."""

    first: NDArray[np.int64]  # (GROUPS + 1,) first mode of each group
    kept: NDArray[np.int64]  # (2,) number of bending modes that are kept; behind them come the pseudo-modes
    coupled: NDArray[np.int64]  # (GROUPS,) number of lowest modes that foreshortening couples
    damping: Array  # (D,) retardation time [s]
    modes: NDArray[np.void]  # (D, modes) rows of `mode_type`
    # (D, 2, LOW, LOW, FORMS) by coordinate of a bending group and of its partner: the same group for the odd forms, the
    # other one for the even forms.
    forms: Array

    @property
    def frequency(self) -> Array:
        """(D, modes) natural frequencies [rad/s]."""
        return np.asarray(self.modes["frequency"])

    @property
    def rows(self) -> Array:
        """(D, modes, VALUES) values of the first end by unit amplitude."""
        return np.asarray(self.modes["row"])


class Tables(NamedTuple):
    """Answers of the modes and of the groups' ends to a step, by design and step size (levels)."""

    answers: NDArray[np.void]  # (D, levels, modes) rows of `answer_type`
    responses: NDArray[np.void]  # (D, levels) rows of `response_type`


def make_tables(panels: Panels, levels: int) -> Tables:
    """Allocate tables."""
    designs, modes = panels.modes.shape
    return Tables(np.zeros((designs, levels, modes), answer_type), np.zeros((designs, levels), response_type))


@kernel(inner=True)
def exact_coefficients(frequency, damping_rate, h, coefficients):
    """Fill (COEFFICIENTS,) for a mode that the step resolves: by its Taylor series, whose terms fall as 1/n!."""
    square, damping = (frequency * h) ** 2, 2.0 * damping_rate * h
    for case in range(4):
        # Start value, start rate, then the loads 1.5 - 1.5 t and -0.5 + 1.5 t, which are one at their stages.
        c = 1.0 if case == 0 else 0.0
        following = h if case == 1 else 0.0
        load0, load1 = 0.0, 0.0
        if case == 2:
            load0, load1 = 1.5 * h * h, -1.5 * h * h
        elif case == 3:
            load0, load1 = -0.5 * h * h, 1.5 * h * h
        y1, r1, y2, r2 = c, following, c, following
        third = 1.0
        scale = 1.0 if case == 0 else (h if case == 1 else h * h)
        for n in range(_TERMS):
            load = load0 if n == 0 else (load1 if n == 1 else 0.0)
            # First the term in t^(n + 1), whose coefficient is known; then the coefficient of t^(n + 2).
            y2 += following
            y1 += following * third / 3.0
            third /= 3.0
            c, following = following, (load - damping * (n + 1) * following - square * c) / ((n + 2) * (n + 1))
            r2 += (n + 2) * following
            r1 += (n + 2) * following * third
            if n > 1 and abs(c) + abs(following) < _NEGLIGIBLE * scale:
                break
        coefficients[4 * case] = y1
        coefficients[4 * case + 1] = r1 / h
        coefficients[4 * case + 2] = y2
        coefficients[4 * case + 3] = r2 / h


@kernel(inner=True)
def rational_coefficients(frequency, damping_rate, h, coefficients):
    """Fill (COEFFICIENTS,) as the Radau IIA method answers."""
    square, damping = frequency * frequency, 2.0 * damping_rate
    m11 = 1.0 + h * (damping * A[0][0] + square * h * B[0][0])
    m12 = h * (damping * A[0][1] + square * h * B[0][1])
    m21 = h * (damping * A[1][0] + square * h * B[1][0])
    m22 = 1.0 + h * (damping * A[1][1] + square * h * B[1][1])
    inverse = 1.0 / (m11 * m22 - m12 * m21)
    for case in range(4):
        y0 = 1.0 if case == 0 else 0.0
        v0 = 1.0 if case == 1 else 0.0
        f1 = 1.0 if case == 2 else 0.0
        f2 = 1.0 if case == 3 else 0.0
        f1 -= damping * v0 + square * (y0 + h * v0 * NODES[0])
        f2 -= damping * v0 + square * (y0 + h * v0)
        a1 = (m22 * f1 - m12 * f2) * inverse
        a2 = (m11 * f2 - m21 * f1) * inverse
        coefficients[4 * case] = y0 + h * (v0 * NODES[0] + h * (B[0][0] * a1 + B[0][1] * a2))
        coefficients[4 * case + 1] = v0 + h * (A[0][0] * a1 + A[0][1] * a2)
        coefficients[4 * case + 2] = y0 + h * (v0 + h * (B[1][0] * a1 + B[1][1] * a2))
        coefficients[4 * case + 3] = v0 + h * (A[1][0] * a1 + A[1][1] * a2)


@kernel
def fill_answer(frequency, damping_rate, h, answer):
    """Fill an `answer_type` of a mode for a step `h` [s]."""
    coefficients = answer.coefficient
    answer.defect[0], answer.defect[1] = 0.0, 0.0
    if frequency * h < RESOLVED and 2.0 * damping_rate * h < RESOLVED:
        exact_coefficients(frequency, damping_rate, h, coefficients)
        return
    rational_coefficients(frequency, damping_rate, h, coefficients)
    underdamped = frequency * frequency - damping_rate * damping_rate
    if underdamped > 0.0:
        damped = math.sqrt(underdamped)
        decay = math.exp(-damping_rate * h)
        sine, cosine = decay * math.sin(damped * h) / damped, decay * math.cos(damped * h)
        answer.defect[0] = -frequency * frequency * sine - coefficients[FROM_VALUE + 3]
        answer.defect[1] = cosine - damping_rate * sine - coefficients[FROM_RATE + 3]


@kernel(inlined=True)
def values_of(group):
    """Number of end values of a group."""
    return 2 if group < AXIAL_EVEN else 1


@kernel(inlined=True)
def side(end):
    """Sign of what is odd at an end: as at the first one, or opposite."""
    return 1.0 - 2.0 * end


@kernel(inner=True)
def add_mode(mode, answer, group, own):
    """Add what a mode of a group does to the responses of a step size."""
    held = answer.defect[0] * mode.row[0] / (mode.frequency * mode.frequency)
    for i in range(values_of(group)):
        for j in range(values_of(group)):
            product = mode.row[i] * mode.row[j]
            for c in range(8):
                own.response[group, i, j, c] += product * answer.coefficient[FROM_LOAD + c]
        own.held[group, i] -= held * mode.row[i]


@kernel
def fill_level(panels, tables, level, h):
    """Fill one level of the tables of every design for the step size `h` [s]."""
    for d in range(panels.damping.size):
        of_level = tables.responses[d, level]
        for group in range(GROUPS):
            for i in range(VALUES):
                of_level.held[group, i] = 0.0
                for j in range(VALUES):
                    for c in range(8):
                        of_level.response[group, i, j, c] = 0.0
            for k in range(panels.first[group], panels.first[group + 1]):
                mode, answer = panels.modes[d, k], tables.answers[d, level, k]
                rate = 0.5 * panels.damping[d] * mode.frequency * mode.frequency
                fill_answer(mode.frequency, rate, h, answer)
                add_mode(mode, answer, group, of_level)


@kernel(inlined=True)
def level_size(level):
    """Step size [s] of a level."""
    return GREATEST_STEP * 2.0 ** (-0.5 * level)


@kernel(inner=True)
def level_below(h):
    """Level of the greatest tabled step size that does not exceed `h` [s]; LEVELS if there is none."""
    level = 0
    while level < LEVELS and level_size(level) > h * (1.0 + 1e-12):
        level += 1
    return level


def filled_tables(panels: Panels) -> Tables:
    """Tables for all tabled step sizes."""
    tables = make_tables(panels, LEVELS)
    for level in range(LEVELS):
        fill_level(panels, tables, level, level_size(level))
    return tables
