"""Table of all maps of where methods fail, and measuring them into tables."""

from collections.abc import Callable
from pathlib import Path

from solar_env.studies.common.tables import provenance, write_table
from solar_env.studies.stability.beam_maps import BEAM_STEP
from solar_env.studies.stability.contact_law_maps import PULL_OFF, RESTITUTION
from solar_env.studies.stability.friction_maps import CREEP, STEP
from solar_env.studies.stability.impact_maps import EXPLICIT, IMPLICIT
from solar_env.studies.stability.maps import StabilityMap
from solar_env.studies.stability.modal_maps import DEPLOYMENT, RANGE
from solar_env.studies.stability.multiplier_maps import STEP_CHANGE
from solar_env.studies.stability.stop_maps import CABLE, DEPTH, LATCH

COMMAND = "solar-env study stability"
ALL = (
    IMPLICIT, EXPLICIT, STEP_CHANGE, BEAM_STEP, RESTITUTION, PULL_OFF, CREEP, STEP, CABLE, LATCH, DEPTH, RANGE,
    DEPLOYMENT,
)  # fmt: skip
MAPS: dict[str, StabilityMap] = {one.name: one for one in ALL}


def measure_map(name: str, quick: bool, path: Path, progress: Callable[[], None]) -> None:
    """Measure all cells of one of MAPS, or a `quick` few, and write its table; `progress` is called after each."""
    chosen, rows = MAPS[name], []
    for panel, x, y in chosen.cells(quick):
        rows.append(chosen.row(panel, x, y))
        progress()
    made_by = provenance(COMMAND, map=name, quick=quick, **chosen.description())
    write_table(path, rows, made_by)
