"""Cases of what a modal panel is made of: its frequencies, and the flexibility of its ends."""

import math
from collections.abc import Iterator

import numpy as np

from solar_env.mechanics.mechanism.beams import PANEL
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.verification.checks import Check
from solar_env.verification.panels import theory
from solar_env.verification.panels.mechanisms import modal, start

MODES = (0, 1, 3, 6, 12, 24, 48)
_ROUNDING = 4.0 * np.finfo(float).eps
MEAN_AXES = "closed form: a free beam whose inertia holds the load, in its mean axes"


def frequencies() -> Iterator[Check]:
    """Frequencies of a free panel, all that are kept."""
    panels = start(Mechanism((modal(PANEL, 48),))).model.panels
    unit = math.sqrt(PANEL.bending_stiffness / PANEL.mass / PANEL.length**3)
    bending = unit * theory.free_wave_numbers(48) ** 2
    axial = np.arange(1, 25) * math.pi * math.sqrt(PANEL.axial_stiffness / PANEL.mass / PANEL.length)
    families = (("bending", bending, panels.bending_frequency), ("axial", axial, panels.axial_frequency))
    for name, exact, found in families:
        yield Check(
            quantity=f"{name}: largest relative error of {exact.size} frequencies",
            obtained=float(np.abs(found[0, : exact.size] / exact - 1.0).max()),
            tolerance=_ROUNDING,
            source="roots of cos x cosh x = 1 by mpmath; standing waves of a bar",
        )


def static_flexibility() -> Iterator[Check]:
    """Answers of both ends to constant forces and moments, whatever the number of modes."""
    bending = theory.bending_flexibility(PANEL.length, PANEL.bending_stiffness)
    axial = theory.axial_flexibility(PANEL.length, PANEL.axial_stiffness)
    for modes in MODES:
        panels = start(Mechanism((modal(PANEL, modes),))).model.panels
        families = (
            ("bending", bending, panels.bending_rows[0], panels.bending_frequency[0]),
            ("axial", axial, panels.axial_rows[0], panels.axial_frequency[0]),
        )
        for name, exact, rows, omega in families:
            scale = np.sqrt(np.diag(exact))
            error = (rows / omega**2) @ rows.T - exact
            yield Check(
                quantity=f"{name}: largest relative error of the ends' flexibility, modes = {modes}",
                obtained=float(np.abs(error / np.outer(scale, scale)).max()),
                tolerance=1e-10,
                source=MEAN_AXES,
            )
