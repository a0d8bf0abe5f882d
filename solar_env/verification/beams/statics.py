"""Cases of beams at rest: large deflections of a cantilever, and the elements' orders of convergence."""

import cmath
import math
from collections.abc import Iterator

import numpy as np

from solar_env.mechanics.analysis.linearization import natural_frequencies, static_equilibrium
from solar_env.mechanics.mechanism import PANEL, Beam, Mechanism, cantilever
from solar_env.verification.beams import theory
from solar_env.verification.beams.fields import flexible_body, nodes
from solar_env.verification.checks import Check, compare

ELASTICA = "K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272"
CIRCLE = "exact: circular arc; elements miss E I h^4 kappa^6 / 1440 and turn less by (kappa h)^4 / 240"
PERTURBED = "first-order perturbation of the potential: h^4 of bending, h^6 of membrane locking"
STRANG_FIX = "G. Strang and G. Fix, An Analysis of the Finite Element Method, 1973, sections 1.6 and 6.3"
CUBICS = f"{STRANG_FIX}: 2 (k + 1 - m) with cubics, k = 3,"


def solve_tip(mechanism: Mechanism, load_steps: int = 10) -> tuple[complex, float]:
    """Place x + i y [m] and direction [rad], from -pi to pi, of the tip at equilibrium."""
    places, slopes = nodes(flexible_body(mechanism), np.asarray(static_equilibrium(mechanism, load_steps=load_steps)))
    return complex(places[-1]), cmath.phase(complex(slopes[-1]))


def tip_load() -> Iterator[Check]:
    """A cantilever under a transverse dead load at its tip, so slender that it does not stretch."""
    # Slenderness E A L^2 / (E I) = 1e6; stretch changes the figures by some load / 1e6.
    beam, elements = Beam(length=1.0, linear_density=1.0, axial_stiffness=1e6, bending_stiffness=1.0), 40
    names = ("deflection w / L", "shortening u / L", "tip angle [rad]")
    for load in (0.5, 1.0, 2.0, 5.0):
        place, angle = solve_tip(cantilever(beam, elements, (0.0, load)))
        bound = abs(theory.element_deflection_error(load, beam.axial_stiffness, elements))
        figures = zip(names, theory.tip_load_elastica(load), (place.imag, 1.0 - place.real, angle), strict=True)
        quantity = f"P L^2 / (E I) = {load:g}: {{}}, {elements} elements"
        yield from compare(figures, quantity, 2.0 * bound + 4.0 * load / beam.axial_stiffness, ELASTICA)


def tip_moment() -> Iterator[Check]:
    """A cantilever that a tip moment rolls up, to a full circle."""
    beam, elements = PANEL, 16
    for turns, name in ((0.25, "quarter"), (0.5, "half"), (1.0, "full")):
        turn = 2.0 * math.pi * turns
        mechanism = cantilever(beam, elements, tip_torque=turn * beam.bending_stiffness / beam.length)
        place, angle = solve_tip(mechanism, load_steps=20)
        exact = (cmath.exp(1j * turn) - 1.0) / (1j * turn)
        figures = (
            ("x / L of the tip", exact.real, place.real / beam.length),
            ("y / L of the tip", exact.imag, place.imag / beam.length),
            ("turn of the tip [rad]", turn, angle + 2.0 * math.pi * round((turn - angle) / (2.0 * math.pi))),
        )
        # Of the elements, and of the end of the iteration.
        tolerance = 1.1 * turn * (turn / elements) ** 4 / 240.0 + 1e-9
        yield from compare(figures, f"{name} circle: {{}}, {elements} elements", tolerance, CIRCLE)


def orders() -> Iterator[Check]:
    """Errors of frequencies and of large static deflections: their order, and their leading term."""
    beam, support, coarse, fine = PANEL, "clamped-free", 8, 16
    exact = theory.bending_frequencies(support, beam, 3)
    wave_numbers = theory.bending_wave_numbers(support, 3) / beam.length
    errors = {n: natural_frequencies(cantilever(beam, n))[:3] / exact - 1.0 for n in (coarse, fine)}
    for mode in (1, 2):
        obtained = math.log2(errors[coarse][mode] / errors[fine][mode])
        quantity = f"order of the frequency of bending mode {mode + 1}, {coarse} and {fine} elements"
        yield Check(quantity, 4.0, obtained, 0.2, f"{CUBICS} and curvatures, m = 2")
        obtained = errors[fine][mode] / theory.cubic_element_frequency_error(wave_numbers[mode], beam.length / fine)
        quantity = f"error of the frequency of bending mode {mode + 1}, {fine} elements, over (beta h)^4 / 1440"
        yield Check(quantity, 1.0, obtained, 0.05, f"{STRANG_FIX}: leading term")
    # Nearly without bending stiffness, whose modes lie far below.
    bar = Beam(1.0, 1.0, 1.0, 1e-12)
    expected = float(theory.axial_frequencies(support, bar, 2)[1])
    found = [np.abs(natural_frequencies(cantilever(bar, n)) - expected).min() for n in (coarse, fine)]
    quantity = f"order of the second axial frequency, {coarse} and {fine} elements"
    yield Check(quantity, 6.0, math.log2(found[0] / found[1]), 0.3, f"{CUBICS} and strains, m = 1")
    # Thick, bending decides; slender, membrane locking does.
    for slenderness, load, order in ((100.0, 5.0, 4.0), (67500.0, 0.5, 6.0)):
        bent = Beam(1.0, 1.0, slenderness, 1.0)
        place, _ = theory.deflected_tip(bent, 1j * load)
        missing = [(solve_tip(cantilever(bent, n, (0.0, load)))[0] - place).imag for n in (coarse, fine)]
        name = f"tip deflection, E A L^2 = {slenderness:g} E I, P L^2 = {load:g} E I"
        obtained = math.log2(missing[0] / missing[1])
        yield Check(f"{name}: order, {coarse} and {fine} elements", order, obtained, 0.3, PERTURBED)
        # The next term has a factor h^2
        obtained = missing[1] / theory.element_deflection_error(load, slenderness, fine)
        yield Check(f"{name}: error over its leading term, {fine} elements", 1.0, obtained, 0.15, PERTURBED)
