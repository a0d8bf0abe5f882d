"""The result of a search in words and tables."""

from collections.abc import Iterator, Sequence

import numpy as np

from solar_env.studies.common.drawing import short
from solar_env.studies.paper.claims import CLAIMS, Claim
from solar_env.studies.paper.identification.exclusions import NEARLY, Met, agreeing, exclusions, front, missed, ranges
from solar_env.studies.paper.identification.open_parameters import OPEN_PARAMETERS, SLIDING, quantities
from solar_env.studies.paper.identification.search import (
    RANDOM_CELLS,
    RANDOM_SETS,
    RIGID_CLAIMS,
    SearchedSet,
    met_matrix,
    parameters_of,
)
from solar_env.studies.paper.identification.stages import Identification
from solar_env.support.markdown import markdown_table

TRIPLES, FLEXIBLE_PAIRS = 10, 10  # that the page lists
# N; greatest forces that the paper's Fig 10, and Figs 20 and 21, can be read as.
ABOUT_800, ABOUT_300 = (700.0, 900.0), 320.0


def as_markdown(found: Identification) -> str:
    """Counts, the best sets, what excludes what, ranges, and what the sets say of single questions."""
    met = met_matrix(found.rigid, RIGID_CLAIMS)
    whole = met_matrix(found.whole, CLAIMS)
    best = int(met.sum(axis=1).max())
    text = (
        f"{len(met)} sets were searched with rigid panels, {len(front(met))} of which no other betters; of "
        f"{len(RIGID_CLAIMS)} claims the best meets {best}. {len(whole)} sets were measured with flexible panels, too "
        f"(24 modes, damping 1e-06 s); of all {len(CLAIMS)} claims the best meets {int(whole.sum(axis=1).max())}, on "
        f"one run each. On the paper's mesh, medians of six runs, the best of the search and the named sets:\n\n"
    )
    return (
        text
        + _shortlist(found.shortlist)
        + "\n\nPairs of claims, on rigid panels, that no searched set meets together:\n\n"
        + _pairs(met)
        + f"\n\nPairs with a claim on flexible panels, of {len(whole)} sets:\n\n"
        + _flexible_pairs(whole)
        + "\n\nTriples of which any two are met together, but not all three, the best founded first:\n\n"
        + _triples(met)
        + f"\n\nRanges of the {int(agreeing(met).sum())} sets that meet at least {best - NEARLY} of these claims:\n\n"
        + _ranges(found.rigid, met)
        + "\n\nSingle questions:\n\n"
        + markdown_table(("question", "answer"), _answers(found.rigid, met))
    )


def _shortlist(shortlist: Sequence[SearchedSet]) -> str:
    rows = []
    for name, one in zip(shortlist_names(shortlist), shortlist, strict=True):
        apart = list(missed(one["figures"], CLAIMS))
        # A claim that a set misses counts, whatever has been chosen for it.
        total = sum(not claim.by_construction or claim in apart for claim in CLAIMS)
        count = total - len(apart)
        share = f"{count} of {total} ({count / total:.0%})"
        apart_keys = ", ".join(f"`{claim.key}`" for claim in apart)
        rows.append((name, f"{len(CLAIMS) - len(apart)} of {len(CLAIMS)}", share, apart_keys))
    return markdown_table(("set", "claims met", "without those that agree by construction", "differs in"), rows)


def shortlist_names(shortlist: Sequence[SearchedSet]) -> list[str]:
    """Names of the sets: numbers, or those of the named ones."""
    return [one.get("named", f"found {number + 1}") for number, one in enumerate(shortlist)]


def _pairs(met: Met) -> str:
    alone = met.sum(axis=0)
    rows = []
    for one in exclusions(met):
        if len(one.claims) == 2:
            a, b = one.claims
            rows.append((_keys(one.claims), f"{alone[a]}, {alone[b]}"))
    return markdown_table(("claims", "sets that meet either"), rows)


def _flexible_pairs(met: Met) -> str:
    pairs = [one for one in exclusions(met) if len(one.claims) == 2]
    flexible = [one for one in pairs if any(CLAIMS[claim] not in RIGID_CLAIMS for claim in one.claims)]
    alone = met.sum(axis=0)
    rows = [
        (_keys(one.claims, CLAIMS), ", ".join(str(alone[claim]) for claim in one.claims))
        for one in flexible[:FLEXIBLE_PAIRS]
    ]
    never = [claim.key for claim, count in zip(CLAIMS, alone, strict=True) if not count]
    names = ", ".join(f"`{key}`" for key in never)
    words = f"\n\nMet by none of these sets, which is no proof: {names}." if never else ""
    return markdown_table(("claims", "sets that meet either"), rows) + words


def _triples(met: Met) -> str:
    triples = [one for one in exclusions(met) if len(one.claims) == 3][:TRIPLES]
    rows = [(_keys(one.claims), str(one.tried)) for one in triples]
    return markdown_table(("claims", "sets that meet any two, at least"), rows)


def _keys(places: Sequence[int], claims: Sequence[Claim] = RIGID_CLAIMS) -> str:
    return " and ".join(f"`{claims[place].key}`" for place in places)


def _ranges(sets: Sequence[SearchedSet], met: Met) -> str:
    near = [sets[number] for number in np.flatnonzero(agreeing(met)).tolist()]
    found = ranges(near)
    rows = []
    for own in OPEN_PARAMETERS:
        low, high = found[own.name]
        rows.append(
            (
                f"`{own.name}` [{own.unit}]" if own.unit else f"`{own.name}`",
                f"{short(own.low)} to {short(own.high)}",
                f"{short(low)} to {short(high)}",
            )
        )
    readings = sorted({" and ".join(one["readings"].values()) for one in near})
    rows.append(("sliding and contact stiffness", "all six", "; ".join(readings)))
    return markdown_table(("parameter", "searched", "agreeing"), rows)


def _answers(sets: Sequence[SearchedSet], met: Met) -> Iterator[tuple[str, str]]:
    """Answers of the sets to single questions, each with the number of sets that it rests on."""
    figures = np.array([one["figures"] for one in sets], dtype=float)
    values = [quantities(parameters_of(one)) for one in sets]
    hinge, ratio = (np.array([one[name] for one in values]) for name in ("hinge_y", "cable_torque_ratio"))
    keys = [claim.key for claim in RIGID_CLAIMS]

    def figure(key: str) -> np.ndarray:
        return figures[:, keys.index(key)]

    def holds(key: str) -> np.ndarray:
        return met[:, keys.index(key)]

    def share(which: np.ndarray, of: np.ndarray) -> str:
        return f"{int((which & of).sum())} of {int(of.sum())}"

    on_time = holds("latch-1") & holds("latch-2")
    yield (
        "greatest lead of joint 1 where both latch on time",
        f"{1e3 * figure('lead')[on_time].max():.1f} ms ({on_time.sum()} sets)",
    )
    slope, middle = np.polyfit(hinge[on_time], ratio[on_time], 1)
    curve = ", ".join(f"{place:g}: {middle + slope * place:.2f}" for place in (-0.5, 0.0, 0.5))
    yield "torque ratio that latches on time, by `hinge_y`", curve
    double = np.abs(ratio - 2.0) < 0.1
    times = figure("latch-1")[double]
    yield (
        "joint 1 latches with a torque ratio of 1.9 to 2.1 at",
        f"{np.nanmin(times):.1f} to {np.nanmax(times):.1f} s ({double.sum()} sets)",
    )
    strong = (figure("peak") >= ABOUT_800[0]) & (figure("peak") <= ABOUT_800[1])
    small = figure("distribution-force") <= ABOUT_300
    limits = f"{ABOUT_800[0]:g} to {ABOUT_800[1]:g} N with equal clearances"
    yield f"models 1 and 2 at most {ABOUT_300:g} N, of the sets with {limits}", share(small, strong)
    for key, what in (("lock-torque-2", "under the greater lock torque"), ("stronger-2", "struck harder")):
        yield f"joint 2 {what}, of the sets with {limits}", share(holds(key), strong)
    yield (
        "bursts to the end, of the sets with models 1 and 2 below 300 N",
        share(holds("late-bursts"), holds("distribution-force")),
    )
    yield "bursts at the paper's times (1 in 40 by chance)", share(holds("burst-times"), np.ones(len(sets), dtype=bool))
    random = np.arange(len(sets)) < RANDOM_CELLS * RANDOM_SETS
    for sliding in SLIDING:
        own = random & np.array([one["readings"]["sliding"] == sliding for one in sets]) & np.isfinite(figure("peak"))
        yield (
            f"model 2 wears less at its worst joint; more evenly; both, sliding of {sliding}, of sets at random",
            "; ".join((share(holds("distribution-wear"), own), share(holds("distribution-evenness"), own),
                       share(holds("distribution-wear") & holds("distribution-evenness"), own))),
        )  # fmt: skip
