"""Covering arrays: few combinations of options in which every two values meet."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

LEFT_OUT = object()


def pairwise(options: Mapping[str, Sequence[Any]]) -> Iterator[dict[str, Any]]:
    """Yield options with values, of which each may be left out, until every pair of values has been together.

    Greedy, as AETG is (D. M. Cohen et al., IEEE Trans. Software Eng. 23 (1997) 437): a pair that is missing, and then
    option by option the value that makes most missing pairs.
    """
    values = {name: (LEFT_OUT, *given) for name, given in options.items()}

    def pairs(one: tuple[str, Any], other: tuple[str, Any]) -> frozenset[tuple[str, int]]:
        return frozenset((name, values[name].index(value)) for name, value in (one, other))

    missing = {
        pairs((a, x), (b, y)): ((a, x), (b, y))
        for a, b in itertools.combinations(values, 2)
        for x, y in itertools.product(values[a], values[b])
    }
    while missing:
        row = dict(next(iter(missing.values())))
        for name in values:
            if name not in row:
                made = [sum(pairs((name, x), chosen) in missing for chosen in row.items()) for x in values[name]]
                row[name] = values[name][made.index(max(made))]
        for pair in itertools.combinations(row.items(), 2):
            missing.pop(pairs(*pair), None)
        yield {name: value for name, value in row.items() if value is not LEFT_OUT}
