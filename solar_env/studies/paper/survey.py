"""Claims measured: over an ensemble, and over the ranges of parameters that the paper leaves open."""

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from solar_env.array import ArrayParameters
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.paper.cases import MEMBERS, CaseRun, is_flexible
from solar_env.studies.paper.claims import CLAIMS, Claim
from solar_env.support.markdown import markdown_table

Value = float | str | None

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


@dataclass(frozen=True)
class Finding:
    """Verdict on a claim, with the figures it rests on.

    Attributes:
        key, statement, paper, unit: of the claim.
        low, high: where it agrees.
        median, least, greatest: of the figure over the ensemble.
        agreeing: share of the members in which the claim holds.
        agrees: whether it holds for the median.
        holds_for: by parameter that the paper leaves open, the values at which it holds; the default's included.
        fails_for: the values at which it does not.
        why: if it differs: why.
        by_construction: parameters that have been chosen for it; empty where none have.
    """

    key: str
    statement: str
    paper: str
    unit: str
    low: float
    high: float
    median: float
    least: float
    greatest: float
    agreeing: float
    agrees: bool
    holds_for: Mapping[str, tuple[Value, ...]]
    fails_for: Mapping[str, tuple[Value, ...]]
    why: str
    by_construction: str


def planned_runs(claims: Sequence[Claim] = CLAIMS, members: int = MEMBERS) -> list[CaseRun]:
    """All runs that the claims need, the longest first."""
    cases = dict.fromkeys(case for claim in claims for case in claim.cases)
    runs = {CaseRun(case, member) for case in cases for member in range(members)}
    runs |= {run for claim in claims for run in _range_runs(claim)}
    order = {case: number for number, case in enumerate(cases)}
    return sorted(runs, key=lambda run: (not is_flexible(run.case), order[run.case], _where(run)))


def _where(run: CaseRun) -> tuple[str, str, int]:
    return run.parameter, str(run.value), run.member


def _range_members(claim: Claim) -> range:
    return range(1 if claim.on_flexible_panels else RANGE_MEMBERS)


def _range_runs(claim: Claim) -> Iterator[CaseRun]:
    for parameter in claim.open_parameters:
        for value in RANGES[parameter]:
            for member in _range_members(claim):
                for case in claim.cases:
                    yield CaseRun(case, member, parameter, value)


def judge(claim: Claim, motions: Mapping[CaseRun, Trajectory]) -> Finding:
    """Measure a claim on the runs that `planned_runs` lists.

    Raises:
        KeyError: if one of them is missing.
    """
    members = sorted({run.member for run in motions if run.case == claim.cases[0] and not run.parameter})
    figures = np.array([_figure(claim, motions, member) for member in members])
    median = float(np.median(figures))
    holds: dict[str, tuple[Value, ...]] = {}
    fails: dict[str, tuple[Value, ...]] = {}
    for parameter in claim.open_parameters:
        figure_at: dict[Any, float] = {getattr(ArrayParameters.preset("paper"), parameter): median}
        for value in RANGES[parameter]:
            found = [_figure(claim, motions, member, parameter, value) for member in _range_members(claim)]
            figure_at[value] = float(np.median(found))
        holds[parameter] = tuple(value for value in sorted(figure_at, key=_order) if claim.holds(figure_at[value]))
        fails[parameter] = tuple(sorted(figure_at.keys() - set(holds[parameter]), key=_order))
    agrees = claim.holds(median)
    return Finding(
        key=claim.key,
        statement=claim.statement,
        paper=claim.paper,
        unit=claim.unit,
        low=claim.low,
        high=claim.high,
        median=median,
        least=float(figures.min()),
        greatest=float(figures.max()),
        agreeing=float(np.mean([claim.holds(figure) for figure in figures])),
        agrees=agrees,
        holds_for=holds,
        fails_for=fails,
        why="" if agrees else claim.why,
        by_construction=claim.by_construction,
    )


def _figure(
    claim: Claim, motions: Mapping[CaseRun, Trajectory], member: int, parameter: str = "", value: Value = 0.0
) -> float:
    return claim.measure({case: motions[CaseRun(case, member, parameter, value)] for case in claim.cases})


def _order(value: Value) -> tuple[bool, float, str]:
    return (not isinstance(value, float), value if isinstance(value, float) else 0.0, str(value))


def as_json(findings: Iterable[Finding]) -> str:
    """The findings as JSON text; what is not finite becomes null."""

    def plain(value: Any) -> Any:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    rows = [{name: plain(value) for name, value in asdict(finding).items()} for finding in findings]
    return json.dumps(rows, indent=1)


def summary(findings: Sequence[Finding]) -> str:
    """How many claims agree, in a sentence."""
    free = [finding for finding in findings if not finding.by_construction]
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
        values = f"{_number(one.median)} [{_number(one.least)}, {_number(one.greatest)}] {one.unit}".strip()
        rows.append((f"`{one.key}`", one.statement, one.paper, values, _interval(one), _verdict(one)))
    return f"{summary(findings)}\n\n{markdown_table(columns, rows)}"


def _interval(finding: Finding) -> str:
    if math.isinf(finding.high):
        return f"from {_number(finding.low)}"
    if math.isinf(finding.low):
        return f"to {_number(finding.high)}"
    return f"{_number(finding.low)} to {_number(finding.high)}"


def _verdict(finding: Finding) -> str:
    words = "agrees" if finding.agrees else f"**differs**: {finding.why}"
    if finding.by_construction:
        chosen = ", ".join(f"`{name}`" for name in finding.by_construction.split(", "))
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
