"""Cases of beams that vibrate: natural frequencies of a panel, material damping."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.linalg import eigh, null_space

from solar_env.mechanics.analysis.linearization import linearize, natural_frequencies
from solar_env.mechanics.arrays.model import ELASTIC, KINETIC
from solar_env.mechanics.integrators.settings import GeneralizedAlpha
from solar_env.mechanics.mechanism.beams import PANEL, cantilever, flexible_pendulum, free_beam
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.beams import theory
from solar_env.verification.beams.fields import coordinates_of, flexible_body
from solar_env.verification.checks import Check

MODAL_DECAY = "exact: damping * omega^2 / 2 for a mode that is damped in proportion to its stiffness"
STANDING_WAVES = "exact: standing waves of a bar"
EULER_BERNOULLI = "Euler-Bernoulli: characteristic equation (S. Timoshenko, Vibration Problems in Engineering, 1937)"
RIGID_BODY = "as many zero frequencies as rigid-body motions"


def panel_frequencies() -> Iterator[Check]:
    """Bending frequencies of a panel, clamped, pinned and free, and of two panels in a row."""
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
            # The elements' error, and the rounding of an eigenvalue, which is relative to the highest one.
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
    """Decay of the first bending mode of a damped cantilever."""
    beam = replace(PANEL, damping=1e-3)
    mechanism = cantilever(beam, 6)
    of_beam = coordinates_of(flexible_body(mechanism))
    system = linearize(mechanism)
    free = null_space(system.constraints[:, of_beam])
    projected = (free.T @ matrix[of_beam, of_beam] @ free for matrix in (system.stiffness, system.mass))
    squares, shapes = eigh(*projected, subset_by_index=[0, 0])
    shape, omega = free @ shapes[:, 0], math.sqrt(float(squares[0]))
    simulation = Simulation(mechanism, GeneralizedAlpha(step=1e-3))
    # Small: the squares of rotations stay below 1e-6.
    simulation.state.v[: len(shape)] = shape * (1e-3 * omega / np.abs(shape).max())
    simulation.state.clock["acceleration_current"] = 0
    rate, cycles = 0.5 * beam.damping * omega**2, 8
    duration = cycles * 2.0 * math.pi / math.sqrt(omega**2 - rate**2)
    start = float(simulation.stored_energies()[[KINETIC, ELASTIC]].sum())
    simulation.advance(duration)
    left = float(simulation.stored_energies()[[KINETIC, ELASTIC]].sum())
    # Relative; the integrator's damping is some (omega h)^3 / (damping omega).
    obtained = -0.5 * math.log(left / start) / duration
    quantity = f"decay rate of the first bending mode [1/s], from the energy after {cycles} periods"
    yield Check(quantity, rate, obtained, 1e-3, MODAL_DECAY, relative=True)
