"""Claims measured: over an ensemble, and over the ranges of parameters that the paper leaves open."""

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solar_env.array import ArrayParameters
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.paper.cases import MEMBERS, CaseRun, Changes, Value, is_flexible
from solar_env.studies.paper.claims import CLAIMS, Claim
from solar_env.support.markdown import markdown_table

# Of parameters that the paper leaves open, besides their defaults; and of the sliding speed, which wear hangs on.
RANGES: Mapping[str, tuple[Value, ...]] = {
    "friction_sliding": ("centres", "places"),
    "cable_stiffness": (5.0, 10.0, 40.0, 80.0),
    "latch_stiffness": (300.0, 3e3, 1e4),
    "latch_damping": (1.0, 3.0, 30.0),
    "latch_gap": (0.003, 0.03),
    "contact_stiffness": (None,),  # of Eq 40
}
# Members at each value; one where flexible panels, whose runs take long, are needed.
RANGE_MEMBERS = 3
Motions = Mapping[CaseRun, Trajectory]


@dataclass(frozen=True)
class Finding:
    """Verdict on a claim, with the figures it rests on.

    Attributes:
        claim: what is judged.
        median, least, greatest: of the figure over the ensemble.
        agreeing: share of the members in which the claim holds.
        holds_for: by parameter that the paper leaves open, the values at which it holds; the default's included.
        fails_for: the values at which it does not.
    """

    claim: Claim
    median: float
    least: float
    greatest: float
    agreeing: float
    holds_for: Mapping[str, tuple[Value, ...]]
    fails_for: Mapping[str, tuple[Value, ...]]

    @property
    def agrees(self) -> bool:
        """Whether the claim holds for the median."""
        return self.claim.holds(self.median)


def planned_runs(claims: Sequence[Claim] = CLAIMS, members: int = MEMBERS) -> list[CaseRun]:
    """All runs that the claims need, the longest first."""
    runs = [CaseRun(case, member) for claim in claims for case in claim.cases for member in range(members)]
    for claim in claims:
        for changes in _range_changes(claim):
            runs += [CaseRun(case, member, changes) for case in claim.cases for member in _range_members(claim)]
    return sorted(dict.fromkeys(runs), key=lambda run: not is_flexible(run.case))


def _range_members(claim: Claim) -> range:
    return range(1 if claim.on_flexible_panels else RANGE_MEMBERS)


def _range_changes(claim: Claim) -> Iterator[Changes]:
    for parameter in claim.open_parameters:
        for value in RANGES[parameter]:
            yield ((parameter, value),)


def judge(claim: Claim, motions: Motions) -> Finding:
    """Measure a claim on the runs that `planned_runs` lists.

    Raises:
        KeyError: if one of them is missing.
    """
    members = sorted({run.member for run in motions if run.case == claim.cases[0] and not run.changes})
    figures = _figures(claim, motions, members)
    median = float(np.median(figures))
    preset = ArrayParameters.preset("paper")
    at = {parameter: {getattr(preset, parameter): median} for parameter in claim.open_parameters}
    for changes in _range_changes(claim):
        ((parameter, value),) = changes
        at[parameter][value] = float(np.median(_figures(claim, motions, _range_members(claim), changes)))

    def values(holding: bool) -> dict[str, tuple[Value, ...]]:
        return {
            parameter: tuple(value for value in sorted(found, key=_order) if claim.holds(found[value]) == holding)
            for parameter, found in at.items()
        }

    return Finding(
        claim=claim,
        median=median,
        least=float(figures.min()),
        greatest=float(figures.max()),
        agreeing=float(np.mean([claim.holds(figure) for figure in figures])),
        holds_for=values(holding=True),
        fails_for=values(holding=False),
    )


def _figures(claim: Claim, motions: Motions, members: Iterable[int], changes: Changes = ()) -> np.ndarray:
    """The figure of every member, of the preset or with changes."""
    return np.array(
        [claim.value({case: motions[CaseRun(case, member, changes)] for case in claim.cases}) for member in members]
    )


def _order(value: Value) -> tuple[bool, float, str]:
    return (not isinstance(value, float), value if isinstance(value, float) else 0.0, str(value))


def as_json(findings: Iterable[Finding]) -> str:
    """The findings as JSON text; what is not finite becomes null."""

    def plain(value: float) -> float | None:
        return value if math.isfinite(value) else None

    rows = []
    for one in findings:
        claim = one.claim
        row: dict[str, Any] = {name: getattr(claim, name) for name in ("key", "statement", "paper", "unit")}
        row |= {"low": plain(claim.low), "high": plain(claim.high)}
        row |= {name: plain(getattr(one, name)) for name in ("median", "least", "greatest", "agreeing")}
        row |= {"agrees": one.agrees, "holds_for": one.holds_for, "fails_for": one.fails_for}
        rows.append({**row, "why": "" if one.agrees else claim.why, "by_construction": claim.by_construction})
    return json.dumps(rows, indent=1)


def summary(findings: Sequence[Finding]) -> str:
    """How many claims agree, in a sentence."""
    free = [finding for finding in findings if not finding.claim.by_construction]
    agreeing = sum(finding.agrees for finding in free)
    chosen = len(findings) - len(free)
    return (
        f"{agreeing} of {len(free)} claims agree ({agreeing / max(len(free), 1):.0%}); {chosen} more, of which "
        f"{sum(finding.agrees for finding in findings) - agreeing} agree, have had a parameter chosen for them."
    )


def as_markdown(findings: Sequence[Finding]) -> str:
    """The findings as a sentence and a table in Markdown."""
    columns = ("", "the paper says", "there", "here: median [least, greatest]", "agrees from, to", "")
    rows = []
    for one in findings:
        claim = one.claim
        values = f"{_number(one.median)} [{_number(one.least)}, {_number(one.greatest)}] {claim.unit}".strip()
        rows.append((f"`{claim.key}`", claim.statement, claim.paper, values, _interval(claim), _verdict(one)))
    return f"{summary(findings)}\n\n{markdown_table(columns, rows)}"


def _interval(claim: Claim) -> str:
    if math.isinf(claim.high):
        return f"from {_number(claim.low)}"
    if math.isinf(claim.low):
        return f"to {_number(claim.high)}"
    return f"{_number(claim.low)} to {_number(claim.high)}"


def _verdict(finding: Finding) -> str:
    claim = finding.claim
    words = "agrees" if finding.agrees else ": ".join(filter(None, ("**differs**", claim.why)))
    if claim.by_construction:
        chosen = ", ".join(f"`{name}`" for name in claim.by_construction.split(", "))
        words += f" by construction: {chosen} chosen for it"
    if 0.0 < finding.agreeing < 1.0:
        words += f" ({finding.agreeing:.0%} of the runs agree)"
    everywhere: list[str] = []
    nowhere: list[str] = []
    for parameter, held in finding.holds_for.items():
        failed = finding.fails_for[parameter]
        if held and failed:
            words += f"; holds for `{parameter}` {_listed(held)}, not {_listed(failed)}"
        else:
            (everywhere if held else nowhere).append(f"`{parameter}`")
    if everywhere:
        words += f"; holds for every tested {', '.join(everywhere)}"
    if nowhere:
        words += f"; for no tested {', '.join(nowhere)}"
    return words


def _listed(values: Iterable[Value]) -> str:
    return ", ".join("by Eq 40" if v is None else v if isinstance(v, str) else f"{v:g}" for v in values)


def _number(value: float) -> str:
    return f"{value:.4g}"
