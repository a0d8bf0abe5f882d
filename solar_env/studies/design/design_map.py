"""Maps of peak force and of the deepest wear over parameters of the design, an ensemble in every cell."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from solar_env.array import ArrayParameters
from solar_env.studies.common.motion import Level
from solar_env.studies.common.tables import Row
from solar_env.support.campaigns import Campaign, Cell

FILE = "design.csv"
STORE = "design.jsonl"
MODEL = "rigid-clearance"
DURATION = 30.0  # s


@dataclass(frozen=True)
class DesignMap:
    """A map over two design quantities."""

    x: str  # with its unit
    y: str
    x_values: tuple[float, ...]  # in SI units
    y_values: tuple[float, ...]
    changes: Callable[[float, float], Mapping[str, object]]  # of parameters
    marked: tuple[tuple[float, float], ...] = ()  # points that the paper compares


_CLEARANCES = (5e-5, 1e-4, 1.5e-4, 2e-4, 3e-4, 5e-4)
MAPS: Mapping[str, DesignMap] = {
    "clearances": DesignMap(
        "clearance 1 [m]",
        "clearance 2 [m]",
        _CLEARANCES,
        _CLEARANCES,
        lambda x, y: {"clearance": (x, y)},
        marked=((1e-4, 2e-4), (2e-4, 1e-4)),
    ),
    "stiffnesses": DesignMap(
        "latch stiffness [N m/rad]",
        "cable stiffness [N m/rad]",
        (100.0, 300.0, 1e3, 3e3, 1e4),
        (5.0, 10.0, 20.0, 40.0, 80.0),
        lambda x, y: {"latch_stiffness": x, "cable_stiffness": y},
    ),
}


def measure_cell(cell: Cell) -> dict[str, list[list[float]]]:
    """Wear and forces of the ensemble of a cell, which is preset, map, x, y and number of members.

    Returns:
        (members, joints) lists: deepest wear of bearing or journal [m], greatest contact force after the first
        latching [N].
    """
    changes = MAPS[cell["map"]].changes(cell["x"], cell["y"])
    parameters = ArrayParameters.preset(cell["preset"]).with_changes(changes)
    runs = [Level(MODEL).deploy(parameters, member, DURATION, DURATION) for member in range(cell["members"])]
    return {
        "wear_m": [run.wear_depth.tolist() for run in runs],
        "force_N": [run.postlock_peak_force.tolist() for run in runs],
    }


def measure_design(preset: str, members: int, workers: int, folder: Path, console: Console) -> list[Row]:
    """Measure both maps, going on where an earlier run of the same maps stopped; returns a row for each cell.

    Raises:
        ValueError: if the folder holds maps of other settings or code.
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
    return [_row(cell, result) for cell, result in zip(cells, results, strict=True)]


def _row(cell: Cell, result: Mapping[str, list[list[float]]]) -> Row:
    """Medians of the worse joint and of each, with the quartiles of the worse one."""
    row: Row = {"map": cell["map"], "x": cell["x"], "y": cell["y"]}
    for name in ("wear_m", "force_N"):
        figures = np.array(result[name])
        low, median, high = np.quantile(figures.max(axis=1), (0.25, 0.5, 0.75)).tolist()
        row |= {name: median, f"{name}_low": low, f"{name}_high": high}
        row |= {f"{name}_joint_{j}": value for j, value in enumerate(np.median(figures, axis=0).tolist(), start=1)}
    return row
