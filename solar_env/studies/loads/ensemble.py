"""The ensemble: members at a level of the model, and at the finest one."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from solar_env.array import ArrayParameters, ModelLevel, ParameterFile
from solar_env.array.motorization import motorization
from solar_env.array.parameters.ranges import checked_ranges
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.failures import told
from solar_env.studies.common.motion import FINEST, Level
from solar_env.studies.loads.quantities import QUANTITIES, read_all
from solar_env.studies.loads.runs import deploy, member_parameters
from solar_env.studies.loads.statistics import Figure, figure_of
from solar_env.support.campaigns import Campaign, Cell

Array = NDArray[np.float64]

STORE = "loads.jsonl"
FINEST_OF_ELEMENTS = Level("flexible-clearance:12 elements", 10.0)
SPHERES, CYLINDER = "lankarani-nikravesh", "pereira"


@dataclass(frozen=True)
class LoadsPlan:
    """Question that an ensemble answers.

    Raises:
        ValueError: on construction, for a value out of range, or ideal joints, which tell nothing of impacts.
    """

    array: ParameterFile  # parameters, and what of them is drawn
    model: str = "flexible-clearance"  # the same members run at the finest level, too
    members: int = 16  # of each level
    window: float = 10.0  # simulated after the last latching [s]
    deadline: float = 60.0  # by which all joints must have latched [s]

    def __post_init__(self) -> None:
        if not ModelLevel.of(self.model).clearance:
            raise ValueError(
                f"model = {self.model!r} has ideal joints, which know no impacts; choose one with clearance"
            )
        if self.members < 1:
            raise ValueError(f"runs = {self.members!r} must be at least 1")
        for name in ("window", "deadline"):
            if not 0.0 < getattr(self, name) <= 1e4:
                raise ValueError(f"{name} = {getattr(self, name)!r} s must be positive and at most 10000")

    @cached_property
    def other_law(self) -> ParameterFile | None:
        """The array with a contact law of another geometry: of a cylinder in its bush, or of spheres.

        None where that law refuses it.
        """
        law = SPHERES if self.array.parameters.contact_law == CYLINDER else CYLINDER
        ranges = {name: pair for name, pair in self.array.randomize.items() if name != "contact_stiffness"}
        try:
            other = self.array.parameters.with_changes({"contact_law": law, "contact_stiffness": None})
            return ParameterFile(other, checked_ranges(other, ranges))
        except ValueError:
            return None

    @property
    def levels(self) -> tuple[Level, Level]:
        """The level chosen, and the finest one, of elements where the panels have fittings."""
        return Level(self.model), FINEST_OF_ELEMENTS if self.array.parameters.panel_masses else FINEST


def run_member(cell: Cell) -> dict[str, object]:
    """Quantities, spectra and warnings of a member at a level, or why it failed, as values that JSON keeps."""
    level = Level(cell["model"], cell["tighter"])
    nominal = ArrayParameters().with_changes(cell["parameters"])
    parameters = member_parameters(nominal, cell["randomize"], cell["member"])
    try:
        done = deploy(level, parameters, cell["member"], cell["window"], cell["deadline"])
    except SimulationError as error:
        values = "".join(f", {name} = {getattr(parameters, name)}" for name in cell["randomize"])
        return {"failed": {f"run {cell['member']} of {level.name}{values}": str(error)}}
    return {
        "latched": bool(np.isfinite(done.trajectory.latch_times).all()),
        "quantities": read_all(done),
        "hinge_spectrum": done.hinge_spectrum.tolist(),
        "hub_spectrum": done.hub_spectrum.tolist(),
        "warnings": list(done.warnings),
    }


@dataclass(frozen=True)
class Loads:
    """Answer of an ensemble."""

    plan: LoadsPlan
    figures: Mapping[str, tuple[Figure, ...]]  # quantity -> a figure for each joint, or one of the hub
    hinge_spectrum: Array  # (levels, members, f, joints) of members that latched
    hub_spectrum: Array  # (levels, members, f)
    unlatched: Sequence[int]  # members that did not latch by the deadline, of the level and of the finest one
    warnings: Mapping[str, int]  # text -> in how many runs the simulator said it
    failures: str  # which runs failed, and why; empty where none did
    form: tuple[Figure, ...]  # peak force by joint with another contact law, and this one's mean less its; else empty


def measure_loads(plan: LoadsPlan, folder: Path, workers: int, console: Console) -> Loads:
    """Run what is missing of the ensemble, going on where an earlier run of the same plan stopped.

    Raises:
        ValueError: if the folder holds another ensemble, or in no run all joints latch.
    """
    level, finest = plan.levels
    asked = [(level, plan.array), (finest, plan.array), *([(level, plan.other_law)] if plan.other_law else [])]
    cells = [
        {
            "model": level.model,
            "tighter": level.tighter,
            "member": member,
            "parameters": array.parameters.to_dict(),
            "randomize": dict(array.randomize),
            "window": plan.window,
            "deadline": plan.deadline,
        }
        for member in range(1, plan.members + 1)
        for level, array in asked
    ]
    campaign = Campaign(run_member, cells, folder / STORE)
    return gathered(plan, campaign.run_shown(workers, console, "deployments, at two levels, with two contact laws"))


def gathered(plan: LoadsPlan, results: list[dict[str, Any]]) -> Loads:
    """The figures of results, member by member: at the chosen level, at the finest, and with the other contact law.

    A member that failed in one of them is left out.

    Raises:
        ValueError: if in no run all joints latch, or too many have failed.
    """
    failed: dict[str, str] = {}
    for run in results:
        failed |= run.get("failed", {})
    failures, stride = told(failed, len(results)), 3 if plan.other_law else 2
    members = zip(*(results[k::stride] for k in range(stride)), strict=True)
    whole = [runs for runs in members if not any("failed" in run for run in runs)]
    levels = [runs[0] for runs in whole], [runs[1] for runs in whole]
    unlatched = [sum(not run["latched"] for run in runs) for runs in levels]
    if min(unlatched) == len(whole):
        stalled = [str(hinge) for hinge in motorization(plan.array.parameters) if hinge.stalls_at is not None]
        raise ValueError(
            f"in none of {plan.members} runs all joints latch within {plan.deadline:g} s; "
            f"{'; '.join(stalled) or 'give a longer --deadline, or stiffer springs'}"
        )
    figures = {}
    for name in QUANTITIES:
        level, finest = (np.array([run["quantities"][name] for run in runs], dtype=float) for runs in levels)
        figures[name] = tuple(figure_of(*values) for values in zip(level.T, finest.T, strict=True))
    both = [k for k in range(len(whole)) if levels[0][k]["latched"] and levels[1][k]["latched"]]
    hinge, hub = (
        np.array([[runs[k][name] for k in both] for runs in levels]) for name in ("hinge_spectrum", "hub_spectrum")
    )
    said = Counter(text for runs in whole for run in runs for text in run["warnings"])
    form: tuple[Figure, ...] = ()
    if plan.other_law:
        other, this = (np.array([runs[k]["quantities"]["peak_force"] for runs in whole], float) for k in (2, 0))
        form = tuple(figure_of(*values) for values in zip(other.T, this.T, strict=True))
    return Loads(plan, figures, hinge, hub, unlatched, said, failures, form)
