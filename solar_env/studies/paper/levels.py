"""Which statements on flexible panels are physics, which the mesh's, and which hang on the material's missing damping.

The paper's panels have six elements and no damping. Every claim on flexible panels is measured on them, with damping,
on a finer mesh, and on converged panels (modes) over two decades of damping.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solar_env.array import ArrayParameters
from solar_env.studies.paper.cases import simulate_case
from solar_env.studies.paper.claims import CLAIMS, Claim
from solar_env.support.markdown import markdown_table

MEMBERS = 3
STORE = "levels.jsonl"


@dataclass(frozen=True)
class PanelLevel:
    """Panels with a damping.

    Attributes:
        panels: what they consist of.
        damping: retardation time of the material [s].
    """

    panels: str
    damping: float

    @property
    def name(self) -> str:
        """The level in words."""
        return f"{self.panels}, " + (f"{self.damping:g} s" if self.damping else "undamped")


PAPER, DAMPED, FINER = (
    PanelLevel("6 elements", 0.0),
    PanelLevel("6 elements", 1e-5),
    PanelLevel("12 elements", 0.0),
)
CONVERGED = (
    PanelLevel("48 modes", 1e-6),
    PanelLevel("24 modes", 1e-5),
    PanelLevel("24 modes", 1e-4),
)
LEVELS = (PAPER, FINER, DAMPED, *CONVERGED)
FLEXIBLE_CLAIMS: tuple[Claim, ...] = tuple(claim for claim in CLAIMS if claim.on_flexible_panels)


def cells() -> Iterator[dict[str, Any]]:
    """Deployments to measure: a level and the member of an ensemble, those that are done soonest first."""
    for level in (*CONVERGED[1:], CONVERGED[0], PAPER, DAMPED, FINER):
        for member in range(MEMBERS):
            yield {"level": level.name, "member": member}


def measure(cell: Mapping[str, Any]) -> dict[str, float]:
    """Figures of all claims on flexible panels by key, of a cell.

    Raises:
        SimulationError: if a run cannot go on.
    """
    level = next(level for level in LEVELS if level.name == cell["level"])
    parameters = ArrayParameters.preset("paper").with_changes({"panel_damping": level.damping})
    needed = dict.fromkeys(case for claim in FLEXIBLE_CLAIMS for case in claim.cases)
    member = {case: simulate_case(case, parameters, cell["member"], level.panels) for case in needed}
    return {claim.key: claim.value(member) for claim in FLEXIBLE_CLAIMS}


def verdict(holds: Mapping[PanelLevel, bool]) -> str:
    """Name the cause of a claim, by the levels at which it holds: physics, mesh or missing damping."""
    converged = [holds[level] for level in CONVERGED]
    if all(converged):
        return "physics" if holds[PAPER] else "physics, but not on the paper's mesh"
    if any(converged):
        dampings = ", ".join(f"{level.damping:g} s" for level, held in zip(CONVERGED, converged, strict=True) if held)
        return f"physics, if the damping is {dampings}"
    if holds[DAMPED]:
        return "the mesh's"
    if holds[PAPER]:
        return "missing damping's" if holds[FINER] else "the mesh's, undamped"
    return "holds nowhere"


def as_markdown(results: Sequence[Mapping[str, Any]]) -> str:
    """A table of the claims by level from the results of all cells, in their order."""
    found: dict[str, list[Mapping[str, float]]] = {}
    for cell, result in zip(cells(), results, strict=True):
        found.setdefault(cell["level"], []).append(result)
    rows = []
    for claim in FLEXIBLE_CLAIMS:
        medians = {level: float(np.median([one[claim.key] for one in found[level.name]])) for level in LEVELS}
        holds = {level: claim.holds(value) for level, value in medians.items()}
        figures = [f"**{value:.3g}**" if holds[level] else f"{value:.3g}" for level, value in medians.items()]
        unit = f" [{claim.unit}]" if claim.unit else ""
        rows.append((claim.statement + unit, *figures, verdict(holds)))
    return markdown_table(("claim", *(level.name for level in LEVELS), "verdict"), rows)
