"""Figure of the ensembles, from their table alone: bias of a method against its cost, with sampling bands."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from solar_env.pictures.style import FAINT, METHOD_LOOKS, STYLE, Look, look_of
from solar_env.studies.common.bootstrap import mean_band
from solar_env.studies.common.drawing import make_figure, save, use_decades
from solar_env.studies.common.tables import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LABELS = {
    "peak_force_N": "peak force",
    "median_force_N": "impacts' median force",
    "high_force_N": "impacts' 95 % force",
    "impulse_Ns": "impulse",
    "impacts": "number of impacts",
    "sliding_work_J": "sliding work",
    "wear_depth_m": "wear depth",
    "energy_lost": "energy dissipated",
}

_WIDE = 2.5  # a method that is so far off is shown on a logarithmic axis, lest it hide the others' differences


def draw_ensembles(rows: Table, folder: Path) -> list[Path]:
    """Draw means over the reference's against wall time: a column for each joint of each model; returns the file."""
    import matplotlib as mpl

    columns = [(model, joint) for model in rows.values("model") for joint in rows.where(model=model).values("joint")]
    looks = {str(name): look_of(str(name), METHOD_LOOKS) for name in rows.values("method")}
    figure, axes = make_figure(len(LABELS), len(columns), (2.6, 1.35), len(looks))
    with mpl.rc_context(STYLE):
        for (model, joint), panels in zip(columns, axes.T, strict=True):
            own = rows.where(model=model, joint=joint)
            for axis, (statistic, label) in zip(panels, LABELS.items(), strict=True):
                _draw_panel(axis, own, statistic, looks)
                axis.set_ylabel(label)
            panels[0].set_title(f"{model}, joint {joint}\n{len(own.where(**_first(own)).rows)} runs of the reference")
            panels[-1].set_xlabel("wall time of a run [s]")
    path = folder / "ensembles.png"
    note = (
        "mean over the mean of the reference (the first method's finest setting), 95 % bootstrap bands; grey: its band"
    )
    save(figure, path, looks, _title(rows), note)
    return [path]


def _first(rows: Table) -> dict[str, Any]:
    """The reference: the first method and setting of a table."""
    return {"method": rows.rows[0]["method"], "value": rows.rows[0]["value"]}


def _title(rows: Table) -> str:
    """The methods whose mean peak force is that of the reference within sampling bands, at every joint."""
    within: dict[str, bool] = {}
    for model, joint in dict.fromkeys((row["model"], row["joint"]) for row in rows.rows):
        own = rows.where(model=model, joint=joint)
        _, low, high = mean_band(own.where(**_first(own)).column("peak_force_N"))
        for method in map(str, own.values("method")):
            settings = [own.where(method=method, value=value) for value in own.where(method=method).values("value")]
            bands = [mean_band(of.column("peak_force_N")) for of in settings]
            meets = all(bottom <= high and top >= low for _, bottom, top in bands)
            within[method] = within.get(method, True) and meets
    return "Right in peak force, at every setting measured: " + "; ".join(
        name for name, meets in within.items() if meets
    )


def _draw_panel(axis: Axes, rows: Table, statistic: str, looks: dict[str, Look]) -> None:
    mean, low, high = mean_band(rows.where(**_first(rows)).column(statistic))
    axis.set_xscale("log")
    if np.isfinite(mean) and mean != 0.0:
        axis.axhspan(low / mean, high / mean, color=FAINT, alpha=0.5, linewidth=0.0, zorder=0)
        for method, value in dict.fromkeys((row["method"], row["value"]) for row in rows.rows):
            own = rows.where(method=method, value=value)
            middle, bottom, top = (x / mean for x in mean_band(own.column(statistic)))
            if np.isfinite(middle):
                wall = float(np.median(own.column("wall_s")))
                reach = [[middle - bottom], [top - middle]]
                axis.errorbar([wall], [middle], yerr=reach, markersize=3.5, linewidth=0.8, **looks[str(method)])
        use_decades(axis, "x")
        if axis.get_ylim()[1] > _WIDE:
            axis.set_yscale("log")
        else:
            axis.ticklabel_format(axis="y", useOffset=False)
