"""Joints and axes of modal panels, as controllers and pictures see them."""

from __future__ import annotations

import numpy as np
import pytest

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.bodies.beam_modes import wave_number
from solar_env.mechanics.integrators.settings import ModalRadau
from solar_env.mechanics.mechanism.description import Mechanism, ModalPanel
from solar_env.mechanics.modal.panel.foreshortening import quadratic_forms
from solar_env.mechanics.modal.views import view_joint
from solar_env.mechanics.running.simulation import Simulation

LENGTH, MASS = 2.0, 3.0


def panel(modes: int) -> Simulation:
    body = ModalPanel("panel", LENGTH, MASS, 2e4, 300.0, modes=modes, position=(0.3, -0.2), angle=0.7)
    return Simulation(Mechanism((body,)), ModalRadau())


def shaken(modes: int) -> Simulation:
    """The array with all amplitudes and rates at random, each as large as its share of the same energy."""
    simulation = Simulation(build(ArrayParameters(), f"flexible-clearance:{modes} modes"), ModalRadau())
    model, state, rng = simulation.model, simulation.state, np.random.default_rng(modes)
    frequencies = model.panels.frequency[0]
    for body in model.bodies[model.bodies["panel"] >= 0]:
        own = slice(body["offset"] + 3, body["offset"] + 3 + frequencies.size)
        state.q[own] = 0.1 * rng.normal(size=frequencies.size) / frequencies
        state.v[own] = 0.1 * rng.normal(size=frequencies.size)
        state.v[body["offset"] + 2] = rng.normal()
    return simulation


@pytest.mark.parametrize("modes", [0, 1, 6])
def test_a_joint_is_seen_as_its_loads_have_it(modes: int) -> None:
    simulation = shaken(modes)
    loads, main_body = simulation.joint_loads(), simulation.state.q[2]
    for j in range(2):
        view = view_joint(simulation.model, simulation.state, j)
        assert view.angle == pytest.approx(loads[j, ANGLE], abs=1e-14)
        assert view.rate == pytest.approx(loads[j, RATE], abs=1e-12)
        found = (view.eccentricity_x, view.eccentricity_y)
        assert found == pytest.approx(tuple(loads[j, [ECCENTRICITY_X, ECCENTRICITY_Y]]), abs=1e-14)
    simulation.state.q[2] += 6.0 * np.pi + 1.0
    view = view_joint(simulation.model, simulation.state, 0)
    assert view.inboard_angle == pytest.approx(main_body + 1.0, abs=1e-12)
    assert view.inboard_spin == simulation.state.v[2]


@pytest.mark.parametrize("modes", [0, 1, 6])
def test_axes_of_neighbours_are_as_far_apart_as_the_journal_is_from_its_bearing(modes: int) -> None:
    simulation = shaken(modes)
    axes = [centreline(simulation.model, simulation.state.q, body, 2) for body in range(3)]
    assert [len(axis) for axis in axes] == [2, 17, 17]
    apart = simulation.joint_loads()[1, [ECCENTRICITY_X, ECCENTRICITY_Y]]
    assert axes[2][0] - axes[1][-1] == pytest.approx(apart, abs=1e-14)
    times = np.stack([simulation.state.q, 0.5 * simulation.state.q])
    assert centreline(simulation.model, times, 2, 2)[0] == pytest.approx(axes[2], abs=0.0)


@pytest.mark.parametrize("k", [1, 2, 5])
def test_the_axis_of_a_panel_in_one_mode_has_its_shape(k: int) -> None:
    simulation = panel(6)
    model, q = simulation.model, simulation.state.q
    straight = centreline(model, q, 0)
    amplitude = 1e-6
    # Even and odd modes have a group each.
    q[3 + model.panels.first[(k + 1) % 2] + (k - 1) // 2] = amplitude
    offset = centreline(model, q, 0) - straight
    across = offset @ [-np.sin(0.7), np.cos(0.7)]
    # The textbook's shape, with hyperbolic functions that lose digits where they grow.
    x = float(wave_number(k))
    z = x * np.linspace(0.0, 1.0, len(straight))
    sigma = (np.cosh(x) - np.cos(x)) / (np.sinh(x) - np.sin(x))
    shape = np.cosh(z) + np.cos(z) - sigma * (np.sinh(z) + np.sin(z))
    assert across == pytest.approx(amplitude * shape / np.sqrt(MASS), abs=1e-8 * amplitude)


def test_a_panel_that_bends_without_strain_keeps_its_length() -> None:
    simulation = panel(6)
    model, q = simulation.model, simulation.state.q
    bending = 0.05 * np.array([1.0, -0.4, 0.2, 0.0])
    even, odd, axial, axial_odd = 3 + model.panels.first[:4]
    q[even : even + 2], q[odd : odd + 2] = bending[::2], bending[1::2]
    axis = centreline(model, q, 0, 50)
    stretched = np.hypot(*np.diff(axis, axis=0).T).sum() - LENGTH
    project, _ = quadratic_forms(LENGTH, MASS, bending.size, 3)
    shortening = 0.5 * np.einsum("kij,i,j->k", project[:, :4, :4], bending, bending)
    q[axial_odd : axial_odd + 2], q[axial] = shortening[::2], shortening[1]
    axis = centreline(model, q, 0, 50)
    kept = np.hypot(*np.diff(axis, axis=0).T).sum() - LENGTH
    # What is left is of fourth order in the slopes.
    assert abs(kept) < 0.01 * abs(stretched)
    assert stretched > 1e-3
