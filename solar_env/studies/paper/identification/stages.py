"""The stages of the identification: from random sets on rigid panels to ensembles of the best on the paper's mesh."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from solar_env.studies.paper.identification import search
from solar_env.studies.paper.identification.search import SearchedSet
from solar_env.support.campaigns import Campaign


@dataclass(frozen=True)
class Identification:
    """Findings of a search; sets as searched, or with the name of a named one.

    Attributes:
        rigid: sets with figures of RIGID_CLAIMS.
        whole: sets with figures of all CLAIMS, of fast panels.
        shortlist: sets with the members' median figures of all CLAIMS on the paper's mesh, the named ones last.
    """

    rigid: list[SearchedSet]
    whole: list[SearchedSet]
    shortlist: list[SearchedSet]


def identify(folder: Path, run: Callable[[Campaign, str], None]) -> Identification:
    """Search, stage by stage; `run` does what is missing of a campaign, whose results files in `folder` keep."""
    cells = list(search.broad_cells())

    def searched(description: str) -> list[Any]:
        campaign = Campaign(search.explore, cells, folder / search.STORE)
        run(campaign, description)
        return campaign.results()

    def measured(cells: list[dict[str, Any]], description: str) -> list[SearchedSet]:
        campaign = Campaign(search.measure_set, cells, folder / search.FLEXIBLE_STORE)
        run(campaign, description)
        results = zip(cells, campaign.results(), strict=True)
        return [{**search.place_of(cell), "figures": found} for cell, found in results]

    rigid = list(chain.from_iterable(searched("searches, rigid panels")))
    cells += search.refining_cells(rigid)
    rigid = list(chain.from_iterable(searched("searches from the best sets")))
    cells += search.aimed_cells(rigid)
    rigid = list(chain.from_iterable(searched("searches for pairs of claims")))
    whole = measured(list(search.candidate_cells(rigid)), "sets, flexible panels")
    for next_cells in (search.whole_cells, search.whole_aimed_cells):
        done = len(cells)
        cells += next_cells(whole)
        whole += chain.from_iterable(searched("searches, flexible panels")[done:])
    finalists = measured(list(search.finalist_cells(whole)), "finalists, the paper's mesh")
    members = measured(list(search.ensemble_cells(finalists)), "ensembles, the paper's mesh")
    each = search.SHORTLIST_MEMBERS
    shortlist = [_median(members[k : k + each]) for k in range(0, len(members), each)]
    return Identification(rigid, whole, shortlist)


def _median(members: Sequence[SearchedSet]) -> SearchedSet:
    figures = np.array([one["figures"] for one in members], dtype=float)
    medians = [None if math.isnan(value) else float(value) for value in np.median(figures, axis=0)]
    return {**members[0], "figures": medians}
