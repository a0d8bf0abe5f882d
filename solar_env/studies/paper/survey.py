"""Test of the paper's claims by an ensemble of runs, and by runs with other values of parameters it leaves open."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from solar_env.array import ArrayParameters
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.common.tables import Row
from solar_env.studies.paper.cases import MEMBERS, CaseRun, Changes, Value, is_flexible
from solar_env.studies.paper.claims import CLAIMS, Claim
from solar_env.support.markdown import markdown_table

# Values tested beside the defaults, of the parameters that the paper leaves open and of the wear's sliding speed.
RANGES: Mapping[str, tuple[Value, ...]] = {
    "friction_sliding": ("centres", "places"),
    "cable_stiffness": (5.0, 10.0, 40.0, 80.0),
    "latch_stiffness": (300.0, 3e3, 1e4),
    "latch_damping": (1.0, 3.0, 30.0),
    "latch_gap": (0.003, 0.03),
    "contact_stiffness": (None,),  # by Eq 40
}
# Ensemble members at each value; a claim on flexible panels, whose runs take long, uses a single member.
RANGE_MEMBERS = 3
Motions = Mapping[CaseRun, Trajectory]


@dataclass(frozen=True)
class Finding:
    """Verdict on a claim, with the measured values behind the verdict.

    Attributes:
        claim: claim that is judged.
        median, least, greatest: statistics of the claim's quantity over the ensemble.
        agreeing: fraction of the ensemble members in which the claim holds.
        holds_for: parameter that the paper leaves open -> tested values at which the claim holds.
        fails_for: the same parameters -> the other tested values. The `paper` preset's value is among the tested ones.
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
        """True if the claim holds for the ensemble's median."""
        return self.claim.holds(self.median)


def planned_runs(members: int = MEMBERS) -> list[CaseRun]:
    """Return all runs that the claims need, first the runs with flexible panels, which take longest.

    Each deployment has `members` runs, and up to RANGE_MEMBERS for every other value of a parameter that is left open.
    """
    runs = [CaseRun(case, member) for claim in CLAIMS for case in claim.cases for member in range(members)]
    for claim in CLAIMS:
        for parameter in claim.open_parameters:
            for value in RANGES[parameter]:
                changes = ((parameter, value),)
                runs += [CaseRun(case, member, changes) for case in claim.cases for member in _range_members(claim)]
    return sorted(dict.fromkeys(runs), key=lambda run: not is_flexible(run.case))


def _range_members(claim: Claim) -> range:
    return range(1 if claim.on_flexible_panels else RANGE_MEMBERS)


def judge(claim: Claim, motions: Motions) -> Finding:
    """Return the `Finding`, the verdict on a claim; `motions` maps runs from `planned_runs` to their trajectories."""
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
        # Sort numbers first, then names and None (stiffness by Eq 40).
        ordered = sorted(found, key=lambda value: (value if isinstance(value, float) else math.inf, str(value)))
        for values, holding in ((holds_for, True), (fails_for, False)):
            values[parameter] = [value for value in ordered if claim.holds(found[value]) == holding]
    agreeing = float(np.mean([claim.holds(figure) for figure in figures]))
    return Finding(claim, median, float(figures.min()), float(figures.max()), agreeing, holds_for, fails_for)


def _figures(claim: Claim, motions: Motions, members: Iterable[int], changes: Changes = ()) -> np.ndarray:
    """Return the claim's quantity for each ensemble member, from its runs in `motions` with `changes` to the preset."""
    return np.array(
        [claim.value({case: motions[CaseRun(case, member, changes)] for case in claim.cases}) for member in members]
    )


def as_rows(findings: Iterable[Finding]) -> list[Row]:
    """Return the findings as table rows; the column `holds_at` has the parameter values at which the claim holds."""
    rows: list[Row] = []
    for one in findings:
        claim = one.claim
        row = {name: getattr(claim, name) for name in ("key", "statement", "paper", "unit", "low", "high")}
        row |= {name: getattr(one, name) for name in ("median", "least", "greatest", "agreeing")}
        row |= {"agrees": "yes" if one.agrees else "no", "holds_at": _places(one)}
        rows.append({**row, "why": "" if one.agrees else claim.why, "by_construction": claim.by_construction})
    return rows


def summary(findings: Sequence[Finding]) -> str:
    """Return a text on how many of the paper's claims our simulations confirm; a `Finding` is the verdict on a claim.

    The second sentence counts the claims that parameters were chosen to meet.
    """
    free = [finding for finding in findings if not finding.claim.by_construction]
    agreeing = sum(finding.agrees for finding in free)
    chosen = len(findings) - len(free)
    return (
        f"{agreeing} of {len(free)} claims agree ({agreeing / max(len(free), 1):.0%}). Parameters were chosen to meet "
        f"{chosen} more claims, of which {sum(finding.agrees for finding in findings) - agreeing} agree."
    )


def as_markdown(findings: Sequence[Finding]) -> str:
    """Return a Markdown table of the claims that disagree; claims that disagree for the same reason share a row."""
    by_reason: dict[str, list[Finding]] = {}
    for one in findings:
        if not one.agrees:
            by_reason.setdefault(one.claim.why or one.claim.key, []).append(one)
    rows = [
        (
            ", ".join(f"`{one.claim.key}`" for one in group),
            # Statements that share a reason share what stands before the colon.
            "; ".join([group[0].claim.statement, *(one.claim.statement.rpartition(": ")[2] for one in group[1:])]),
            "; ".join(dict.fromkeys(one.claim.paper for one in group)),
            "; ".join(f"{one.median:.4g} {one.claim.unit}".strip() for one in group),
            group[0].claim.why,
        )
        for group in by_reason.values()
    ]
    columns = ("claim", "the paper says", "there", "here, median", "why it differs")
    return markdown_table(columns, rows)


def _places(finding: Finding) -> str:
    """Return a text such as "latch_gap 0.003, 0.01, not 0.03" for each parameter that the paper leaves open.

    The claim holds at the values before "not". "every latch_gap" or "no latch_gap" says that it always or never holds.
    """
    places = []
    for name, held in finding.holds_for.items():
        failed = finding.fails_for[name]
        some = f"{name} {_listed(held)}, not {_listed(failed)}"
        places.append(some if held and failed else f"{'every' if held else 'no'} {name}")
    return "; ".join(places)


def _listed(values: Iterable[Value]) -> str:
    return ", ".join("by Eq 40" if v is None else v if isinstance(v, str) else f"{v:g}" for v in values)
