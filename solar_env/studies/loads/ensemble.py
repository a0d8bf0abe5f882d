"""The ensemble: members at a level of the model, at the finest one, and with other contact laws; what changes it."""

import contextlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from solar_env.array import ArrayParameters, ModelLevel, ParameterFile
from solar_env.array.motorization import motorization
from solar_env.array.parameters.ranges import Ranges, checked_ranges
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.failures import told
from solar_env.studies.common.motion import FINEST, Level
from solar_env.studies.loads.quantities import QUANTITIES, read_all
from solar_env.studies.loads.runs import deploy, member_parameters
from solar_env.studies.loads.sensitivity import Result, Sensitivity, Shift, one_at_a_time, regression, shifts
from solar_env.studies.loads.statistics import Figure, figure_of
from solar_env.support.campaigns import Campaign, Cell

Array = NDArray[np.float64]

STORE = "loads.jsonl"
FINEST_OF_ELEMENTS = Level("flexible-clearance:12 elements", 10.0)
# Contact laws of different geometry -> what they are the contact of.
GEOMETRIES = {
    "lankarani-nikravesh": "spheres",
    "pereira": "a cylinder in its bush",
    "bracket": "bracket and bush that yield more than the surfaces",
}


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
    def forms(self) -> Mapping[str, ParameterFile]:
        """The array with the contact laws of other geometries, by what these are the contact of; not those refused."""
        own = self.array.parameters.contact_law
        own = own if own in GEOMETRIES else next(iter(GEOMETRIES))
        ranges = {name: pair for name, pair in self.array.randomize.items() if name != "contact_stiffness"}
        forms = {}
        for law, contact in GEOMETRIES.items():
            if law != own:
                with contextlib.suppress(ValueError):
                    other = self.array.parameters.with_changes({"contact_law": law, "contact_stiffness": None})
                    forms[contact] = ParameterFile(other, checked_ranges(other, ranges))
        return forms

    @property
    def asked(self) -> tuple[tuple[Level, ParameterFile], ...]:
        """Levels and arrays that every member runs: the level, the finest one, the level with other contact laws."""
        level, finest = self.levels
        return (level, self.array), (finest, self.array), *((level, form) for form in self.forms.values())

    def cell(self, level: Level, parameters: ArrayParameters, ranges: Ranges, member: int) -> Cell:
        """Cell of a run for `run_member`."""
        return {
            "model": level.model,
            "tighter": level.tighter,
            "member": member,
            "parameters": parameters.to_dict(),
            "randomize": dict(ranges),
            "window": self.window,
            "deadline": self.deadline,
        }

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
    forms: Mapping[str, tuple[Figure, ...]]  # contact -> peak force by joint, and this law's mean less its
    sensitivity: Sensitivity


def measure_loads(plan: LoadsPlan, folder: Path, workers: int, console: Console) -> Loads:
    """Run what is missing of the ensemble, going on where an earlier run of the same plan stopped.

    Raises:
        ValueError: if the folder holds another ensemble, or in no run all joints latch.
    """
    cells = [
        plan.cell(level, array.parameters, array.randomize, member)
        for member in range(1, plan.members + 1)
        for level, array in plan.asked
    ]
    shifted = {} if plan.array.randomize else shifts(plan.array.parameters, plan.model)
    singles = {key: plan.cell(plan.levels[0], array, {}, 0) for key, array in shifted.items()}
    campaign = Campaign(run_member, [*cells, *singles.values()], folder / STORE)
    results = campaign.run_shown(workers, console, "deployments, at two levels, with other contact laws")
    return gathered(plan, results[: len(cells)], dict(zip(singles, results[len(cells) :], strict=True)))


def gathered(plan: LoadsPlan, results: Sequence[Result], singles: Mapping[Shift | None, Result]) -> Loads:
    """The figures of results, member by member in the order of `LoadsPlan.asked`, and what changes them.

    A member that failed in one of them is left out. Singles are runs of the nominal array (None) and of shifted ones.

    Raises:
        ValueError: if in no run all joints latch, or too many have failed.
    """
    failed: dict[str, str] = {}
    for run in results:
        failed |= run.get("failed", {})
    failures, stride = told(failed, len(results)), len(plan.asked)
    members = dict(enumerate(zip(*(results[k::stride] for k in range(stride)), strict=True), start=1))
    members = {k: runs for k, runs in members.items() if not any("failed" in run for run in runs)}
    whole = list(members.values())
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
    this, _, *others = (np.array([runs[k]["quantities"]["peak_force"] for runs in whole], float) for k in range(stride))
    forms = {
        contact: tuple(figure_of(*values) for values in zip(other.T, this.T, strict=True))
        for contact, other in zip(plan.forms, others, strict=True)
    }
    values = {name: np.array([run["quantities"][name] for run in levels[0]], dtype=float) for name in QUANTITIES}
    drawn = [member_parameters(plan.array.parameters, plan.array.randomize, k) for k in members]
    if singles:
        sensitivity = one_at_a_time(singles, values)
    else:
        sensitivity = regression(plan.array.randomize, drawn, values)
    return Loads(plan, figures, hinge, hub, unlatched, said, failures, forms, sensitivity)
