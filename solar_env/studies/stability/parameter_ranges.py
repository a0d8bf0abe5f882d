"""Ranges of the parameters: runs with each varied over eight decades, and whether they end well, warned or stopped."""

import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from solar_env.array import ArrayParameters, build, default_integrator
from solar_env.array.parameters.checks import UnitWarning
from solar_env.mechanics.running.diagnosis import LARGEST_ENERGY_SHARE
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.common.tables import Row, provenance, write_table
from solar_env.studies.stability.maps import Finding, Kind, Said, listen

FACTORS = tuple(10.0**decade for decade in range(-4, 5))
MODELS = ("rigid-clearance", "flexible-clearance")
DURATION = 15.0  # s; the default array latches after 12.3 s
MAX_STEPS = 500_000
# Base values of the decades in SI units, for parameters whose default is zero or follows from other parameters.
COUNTED_FROM = {
    "hinge_y": 0.5, "panel_area_mass": 4.0, "panel_bending_stiffness": 200.0, "fold_angle": 1.5, "lock_angle": 1.5,
    "release_time": 1.0, "hinge_damping": 0.1, "hinge_friction_torque": 0.01, "hinge_friction_rate": 0.01,
    "cable_torque_ratio": 1.0, "gravity": 9.81, "offloading_share": 0.5, "offloading_friction": 0.01,
    "initial_spin": 0.01, "initial_rate": 0.01,
}  # fmt: skip
_GROUND: dict[str, Any] = {"body_fixed": True, "gravity": 9.81, "offloading_share": 1.0}
_BRACKET: dict[str, Any] = {"contact_law": "bracket", "contact_stiffness": None}
# Parameter -> values of other parameters without which the parameter has no effect.
BESIDE: dict[str, dict[str, Any]] = {
    "hinge_friction_rate": {"hinge_friction_torque": 0.01}, "bracket_stiffness": _BRACKET,
    "gravity": _GROUND, "offloading_share": _GROUND, "offloading_friction": _GROUND,
}  # fmt: skip
NAMES = tuple(name for name in vars(ArrayParameters()) if name in ArrayParameters.CONTINUOUS)
FINE, WARNED, STOPPED, REFUSED, SILENT = "fine", "warned", "stopped", "refused", "silent failure"


def scaled(name: str, factor: float = 1.0) -> tuple[float, ...]:
    """Return `factor` times a parameter's base value: a tuple of one number, or of a number for each joint."""
    value: Any = COUNTED_FROM.get(name, getattr(ArrayParameters(), name))
    return tuple(factor * entry for entry in (value if isinstance(value, tuple) else (float(value),)))


def trial(name: str, factor: float, model: str, duration: float = DURATION) -> Row:
    """Simulate a deployment with parameter `name` scaled by `factor`; return a table row with outcome and message."""
    values = scaled(name, factor)
    change: dict[str, Any] = {**BESIDE.get(name, {}), name: values if len(values) > 1 else values[0]}

    def deployed() -> Simulation:
        # This study tests unusual values on purpose.
        warnings.simplefilter("ignore", UnitWarning)
        method = replace(default_integrator(model), max_steps=MAX_STEPS)
        simulation = Simulation(build(ArrayParameters(**change), model), method)
        simulation.advance(duration)
        simulation.check()
        return simulation

    def judge(simulation: Simulation) -> Finding:
        residual, turnover = simulation.energy_book()
        return Finding(Kind.FINE if abs(residual) <= LARGEST_ENERGY_SHARE * turnover else Kind.WRONG, residual)

    cell = listen(deployed, judge)
    ends = {Said.ERROR: STOPPED, Said.WARNING: WARNED, Said.SILENT: FINE if cell.kind == Kind.FINE else SILENT}
    ended = REFUSED if cell.kind == Kind.REFUSED else ends[cell.said]
    row: Row = {"parameter": name, "model": model, "factor": factor, "value": values[0]}
    return {**row, "class": ended, "message": " ".join(cell.message.split())}


def measure(path: Path, tick: Callable[[], object]) -> None:
    """Simulate deployments with one parameter at a time multiplied by one of FACTORS; write outcomes to `path` (CSV).

    The runs cover all combinations of model, parameter and factor. `tick` is called after each run.
    """
    rows = []
    for name in NAMES:
        for model in MODELS:
            for factor in FACTORS:
                rows.append(trial(name, factor, model))
                tick()
    write_table(path, rows, provenance("solar-env study stability --only parameters", duration_s=DURATION))
