"""Plot of clearance, wear and peak force against the number of deployments, drawn from a table of results."""

from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from solar_env.pictures.style import COLOURS, STYLE
from solar_env.studies.common.tables import Table
from solar_env.support.files import save_figure

JOINTS = (1, 2)
# Column name, with "{}" for the joint -> axis label, and factor from SI units to the label's unit.
COLUMNS = {
    "clearance_{}_m": ("clearance [mm]", 1e3),
    "wear_{}_m": ("growth of the clearance\nby a deployment [µm]", 1e6),
    "force_{}_N": ("peak post-lock force [N]", 1.0),
}


def draw_repeated(table: Table, folder: Path) -> Path:
    """Plot clearance, wear and peak force against the number of deployments; return the plot's file."""
    deployments, growth = table.column("deployment"), 0.0
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 3.2), layout="constrained")
        for axis, (column, (label, unit)) in zip(figure.subplots(1, 3), COLUMNS.items(), strict=True):
            for joint in JOINTS:
                name = column.format(joint)
                errors = unit * table.column(f"{name}_error") if f"{name}_error" in table.rows[0] else None
                look = {"color": COLOURS[joint - 1], "label": f"joint {joint}", "linewidth": 0.8}
                values = unit * table.column(name)
                axis.errorbar(deployments, values, yerr=errors, fmt="o-", markersize=3.0, **look)
                growth = max(growth, values[-1] / values[0]) if column.startswith("clearance") else growth
            axis.set(xlabel="deployments before", ylabel=label)
        figure.axes[0].legend()
        figure.suptitle(f"Wear feeds back: clearances grow {growth:.1f}-fold, and forces with them")
        path = folder / "repeated.png"
        save_figure(figure, path, dpi=100)
    return path
