"""Maps of peak force and of the deepest wear over parameters of the design, an ensemble in every cell."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from solar_env.array import ArrayParameters
from solar_env.studies.common.levels import Level
from solar_env.studies.common.tables import Row, provenance, write_table
from solar_env.support.campaigns import Campaign, Cell, Workers

FILE = "design.csv"
STORE = "design.jsonl"
MODEL = "rigid-clearance"
DURATION = 30.0  # s
JOINTS = 2


@dataclass(frozen=True)
class DesignMap:
    """A map over two design quantities.

    Attributes:
        x, y: their names, with units.
        x_values, y_values: in SI units.
        marked: points of the map that the paper compares.
    """

    x: str
    y: str
    x_values: tuple[float, ...]
    y_values: tuple[float, ...]
    marked: tuple[tuple[float, float], ...] = ()


_CLEARANCES = (5e-5, 1e-4, 1.5e-4, 2e-4, 3e-4, 5e-4)
MAPS: Mapping[str, DesignMap] = {
    "clearances": DesignMap(
        "clearance 1 [m]", "clearance 2 [m]", _CLEARANCES, _CLEARANCES, marked=((1e-4, 2e-4), (2e-4, 1e-4))
    ),
    "stiffnesses": DesignMap(
        "latch stiffness [N m/rad]", "cable stiffness [N m/rad]", (100.0, 300.0, 1e3, 3e3, 1e4),
        (5.0, 10.0, 20.0, 40.0, 80.0),
    ),
}  # fmt: skip


def changes(name: str, x: float, y: float) -> dict[str, Any]:
    """Parameters that a point of a map changes."""
    if name == "clearances":
        return {"clearance": (x, y)}
    return {"latch_stiffness": x, "cable_stiffness": y}


def measure_cell(cell: Cell) -> dict[str, list[list[float]]]:
    """Wear and forces of the ensemble of a cell, which is preset, map, x, y and number of members.

    Returns:
        (members, joints) lists: deepest wear of bearing or journal [m], greatest contact force after the first
        latching [N].

    Raises:
        SimulationError: if a run cannot go on.
    """
    parameters = ArrayParameters.preset(cell["preset"]).with_changes(changes(cell["map"], cell["x"], cell["y"]))
    wear, force = [], []
    for member in range(cell["members"]):
        motion = Level(MODEL).deploy(parameters, member, DURATION, output_step=DURATION)
        wear.append(motion.wear_depth.tolist())
        force.append(motion.postlock_peak_force.tolist())
    return {"wear_m": wear, "force_N": force}


def measure_design(preset: str, members: int, workers: Workers, folder: Path, console: Console) -> Path:
    """Measure both maps, going on where an earlier run of the same maps stopped; returns the table's file.

    Raises:
        ValueError: if the folder holds maps of other settings or code.
        SimulationError: if a run cannot go on.
    """
    cells = [
        {"preset": preset, "map": name, "x": x, "y": y, "members": members}
        for name, design in MAPS.items()
        for y in design.y_values
        for x in design.x_values
    ]
    settings = {"parameters": ArrayParameters.preset(preset).to_dict(), "model": MODEL, "duration": DURATION}
    campaign = Campaign(measure_cell, cells, folder / STORE, settings)
    results = campaign.run_shown(workers, console, "cells of the maps")
    rows = [_row(cell, result) for cell, result in zip(cells, results, strict=True)]
    table = folder / FILE
    write_table(table, rows, provenance("design", preset=preset, members=members, model=MODEL))
    return table


def _row(cell: Mapping[str, Any], result: Mapping[str, Any]) -> Row:
    """Medians of the worse joint and of each, with the quartiles of the worse one."""
    row: Row = {"map": cell["map"], "x": cell["x"], "y": cell["y"]}
    for name in ("wear_m", "force_N"):
        figures = np.array(result[name])
        low, median, high = np.quantile(figures.max(axis=1), (0.25, 0.5, 0.75)).tolist()
        row |= {name: median, f"{name}_low": low, f"{name}_high": high}
        row |= {f"{name}_joint_{j + 1}": float(np.median(figures[:, j])) for j in range(JOINTS)}
    return row
