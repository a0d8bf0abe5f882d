"""List of all stability maps, and simulation of a map's runs, whose outcomes are written to a table."""

from collections.abc import Callable
from pathlib import Path

from solar_env.studies.common.tables import provenance, write_table
from solar_env.studies.stability.friction_maps import FRICTION_MAP
from solar_env.studies.stability.impact_maps import IMPLICIT, RESTITUTION
from solar_env.studies.stability.maps import StabilityMap
from solar_env.studies.stability.step_maps import LATCH, STEP_CHANGE

ALL = (IMPLICIT, STEP_CHANGE, RESTITUTION, FRICTION_MAP, LATCH)
MAPS: dict[str, StabilityMap] = {one.name: one for one in ALL}


def measure_map(name: str, quick: bool, path: Path, progress: Callable[[], None]) -> None:
    """Simulate a map's runs (few if `quick`), and write its table to `path`; call `progress` after each run."""
    chosen, rows = MAPS[name], []
    for panel, x, y in chosen.cells(quick):
        rows.append(chosen.row(panel, x, y))
        progress()
    write_table(path, rows, provenance("solar-env study stability", map=name, quick=quick, **chosen.description()))
