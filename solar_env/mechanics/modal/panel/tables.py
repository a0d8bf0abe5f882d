"""Constants of the designs of panels, and how their modes answer a step: tables over step sizes.

A mode is even or odd about the panel's middle: both ends deflect alike, or oppositely. So the modes form four groups,
each of which sees the sum or the difference of the loads at the two ends, and one end's values tell the other's.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import record
from solar_env.mechanics.modal.panel.oscillators import (
    COEFFICIENTS,
    FROM_LOAD,
    free_rate_defects,
    mode_coefficients,
)
from solar_env.mechanics.numerics.jit import kernel

Array = NDArray[np.float64]

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
        ("coefficient", np.float64, COEFFICIENTS),  # see `oscillators`
        ("defect", np.float64, 2),  # of the rate at the end by start value and by start rate
    ]
)

# How the ends answer the groups' loads in a step of one size.
response_type = record(
    [
        # Of value i by load j of a group: [4 load stage + 2 stage + (value or rate)].
        ("response", np.float64, (GROUPS, VALUES, VALUES, 8)),
        # The same of the two bending groups, without the modes that foreshortening couples.
        ("rest", np.float64, (2, VALUES, VALUES, 8)),
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
        # By a unit of the ends' axial load, alike and opposite, through a bent axis: motion of the ends in bending, and
        # foreshortening, of the ends alike and opposite. Columns as those of a response.
        ("bent", np.float64, (2, 2, VALUES, 8)),
        ("shortened", np.float64, (2, 2, 8)),
    ]
)


class Panels(NamedTuple):
    """Constants of D designs of panels, each with the same number of modes."""

    first: NDArray[np.int64]  # (GROUPS + 1,) first mode of each group
    kept: NDArray[np.int64]  # (GROUPS,) number of modes that are kept; behind them come the pseudo-modes
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


@kernel(inlined=True)
def values_of(group):
    """Number of end values of a group."""
    return 2 if group < AXIAL_EVEN else 1


@kernel(inlined=True)
def side(end):
    """Sign of what is odd at an end: as at the first one, or opposite."""
    return 1.0 - 2.0 * end


@kernel(inner=True)
def add_mode(mode, answer, group, coupled, own):
    """Add what a mode of a group, one that is `coupled` or not, does to the responses of a step size."""
    held = answer.defect[0] * mode.row[0] / (mode.frequency * mode.frequency)
    for i in range(values_of(group)):
        for j in range(values_of(group)):
            product = mode.row[i] * mode.row[j]
            for c in range(8):
                response = product * answer.coefficient[FROM_LOAD + c]
                own.response[group, i, j, c] += response
                if group < AXIAL_EVEN and not coupled:
                    own.rest[group, i, j, c] += response
        own.held[group, i] -= held * mode.row[i]


@kernel
def fill_level(panels, tables, level, h, coefficients):
    """Fill one level of the tables of every design for the step size `h` [s]; `coefficients` is scratch."""
    for d in range(panels.damping.size):
        own = tables.responses[d, level]
        for group in range(GROUPS):
            for i in range(VALUES):
                own.held[group, i] = 0.0
                for j in range(VALUES):
                    for c in range(8):
                        own.response[group, i, j, c] = 0.0
                        if group < AXIAL_EVEN:
                            own.rest[group, i, j, c] = 0.0
            for k in range(panels.first[group], panels.first[group + 1]):
                mode, answer = panels.modes[d, k], tables.answers[d, level, k]
                rate = 0.5 * panels.damping[d] * mode.frequency * mode.frequency
                mode_coefficients(mode.frequency, rate, h, coefficients)
                by_value, by_rate = free_rate_defects(mode.frequency, rate, h, coefficients)
                answer.defect[0], answer.defect[1] = by_value, by_rate
                for c in range(COEFFICIENTS):
                    answer.coefficient[c] = coefficients[c]
                add_mode(mode, answer, group, k < panels.first[group] + panels.coupled[group], own)


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
        fill_level(panels, tables, level, level_size(level), np.zeros(COEFFICIENTS))
    return tables
