"""Constants of the designs of panels, and how their ends answer loads: tables over step sizes."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.modal.oscillators import (
    COEFFICIENTS,
    FROM_LOAD,
    FROM_RATE,
    free_rate_defects,
    mode_coefficients,
)
from solar_env.mechanics.numerics.jit import kernel

Array = NDArray[np.float64]

# Tabled step sizes: the greatest [s], and their number; each is the one before over the square root of two.
GREATEST_STEP = 0.032
LEVELS = 50


# Quadratic forms of foreshortening, side by side: axial projections from the first on, the two ends from the last two.
FORMS = 8


class Panels(NamedTuple):
    """Constants of D designs of panels, each with the same number of modes."""

    bending_frequency: Array  # (D, modes) [rad/s]
    axial_frequency: Array  # (D, axial modes)
    damping: Array  # (D,) retardation time [s]
    bending_rows: Array  # (D, 4, modes) end values by unit amplitude, see `beam_modes`
    axial_rows: Array  # (D, 2, axial modes)
    project: Array  # (D, coupled axial, coupled, coupled) K, see `foreshortening`
    ends: Array  # (D, 2, coupled, coupled) S
    forms: Array  # (D, coupled, coupled, FORMS) both side by side


class Tables(NamedTuple):
    """Answers of the modes and of the ends to a step, by design and step size (levels)."""

    bending: Array  # (D, levels, COEFFICIENTS, modes)
    axial: Array  # (D, levels, COEFFICIENTS, axial modes)
    # Free motion of the ends: rows value and rate of an amplitude; columns [4 end value + 2 stage + (value or rate)],
    # then the defects of the rates.
    bending_free: Array  # (D, levels, modes, 2, 20)
    axial_free: Array  # (D, levels, axial modes, 2, 10)
    # Of end value i by load j: [4 load stage + 2 stage + (value or rate)].
    bending_response: Array  # (D, levels, 4, 4, 8)
    axial_response: Array  # (D, levels, 2, 2, 8)
    # Defect of the rate of end value i by load j at the start: what the load holds in place does not vibrate.
    bending_held: Array  # (D, levels, 4, 4)
    axial_held: Array  # (D, levels, 2, 2)


def make_tables(panels: Panels, levels: int) -> Tables:
    """Allocate tables."""
    designs, modes = panels.bending_frequency.shape
    axial = panels.axial_frequency.shape[1]
    return Tables(
        np.zeros((designs, levels, COEFFICIENTS, modes)),
        np.zeros((designs, levels, COEFFICIENTS, axial)),
        np.zeros((designs, levels, modes, 2, 20)),
        np.zeros((designs, levels, axial, 2, 10)),
        np.zeros((designs, levels, 4, 4, 8)),
        np.zeros((designs, levels, 2, 2, 8)),
        np.zeros((designs, levels, 4, 4)),
        np.zeros((designs, levels, 2, 2)),
    )


@kernel(inner=True)
def fill_family(frequencies, damping, rows, h, answers, free, response, held, coefficients):
    """Fill the tables of one family of modes, bending or axial, for one step size `h` [s]."""
    ends, modes = rows.shape
    for i in range(ends):
        for j in range(ends):
            held[i, j] = 0.0
            for c in range(8):
                response[i, j, c] = 0.0
    for k in range(modes):
        frequency = frequencies[k]
        rate = 0.5 * damping * frequency * frequency
        mode_coefficients(frequency, rate, h, coefficients)
        by_value, by_rate = free_rate_defects(frequency, rate, h, coefficients)
        for c in range(COEFFICIENTS):
            answers[c, k] = coefficients[c]
        for i in range(ends):
            row = rows[i, k]
            for c in range(4):
                free[k, 0, 4 * i + c] = row * coefficients[c]
                free[k, 1, 4 * i + c] = row * coefficients[FROM_RATE + c]
            free[k, 0, 4 * ends + i] = row * by_value
            free[k, 1, 4 * ends + i] = row * by_rate
            for j in range(ends):
                product = row * rows[j, k]
                held[i, j] -= product * by_value / (frequency * frequency)
                for c in range(8):
                    response[i, j, c] += product * coefficients[FROM_LOAD + c]


@kernel
def fill_level(panels, tables, level, h, coefficients):
    """Fill one level of the tables of every design for the step size `h` [s]."""
    for d in range(panels.damping.size):
        fill_family(
            panels.bending_frequency[d],
            panels.damping[d],
            panels.bending_rows[d],
            h,
            tables.bending[d, level],
            tables.bending_free[d, level],
            tables.bending_response[d, level],
            tables.bending_held[d, level],
            coefficients,
        )
        fill_family(
            panels.axial_frequency[d],
            panels.damping[d],
            panels.axial_rows[d],
            h,
            tables.axial[d, level],
            tables.axial_free[d, level],
            tables.axial_response[d, level],
            tables.axial_held[d, level],
            coefficients,
        )


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
