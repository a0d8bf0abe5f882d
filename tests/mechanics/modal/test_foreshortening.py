"""Shortening of a bent panel against a fine integration of its slopes."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from solar_env.mechanics.bodies.beam_modes import wave_number
from solar_env.mechanics.modal.panel.foreshortening import quadratic_forms, slopes

LENGTH, MASS, BENDING, AXIAL = 1.5, 6.0, 6, 3


def test_slopes_are_those_of_the_modes_in_extended_precision() -> None:
    x = np.linspace(0.0, LENGTH, 7)
    found = slopes(LENGTH, MASS, BENDING, x)
    with mpmath.workdps(40):
        for k in range(BENDING):
            wave = wave_number(k + 1)
            c, s, ch, sh = mpmath.cos(wave), mpmath.sin(wave), mpmath.cosh(wave), mpmath.sinh(wave)
            sigma = (ch - c) / (sh - s)
            for i, place in enumerate(x):
                z = wave * mpmath.mpf(place) / LENGTH
                slope = mpmath.sinh(z) - mpmath.sin(z) - sigma * (mpmath.cosh(z) + mpmath.cos(z))
                assert found[k, i] == pytest.approx(
                    float(wave / LENGTH * slope) / math.sqrt(MASS), rel=1e-11, abs=1e-11
                )


def test_projections_and_the_rest_at_the_ends_add_up_to_the_shortening() -> None:
    amplitudes = np.random.default_rng(1).normal(size=BENDING) * 0.01
    project, ends = quadratic_forms(LENGTH, MASS, BENDING, AXIAL)
    x = np.linspace(0.0, LENGTH, 200001)
    rate = -0.5 * (amplitudes @ slopes(LENGTH, MASS, BENDING, x)) ** 2
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
