"""Joints and axes of modal panels, as controllers and pictures see them."""

from __future__ import annotations

import numpy as np
import pytest

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.integrators.settings import ModalRadau
from solar_env.mechanics.mechanism.description import Mechanism, ModalPanel
from solar_env.mechanics.modal.foreshortening import bending_shapes
from solar_env.mechanics.modal.formulation import view_joint
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


def test_a_joint_is_seen_as_its_loads_have_it_before_and_after_a_step() -> None:
    simulation = Simulation(build(ArrayParameters(initial_rate=0.2), "flexible-clearance:2 modes"), ModalRadau())
    for end in (0.0, 0.01):
        simulation.advance(end)
        model, state, loads = simulation.model, simulation.state, simulation.joint_loads()
        for j in range(2):
            view = view_joint(model, state, j)
            columns = loads[j, [ANGLE, RATE, ECCENTRICITY_X, ECCENTRICITY_Y]]
            assert (view.angle, view.rate, view.eccentricity_x, view.eccentricity_y) == pytest.approx(
                columns, rel=1e-12
            )
        assert view_joint(model, state, 0).inboard_angle == pytest.approx(state.q[2], abs=1e-15)
        assert view_joint(model, state, 0).inboard_spin == state.v[2]
    simulation.state.views[0, 2] += 6.0 * np.pi + 1.0
    assert view_joint(model, state, 0).inboard_angle == pytest.approx(state.q[2] + 1.0, abs=1e-12)


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
    across = (centreline(model, q, 0) - straight) @ [-np.sin(0.7), np.cos(0.7)]
    shape = bending_shapes(LENGTH, MASS, k, np.linspace(0.0, LENGTH, len(straight)))[0, -1]
    assert across == pytest.approx(amplitude * shape, abs=1e-8 * amplitude)
