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


@pytest.mark.parametrize("model_name", ["rigid-clearance", "flexible-clearance:6 elements"])
def test_rigid_bodies_give_their_two_base_points(model_name: str) -> None:
    model, state = compile_mechanism(build(ArrayParameters(), model_name))
    assert centreline(model, state.q, 0).tolist() == [[0.0, 0.0], [0.5, 0.0]]
    if model_name == "rigid-clearance":
        assert centreline(model, state.q, 1) == pytest.approx(np.array([[0.5, 0.0], [0.5, -LENGTH]]), abs=1e-15)


def test_a_held_body_has_base_points_too() -> None:
    model, state = compile_mechanism(build(ArrayParameters(body_fixed=True), "flexible-ideal:6 elements"))
    assert centreline(model, state.q, 0).tolist() == [[0.0, 0.0], [0.5, 0.0]]


@pytest.mark.parametrize("body", [0, 1, 2])
def test_several_times_give_what_each_of_them_gives(body: int) -> None:
    model, state = compile_mechanism(build(ArrayParameters(), "flexible-ideal:3 elements"))
    q = np.random.default_rng(1).normal(size=(2, 4, state.q.size))
    together = centreline(model, q, body, 4)
    apart = np.array([[centreline(model, one, body, 4) for one in row] for row in q])
    assert np.array_equal(together, apart)


@pytest.mark.parametrize("body", [0, 1])
def test_the_points_belong_to_the_caller(body: int) -> None:
    model, state = compile_mechanism(build(ArrayParameters(), "flexible-ideal:1 element"))
    assert not np.shares_memory(centreline(model, state.q, body, 1), state.q)


def test_too_few_points_are_refused() -> None:
    model, state = compile_mechanism(build(ArrayParameters(), "flexible-ideal:6 elements"))
    with pytest.raises(ValueError, match="points_per_element = 0"):
        centreline(model, state.q, 1, 0)
