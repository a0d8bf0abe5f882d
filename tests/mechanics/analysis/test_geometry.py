"""The shapes of bodies that drawings and figures are made of."""

from __future__ import annotations

import numpy as np
import pytest

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.equations.build import compile_mechanism

LENGTH = ArrayParameters().panel_length


def panel_nodes(q: np.ndarray, model: np.ndarray, body: int) -> np.ndarray:
    """(nodes, 2, 2) view of the positions and slopes of a panel."""
    record = model.bodies[body]
    return q[record["offset"] : record["offset"] + record["coordinates"]].reshape(-1, 2, 2)


@pytest.mark.parametrize("elements", [1, 5])
def test_the_centreline_of_a_beam_is_the_cubic_through_its_nodes(elements: int) -> None:
    model, state = compile_mechanism(build(ArrayParameters(), f"flexible-ideal:{elements} elements"))
    rng = np.random.default_rng(0)
    state.q[:] += rng.normal(scale=0.3, size=state.q.size)
    nodes, found = panel_nodes(state.q, model, 2), centreline(model, state.q, 2, 2)
    assert found[::2] == pytest.approx(nodes[:, 0], abs=1e-14)
    middles = 0.5 * (nodes[:-1, 0] + nodes[1:, 0]) + LENGTH / elements / 8.0 * (nodes[:-1, 1] - nodes[1:, 1])
    assert found[1::2] == pytest.approx(middles, abs=1e-14)


def test_rigid_bodies_give_their_two_base_points_and_a_held_body_too() -> None:
    model, state = compile_mechanism(build(ArrayParameters(body_fixed=True), "rigid-clearance"))
    assert centreline(model, state.q, 0).tolist() == [[0.0, 0.0], [0.5, 0.0]]
    assert centreline(model, state.q, 1) == pytest.approx(np.array([[0.5, 0.0], [0.5, -LENGTH]]), abs=1e-15)
