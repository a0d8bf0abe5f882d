"""Measurement of claims over an ensemble, and over the ranges of parameters that the paper leaves open."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from solar_env.array import ArrayParameters
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.paper.cases import MEMBERS, CaseRun, Changes, Value, is_flexible
from solar_env.studies.paper.claims import CLAIMS, Claim
from solar_env.support.markdown import markdown_table

# Values beside the defaults: of parameters that the paper leaves open, and of the sliding speed that sets the wear.
RANGES: Mapping[str, tuple[Value, ...]] = {
    "friction_sliding": ("centres", "places"),
    "cable_stiffness": (5.0, 10.0, 40.0, 80.0),
    "latch_stiffness": (300.0, 3e3, 1e4),
    "latch_damping": (1.0, 3.0, 30.0),
    "latch_gap": (0.003, 0.03),
    "contact_stiffness": (None,),  # by Eq 40
}
# Members at each value; a single one where flexible panels are needed, whose runs take long.
RANGE_MEMBERS = 3
Motions = Mapping[CaseRun, Trajectory]


@dataclass(frozen=True)
class Finding:
    """Verdict on a claim, with the figures it rests on.

    Attributes:
        claim: claim that is judged.
        median, least, greatest: statistics of the figure over the ensemble.
        agreeing: share of the members in which the claim holds.
        holds_for: by parameter that the paper leaves open, the values at which the claim holds; the default included.
        fails_for: likewise, the values at which the claim fails.
    """

    claim: Claim
    median: float
    least: float
    greatest: float
    agreeing: float
    holds_for: Mapping[str, Sequence[Value]]
    fails_for: Mapping[str, Sequence[Value]]

    @property
    def agrees(self) -> bool:
        """True if the claim holds for the median."""
        return self.claim.holds(self.median)


def planned_runs(claims: Sequence[Claim] = CLAIMS, members: int = MEMBERS) -> list[CaseRun]:
    """List all runs that the claims need, the longest first."""
    runs = [CaseRun(case, member) for claim in claims for case in claim.cases for member in range(members)]
    for claim in claims:
        for parameter in claim.open_parameters:
            for value in RANGES[parameter]:
                changes = ((parameter, value),)
                runs += [CaseRun(case, member, changes) for case in claim.cases for member in _range_members(claim)]
    return sorted(dict.fromkeys(runs), key=lambda run: not is_flexible(run.case))


def _range_members(claim: Claim) -> range:
    return range(1 if claim.on_flexible_panels else RANGE_MEMBERS)


def judge(claim: Claim, motions: Motions) -> Finding:
    """Measure a claim on the runs that `planned_runs` lists."""
    members = sorted({run.member for run in motions if run.case == claim.cases[0] and not run.changes})
    figures = _figures(claim, motions, members)
    median, preset = float(np.median(figures)), ArrayParameters.preset("paper")
    holds_for: dict[str, list[Value]] = {}
    fails_for: dict[str, list[Value]] = {}
    for parameter in claim.open_parameters:
        found = {getattr(preset, parameter): median}
        for value in RANGES[parameter]:
            varied = _figures(claim, motions, _range_members(claim), ((parameter, value),))
            found[value] = float(np.median(varied))
        # Numbers in their order, then names and None, by Eq 40.
        ordered = sorted(found, key=lambda value: (value if isinstance(value, float) else math.inf, str(value)))
        for values, holding in ((holds_for, True), (fails_for, False)):
            values[parameter] = [value for value in ordered if claim.holds(found[value]) == holding]
    agreeing = float(np.mean([claim.holds(figure) for figure in figures]))
    return Finding(claim, median, float(figures.min()), float(figures.max()), agreeing, holds_for, fails_for)


def _figures(claim: Claim, motions: Motions, members: Iterable[int], changes: Changes = ()) -> np.ndarray:
    """Return the figure of every member, with the preset or with changes of it."""
    return np.array(
        [claim.value({case: motions[CaseRun(case, member, changes)] for case in claim.cases}) for member in members]
    )


def as_json(findings: Iterable[Finding]) -> str:
    """Format the findings as JSON text; numbers that are not finite become null."""
    rows = []
    for one in findings:
        claim = one.claim
        row = {name: getattr(claim, name) for name in ("key", "statement", "paper", "unit", "low", "high")}
        row |= {name: getattr(one, name) for name in ("median", "least", "greatest", "agreeing", "agrees")}
        row = {name: None if isinstance(v, float) and not math.isfinite(v) else v for name, v in row.items()}
        row |= {"holds_for": one.holds_for, "fails_for": one.fails_for}
        rows.append({**row, "why": "" if one.agrees else claim.why, "by_construction": claim.by_construction})
    return json.dumps(rows, indent=1)


def summary(findings: Sequence[Finding]) -> str:
    """State in a sentence how many claims agree."""
    free = [finding for finding in findings if not finding.claim.by_construction]
    agreeing = sum(finding.agrees for finding in free)
    chosen = len(findings) - len(free)
    return (
        f"{agreeing} of {len(free)} claims agree ({agreeing / max(len(free), 1):.0%}); {chosen} more, of which "
        f"{sum(finding.agrees for finding in findings) - agreeing} agree, have had a parameter chosen for them."
    )


def as_markdown(findings: Sequence[Finding]) -> str:
    """Format the findings as a sentence and a table in Markdown."""
    columns = ("", "the paper says", "there", "here: median [least, greatest]", "agrees from, to", "")
    rows = []
    for one in findings:
        claim = one.claim
        values = f"{one.median:.4g} [{one.least:.4g}, {one.greatest:.4g}] {claim.unit}".strip()
        ends = [f"{end:.4g}" for end in (claim.low, claim.high)]
        interval = " to ".join(ends).replace("-inf to", "to")
        if claim.high == math.inf:
            interval = f"from {ends[0]}"
        rows.append((f"`{claim.key}`", claim.statement, claim.paper, values, interval, _verdict(one)))
    return f"{summary(findings)}\n\n{markdown_table(columns, rows)}"


def _verdict(finding: Finding) -> str:
    claim = finding.claim
    words = "agrees" if finding.agrees else ": ".join(filter(None, ("**differs**", claim.why)))
    if claim.by_construction:
        chosen = ", ".join(f"`{name}`" for name in claim.by_construction.split(", "))
        words += f" by construction: {chosen} chosen for it"
    if 0.0 < finding.agreeing < 1.0:
        words += f" ({finding.agreeing:.0%} of the runs agree)"
    places = []
    for parameter, held in finding.holds_for.items():
        failed = finding.fails_for[parameter]
        name = f"`{parameter}`"
        places.append(
            f"{name} {_listed(held)}, not {_listed(failed)}"
            if held and failed
            else f"{'every' if held else 'no'} {name}"
        )
    return "; holds at ".join(filter(None, (words, "; at ".join(places))))


def _listed(values: Iterable[Value]) -> str:
    return ", ".join("by Eq 40" if v is None else v if isinstance(v, str) else f"{v:g}" for v in values)
