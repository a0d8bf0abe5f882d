"""Cases of beams that vibrate: natural frequencies of a panel, material damping."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from solar_env.mechanics.analysis.linearization import linearize, natural_frequencies
from solar_env.mechanics.arrays.model import ELASTIC, KINETIC
from solar_env.mechanics.integrators.settings import GeneralizedAlpha
from solar_env.mechanics.mechanism.beams import PANEL, Beam, cantilever, flexible_pendulum, free_beam
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.verification.beams import theory
from solar_env.verification.beams.fields import coordinates_of, flexible_body, nodes
from solar_env.verification.checks import Check, compare

STRESS = "stress = modulus * (strain + damping * strain rate)"
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
        obtained = int(np.count_nonzero(frequencies < 1e-3 * exact[0]))
        yield Check(f"{title}: frequencies below 1e-3 of the first bending mode", rigid, obtained, 0.0, RIGID_BODY)
        along = theory.axial_frequencies(support, beam, 1)[0]
        obtained = frequencies[np.abs(frequencies - along).argmin()]
        yield Check(
            f"{title}: first axial mode [Hz], {elements} elements", along, obtained, 1e-8, STANDING_WAVES, relative=True
        )


def _first_mode(mechanism: Mechanism) -> tuple[NDArray[np.float64], float]:
    """Shape and angular frequency [rad/s] of the lowest mode of a mechanism without rigid-body motions."""
    own = coordinates_of(flexible_body(mechanism))
    mass, _, stiffness, constraints = linearize(mechanism)
    free = null_space(constraints[:, own])
    projected = (free.T @ matrix[own, own] @ free for matrix in (stiffness, mass))
    squares, shapes = eigh(*projected, subset_by_index=[0, 0])
    return free @ shapes[:, 0], math.sqrt(float(squares[0]))


def material_damping() -> Iterator[Check]:
    """Decay of a bending mode; rigid rotation, which the damping must not brake."""
    beam, elements = replace(PANEL, damping=1e-3), 6
    mechanism = cantilever(beam, elements)
    system = linearize(mechanism)
    scale = np.abs(system.stiffness).max()
    obtained = np.abs(system.damping - beam.damping * system.stiffness).max() / (beam.damping * scale)
    yield Check(
        "damping matrix of the unstrained beam less damping * stiffness matrix, relative", 0.0, obtained, 1e-12, STRESS
    )
    shape, omega = _first_mode(mechanism)
    simulation = Simulation(mechanism, GeneralizedAlpha(step=1e-3))
    # Small: the squares of rotations stay below 1e-6.
    simulation.state.v[: len(shape)] = shape * (1e-3 * omega / np.abs(shape).max())
    simulation.state.clock["acceleration_current"] = 0
    rate = theory.modal_decay_rate(omega / (2.0 * math.pi), beam.damping)
    period = 2.0 * math.pi / math.sqrt(omega**2 - rate**2)
    start = float(simulation.stored_energies()[[KINETIC, ELASTIC]].sum())
    cycles = 8
    simulation.advance(cycles * period)
    left = float(simulation.stored_energies()[[KINETIC, ELASTIC]].sum())
    # Relative; the integrator's own damping is some (omega h)^3 / (damping omega).
    obtained = -0.5 * math.log(left / start) / (cycles * period)
    quantity = f"decay rate of the first bending mode [1/s], from the energy after {cycles} periods"
    yield Check(quantity, rate, obtained, 1e-3, MODAL_DECAY, relative=True)
    soft, spin = Beam(2.0, 1.0, 1e3, 10.0, damping=0.01), 5.0
    turning = free_beam(soft, elements, velocity=(0.0, -0.5 * spin * soft.length), spin=spin)
    motion = simulate(turning, 10.0, integrator=GeneralizedAlpha(step=5e-4), output_step=0.1)
    places, _ = nodes(flexible_body(turning), motion.coordinates)
    ends = places[-1] - places[0]
    rates = np.diff(np.unwrap(np.angle(ends))) / np.diff(motion.time)
    steady_rate, steady_length = theory.spinning_free_beam(soft, spin)
    figures = (
        ("spin after the stretch has died out [rad/s]", steady_rate, rates[-10:].mean()),
        ("spin 5 s earlier [rad/s]", steady_rate, rates[-60:-50].mean()),
        ("length [m]", steady_length, np.abs(ends[-1])),
    )
    yield from compare(
        figures,
        "damped beam in free rotation: {}",
        tolerance=1e-5,  # (omega h)^2
        relative=True,
        source="exact: E A r'' = -rho A rate^2 r, with the angular momentum of the start",
    )
