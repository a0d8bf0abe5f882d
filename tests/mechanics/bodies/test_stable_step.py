"""The explicit method's largest stable step for a beam: stability function, frequencies, and real vibrations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from mechanisms import Vector
from scipy.linalg import eigh

from solar_env.mechanics.bodies.cable_element.element import add_mass_product
from solar_env.mechanics.bodies.cable_element.tangent import add_elastic_tangents, make_element_slopes
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.mechanism.description import Body, FlexibleBody, Mechanism
from solar_env.mechanics.numerics.profile import dense, make_profile_matrix
from solar_env.mechanics.running.simulation import Simulation, simulate

AXIAL = FlexibleBody("beam", 1.7, 3, linear_density=0.8, axial_stiffness=5.0, bending_stiffness=1e-3)
BENDING = replace(AXIAL, bending_stiffness=0.6)


def step_of(beam: FlexibleBody) -> float:
    """Largest stable step of the explicit method on the beam."""
    return compile_mechanism(Mechanism((beam,)))[0].stable_step


def matrices(beam: FlexibleBody) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, damping and stiffness of the free straight beam, as the kernels have them."""
    model, state = compile_mechanism(Mechanism((beam,)))
    body, size = model.bodies[0], state.q.size
    mass = np.zeros((size, size))
    for row in range(size):
        add_mass_product(body, model.body_constants, np.eye(size)[row], mass[row])
    parts = [make_profile_matrix(model.elimination) for _ in range(2)]
    add_elastic_tangents(model.cable_elements, state.q, state.v, make_element_slopes(), model.elimination, *parts)
    stiffness, damping = (dense(model.elimination, part)[:size, :size] for part in parts)
    return mass, damping, stiffness


def amplification(z: complex | Vector) -> complex | Vector:
    return 1.0 + z + z**2 / 2.0 + z**3 / 6.0 + z**4 / 24.0


# Beyond a dozen elements the largest frequencies hardly change, and are no longer looked for.
@pytest.mark.parametrize(("elements", "tolerance"), [(1, 1e-4), (5, 1e-4), (12, 1e-4), (13, 5e-3), (40, 5e-3)])
@pytest.mark.parametrize("damping", [0.0, 0.003, 0.5])
def test_the_step_ends_where_a_vibration_of_the_kernels_matrices_would_grow(
    elements: int, tolerance: float, damping: float
) -> None:
    beam = replace(BENDING, elements=elements, damping=damping)
    mass, _, stiffness = matrices(beam)
    omegas = np.sqrt(np.maximum(eigh(stiffness, mass, eigvals_only=True), 0.0))
    omega = omegas[-1]
    eigenvalues = np.roots([1.0, damping * omega**2, omega**2])
    step = step_of(beam)
    inside = np.abs(amplification(np.outer(np.linspace(0.0, 1.0 - tolerance, 500) * step, eigenvalues)))
    assert inside.max() <= 1.0 + 1e-12
    assert np.abs(amplification((1.0 + 2.0 * tolerance) * step * eigenvalues)).max() > 1.0


def test_the_step_of_a_single_element_is_the_textbooks() -> None:
    length, density, axial, bending = 0.7, 0.8, 5.0, 0.6
    # Roots of mu^2 - 180 mu + 1680 = 0, and the greater one of the free element's 720 and 8400.
    frequencies = (
        math.sqrt((90.0 + math.sqrt(6420.0)) * axial / density) / length,
        math.sqrt(8400.0 * bending / density) / length**2,
    )
    beam = FlexibleBody("beam", length, 1, density, axial, bending)
    # Undamped vibrations are stable up to omega h = sqrt(8).
    assert step_of(beam) == pytest.approx(math.sqrt(8.0) / max(frequencies), rel=1e-4)


def test_rigid_bodies_bound_no_step_and_the_stiffest_beam_counts() -> None:
    rigid = Body("rigid", 1.0, 1.0, 1.0, (0.0, 0.0))
    assert compile_mechanism(Mechanism((rigid,)))[0].stable_step == math.inf
    stiff = replace(AXIAL, name="stiff", axial_stiffness=500.0)
    limits = [
        compile_mechanism(Mechanism(bodies))[0].stable_step for bodies in ((AXIAL,), (stiff,), (AXIAL, rigid, stiff))
    ]
    assert limits[0] > limits[1] == limits[2]


def shaken(beam: FlexibleBody, step: float) -> Simulation:
    """A beam at rest but for tiny random velocities, about to take steps of a given size without error control."""
    simulation = Simulation(Mechanism((beam,)), RungeKutta(rtol=0.1, velocity_scale=1e9, max_step=step))
    simulation.state.v[:] = 1e-9 * np.random.default_rng(0).normal(size=simulation.state.v.size)
    simulation.state.clock["step_size"] = step
    simulation.state.clock["last_error"] = 1.0
    return simulation


@pytest.mark.parametrize("damping", [0.0, 0.05])
@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_the_explicit_integrator_is_stable_just_below_that_step_and_not_above(factor: float, damping: float) -> None:
    beam = replace(AXIAL, damping=damping)
    limit = step_of(beam)
    simulation = shaken(beam, factor * limit)
    # Without the bound that the integrator would keep by itself.
    simulation.model = simulation.model._replace(stable_step=math.inf)
    before = simulation.stored_energies().sum()
    simulation.advance(150.0 * factor * limit)
    assert simulation.state.clock["steps"][0] in (150, 151)
    growth = simulation.stored_energies().sum() / before
    assert growth <= 1.0 if factor < 1.0 else growth > 100.0


def test_the_explicit_integrator_keeps_the_bound_by_itself_and_counts_its_steps() -> None:
    limit = step_of(AXIAL)
    simulation = shaken(AXIAL, 100.0 * limit)
    before = simulation.stored_energies().sum()
    simulation.advance(500.0 * limit)
    assert simulation.stored_energies().sum() <= before
    clock = simulation.state.clock[0]
    assert 500 < clock.steps < 530
    assert clock.steps - 1 <= clock.stability_bound_steps <= clock.steps
    rigid = Body("rigid", 1.0, 1.0, 1.0, (0.0, 0.0), spin=1.0)
    assert simulate(Mechanism((rigid,)), 1.0).summary()["stability_bound_steps"] == 0
