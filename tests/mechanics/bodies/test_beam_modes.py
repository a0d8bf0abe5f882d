"""Modes of a free beam against roots in extended precision and against the closed-form flexibility of its ends."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

from solar_env.mechanics.bodies.beam_modes import EndModes, axial_modes, bending_modes

LENGTH, MASS, AXIAL, BENDING = 1.5, 6.0, 5.6e6, 186.7
KEPT = (0, 3, 24)


def flexibility(modes: EndModes, power: int = 1) -> NDArray[np.float64]:
    """Sum of v v^T omega^-2power over the modes: of the displacements of the ends by the loads there."""
    return (modes.rows * modes.frequencies ** (-2 * power)) @ modes.rows.T


def elastic_receptance(omega: float) -> NDArray[np.float64]:
    """(4, 4) deflections and slopes of the ends of a free beam by harmonic forces and moments there, elastic part.

    From the general solution of E I w'''' = rho A omega^2 w, in 60 digits, less the motion of the rigid beam
    (R. E. D. Bishop and D. C. Johnson, The Mechanics of Vibration, Cambridge 1960, chapter 7).
    """
    with mpmath.workdps(60):
        length, mass, stiffness = mpmath.mpf(LENGTH), mpmath.mpf(MASS), mpmath.mpf(BENDING)
        wave = (mass / length * mpmath.mpf(omega) ** 2 / stiffness) ** (mpmath.mpf(1) / 4)

        def derivatives(x: mpmath.mpf) -> list[list[mpmath.mpf]]:
            c, s, ch, sh = mpmath.cos(wave * x), mpmath.sin(wave * x), mpmath.cosh(wave * x), mpmath.sinh(wave * x)
            rows = [[c, s, ch, sh], [-s, c, sh, ch], [-c, -s, ch, sh], [s, -c, sh, ch]]
            return [[wave**order * value for value in row] for order, row in enumerate(rows)]

        start, end = derivatives(mpmath.mpf(0)), derivatives(length)
        loads = mpmath.matrix(
            [
                [stiffness * value for value in start[3]],
                [-stiffness * value for value in start[2]],
                [-stiffness * value for value in end[3]],
                [stiffness * value for value in end[2]],
            ]
        )
        motion = mpmath.matrix([start[0], start[1], end[0], end[1]])
        receptance = motion * loads**-1
        rigid_rows = [(1, -length / 2), (0, 1), (1, length / 2), (0, 1)]
        inertia = mass * length**2 / 12
        for i, (w, turn) in enumerate(rigid_rows):
            for j, (force, moment) in enumerate(rigid_rows):
                receptance[i, j] += (w * force / mass + turn * moment / inertia) / mpmath.mpf(omega) ** 2
        return np.array(receptance.tolist(), dtype=np.float64)


def test_frequencies_are_the_roots_of_the_frequency_equation() -> None:
    modes = bending_modes(LENGTH, MASS, BENDING, 12, blocks=0)
    unit = math.sqrt(BENDING / MASS / LENGTH**3)
    with mpmath.workdps(40):
        for k, frequency in enumerate(modes.frequencies, start=1):
            near = (k + mpmath.mpf(1) / 2) * mpmath.pi
            width = mpmath.mpf("0.03")
            root = mpmath.findroot(
                lambda x: mpmath.cos(x) * mpmath.cosh(x) - 1, (near - width, near + width), solver="anderson"
            )
            assert frequency == pytest.approx(float(root**2) * unit, rel=1e-14)
    axial = axial_modes(LENGTH, MASS, AXIAL, 5, blocks=0)
    assert axial.frequencies == pytest.approx(np.arange(1, 6) * math.pi * math.sqrt(AXIAL / MASS / LENGTH), rel=1e-15)


@pytest.mark.parametrize("blocks", [1, 2])
@pytest.mark.parametrize("kept", KEPT)
def test_ends_of_a_free_bar_have_the_exact_static_flexibility(kept: int, blocks: int) -> None:
    exact = LENGTH / AXIAL * np.array([[1 / 3, -1 / 6], [-1 / 6, 1 / 3]])
    assert flexibility(axial_modes(LENGTH, MASS, AXIAL, kept, blocks)) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("blocks", [1, 2])
@pytest.mark.parametrize("kept", KEPT)
def test_ends_of_a_free_beam_have_the_exact_static_flexibility(kept: int, blocks: int) -> None:
    # By integration of E I w'''' = p, with the loads balanced by the inertia of the rigid beam.
    ww, wt, wv, wu, tt, tu = 1 / 105, -11 / 210, 1 / 140, 13 / 420, 13 / 35, -9 / 70
    exact = np.array([[ww, wt, wv, wu], [wt, tt, -wu, tu], [wv, -wu, ww, -wt], [wu, tu, -wt, tt]])
    exact *= np.outer((LENGTH, 1, LENGTH, 1), (LENGTH, 1, LENGTH, 1)) * LENGTH / BENDING
    found = flexibility(bending_modes(LENGTH, MASS, BENDING, kept, blocks))
    assert found == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("kept", KEPT)
def test_second_block_makes_the_receptance_exact_to_the_fourth_power_of_frequency(kept: int) -> None:
    modes = bending_modes(LENGTH, MASS, BENDING, kept, blocks=2)
    first = math.sqrt(BENDING / MASS / LENGTH**3) * 22.3733
    errors = []
    for omega in (0.5 * first, 0.25 * first):
        found = (modes.rows / (modes.frequencies**2 - omega**2)) @ modes.rows.T
        exact = elastic_receptance(omega)
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    # With two blocks the moments up to omega^6 of the discarded modes are kept, so that the error falls with omega^8.
    assert errors[1] < max(errors[0] / 200, 1e-13)
    assert errors[0] < 1e-4
