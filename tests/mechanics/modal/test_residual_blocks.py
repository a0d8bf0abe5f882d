"""Panels with and without pseudo-modes for the modes that are left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solar_env.mechanics.bodies.description import ModalPanel
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.build import compile_modal, compile_panels, design

LENGTH, BENDING = 2.0, 300.0
PANEL = ModalPanel("panel", LENGTH, 3.0, axial_stiffness=2e4, bending_stiffness=BENDING, modes=4)


def tip_flexibility(blocks: int) -> float:
    """Deflection of a panel's first end by a transverse force there [m/N], against its rigid motion."""
    panels, _ = compile_panels((design(replace(PANEL, residual_blocks=blocks)),))
    bending = slice(0, panels.first[2])
    return float(np.sum((panels.rows[0, bending, 0] / panels.frequency[0, bending]) ** 2))


def test_one_block_has_the_exact_flexibility_and_without_any_the_ends_are_too_stiff() -> None:
    exact = LENGTH**3 / BENDING / 105.0
    assert [tip_flexibility(blocks) for blocks in (1, 2)] == pytest.approx([exact, exact], rel=1e-12)
    # The modes above the fourth have about 4 / x^4 each, with x from (5 + 1/2) pi on.
    missing = sum(4.0 / ((k + 0.5) * np.pi) ** 4 for k in range(5, 1000)) * LENGTH**3 / BENDING
    assert exact - tip_flexibility(0) == pytest.approx(missing, rel=1e-6)


def test_panels_of_one_mechanism_have_the_same_number_of_blocks() -> None:
    other = replace(PANEL, name="other", residual_blocks=1)
    with pytest.raises(ValueError, match=r"residual_blocks = \[2, 1\] of the panels differ, .* the greatest of these"):
        compile_modal(Mechanism((PANEL, other)))
