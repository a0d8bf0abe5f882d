"""Claims of the paper measured over what it leaves open: at random, and by CMA-ES towards as many as possible."""

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from solar_env.array import ArrayParameters, PanelModel
from solar_env.array.panels import MODAL
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.paper.cases import MEMBERS, PANELS, simulate_case
from solar_env.studies.paper.claims import CLAIMS, Claim
from solar_env.studies.paper.identification.open_parameters import (
    NAMED,
    OPEN_PARAMETERS,
    SLIDING,
    STIFFNESS,
    Readings,
    named,
    parameters_at,
    point_of,
)
from solar_env.support.minimisation import minimise

STORE, FLEXIBLE_STORE = "identification.jsonl", "identification-flexible.jsonl"
RIGID_CLAIMS = tuple(claim for claim in CLAIMS if not claim.on_flexible_panels)
# Converged panels with the least damping of `paper.levels`, some three times as fast as the paper's mesh.
FAST_PANELS, FAST_DAMPING = PanelModel(MODAL, 24), 1e-6
# Of a searched set: the readings, the place in the unit cube, and a figure of each claim, None where it has none.
# A named set has its name instead.
SearchedSet = Mapping[str, Any]

RANDOM_SETS, RANDOM_CELLS = 128, 6
FREE_SEARCHES, FREE_SETS = 6, 330
REFINING_SEARCHES, REFINING_SETS = 6, 330
APART = 0.4  # distance in the unit cube
AIMED_SEARCHES, AIMED_SETS = 20, 66
AIM = 5.0  # weight of claims that a search is aimed at
CANDIDATES = 36  # sets that are measured with flexible panels
WHOLE_SEARCHES, WHOLE_SETS = 2, 88  # over all claims
WHOLE_AIMED_SETS = 55
FINALISTS = 10  # sets that are measured on the paper's mesh
SHORTLIST, SHORTLIST_MEMBERS = 3, MEMBERS
NAMES = ("preset", *NAMED)
USUAL = {"sliding": "material", "stiffness": "table"}


def figures_of(
    parameters: ArrayParameters, claims: Sequence[Claim], member: int = 0, panels: PanelModel = PANELS
) -> list[float | None]:
    """A figure of each claim for an array; None where there is none, as for an array that does not latch."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # What is searched may be far from any sensible array: that shows in the figures.
        warnings.simplefilter("ignore", SimulationWarning)
        warnings.simplefilter("ignore", RuntimeWarning)
        runs = {}
        try:
            for case in dict.fromkeys(case for claim in claims for case in claim.cases):
                runs[case] = simulate_case(case, parameters, member, panels)
                if not np.isfinite(runs[case].latch_times).all():
                    return [None] * len(claims)
        except SimulationError:
            return [None] * len(claims)
        return [_figure(claim, runs) for claim in claims]


def _figure(claim: Claim, runs: Mapping[str, Any]) -> float | None:
    try:
        value = claim.measure(runs)
    except (ValueError, IndexError, ZeroDivisionError):  # of a phase without contacts, which has no greatest force
        return None
    return float(f"{value:.5g}") if math.isfinite(value) else None


def cost(figures: Sequence[float | None], weights: Sequence[float], claims: Sequence[Claim]) -> float:
    """Weighted sum of what claims miss: 0 for one that holds, from 1/2 just outside its interval to 1 far off."""
    total = 0.0
    for claim, figure, weight in zip(claims, figures, weights, strict=True):
        missed = claim.shortfall(math.nan if figure is None else figure)
        total += weight * (1.0 if math.isnan(missed) else 0.5 * (missed > 0.0) + 0.5 * missed / (1.0 + missed))
    return total


def explore(cell: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Search from a cell: at random without a start, else by CMA-ES; returns all sets with their figures."""
    claims = CLAIMS if cell["flexible"] else RIGID_CLAIMS
    found: list[dict[str, Any]] = []
    if cell["start"] is None:
        points = qmc.Sobol(len(OPEN_PARAMETERS), seed=cell["seed"]).random(cell["sets"]).tolist()
        return [_searched(point, cell["readings"], claims) for point in points]
    weights = _weights(cell, claims)

    def costs(points: Sequence[np.ndarray]) -> list[float]:
        sets = [_searched(point, cell["readings"], claims) for point in points]
        found.extend(sets)
        return [cost(one["figures"], weights, claims) for one in sets]

    minimise(costs, np.array(cell["start"]), cell["sets"], cell["seed"], progress=False, spread=cell["spread"])
    return found


def _searched(
    point: Sequence[float] | NDArray[np.float64], readings: Readings, claims: Sequence[Claim]
) -> dict[str, Any]:
    place = [round(float(share), 5) for share in point]
    changes = {"panel_damping": FAST_DAMPING}  # of no effect on rigid panels
    parameters = parameters_at(place, readings).with_changes(changes)
    return {"readings": readings, "point": place, "figures": figures_of(parameters, claims, panels=FAST_PANELS)}


def _weights(cell: Mapping[str, Any], claims: Sequence[Claim]) -> list[float]:
    """Weights of the claims: even, drawn by the seed to see what pulls apart, or those aimed at before the rest."""
    if cell["aim"]:
        return [AIM if claim.key in cell["aim"] else 1.0 / len(claims) for claim in claims]
    if not cell["drawn"]:
        return [1.0] * len(claims)
    return np.random.default_rng(cell["seed"]).exponential(size=len(claims)).tolist()


def _cell(seed: int, sets: int, start: Sequence[float] | None, **others: Any) -> dict[str, Any]:
    usual = {"readings": USUAL, "aim": [], "drawn": False, "spread": 0.25, "flexible": False}
    return {"seed": seed, "sets": sets, "start": start, **usual, **others}


def broad_cells() -> Iterator[dict[str, Any]]:
    """Sets at random, with all readings alike; then searches from the named sets and from random ones."""
    for seed in range(RANDOM_CELLS):
        readings = {"sliding": SLIDING[seed % 3], "stiffness": STIFFNESS[seed // 3 % 2]}
        yield _cell(seed, RANDOM_SETS, None, readings=readings)
    starts = [point_of(named(name)) for name in NAMES[:-1]]  # the last one comes from this search
    for seed in range(FREE_SEARCHES):
        readings = {"sliding": "centres" if seed % 6 == 4 else "material", "stiffness": STIFFNESS[seed % 6 == 5]}
        random = np.random.default_rng(seed).uniform(0.2, 0.8, len(OPEN_PARAMETERS))
        start = starts[seed] if seed < len(starts) else random.round(4).tolist()
        yield _cell(seed, FREE_SETS, start, readings=readings)


def met_matrix(sets: Sequence[SearchedSet], claims: Sequence[Claim]) -> NDArray[np.bool_]:
    """(sets, claims) whether a set meets a claim."""
    met = np.zeros((len(sets), len(claims)), dtype=bool)
    for row, one in zip(met, sets, strict=True):
        row[:] = [
            figure is not None and claim.holds(figure) for claim, figure in zip(claims, one["figures"], strict=True)
        ]
    return met


def not_met_together(met: NDArray[np.bool_]) -> list[tuple[int, ...]]:
    """Pairs of claims that are met, but by no set together; first those whose rarer claim is met most often."""
    alone = met.sum(axis=0)
    pairs = combinations(np.flatnonzero(alone).tolist(), 2)
    apart = [(a, b) for a, b in pairs if not (met[:, a] & met[:, b]).any()]
    return sorted(apart, key=lambda pair: -min(alone[pair[0]], alone[pair[1]]))


def _best_apart(sets: Sequence[SearchedSet], claims: Sequence[Claim], count: int) -> list[SearchedSet]:
    """The best sets of which none lies near another."""
    chosen: list[SearchedSet] = []
    for one in best_first(sets, claims):
        near = (np.linalg.norm(np.subtract(one["point"], other["point"])) < APART for other in chosen)
        if len(chosen) < count and not any(near):
            chosen.append(one)
    return chosen


def refining_cells(sets: Sequence[SearchedSet]) -> Iterator[dict[str, Any]]:
    """Searches about the best sets that lie apart, every other one with drawn weights: to see what pulls apart."""
    for number, one in enumerate(_best_apart(sets, RIGID_CLAIMS, REFINING_SEARCHES)):
        drawn = number % 2 == 1
        yield _cell(number, REFINING_SETS, one["point"], readings=one["readings"], spread=0.08, drawn=drawn)


def aimed_cells(sets: Sequence[SearchedSet]) -> Iterator[dict[str, Any]]:
    """Searches for sets that meet both claims of a pair that none meets yet."""
    for number, pair in enumerate(not_met_together(met_matrix(sets, RIGID_CLAIMS))[:AIMED_SEARCHES]):
        yield _aimed_cell(number, AIMED_SETS, [RIGID_CLAIMS[claim].key for claim in pair], sets, flexible=False)


def whole_aimed_cells(whole: Sequence[SearchedSet]) -> Iterator[dict[str, Any]]:
    """Searches for sets that meet a claim on flexible panels that none meets yet."""
    missed = np.flatnonzero(~met_matrix(whole, CLAIMS).any(axis=0)).tolist()
    never = [CLAIMS[claim].key for claim in missed if CLAIMS[claim] not in RIGID_CLAIMS]
    for number, key in enumerate(never):
        yield _aimed_cell(number, WHOLE_AIMED_SETS, [key], whole, flexible=True)


def _aimed_cell(
    number: int, sets: int, aim: Sequence[str], known: Sequence[SearchedSet], flexible: bool
) -> dict[str, Any]:
    """A search for claims, from the nearest of the known sets."""
    claims = CLAIMS if flexible else RIGID_CLAIMS
    weights = _weights({"aim": aim}, claims)
    nearest = min(known, key=lambda one: cost(one["figures"], weights, claims))
    start = {"start": nearest["point"], "readings": nearest["readings"]}
    return _cell(number, sets, **start, aim=list(aim), spread=0.15, flexible=flexible)


def best_first(sets: Sequence[SearchedSet], claims: Sequence[Claim]) -> list[SearchedSet]:
    """The sets by the number of claims that they meet; of those that meet the same claims the one that misses least."""
    met = met_matrix(sets, claims)
    costs = [cost(one["figures"], [1.0] * len(claims), claims) for one in sets]
    order = sorted(range(len(sets)), key=lambda k: (-met[k].sum(), costs[k]))
    different = {met[k].tobytes(): k for k in reversed(order)}
    return [sets[k] for k in order if different[met[k].tobytes()] == k]


def parameters_of(one: Mapping[str, Any]) -> ArrayParameters:
    """The array of a searched or of a named set."""
    return named(one["named"]) if "named" in one else parameters_at(one["point"], one["readings"])


def measure_set(cell: Mapping[str, Any]) -> list[float | None]:
    """Figures of all claims of a set: of fast panels, or of a member of an ensemble of the paper's own."""
    parameters = parameters_of(cell)
    if cell["member"] is None:
        return figures_of(parameters.with_changes({"panel_damping": FAST_DAMPING}), CLAIMS, 0, FAST_PANELS)
    return figures_of(parameters, CLAIMS, cell["member"])


def candidate_cells(sets: Sequence[SearchedSet]) -> Iterator[dict[str, Any]]:
    """The sets that meet most claims on rigid panels, to be measured with flexible ones."""
    for one in best_first(sets, RIGID_CLAIMS)[:CANDIDATES]:
        yield {**place_of(one), "member": None}


def whole_cells(whole: Sequence[SearchedSet]) -> Iterator[dict[str, Any]]:
    """Searches over all claims from the best sets that have been measured with flexible panels."""
    for number, one in enumerate(_best_apart(whole, CLAIMS, WHOLE_SEARCHES)):
        yield _cell(number, WHOLE_SETS, one["point"], readings=one["readings"], flexible=True, spread=0.08)


def finalist_cells(whole: Sequence[SearchedSet]) -> Iterator[dict[str, Any]]:
    """The best sets, to be measured on the paper's mesh, once."""
    yield from ({**place_of(one), "member": 0} for one in best_first(whole, CLAIMS)[:FINALISTS])


def ensemble_cells(finalists: Sequence[SearchedSet]) -> Iterator[dict[str, Any]]:
    """The best finalists, then the named sets, to be measured over an ensemble."""
    places = [place_of(one) for one in best_first(finalists, CLAIMS)[:SHORTLIST]]
    for place in (*places, *({"named": name} for name in NAMES)):
        yield from ({**place, "member": member} for member in range(SHORTLIST_MEMBERS))


def place_of(one: Mapping[str, Any]) -> dict[str, Any]:
    """The entries that say which set it is, without its figures."""
    return {name: one[name] for name in ("named", "readings", "point") if name in one}
