"""Deployments as files that other tools read: NumPy's npz with everything, or a table of the samples as CSV."""

import csv
import io
from pathlib import Path

import numpy as np

from solar_env.mechanics.arrays.columns import TORQUES
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.support.files import check_target, write_text

SUFFIXES = (".csv", ".npz")
# Column of the table, with its unit, -> attribute of the trajectory, by joint.
_BY_JOINT = {
    "angle_rad": "angles",
    "rate_rad_per_s": "rates",
    "gap_m": "penetration",
    "normal_force_N": "normal_force",
    "tangential_force_N": "tangential_force",
    **{f"{law.name}_Nm": law.name for law in TORQUES},
    "impulse_Ns": "impulse",
    "sliding_work_J": "sliding_work",
}


def write_data(trajectory: Trajectory, path: Path) -> None:
    """Write a deployment in the suffix's format: ".npz" for all of it, see `Trajectory.load`, ".csv" a row per sample.

    Columns of the table name quantity, unit and joint, as in "angle_rad_1"; energies are "kinetic_J" and the like.
    """
    check_target(path, SUFFIXES)
    if path.suffix.lower() == ".npz":
        trajectory.save(path)
        return
    columns = {"time_s": trajectory.time}
    for name, attribute in _BY_JOINT.items():
        values = getattr(trajectory, attribute)
        sign = -1.0 if attribute == "penetration" else 1.0
        columns |= {f"{name}_{joint + 1}": sign * values[:, joint] for joint in range(values.shape[1])}
    columns |= {f"{name}_J": values for name, values in trajectory.energies.items()}
    write_columns(path, columns)


def write_columns(path: Path, columns: dict[str, np.ndarray]) -> None:
    """Write a CSV file of columns (n,) by their names, with as many digits as the numbers have."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
    write_text(path, text.getvalue())
