"""Cases of what a modal panel is made of: its frequencies, and the flexibility of its ends."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.mechanism.beams import PANEL
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.tables import Panels
from solar_env.verification.beams.theory import bending_wave_numbers
from solar_env.verification.checks import Check
from solar_env.verification.panels import theory
from solar_env.verification.panels.mechanisms import modal, start

EXACT = "roots of cos x cosh x = 1; standing waves of a bar"
MODES = (0, 1, 3, 6, 12, 24, 48)
_ROUNDING = 4.0 * np.finfo(float).eps
MEAN_AXES = "closed form: a free beam whose inertia holds the load, in its mean axes"


def end_values(panels: Panels) -> NDArray[np.float64]:
    """(6, modes) by unit amplitudes: deflection and slope of both ends, then axial displacements."""
    w, slope = panels.rows[0].T
    odd, axial, axial_odd, end = panels.first[1:]
    sign = np.ones(end)
    sign[odd:axial] = sign[axial_odd:] = -1.0
    bent = np.arange(end) < axial
    return np.stack([w * bent, slope * bent, sign * w * bent, -sign * slope * bent, w * ~bent, sign * w * ~bent])


def frequencies() -> Iterator[Check]:
    """Frequencies of a free panel, all that are kept."""
    panels = start(Mechanism((modal(PANEL, 48),))).model.panels
    unit = math.sqrt(PANEL.bending_stiffness / PANEL.mass / PANEL.length**3)
    bending = unit * bending_wave_numbers("free-free", 48) ** 2
    axial = np.arange(1, 25) * math.pi * math.sqrt(PANEL.axial_stiffness / PANEL.mass / PANEL.length)
    for name, exact, groups in (("bending", bending, (0, 1)), ("axial", axial, (3, 2))):
        # Even and odd modes by turns, the pseudo-modes last.
        found = np.zeros(exact.size)
        for turn, group in enumerate(groups):
            found[turn::2] = panels.frequency[0, panels.first[group] :][: exact.size // 2]
        obtained = np.abs(found / exact - 1.0).max()
        yield Check(f"{name}: largest relative error of {exact.size} frequencies", 0.0, obtained, _ROUNDING, EXACT)


def static_flexibility() -> Iterator[Check]:
    """Answers of both ends to constant forces and moments, whatever the number of modes."""
    bending = theory.bending_flexibility(PANEL.length, PANEL.bending_stiffness)
    axial = theory.axial_flexibility(PANEL.length, PANEL.axial_stiffness)
    for modes in MODES:
        panels = start(Mechanism((modal(PANEL, modes),))).model.panels
        values = end_values(panels)
        for name, exact, rows, family in (
            ("bending", bending, values[:4], slice(0, panels.first[2])),
            ("axial", axial, values[4:], slice(panels.first[2], None)),
        ):
            rows, omega = rows[:, family], panels.frequency[0, family]
            scale = np.sqrt(np.diag(exact))
            error = (rows / omega**2) @ rows.T - exact
            obtained = np.abs(error / np.outer(scale, scale)).max()
            quantity = f"{name}: largest relative error of the ends' flexibility, modes = {modes}"
            yield Check(quantity, 0.0, obtained, 1e-10, MEAN_AXES)
