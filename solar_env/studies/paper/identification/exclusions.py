"""Claims together, as the searched sets have them: the front, pairs and triples that no set meets, and ranges."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from solar_env.studies.common.tables import Row
from solar_env.studies.paper.claims import Claim
from solar_env.studies.paper.identification.open_parameters import OPEN_PARAMETERS, quantities
from solar_env.studies.paper.identification.search import USUAL, SearchedSet, met_matrix, parameters_of

Met = NDArray[np.bool_]
# Sets that meet so many claims fewer than the best one still count as agreeing where ranges are given.
NEARLY = 1


@dataclass(frozen=True)
class Exclusion:
    """Claims that no searched set meets together, though any fewer of them are met.

    Attributes:
        claims: their places in the table.
        tried: the least number of sets that meet all but one of them: how well founded it is.
    """

    claims: tuple[int, ...]
    tried: int


def front(met: Met) -> NDArray[np.intp]:
    """Sets that no other set betters, which would meet all of their claims and more; the one that meets most first."""
    order = np.argsort(-met.sum(axis=1), kind="stable")
    kept: list[int] = []
    for one in order:
        if not kept or not (met[kept] >= met[one]).all(axis=1).any():
            kept.append(int(one))
    return np.array(kept)


def exclusions(met: Met) -> list[Exclusion]:
    """Pairs and triples of claims that exclude each other, the best founded first."""
    together = met.T.astype(np.int64) @ met.astype(np.int64)
    alone = together.diagonal()
    found = [
        Exclusion((a, b), int(min(alone[a], alone[b])))
        for a, b in combinations(np.flatnonzero(alone).tolist(), 2)
        if not together[a, b]
    ]
    for a, b, c in combinations(range(met.shape[1]), 3):
        tried = int(min(together[a, b], together[a, c], together[b, c]))
        if tried and not (met[:, a] & met[:, b] & met[:, c]).any():
            found.append(Exclusion((a, b, c), tried))
    return sorted(found, key=lambda one: (len(one.claims), -one.tried))


def pair_rows(met: Met, claims: Sequence[Claim]) -> list[Row]:
    """A row for each pair of claims, and for each claim with itself: how many sets meet both."""
    together = met.T.astype(np.int64) @ met.astype(np.int64)
    return [
        {"claim": claims[a].key, "other": claims[b].key, "sets": int(together[a, b])}
        for a in range(len(claims))
        for b in range(a, len(claims))
    ]


def set_rows(sets: Sequence[SearchedSet], claims: Sequence[Claim], names: Sequence[str] = ()) -> list[Row]:
    """A row for each set: its name if it has one, its readings and quantities, what it meets, and its figures."""
    met = met_matrix(sets, claims)
    rows: list[Row] = []
    for number, one in enumerate(sets):
        values = quantities(parameters_of(one))
        rows.append(
            {
                **({"name": names[number]} if names else {}),
                **one.get("readings", USUAL),
                **{name: float(f"{value:.4g}") for name, value in values.items()},
                "claims_met": int(met[number].sum()),
                **{
                    claim.key: "" if figure is None else float(f"{figure:.6g}")
                    for claim, figure in zip(claims, one["figures"], strict=True)
                },
            }
        )
    return rows


def agreeing(met: Met) -> Met:
    """Which sets meet as many claims as the best one, but for NEARLY."""
    count = met.sum(axis=1)
    return np.asarray(count >= count.max() - NEARLY)


def ranges(sets: Sequence[SearchedSet]) -> Mapping[str, tuple[float, float]]:
    """Least and greatest value of every open parameter over some sets."""
    found = [quantities(parameters_of(one)) for one in sets]
    return {
        own.name: (min(one[own.name] for one in found), max(one[own.name] for one in found)) for own in OPEN_PARAMETERS
    }


def missed(figures: Sequence[float | None], claims: Sequence[Claim]) -> Iterator[Claim]:
    """The claims that a set does not meet."""
    for claim, figure in zip(claims, figures, strict=True):
        if figure is None or not claim.holds(figure):
            yield claim
