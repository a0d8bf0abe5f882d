"""Cases of the beam element itself: mass, rigid motion, strain energy, tangents, orders of convergence."""

import cmath
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.analysis.linearization import linearize, natural_frequencies, static_equilibrium
from solar_env.mechanics.arrays.model import ELASTIC, KINETIC, MATERIAL_DISSIPATION
from solar_env.mechanics.bodies.cable_element.tangent import add_elastic_tangents, make_element_slopes
from solar_env.mechanics.equations.system import applied_forces, make_workspace
from solar_env.mechanics.mechanism.beams import BEAM, PANEL, Beam, cantilever, free_beam
from solar_env.mechanics.mechanism.description import Load
from solar_env.mechanics.numerics.profile import dense, make_profile_matrix
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.beams import theory
from solar_env.verification.beams.fields import coordinates_of, flexible_body, straight_coordinates, tip
from solar_env.verification.checks import Check, compare

UNITY = "exact: partition of unity, M^-1 M g = g"
PRZEMIENIECKI = "J. S. Przemieniecki, Theory of Matrix Structural Analysis, 1968, section 5.6"
UNIFORM_BEAM = "exact: integrals over the uniform straight beam; cubic fields contain rigid motion"
PERTURBED = "first-order perturbation of the potential: h^4 of bending, h^6 of membrane locking"
Vector = NDArray[np.float64]

ROUNDING = 1e-12
STRANG_FIX = "G. Strang and G. Fix, An Analysis of the Finite Element Method, 1973, sections 1.6 and 6.3"


def internal_forces(simulation: Simulation, q: Vector, v: Vector) -> tuple[Vector, float]:
    """Generalized forces (n,) of a mechanism that bears no loads, and the power [W] that its material dissipates."""
    work = make_workspace(simulation.model, simulation.state)
    applied_forces(simulation.model, simulation.state.joints, q, v, work)
    return work.force.copy(), float(work.power[MATERIAL_DISSIPATION])


def strain_energy(simulation: Simulation, q: Vector) -> float:
    """Strain energy [J] of a mechanism whose only bodies are flexible."""
    simulation.state.q[:] = q
    return float(simulation.stored_energies()[ELASTIC])


def element_mass() -> Iterator[Check]:
    """Mass matrix: uniform acceleration, moments of the mass, kinetic energy and momentum of rigid motion."""
    beam, elements = PANEL, 3
    mechanism = free_beam(beam, elements)
    body = flexible_body(mechanism)
    own = coordinates_of(body)
    mass = linearize(mechanism).mass[own, own]
    shift = straight_coordinates(body, 1.0 + 0.0j, 0j)
    turn = straight_coordinates(body, 0j, 1j)  # velocity of the straight beam along x that turns about its end
    lift = straight_coordinates(body, 1j, 0j)
    moving = free_beam(beam, elements, velocity=(0.3, -0.4), spin=2.0, angle=0.7)
    start, along = complex(0.3, -0.4), cmath.rect(1.0, 0.7)
    centre_speed = abs(start + 2j * 0.5 * beam.length * along)
    energy = 0.5 * beam.mass * (centre_speed**2 + (beam.length * 2.0) ** 2 / 12.0)
    figures = (
        ("total mass [kg]", beam.mass, shift @ mass @ shift),
        ("mass between the directions [kg]", 0.0, shift @ mass @ lift),
        ("first moment about the end [kg m]", beam.mass * beam.length / 2.0, lift @ mass @ turn),
        ("second moment about the end [kg m2]", beam.mass * beam.length**2 / 3.0, turn @ mass @ turn),
        ("asymmetry of the mass matrix [kg]", 0.0, np.abs(mass - mass.T).max()),
        ("kinetic energy of a rigid motion [J]", energy, Simulation(moving).stored_energies()[KINETIC]),
    )
    for name, expected, obtained in figures:
        yield Check(name, expected, float(obtained), ROUNDING * max(1.0, abs(expected)), UNIFORM_BEAM)
    falling = Simulation(replace(free_beam(beam, elements, angle=0.7), gravity=(1.0, -2.0)))
    falling.advance(0.5)
    uniform = straight_coordinates(body, 1.0 * 0.5 - 2.0j * 0.5, 0j)
    # Rounding of the strains times the stiffness
    obtained = np.abs(falling.state.v[own] - uniform).max()
    yield Check("free fall: greatest difference of a nodal velocity from g t [m/s, 1/s]", 0.0, obtained, 1e-10, UNITY)


def element_strains() -> Iterator[Check]:
    """Strain energy and forces: none for rigid motion, exact for stretch, bending independent of stretch."""
    beam = replace(PANEL, damping=0.01)
    mechanism = free_beam(beam, 4)
    simulation, body = Simulation(mechanism), flexible_body(mechanism)
    still = np.zeros_like(simulation.state.q)
    angles = np.linspace(-math.pi, math.pi, 9)
    forces, energies, powers = [], [], []
    for angle in angles:
        along = cmath.rect(1.0, float(angle))
        q = straight_coordinates(body, 3.0 - 2.0j, along)
        forces.append(float(np.abs(internal_forces(simulation, q, still)[0]).max()))
        energies.append(strain_energy(simulation, q))
        # A stretched beam in steady rotation: the strains keep their value.
        stretched = straight_coordinates(body, 0j, 1.1 * along)
        powers.append(
            internal_forces(simulation, stretched, straight_coordinates(body, 1.0 + 2.0j, 5j * 1.1 * along))[1]
        )
    scale = beam.axial_stiffness
    stretch = straight_coordinates(body, 0j, 1.1 * cmath.rect(1.0, 0.3))
    figures = [
        ("rigid displacement: greatest force over E A", 0.0, max(forces) / scale, ROUNDING),
        ("rigid displacement: strain energy over E A L", 0.0, max(energies) / (scale * beam.length), ROUNDING),
        (
            "stretched beam in rotation: dissipated power over E A L / s",
            0.0,
            max(np.abs(powers)) / (scale * beam.length),
            ROUNDING,
        ),
        (
            "stretch of 0.1: strain energy over E A L",
            0.005,
            strain_energy(simulation, stretch) / (scale * beam.length),
            ROUNDING,
        ),
    ]
    # The same shape at twice the size turns as much per undeformed length.
    fine = free_beam(beam, 16)
    ring, ring_body = Simulation(fine), flexible_body(fine)
    s = np.linspace(0.0, 2.0 * math.pi, ring_body.elements + 1)
    places, slopes = beam.length / (2.0 * math.pi) * np.exp(1j * s), 1j * np.exp(1j * s)
    circle = np.column_stack([places.real, places.imag, slopes.real, slopes.imag]).ravel()
    bent = [strain_energy(ring, factor * circle) for factor in (1.0, 1.5)]
    bending = 0.5 * beam.bending_stiffness * (2.0 * math.pi) ** 2 / beam.length
    pulled = 0.5 * beam.axial_stiffness * 0.5**2 * beam.length
    turn = 2.0 * math.pi / ring_body.elements  # per element
    figures += [
        ("full circle: strain energy over that of bending", 1.0, bent[0] / bending, 1.1 * turn**4 / 720.0),
        # The interpolated circle is too short by turn^4 / 720, which the energy of the stretch multiplies by 6.
        (
            "full circle, stretched by 0.5, over that of stretch and bending",
            1.0,
            bent[1] / (pulled + bending),
            1.1 * 6.0 * turn**4 / 720.0,
        ),
    ]
    exact = "exact: E A eps^2 / 2 and E I (turn per undeformed length)^2 / 2; circle: cubic interpolation"
    yield from compare(figures, "{}", None, exact)


def element_tangent() -> Iterator[Check]:
    """Tangents: of a straight beam against the textbook's, of a deformed one against differences."""
    beam, elements = PANEL, 2
    mechanism = free_beam(beam, elements)
    stiffness = linearize(mechanism).stiffness
    h = beam.length / elements
    textbook = np.zeros((2 * (elements + 1), 2 * (elements + 1)))
    cubic = np.array(
        [
            [12.0, 6.0 * h, -12.0, 6.0 * h],
            [6.0 * h, 4.0 * h * h, -6.0 * h, 2.0 * h * h],
            [-12.0, -6.0 * h, 12.0, -6.0 * h],
            [6.0 * h, 2.0 * h * h, -6.0 * h, 4.0 * h * h],
        ]
    )
    for e in range(elements):
        textbook[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += beam.bending_stiffness / h**3 * cubic
    across = np.arange(2 * (elements + 1)) * 2 + 1  # y and y'
    obtained = np.abs(stiffness[np.ix_(across, across)] - textbook).max() / textbook.max()
    quantity = "straight beam: greatest difference of the transverse stiffness matrix, relative"
    yield Check(quantity, 0.0, obtained, ROUNDING, PRZEMIENIECKI)
    # Deformed at random and moving: forces from differences of the energy, tangents from differences of the forces.
    damped = Simulation(free_beam(replace(beam, damping=0.05), elements))
    model, size = damped.model, 4 * (elements + 1)
    rng = np.random.default_rng(1)
    q, v = damped.state.q.copy(), np.zeros_like(damped.state.v)
    q[:size] += 0.2 * rng.standard_normal(size)
    v[:size] = rng.standard_normal(size)

    def force(places: Vector, rates: Vector) -> Vector:
        return internal_forces(damped, places, rates)[0][:size]

    step = 1e-5
    shifts = step * np.eye(len(q))[:size]
    gradient = [strain_energy(damped, q + d) - strain_energy(damped, q - d) for d in shifts]
    weight = 0.3  # of df/dv
    parts = [make_profile_matrix(model.elimination) for _ in range(2)]
    add_elastic_tangents(model.cable_elements, q, v, make_element_slopes(), model.elimination, *parts)
    stiffness, damping = (dense(model.elimination, part)[:size, :size] for part in parts)
    tangent = stiffness + weight * damping
    slopes = [force(q - d, v) - force(q + d, v) + weight * (force(q, v - d) - force(q, v + d)) for d in shifts]
    still = force(q, np.zeros_like(v))
    for name, analytic, differences, source in (
        ("force from -grad(energy)", still, -np.array(gradient), "central differences of the strain energy"),
        ("tangent from the slope of the force", tangent, np.array(slopes).T, "central differences of the force"),
    ):
        # step^2 times the third derivative; rounding / step
        obtained = np.abs(analytic - differences / (2.0 * step)).max() / np.abs(analytic).max()
        yield Check(f"deformed beam: greatest difference of the {name}, relative", 0.0, obtained, 1e-7, source)


def convergence() -> Iterator[Check]:
    """Errors of frequencies and of large static deflections: their order, and their leading term."""
    beam, support = PANEL, "clamped-free"
    coarse, fine = 8, 16
    exact = theory.bending_frequencies(support, beam, 3)
    wave_numbers = theory.bending_wave_numbers(support, 3) / beam.length
    errors = {n: natural_frequencies(cantilever(beam, n))[:3] / exact - 1.0 for n in (coarse, fine)}
    for mode in (1, 2):
        obtained = math.log2(errors[coarse][mode] / errors[fine][mode])
        quantity = f"order of the frequency of bending mode {mode + 1}, {coarse} and {fine} elements"
        yield Check(
            quantity, 4.0, obtained, 0.2, f"{STRANG_FIX}: 2 (k + 1 - m) with cubics, k = 3, and curvatures, m = 2"
        )
        obtained = errors[fine][mode] / theory.cubic_element_frequency_error(wave_numbers[mode], beam.length / fine)
        quantity = f"error of the frequency of bending mode {mode + 1}, {fine} elements, over (beta h)^4 / 1440"
        yield Check(quantity, 1.0, obtained, 0.05, f"{STRANG_FIX}: leading term")
    # Nearly without bending stiffness, whose modes lie far below.
    bar = Beam(1.0, 1.0, 1.0, 1e-12)
    expected = float(theory.axial_frequencies(support, bar, 2)[1])
    found = [_nearest(natural_frequencies(cantilever(bar, n)), expected) / expected - 1.0 for n in (coarse, fine)]
    obtained = math.log2(found[0] / found[1])
    quantity = f"order of the second axial frequency, {coarse} and {fine} elements"
    yield Check(quantity, 6.0, obtained, 0.3, f"{STRANG_FIX}: 2 (k + 1 - m) with cubics, k = 3, and strains, m = 1")
    # Thick, bending decides; slender, membrane locking does.
    for slenderness, load, order in ((100.0, 5.0, 4.0), (67500.0, 0.5, 6.0)):
        numbers = (8, 16)
        cantilevered = Beam(1.0, 1.0, slenderness, 1.0)
        place, _ = theory.deflected_tip(cantilevered, 1j * load)
        missing = []
        for n in numbers:
            mechanism = cantilever(cantilevered, n, (0.0, load))
            missing.append(float((tip(flexible_body(mechanism), static_equilibrium(mechanism)) - place).imag))
        name = f"tip deflection, E A L^2 = {slenderness:g} E I, P L^2 = {load:g} E I"
        obtained = math.log2(missing[0] / missing[1])
        yield Check(f"{name}: order, {numbers[0]} and {numbers[1]} elements", order, obtained, 0.3, PERTURBED)
        # The next term has a factor h^2
        obtained = missing[1] / theory.element_deflection_error(load, slenderness, numbers[1])
        yield Check(f"{name}: error over its leading term, {numbers[1]} elements", 1.0, obtained, 0.15, PERTURBED)


def _nearest(values: NDArray[np.float64], value: float) -> float:
    return float(values[np.abs(values - value).argmin()])


def loaded_nodes() -> Iterator[Check]:
    """A torque and a force at an inner node, and at the end of a free beam: initial acceleration of the whole."""
    beam, elements = PANEL, 4
    loads = (Load(BEAM, (0.5 * beam.length, 0.0), (3.0, -1.0), 2.0), Load(BEAM, (beam.length, 0.0), (0.0, 1.0), -0.5))
    mechanism = free_beam(beam, elements, angle=0.4, loads=loads)
    body = flexible_body(mechanism)
    own = coordinates_of(body)
    mass = linearize(free_beam(beam, elements, angle=0.4)).mass[own, own]
    simulation = Simulation(mechanism)
    step = 1e-9
    simulation.advance(step)
    momentum = mass @ (simulation.state.v[own] / step)
    along = cmath.rect(1.0, 0.4)
    turning = straight_coordinates(body, 0j, 1j * along)
    arm = beam.length * along
    torque = 2.0 - 0.5 + (0.5 * arm.conjugate() * complex(3.0, -1.0) + arm.conjugate() * 1j).imag
    figures = (
        ("force along x [N]", 3.0, straight_coordinates(body, 1.0 + 0j, 0j) @ momentum),
        ("force along y [N]", 0.0, straight_coordinates(body, 1j, 0j) @ momentum),
        ("moment about the first end [N m]", torque, turning @ momentum),
    )
    yield from compare(figures, "loads at nodes: {}", 1e-6, "exact: sums of the loads")
