"""Triangular factors within a profile against numpy, and the order in which mechanisms are eliminated."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from deployments import NATURAL_LEVELS
from mechanisms import chain

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.mechanism.description import GROUND, Body, Drive, FlexibleBody, Joint, Mechanism
from solar_env.mechanics.mechanism.textbook import four_bar
from solar_env.mechanics.numerics.profile import (
    BLOCK,
    Elimination,
    ProfileMatrix,
    add_entry,
    clear,
    dense,
    make_elimination,
    make_profile_matrix,
    profile_factor,
    profile_product,
    profile_solve,
)


def filled(elimination: Elimination, matrix: np.ndarray) -> ProfileMatrix:
    """The profile matrix of a dense one, entry by entry."""
    result = make_profile_matrix(elimination)
    for i, j in np.argwhere(matrix):
        add_entry(elimination, result, i, j, matrix[i, j])
    return result


def solved(elimination: Elimination, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solution by unknowns, zero for those that are held."""
    factors = filled(elimination, matrix)
    assert profile_factor(elimination, factors)
    free = elimination.position >= 0
    ordered = np.zeros(BLOCK * elimination.first.size)
    ordered[elimination.position[free]] = right[free]
    profile_solve(elimination, factors, ordered.reshape(-1, BLOCK))
    result = np.zeros(len(right))
    result[free] = ordered[elimination.position[free]]
    return result


def random_couplings(rng: np.random.Generator, size: int) -> list[tuple[int, int]]:
    return [tuple(pair) for pair in rng.integers(0, size, (2 * size, 2)).tolist()]


def coupled_matrix(rng: np.random.Generator, size: int, couplings: list[tuple[int, int]]) -> np.ndarray:
    """Random and unsymmetric where unknowns are coupled, with a dominant diagonal."""
    matrix = np.zeros((size, size))
    for i, j in couplings:
        matrix[i, j], matrix[j, i] = rng.normal(size=2)
    matrix[np.diag_indices(size)] = (1.0 + np.abs(matrix).sum(axis=1)) * rng.choice([-1.0, 1.0], size)
    return matrix


@pytest.mark.parametrize("size", [1, 2, 3, 8, 40])
@pytest.mark.parametrize("seed", range(3))
def test_the_solution_of_any_order_and_profile_is_numpys(size: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    couplings = random_couplings(rng, size)
    matrix, right = coupled_matrix(rng, size, couplings), rng.normal(size=size)
    elimination = make_elimination(rng.permutation(size), couplings)
    expected = np.linalg.solve(matrix, right)
    assert solved(elimination, matrix, right) == pytest.approx(expected, abs=1e-15 * size * np.linalg.cond(matrix))


@pytest.mark.parametrize("size", [1, 4, 7, 30])
def test_the_product_with_a_vector_is_numpys(size: int) -> None:
    rng = np.random.default_rng(size)
    couplings = random_couplings(rng, size)
    matrix, x = coupled_matrix(rng, size, couplings), rng.normal(size=size)
    elimination = make_elimination(rng.permutation(size), couplings)
    blocks = BLOCK * elimination.first.size
    ordered, out = np.zeros(blocks), np.full(blocks, math.nan)
    ordered[elimination.position] = x
    profile_product(elimination, filled(elimination, matrix), ordered.reshape(-1, BLOCK), out.reshape(-1, BLOCK))
    assert out[elimination.position] == pytest.approx(matrix @ x, abs=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_a_multiplier_behind_its_coordinates_needs_no_exchange_of_pivots(seed: int) -> None:
    # A chain of masses and springs; every constraint joins a few neighbours, and follows the last of them.
    rng = np.random.default_rng(seed)
    coordinates, rows = 30, 7
    root = np.tril(np.triu(rng.normal(size=(coordinates, coordinates)), -2))
    stiffness = root @ root.T + 0.1 * np.eye(coordinates)
    gradient = np.zeros((rows, coordinates))
    for r, start in enumerate(rng.choice(coordinates - 3, rows, replace=False)):
        gradient[r, start : start + 3] = rng.normal(size=3)
    matrix = np.block([[stiffness, gradient.T], [gradient, np.zeros((rows, rows))]])
    last = [int(np.flatnonzero(row).max()) for row in gradient]
    order = sorted(range(coordinates + rows), key=lambda k: k if k < coordinates else last[k - coordinates] + 0.5)
    position = np.argsort(order)
    elimination = make_elimination(position, [tuple(pair) for pair in np.argwhere(matrix).tolist()])
    right = rng.normal(size=len(matrix))
    expected = np.linalg.solve(matrix, right)
    rounding = 1e-14 * np.linalg.cond(matrix) * np.abs(expected).max()
    assert solved(elimination, matrix, right) == pytest.approx(expected, abs=rounding)
    factors = filled(elimination, matrix)
    profile_factor(elimination, factors)
    # Blocks that hold multipliers are indefinite, the others positive.
    for start in range(0, len(order) - len(order) % BLOCK, BLOCK):
        inverse = factors.diagonal.reshape(-1, BLOCK, BLOCK)[start // BLOCK]
        multipliers = np.count_nonzero(np.array(order[start : start + BLOCK]) >= coordinates)
        assert np.count_nonzero(np.linalg.eigvalsh(0.5 * (inverse + inverse.T)) < 0.0) == multipliers


def test_a_constraint_that_repeats_another_is_reported() -> None:
    matrix = np.zeros((4, 4))
    matrix[:2, :2] = np.eye(2)
    for r in (2, 3):
        matrix[r, :2] = matrix[:2, r] = 1.0, 2.0
    elimination = make_elimination(np.arange(4), [tuple(pair) for pair in np.argwhere(matrix).tolist()])
    assert not profile_factor(elimination, filled(elimination, matrix))
    matrix[3, 0] = matrix[0, 3] = 1.1
    assert profile_factor(elimination, filled(elimination, matrix))


@pytest.mark.parametrize("bad", [0.0, math.nan, math.inf, -math.inf])
def test_a_matrix_that_is_singular_or_not_finite_is_reported(bad: float) -> None:
    elimination = make_elimination(np.arange(3), [(0, 1), (1, 2)])
    for place in range(3):
        matrix = np.diag([2.0, 3.0, 4.0])
        profile = filled(elimination, matrix)
        assert profile_factor(elimination, profile)
        profile = filled(elimination, matrix)
        profile.diagonal[0, (BLOCK + 1) * place] = bad
        assert not profile_factor(elimination, profile)


def test_a_pivot_lost_to_cancellation_is_reported() -> None:
    elimination = make_elimination(np.arange(2), [(0, 1)])
    for excess, regular in ((1e-15, False), (1e-10, True)):
        matrix = np.array([[1.0, 1.0], [1.0, 1.0 + excess]])
        assert profile_factor(elimination, filled(elimination, matrix)) == regular


@pytest.mark.parametrize("seed", range(3))
def test_held_unknowns_take_no_part(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size = 12
    free = np.sort(rng.choice(size, 8, replace=False))
    position = np.full(size, -1)
    position[free] = rng.permutation(8)
    couplings = random_couplings(rng, size)
    matrix, right = coupled_matrix(rng, size, couplings), rng.normal(size=size)
    elimination = make_elimination(position, couplings)
    assert sorted(elimination.position[free]) == list(range(8))
    assert elimination.empty.size == 0
    inner = np.ix_(free, free)
    expected = np.zeros_like(matrix)
    expected[inner] = matrix[inner]
    assert np.array_equal(dense(elimination, filled(elimination, matrix)), expected)
    solution = np.zeros(size)
    solution[free] = np.linalg.solve(matrix[inner], right[free])
    assert solved(elimination, matrix, right) == pytest.approx(solution, abs=1e-14 * np.linalg.cond(matrix[inner]))


def test_entries_add_up_and_can_be_cleared() -> None:
    elimination = make_elimination(np.array([2, 0, 1]), [(0, 1)])
    matrix = make_profile_matrix(elimination)
    for i, j, value in ((0, 1, 2.0), (0, 1, 3.0), (1, 0, 7.0), (2, 2, 1.0), (0, 0, 4.0), (0, 2, 9.0)):
        add_entry(elimination, matrix, i, j, value)
    # Unknown 2 stands between 0 and 1: within the profile.
    assert dense(elimination, matrix).tolist() == [[4.0, 5.0, 9.0], [7.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    clear(elimination, matrix)
    assert not dense(elimination, matrix).any()


def test_a_matrix_without_unknowns_is_solved() -> None:
    elimination = make_elimination(np.full(4, -1), [(0, 1)])
    assert profile_factor(elimination, make_profile_matrix(elimination))


def mixed() -> Mechanism:
    """Ground, a driven beam, a rigid body and another beam."""
    beam = FlexibleBody("first", 1.0, 3, 1.0, 10.0, 0.1)
    bodies = (
        beam,
        Body("middle", 1.0, 0.1, 1.0, (0.5, 0.0), position=(1.0, 0.0)),
        replace(beam, name="last", elements=2, position=(2.0, 0.0)),
    )
    joints = (
        Joint("a", GROUND, "first", (0.0, 0.0), (0.0, 0.0)),
        Joint("b", "first", "middle", (1.0, 0.0), (0.0, 0.0)),
        Joint("c", "last", "middle", (0.0, 0.0), (1.0, 0.0)),
    )
    return Mechanism(bodies, joints, drives=(Drive("first", 0.0, 0.0, point=(1.0 / 3.0, 0.0)),))


MECHANISMS: dict[str, Callable[[], Mechanism]] = {
    **{model: (lambda model=model: build(ArrayParameters(panel_count=3), model)) for model in NATURAL_LEVELS},
    "fixed main body": lambda: build(ArrayParameters(body_fixed=True), "flexible-ideal:6 elements"),
    "four-bar": four_bar,
    "mixed": mixed,
    "free chain": lambda: chain(np.random.default_rng(0), angles=np.full(3, 0.4), eccentricities=np.zeros((3, 2))),
}


@pytest.mark.parametrize("name", MECHANISMS)
def test_every_unknown_of_a_mechanism_has_one_place(name: str) -> None:
    model, state = compile_mechanism(MECHANISMS[name]())
    position = model.elimination.position
    assert position.size == state.q.size + state.multipliers.size
    places = np.concatenate((position[position >= 0], model.elimination.empty))
    assert sorted(places) == list(range(BLOCK * model.elimination.first.size))
    n, rows = state.q.size, model.constraints.size.size
    held = set(np.flatnonzero(position < 0).tolist())
    expected = set()
    for b, body in enumerate(model.bodies):
        own = range(body.offset, int(np.append(model.bodies["offset"], n)[b + 1]))
        expected |= set(own) if body.fixed else set()
        # Only a rigid body's length has a multiplier.
        expected |= {n + rows + b} if not body.constraints else set()
    assert held == expected


@pytest.mark.parametrize("name", MECHANISMS)
def test_every_multiplier_comes_right_after_the_last_coordinate_that_it_acts_on(name: str) -> None:
    model, state = compile_mechanism(MECHANISMS[name]())
    position, constraints = model.elimination.position, model.constraints
    n, rows = state.q.size, constraints.size.size
    places = {int(position[n + r]): constraints.coordinate[r, : constraints.size[r]] for r in range(rows)}
    for b, body in enumerate(model.bodies):
        if body.constraints:
            places[int(position[n + rows + b])] = np.arange(body.offset, body.offset + 4)
    for place, coordinates in places.items():
        last = max(coordinates, key=lambda k: position[k])
        assert 0 <= position[last] < place
        between = np.flatnonzero((position > position[last]) & (position < place))
        # Nothing but other multipliers, and the rest of the same pair of points.
        node = [k for k in between if k < n]
        assert all(abs(k - last) < 4 for k in node), (place, node)


def storage(model: str, panels: int = 2) -> int:
    """Entries below the diagonal in the profile of an array's matrix."""
    compiled, _ = compile_mechanism(build(ArrayParameters(panel_count=panels), model))
    return int(make_profile_matrix(compiled.elimination).lower.size)


@pytest.mark.parametrize("model", ["flexible-ideal", "flexible-clearance"])
def test_storage_grows_linearly_with_the_elements(model: str) -> None:
    sizes = [storage(f"{model}:{n} elements") for n in (6, 12, 24, 48)]
    assert sizes[2] - sizes[1] == 2 * (sizes[1] - sizes[0])
    assert sizes[3] - sizes[2] == 4 * (sizes[1] - sizes[0])
