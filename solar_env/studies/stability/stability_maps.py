"""Table of all maps of where methods fail, and measuring them into tables."""

from collections.abc import Callable
from pathlib import Path

from solar_env.studies.common.tables import provenance, write_table
from solar_env.studies.stability import (
    beam_maps,
    contact_law_maps,
    friction_maps,
    impact_maps,
    multiplier_maps,
    stop_maps,
)
from solar_env.studies.stability.maps import StabilityMap

COMMAND = "python -m solar_env stability"
MAPS: dict[str, StabilityMap] = {
    one.name: one
    for module in (impact_maps, multiplier_maps, beam_maps, contact_law_maps, friction_maps, stop_maps)
    for one in module.MAPS
}


def measure_map(name: str, quick: bool, path: Path, progress: Callable[[], None]) -> None:
    """Measure every cell of a map and write its table.

    Args:
        name: a key of MAPS.
        quick: few cells, or all.
        path: of the CSV file.
        progress: called after every cell.
    """
    chosen, rows = MAPS[name], []
    for panel, x, y in chosen.cells(quick):
        rows.append(chosen.row(panel, x, y))
        progress()
    made_by = provenance(COMMAND, map=name, quick=quick, **chosen.description())
    write_table(path, rows, made_by)
