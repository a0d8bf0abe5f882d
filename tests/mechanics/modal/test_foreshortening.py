"""Shortening of a bent panel against a fine integration of its slopes."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from solar_env.mechanics.bodies.beam_modes import bending_modes
from solar_env.mechanics.modal.foreshortening import bending_shapes, quadratic_forms, rest_slopes

LENGTH, MASS, BENDING, AXIAL = 1.5, 6.0, 6, 3


def test_deflections_and_slopes_are_those_of_the_modes_in_extended_precision() -> None:
    x = np.linspace(0.0, LENGTH, 7)
    found = bending_shapes(LENGTH, MASS, BENDING, x)
    with mpmath.workdps(40):
        for k in range(BENDING):
            wave = mpmath.findroot(lambda z: mpmath.cos(z) - 1 / mpmath.cosh(z), (k + 1.5) * mpmath.pi)
            c, s, ch, sh = mpmath.cos(wave), mpmath.sin(wave), mpmath.cosh(wave), mpmath.sinh(wave)
            sigma = (ch - c) / (sh - s)
            for i, place in enumerate(x):
                z, unit = wave * mpmath.mpf(place) / LENGTH, 1 / mpmath.sqrt(MASS)
                deflection = mpmath.cosh(z) + mpmath.cos(z) - sigma * (mpmath.sinh(z) + mpmath.sin(z))
                slope = mpmath.sinh(z) - mpmath.sin(z) - sigma * (mpmath.cosh(z) + mpmath.cos(z))
                expected = float(unit * deflection), float(unit * wave / LENGTH * slope)
                assert found[:, k, i] == pytest.approx(expected, rel=1e-11, abs=1e-11)


def test_the_rest_of_the_end_values_bends_the_panel_as_all_higher_modes_do_under_loads_at_an_end() -> None:
    kept, many, x = 4, 200, np.linspace(0.1, 0.9, 5)
    rest = bending_modes(1.0, 1.0, 1.0, kept, blocks=2)
    series = bending_modes(1.0, 1.0, 1.0, many, blocks=0)
    shapes, higher = rest_slopes(1.0, kept, x), bending_shapes(1.0, 1.0, many, x)[1]
    for group in range(2):
        # Pseudo-modes know the exact end values: four of each symmetry.
        own = slice(kept + 4 * group, kept + 4 * group + 4)
        values = rest.rows[:2, own] / rest.frequencies[own] ** 2 @ rest.rows[:2, own].T
        modes = np.arange(kept + group, many, 2)
        expected = series.rows[:2, modes] / series.frequencies[modes] ** 2 @ higher[modes]
        assert values @ shapes[2 * group : 2 * group + 2] == pytest.approx(expected, abs=2e-5)


def test_projections_and_the_rest_at_the_ends_add_up_to_the_shortening() -> None:
    amplitudes = np.random.default_rng(1).normal(size=BENDING + 4) * 0.01
    project, ends = quadratic_forms(LENGTH, MASS, BENDING, AXIAL)
    x = np.linspace(0.0, LENGTH, 200001)
    slope = np.concatenate([bending_shapes(LENGTH, MASS, BENDING, x)[1], rest_slopes(LENGTH, BENDING, x)])
    rate = -0.5 * (amplitudes @ slope) ** 2
    step = x[1] - x[0]
    shortening = np.concatenate([[0.0], np.cumsum(0.5 * step * (rate[1:] + rate[:-1]))])
    shortening -= np.trapezoid(shortening, x) / LENGTH
    total = {0: 0.0, 1: 0.0}
    for k in range(AXIAL):
        shape = math.sqrt(2.0 / MASS) * np.cos((k + 1) * math.pi * x / LENGTH)
        projection = MASS / LENGTH * np.trapezoid(shape * shortening, x)
        assert 0.5 * amplitudes @ project[k] @ amplitudes == pytest.approx(projection, rel=1e-6)
        for end in (0, 1):
            total[end] += shape[-end] * projection
    for end in (0, 1):
        rest = 0.5 * amplitudes @ ends[end] @ amplitudes
        assert total[end] + rest == pytest.approx(shortening[-end], rel=1e-6)
