"""Pictures of the design maps and of a campaign of ground tests, from their tables alone."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from solar_env.pictures.style import COLOURS, STYLE
from solar_env.studies.common.drawing import short
from solar_env.studies.common.tables import Table
from solar_env.studies.design.design_map import MAPS, DesignMap
from solar_env.support.files import save_figure

# By column: title, and factor to its unit.
MAPPED = {
    "wear_m": ("deepest wear of the worse joint [1e-14 m]", 1e14),
    "force_N": ("peak post-lock force [kN]", 1e-3),
}
JOINTS = (1, 2)
# By column, with "{}" for the joint: label, and factor to its unit.
REPEATED = {
    "clearance_{}_m": ("clearance [mm]", 1e3),
    "wear_{}_m": ("growth of the clearance\nby a deployment [µm]", 1e6),
    "force_{}_N": ("peak post-lock force [N]", 1.0),
}


def draw_design(table: Table, folder: Path) -> Path:
    """Draw the maps of wear and of force; returns the picture's file."""
    with mpl.rc_context({**STYLE, "axes.grid": False}):
        figure = Figure(figsize=(10.0, 8.0), layout="constrained")
        axes = figure.subplots(len(MAPS), len(MAPPED), squeeze=False)
        for (name, design), row in zip(MAPS.items(), axes, strict=True):
            for (quantity, (title, unit)), axis in zip(MAPPED.items(), row, strict=True):
                _draw_map(axis, table.where(map=name), design, quantity, unit)
                axis.set_title(title)
        force, wear = (table.column(name) for name in ("force_N", "wear_m"))
        figure.suptitle(
            f"Clearances and stiffnesses change the peak force {force.max() / force.min():.0f}-fold, the wear "
            f"{wear.max() / wear.min():.1f}-fold"
        )
        path = folder / "design.png"
        save_figure(figure, path, dpi=100)
    return path


def _draw_map(axis: Axes, table: Table, design: DesignMap, quantity: str, unit: float) -> None:
    """One map, its median and the half-width of its quartiles in every cell."""
    shape = (len(design.y_values), len(design.x_values))
    median, low, high = (unit * table.column(quantity + end).reshape(shape) for end in ("", "_low", "_high"))
    norm = LogNorm(median.min(), median.max())
    axis.imshow(median, origin="lower", aspect="auto", cmap="YlOrRd", norm=norm)
    for (i, k), value in np.ndenumerate(median):
        text = f"{short(value)}\n±{short(float(high[i, k] - low[i, k]) / 2.0)}"
        axis.text(k, i, text, ha="center", va="center", fontsize=7, color="white" if norm(value) > 0.6 else "black")
    for x, y in design.marked:
        place = (design.x_values.index(x) - 0.46, design.y_values.index(y) - 0.46)
        axis.add_patch(mpl.patches.Rectangle(place, 0.92, 0.92, fill=False, linewidth=1.8))
    axis.set_xticks(range(shape[1]), [f"{value:g}" for value in design.x_values])
    axis.set_yticks(range(shape[0]), [f"{value:g}" for value in design.y_values])
    axis.set(xlabel=design.x, ylabel=design.y)


def draw_ground_test(table: Table, folder: Path) -> Path:
    """Draw clearance, wear and force over the deployments; returns the picture's file."""
    deployments, growth = table.column("deployment"), 0.0
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 3.2), layout="constrained")
        for axis, (column, (label, unit)) in zip(figure.subplots(1, 3), REPEATED.items(), strict=True):
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
        path = folder / "ground_test.png"
        save_figure(figure, path, dpi=100)
    return path
