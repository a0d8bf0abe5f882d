"""Verification cases of beams at or near rest: large deflections, frequencies, damping, and orders of convergence."""

import cmath
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.linalg import eigh, null_space

from solar_env.mechanics.analysis.linearization import linearize, natural_frequencies, static_equilibrium
from solar_env.mechanics.arrays.model import ELASTIC, KINETIC
from solar_env.mechanics.integrators.settings import GeneralizedAlpha
from solar_env.mechanics.mechanism import Mechanism
from solar_env.mechanics.mechanism.beams import PANEL, Beam, cantilever, flexible_pendulum, free_beam
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.beams import theory
from solar_env.verification.beams.fields import coordinates_of, flexible_body, nodes
from solar_env.verification.checks import Check, compare

ELASTICA = "K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272"
CIRCLE = "exact: circular arc; elements miss E I h^4 kappa^6 / 1440 and turn less by (kappa h)^4 / 240"
PERTURBED = "first-order perturbation of the potential: h^4 of bending, h^6 of membrane locking"
STRANG_FIX = "G. Strang and G. Fix, An Analysis of the Finite Element Method, 1973, sections 1.6 and 6.3"
CUBICS = f"{STRANG_FIX}: 2 (k + 1 - m) with cubics, k = 3,"
MODAL_DECAY = "exact: damping * omega^2 / 2 for a mode that is damped in proportion to its stiffness"
STANDING_WAVES = "exact: standing waves of a bar"
EULER_BERNOULLI = "Euler-Bernoulli: characteristic equation (S. Timoshenko, Vibration Problems in Engineering, 1937)"
RIGID_BODY = "as many zero frequencies as rigid-body motions"


def solve_tip(mechanism: Mechanism, load_steps: int = 10) -> tuple[complex, float]:
    """Solve statics in `load_steps` steps; return the tip's position x + i y [m] and direction [rad] from -pi to pi."""
    places, slopes = nodes(flexible_body(mechanism), np.asarray(static_equilibrium(mechanism, load_steps=load_steps)))
    return complex(places[-1]), cmath.phase(complex(slopes[-1]))


def tip_load() -> Iterator[Check]:
    """Check deflection, shortening and angle at the tip of a nearly inextensible cantilever under a dead tip load."""
    # Slenderness E A L^2 / (E I) = 1e6; stretch changes the results by some load / 1e6.
    beam, elements = Beam(length=1.0, linear_density=1.0, axial_stiffness=1e6, bending_stiffness=1.0), 40
    names = ("deflection w / L", "shortening u / L", "tip angle [rad]")
    for load in (0.5, 1.0, 2.0, 5.0):
        place, angle = solve_tip(cantilever(beam, elements, (0.0, load)))
        bound = abs(theory.element_deflection_error(load, beam.axial_stiffness, elements))
        figures = zip(names, theory.tip_load_elastica(load), (place.imag, 1.0 - place.real, angle), strict=True)
        quantity = f"P L^2 / (E I) = {load:g}: {{}}, {elements} elements"
        yield from compare(figures, quantity, 2.0 * bound + 4.0 * load / beam.axial_stiffness, ELASTICA)


def tip_moment() -> Iterator[Check]:
    """Check the tip of a cantilever that a tip moment rolls up into a quarter, a half and a full circle."""
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
        # The tolerance covers the element error, and an iteration that ends at 1e-9.
        tolerance = 1.1 * turn * (turn / elements) ** 4 / 240.0 + 1e-9
        yield from compare(figures, f"{name} circle: {{}}, {elements} elements", tolerance, CIRCLE)


def orders() -> Iterator[Check]:
    """Check element errors in frequencies and in large static deflections: order of convergence and leading term."""
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
    # The bar has almost no bending stiffness: bending frequencies lie far below axial ones.
    bar = Beam(1.0, 1.0, 1.0, 1e-12)
    expected = float(theory.axial_frequencies(support, bar, 2)[1])
    found = [np.abs(natural_frequencies(cantilever(bar, n)) - expected).min() for n in (coarse, fine)]
    quantity = f"order of the second axial frequency, {coarse} and {fine} elements"
    yield Check(quantity, 6.0, math.log2(found[0] / found[1]), 0.3, f"{CUBICS} and strains, m = 1")
    # Bending dominates the error of a thick beam, membrane locking the error of a slender beam.
    for slenderness, load, order in ((100.0, 5.0, 4.0), (67500.0, 0.5, 6.0)):
        bent = Beam(1.0, 1.0, slenderness, 1.0)
        place, _ = theory.deflected_tip(bent, 1j * load)
        missing = [(solve_tip(cantilever(bent, n, (0.0, load)))[0] - place).imag for n in (coarse, fine)]
        name = f"tip deflection, E A L^2 = {slenderness:g} E I, P L^2 = {load:g} E I"
        obtained = math.log2(missing[0] / missing[1])
        yield Check(f"{name}: order, {coarse} and {fine} elements", order, obtained, 0.3, PERTURBED)
        # The next error term is smaller by a factor h^2.
        obtained = missing[1] / theory.element_deflection_error(load, slenderness, fine)
        yield Check(f"{name}: error over its leading term, {fine} elements", 1.0, obtained, 0.15, PERTURBED)


def panel_frequencies() -> Iterator[Check]:
    """Check frequencies of a clamped, a pinned and a free panel, and of a clamped beam as long as two panels."""
    double = replace(PANEL, length=2.0 * PANEL.length)
    variants = (
        ("clamped-free", PANEL, 12, cantilever(PANEL, 12), 0),
        ("pinned-free", PANEL, 12, flexible_pendulum(PANEL, 12, gravity=0.0), 1),
        ("free-free", PANEL, 12, free_beam(PANEL, 12), 3),
        ("clamped-free", double, 24, cantilever(double, 24), 0),
    )
    for support, beam, elements, mechanism, rigid in variants:
        frequencies = np.asarray(natural_frequencies(mechanism))
        title = f"{support}, {beam.length:g} m"
        exact = theory.bending_frequencies(support, beam, 3)
        wave_numbers = theory.bending_wave_numbers(support, 3) / beam.length
        for mode, expected in enumerate(exact):
            bound = theory.cubic_element_frequency_error(float(wave_numbers[mode]), beam.length / elements)
            # The tolerance covers the element error, and rounding, which is relative to the highest eigenvalue.
            obtained = frequencies[rigid + mode]
            quantity = f"{title}: bending mode {mode + 1} [Hz], {elements} elements"
            tolerance = 1.1 * bound + np.finfo(float).eps * float(frequencies[-1] / expected) ** 2
            yield Check(quantity, expected, obtained, tolerance, EULER_BERNOULLI, relative=True)
        zeros = int(np.count_nonzero(frequencies < 1e-3 * exact[0]))
        yield Check(f"{title}: frequencies below 1e-3 of the first bending mode", rigid, zeros, 0.0, RIGID_BODY)
        along = theory.axial_frequencies(support, beam, 1)[0]
        obtained = frequencies[np.abs(frequencies - along).argmin()]
        quantity = f"{title}: first axial mode [Hz], {elements} elements"
        yield Check(quantity, along, obtained, 1e-8, STANDING_WAVES, relative=True)


def material_damping() -> Iterator[Check]:
    """Check the decay rate of a damped cantilever's first bending mode."""
    beam = replace(PANEL, damping=1e-3)
    mechanism = cantilever(beam, 6)
    of_beam = coordinates_of(flexible_body(mechanism))
    system = linearize(mechanism)
    free = null_space(system.constraints[:, of_beam])
    projected = (free.T @ matrix[of_beam, of_beam] @ free for matrix in (system.stiffness, system.mass))
    squares, shapes = eigh(*projected, subset_by_index=[0, 0])
    shape, omega = free @ shapes[:, 0], math.sqrt(float(squares[0]))
    simulation = Simulation(mechanism, GeneralizedAlpha(step=1e-3))
    # The amplitude is small: squared rotations stay below 1e-6.
    simulation.state.v[: len(shape)] = shape * (1e-3 * omega / np.abs(shape).max())
    simulation.state.clock["acceleration_current"] = 0
    rate, cycles = 0.5 * beam.damping * omega**2, 8
    duration = cycles * 2.0 * math.pi / math.sqrt(omega**2 - rate**2)
    start = float(simulation.stored_energies()[[KINETIC, ELASTIC]].sum())
    simulation.advance(duration)
    left = float(simulation.stored_energies()[[KINETIC, ELASTIC]].sum())
    # The integrator's own damping is some (omega h)^3 / (damping omega) of the decay rate.
    obtained = -0.5 * math.log(left / start) / duration
    quantity = f"decay rate of the first bending mode [1/s], from the energy after {cycles} periods"
    yield Check(quantity, rate, obtained, 1e-3, MODAL_DECAY, relative=True)
