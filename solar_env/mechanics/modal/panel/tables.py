"""Constants of the designs of panels, and how their modes answer a step: tables over step sizes.

A mode is even or odd about the panel's middle: both ends deflect alike, or oppositely. So the modes form four groups,
each of which sees the sum or the difference of the loads at the two ends, and one end's values tell the other's.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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
# Most modes of a bending group that foreshortening couples, and most of an axial group.
LOW, LOW_AXIAL = 3, 2
# Quadratic forms of foreshortening: projections on the coupled axial modes, odd and even ones, and the rest that the
# ends feel, opposite and alike.
ODD_FIRST, ODD_SECOND, ODD_ENDS, EVEN_FIRST, EVEN_ENDS = range(5)
FORMS = 5


class Panels(NamedTuple):
    """Constants of D designs of panels, each with the same number of modes."""

    first: NDArray[np.int64]  # (GROUPS + 1,) first mode of each group
    coupled: NDArray[np.int64]  # (GROUPS,) number of lowest modes that foreshortening couples
    frequency: Array  # (D, modes) [rad/s]
    damping: Array  # (D,) retardation time [s]
    rows: Array  # (D, modes, VALUES) values of the first end by unit amplitude, see `beam_modes`
    # (D, 2, LOW, LOW, FORMS) by mode of a bending group and by mode of its partner: the same group for the odd forms,
    # the other one for the even forms.
    forms: Array


class Tables(NamedTuple):
    """Answers of the modes and of the groups' ends to a step, by design and step size (levels)."""

    answers: Array  # (D, levels, modes, COEFFICIENTS)
    defects: Array  # (D, levels, modes, 2) of the rate at the end by start value and by start rate
    # Of value i by load j of a group: [4 load stage + 2 stage + (value or rate)].
    response: Array  # (D, levels, GROUPS, VALUES, VALUES, 8)
    # Defect of the rate of the first value by load j at the start: what the load holds in place does not vibrate.
    held: Array  # (D, levels, GROUPS, VALUES)


def make_tables(panels: Panels, levels: int) -> Tables:
    """Allocate tables."""
    designs, modes = panels.frequency.shape
    return Tables(
        np.zeros((designs, levels, modes, COEFFICIENTS)),
        np.zeros((designs, levels, modes, 2)),
        np.zeros((designs, levels, GROUPS, VALUES, VALUES, 8)),
        np.zeros((designs, levels, GROUPS, VALUES)),
    )


@kernel(inlined=True)
def values_of(group):
    """Number of end values of a group."""
    return 2 if group < AXIAL_EVEN else 1


@kernel(inlined=True)
def side(end):
    """Sign of what is odd at an end: as at the first one, or opposite."""
    return 1.0 - 2.0 * end


@kernel(inner=True)
def add_mode(panels, tables, d, level, group, k):
    """Add what mode `k` does to the responses of its group."""
    square = panels.frequency[d, k] ** 2
    held = tables.defects[d, level, k, 0] * panels.rows[d, k, 0] / square
    for i in range(values_of(group)):
        for j in range(values_of(group)):
            product = panels.rows[d, k, i] * panels.rows[d, k, j]
            for c in range(8):
                tables.response[d, level, group, i, j, c] += product * tables.answers[d, level, k, FROM_LOAD + c]
        tables.held[d, level, group, i] -= held * panels.rows[d, k, i]


@kernel
def fill_level(panels, tables, level, h, coefficients):
    """Fill one level of the tables of every design for the step size `h` [s]; `coefficients` is scratch."""
    for d in range(panels.damping.size):
        tables.response[d, level] = 0.0
        tables.held[d, level] = 0.0
        for group in range(GROUPS):
            for k in range(panels.first[group], panels.first[group + 1]):
                frequency = panels.frequency[d, k]
                rate = 0.5 * panels.damping[d] * frequency * frequency
                mode_coefficients(frequency, rate, h, coefficients)
                by_value, by_rate = free_rate_defects(frequency, rate, h, coefficients)
                tables.defects[d, level, k, 0], tables.defects[d, level, k, 1] = by_value, by_rate
                for c in range(COEFFICIENTS):
                    tables.answers[d, level, k, c] = coefficients[c]
                add_mode(panels, tables, d, level, group, k)


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
