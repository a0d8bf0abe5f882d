"""Files of deployments for other tools: NumPy's npz with all data, or CSV with a table of the samples."""

import csv
import io
from pathlib import Path

import numpy as np

from solar_env.mechanics.arrays.columns import TORQUES
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.support.files import check_target, write_text

SUFFIXES = (".csv", ".npz")
# CSV column with its unit -> attribute of the trajectory with values by joint.
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
    """Write a deployment in the format of the suffix: ".npz" for all data (`Trajectory.load`), ".csv" for the samples.

    CSV columns name quantity, unit and joint, as in "angle_rad_1"; energies have names such as "kinetic_J".
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
    """Write named columns (n,) to a CSV file, with all digits of the numbers."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
    write_text(path, text.getvalue())
