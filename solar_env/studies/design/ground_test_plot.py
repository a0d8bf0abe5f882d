"""Picture of a campaign of ground tests, from its table alone."""

from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from solar_env.pictures.style import COLOURS, STYLE
from solar_env.studies.common.tables import Table
from solar_env.support.files import save_figure

PICTURE = "ground_test.png"
JOINTS = (1, 2)
# By column, with "{}" for the joint: label, and factor to its unit.
QUANTITIES = {
    "clearance_{}_m": ("clearance [mm]", 1e3),
    "wear_{}_m": ("growth of the clearance\nby a deployment [µm]", 1e6),
    "force_{}_N": ("peak post-lock force [N]", 1.0),
}


def draw_ground_test(table: Table, folder: Path) -> Path:
    """Draw clearance, wear and force over the deployments, extrapolated and direct; returns the picture's file."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 3.2), layout="constrained")
        for axis, (column, (label, unit)) in zip(figure.subplots(1, 3), QUANTITIES.items(), strict=True):
            for joint in JOINTS:
                for kind, style in (("extrapolated", "o-"), ("direct", "+")):
                    own = table.where(kind=kind)
                    if not own.rows:
                        continue
                    name = column.format(joint)
                    errors = unit * own.column(f"{name}_error") if f"{name}_error" in own.rows[0] else None
                    axis.errorbar(
                        own.column("deployment"), unit * own.column(name), yerr=errors, fmt=style, markersize=3.0,
                        color=COLOURS[joint - 1], label=f"joint {joint}, {kind}", linewidth=0.8,
                    )  # fmt: skip
            axis.set(xlabel="deployments before", ylabel=label)
        figure.axes[0].legend()
        last = table.where(kind="extrapolated").rows
        growth = max(float(last[-1][f"clearance_{j}_m"]) / float(last[0][f"clearance_{j}_m"]) for j in JOINTS)
        figure.suptitle(f"Wear feeds back: clearances grow {growth:.1f}-fold, and forces with them")
        path = folder / PICTURE
        save_figure(figure, path, dpi=100)
    return path
