"""Sets of parameters that the paper leaves open, from `identification-shortlist.csv` and `identification-front.csv`.

A search found the sets; commit d3d47ea is the last with its program. The results are on this study's page.
"""

from collections.abc import Mapping

from solar_env.studies.common.tables import Cell, number, read_table
from solar_env.studies.paper.cases import Changes, Value
from solar_env.support.readme import STUDIES

FOLDER = STUDIES / "paper"
LATCH_DEPTH = 0.01  # rad; depth in the stop at which the tables give the latch torque, from which the stiffness follows
_COLUMNS = (
    "hinge_y", "cable_torque_ratio", "cable_stiffness", "cable_preload_force", "latch_gap", "latch_exponent",
    "latch_damping", "latch_ramp_depth", "friction_speed_zero",
)  # fmt: skip


def found_sets() -> dict[str, Changes]:
    """Return changes to the `paper` preset by set name: the shortlist's names, then "front 1", "front 2" and so on."""
    rows = {str(row["name"]): row for row in read_table(FOLDER / "identification-shortlist.csv").rows}
    front = read_table(FOLDER / "identification-front.csv").rows
    rows |= {f"front {number}": row for number, row in enumerate(front, start=1)}
    return {name: _changes(row) for name, row in rows.items()}


def _changes(row: Mapping[str, Cell]) -> Changes:
    changes: dict[str, Value] = {name: number(row, name) for name in _COLUMNS}
    stiffness = number(row, "latch_torque") / LATCH_DEPTH ** number(row, "latch_exponent")
    full = number(row, "friction_speed_zero") * number(row, "friction_speed_ratio")
    # Rounding to the tables' four digits gives back the round values with which the named sets were searched.
    changes |= {"latch_stiffness": float(f"{stiffness:.4g}"), "friction_speed_full": float(f"{full:.4g}")}
    changes["friction_sliding"] = str(row["sliding"])
    if row["stiffness"] == "eq 40":
        changes["contact_stiffness"] = None
    return tuple(changes.items())
