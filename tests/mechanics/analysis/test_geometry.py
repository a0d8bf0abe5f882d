"""The shapes of bodies that drawings and figures are made of."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.equations.build import compile_mechanism

LENGTH = ArrayParameters().panel_length


def panel_nodes(q: np.ndarray, model: np.ndarray, body: int) -> np.ndarray:
    """(nodes, 2, 2) view of the positions and slopes of a panel."""
    record = model.bodies[body]
    return q[record["offset"] : record["offset"] + record["coordinates"]].reshape(-1, 2, 2)


@pytest.mark.parametrize("elements", [1, 2, 5])
@pytest.mark.parametrize("points_per_element", [1, 2, 7])
def test_the_centreline_of_a_beam_is_the_cubic_through_its_nodes(elements: int, points_per_element: int) -> None:
    model, state = compile_mechanism(build(ArrayParameters(), f"flexible-ideal:{elements} elements"))
    rng = np.random.default_rng(0)
    state.q[:] += rng.normal(scale=0.3, size=state.q.size)
    nodes = panel_nodes(state.q, model, 2)
    spline = CubicHermiteSpline(np.linspace(0.0, LENGTH, elements + 1), nodes[:, 0], nodes[:, 1])
    expected = spline(np.linspace(0.0, LENGTH, elements * points_per_element + 1))
    found = centreline(model, state.q, 2, points_per_element)
    assert found == pytest.approx(expected, abs=1e-14)
    assert np.array_equal(found[::points_per_element], nodes[:, 0]), "nodes are met exactly"


def test_rigid_bodies_give_their_two_base_points_and_a_held_body_too() -> None:
    model, state = compile_mechanism(build(ArrayParameters(body_fixed=True), "rigid-clearance"))
    assert centreline(model, state.q, 0).tolist() == [[0.0, 0.0], [0.5, 0.0]]
    assert centreline(model, state.q, 1) == pytest.approx(np.array([[0.5, 0.0], [0.5, -LENGTH]]), abs=1e-15)


def test_too_few_points_are_refused() -> None:
    model, state = compile_mechanism(build(ArrayParameters(), "flexible-ideal:6 elements"))
    with pytest.raises(ValueError, match="points_per_element = 0"):
        centreline(model, state.q, 1, 0)
