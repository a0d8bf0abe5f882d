"""Ensemble of deployments at a chosen and at the finest model level, and with other contact laws."""

import contextlib
import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from solar_env.array import ArrayParameters, ModelLevel, ParameterFile
from solar_env.array.motorization import listed, motorization
from solar_env.array.parameters.ranges import Ranges, checked_ranges
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.failures import told
from solar_env.studies.common.motion import FINEST, Level
from solar_env.studies.loads.quantities import QUANTITIES, read_all
from solar_env.studies.loads.runs import deploy, member_parameters
from solar_env.studies.loads.sensitivity import Result, Sensitivity, one_at_a_time, regression, shifts
from solar_env.studies.loads.statistics import Figure, figure_of
from solar_env.support.campaigns import Campaign, Cell

Array = NDArray[np.float64]

STORE = "loads.jsonl"
COARSE, COARSE_OF_ELEMENTS = "flexible-clearance", "flexible-clearance:6 elements"  # model levels by default
FINEST_OF_ELEMENTS = Level("flexible-clearance:12 elements", 10.0)
# Contact laws of different geometry -> the bodies in contact.
GEOMETRIES = {
    "lankarani-nikravesh": "spheres",
    "pereira": "a cylinder in its bush",
    "bracket": "bracket and bush that deform more than the surfaces",
}


@dataclass(frozen=True)
class LoadsPlan:
    """Plan of an ensemble of deployments: the array, the model level, the number of runs, and when the runs end.

    A value out of range raises a ValueError, and so does a model with ideal joints, which have no impacts.
    """

    array: ParameterFile  # parameters, and ranges of sampled ones
    model: str | None = None  # model level; None for flexible panels, of elements if panels carry point masses
    members: int = 16  # number of members at each level
    window: float = 10.0  # time simulated after the last latching [s]
    deadline: float = 60.0  # time by which all joints must have latched [s]

    def __post_init__(self) -> None:
        model = self.levels[0].model
        if not ModelLevel.of(model).clearance:
            raise ValueError(f"model = {model!r} has ideal joints, which know no impacts; choose one with clearance")
        if self.members < 1:
            raise ValueError(f"runs = {self.members!r} must be at least 1")
        for name in ("window", "deadline"):
            if not 0.0 < getattr(self, name) <= 1e4:
                raise ValueError(f"{name} = {getattr(self, name)!r} s must be positive and at most 10000")

    @cached_property
    def forms(self) -> Mapping[str, ParameterFile]:
        """The array with alternative contact laws; keys name the bodies that a law assumes, such as "spheres".

        A law is left out if the array's parameters, or the ranges of sampled ones, are invalid with the law.
        """
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
        """Pairs (model level, parameters) that are simulated for every ensemble member, in this order.

        The array itself takes the chosen and the finest level; variants with other contact laws take the chosen one.
        """
        level, finest = self.levels
        return (level, self.array), (finest, self.array), *((level, form) for form in self.forms.values())

    def cell(self, level: Level, parameters: ArrayParameters, ranges: Ranges, member: int) -> Cell:
        """Return the arguments of one simulation, with the panel model and tolerance of `level`, as a record for JSON.

        Ensemble member 0 takes the `parameters`; other members replace the ones named in `ranges` by random samples.
        """
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
        """The chosen and the finest model level; panels that carry point masses need elements instead of modes."""
        fitted = self.array.parameters.panel_masses
        chosen, finest = (COARSE_OF_ELEMENTS, FINEST_OF_ELEMENTS) if fitted else (COARSE, FINEST)
        return Level(self.model or chosen), finest


def run_member(cell: Cell) -> dict[str, object]:
    """Simulate the run that `cell` describes; return quantities, spectra and warnings, or the failure, for JSON."""
    level = Level(cell["model"], cell["tighter"])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SimulationWarning)  # of parameters: the command has told of them
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
    """Results of an ensemble of deployments: statistics, shock spectra, warnings, failures and sensitivities."""

    plan: LoadsPlan
    figures: Mapping[str, tuple[Figure, ...]]  # quantity -> statistics for each joint, or one for the hub
    hinge_spectrum: Array  # (levels, members, f, joints) of members that latched at both levels
    hub_spectrum: Array  # (levels, members, f), likewise
    unlatched: Sequence[int]  # number of members not latched by the deadline, at the level and at the finest one
    warnings: Mapping[str, int]  # warning of the simulator -> number of runs with it
    failures: str  # runs that failed, with reasons; empty without failures
    forms: Mapping[str, tuple[Figure, ...]]  # other contact -> peak force by joint; model_error: own law minus this
    values: Mapping[str, Array]  # quantity -> (members, joints) values at the level, or (members, 1) of the hub
    sensitivity: Sensitivity  # by regression if parameters are drawn; otherwise empty until `measure_sensitivity`


def measure_loads(plan: LoadsPlan, folder: Path, workers: int, console: Console) -> Loads:
    """Simulate the ensemble on `workers` processes, and return its results; runs stored in `folder` are not repeated.

    Raise a ValueError if the folder holds another ensemble, or no run latches all joints.
    """
    cells = [
        plan.cell(level, array.parameters, array.randomize, member)
        for member in range(1, plan.members + 1)
        for level, array in plan.asked
    ]
    campaign = Campaign(run_member, cells, folder / STORE)
    return gathered(plan, campaign.run_shown(workers, console, "deployments, at two levels, with other contact laws"))


def measure_sensitivity(loads: Loads, folder: Path, workers: int, console: Console) -> Loads:
    """Simulate the array with one parameter shifted at a time; return `loads` with the changes that the shifts cause.

    Runs are stored in `folder`. Nothing is simulated if a regression on sampled parameters has given their effects.
    """
    plan = loads.plan
    if plan.array.randomize:
        return loads
    shifted = shifts(plan.array.parameters, plan.levels[0].model)
    cells = [plan.cell(plan.levels[0], array, {}, 0) for array in shifted.values()]
    campaign = Campaign(run_member, cells, folder / STORE)
    results = campaign.run_shown(workers, console, "deployments with one parameter shifted")
    return replace(loads, sensitivity=one_at_a_time(dict(zip(shifted, results, strict=True)), loads.values))


def check_latching(plan: LoadsPlan) -> None:
    """Simulate the array once with rigid panels, and raise a ValueError with the reason if a joint does not latch."""
    run = deploy(Level("rigid-clearance"), plan.array.parameters, 0, 0.1, plan.deadline)
    if not np.isfinite(run.trajectory.latch_times).all():
        raise ValueError(_never(plan, "in a first run with rigid panels not"))


def _never(plan: LoadsPlan, where: str) -> str:
    stalled = [hinge for hinge in motorization(plan.array.parameters) if hinge.stalls_at is not None]
    why = listed(stalled) or "give a longer --deadline, or stiffer springs"
    return f"{where} all joints latch within {plan.deadline:g} s; {why}"


def gathered(plan: LoadsPlan, results: Sequence[Result]) -> Loads:
    """Return an ensemble's statistics, shock spectra and sensitivities, computed from its runs' results.

    `results` hold each member's runs in turn: chosen level, finest, other contact laws. A failed run drops its member.
    Raise a ValueError if no run latches all joints, or too many runs have failed.
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
        raise ValueError(_never(plan, f"in none of {plan.members} runs"))
    figures, values = {}, {}
    for name in QUANTITIES:
        level, finest = (np.array([run["quantities"][name] for run in runs], dtype=float) for runs in levels)
        values[name] = level
        figures[name] = tuple(figure_of(*pair) for pair in zip(level.T, finest.T, strict=True))
    both = [k for k in range(len(whole)) if levels[0][k]["latched"] and levels[1][k]["latched"]]
    hinge, hub = (
        np.array([[runs[k][name] for k in both] for runs in levels]) for name in ("hinge_spectrum", "hub_spectrum")
    )
    said = Counter(text for runs in whole for run in runs for text in run["warnings"])
    this, _, *others = (np.array([runs[k]["quantities"]["peak_force"] for runs in whole], float) for k in range(stride))
    forms = {
        contact: tuple(figure_of(*pair) for pair in zip(other.T, this.T, strict=True))
        for contact, other in zip(plan.forms, others, strict=True)
    }
    drawn = [member_parameters(plan.array.parameters, plan.array.randomize, k) for k in members]
    ranges, unknown = plan.array.randomize, Sensitivity(False, {}, "no parameter has been shifted")
    sensitivity = regression(ranges, drawn, values) if ranges else unknown
    return Loads(plan, figures, hinge, hub, unlatched, said, failures, forms, values, sensitivity)
