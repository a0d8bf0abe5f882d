"""Side by side as a figure and as a table, from the measured table alone."""

import math
from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl

from solar_env.pictures.style import METHOD_LOOKS, STYLE, look_of
from solar_env.studies.common.drawing import make_figure, positive_points, save, use_decades
from solar_env.studies.common.tables import Cell, Table, number
from solar_env.studies.precision.side_by_side import DEFAULT
from solar_env.support.files import write_text
from solar_env.support.markdown import markdown_table

ERRORS = {
    "angle_error_rad": "error of angles before the latch [rad]",
    "latch_error_s": "error of latch times [s]",
}
_COLUMNS = (
    "model", "method", "panels", "setting", "wall time [s]", "times real time", *ERRORS.values(),
    "peak forces over the converged ensemble's, joints 1 / 2", "peer's time over ours at no larger error",
)  # fmt: skip
_SIZE = (2.15, 2.1)  # of one panel with its labels [inch]


def write_side_by_side(rows: Table, folder: Path) -> list[Path]:
    """Draw wall time against the error of angles, a column for each model, and write the table; returns the files."""
    looks = {str(name): look_of(str(name), METHOD_LOOKS) for name in rows.values("method")}
    models = rows.values("model")
    figure, axes = make_figure(1, len(models), _SIZE, len(looks))
    with mpl.rc_context(STYLE):
        for axis, model in zip(axes[0], models, strict=True):
            own = rows.where(model=model)
            axis.set_xscale("log")
            axis.set_yscale("log")
            for name in own.values("method"):
                chosen = own.where(method=name)
                errors, walls = positive_points(chosen.column("angle_error_rad"), chosen.column("wall_s"))
                axis.plot(errors, walls, markersize=4, **looks[str(name)])
            use_decades(axis, "x")
            use_decades(axis, "y")
            axis.set_title(str(model))
        axes[0, 0].set_ylabel("wall time [s]")
    picture, page = folder / "side_by_side.png", folder / "side_by_side.md"
    save(figure, picture, looks, _conclusion(rows), f"{ERRORS['angle_error_rad']}, panels included")
    write_text(page, markdown_table(_COLUMNS, [_line(rows, row) for row in rows.rows]) + "\n")
    return [picture, page]


def ratio_at_equal_error(rows: Table, peer: Mapping[str, Cell]) -> float:
    """The peer's wall time over that of the cheapest own run whose errors are no larger; nan if there is none."""
    walls = [
        number(row, "wall_s")
        for row in rows.where(model=peer["model"], peer=0).rows
        if all(number(row, name) <= number(peer, name) for name in ERRORS)
    ]
    return number(peer, "wall_s") / min(walls, default=math.nan)


def _conclusion(rows: Table) -> str:
    """By how much a peer's setting takes longer on each model, at the least."""
    least: dict[str, float] = {}
    for row in rows.where(peer=1).rows:
        ratio = ratio_at_equal_error(rows, row)
        if math.isfinite(ratio):
            model = str(row["model"])
            least[model] = min(ratio, least.get(model, math.inf))
    clauses = [f"{ratio:.3g} times with {model}" for model, ratio in least.items()]
    return f"At no larger error a peer takes at least {', '.join(clauses)}" if clauses else "No peer was measured"


def _line(rows: Table, row: Mapping[str, Cell]) -> list[str]:
    cells = [str(row[name]) for name in ("model", "method", "panels")]
    cells.append("" if row["method"] == DEFAULT else f"{number(row, 'value'):g}")
    if row["failure"]:
        return [*cells, "failed", *[""] * (len(_COLUMNS) - len(cells) - 1)]
    ratio = ""
    if row["peer"]:
        own = ratio_at_equal_error(rows, row)
        ratio = "none of ours is as accurate" if math.isnan(own) else f"{own:.3g}"
    wall, duration = number(row, "wall_s"), number(row, "duration_s")
    errors = [f"{number(row, name):.1e}" for name in ERRORS]
    return [*cells, f"{wall:.3g}", f"{duration / wall:.3g}", *errors, _forces(row), ratio]


def _forces(row: Mapping[str, Cell]) -> str:
    ratios = [(number(row, f"force_ratio_{j}"), number(row, f"force_ratio_{j}_error")) for j in (1, 2)]
    return "" if math.isnan(ratios[0][0]) else " / ".join(f"{ratio:.2f} ± {error:.2f}" for ratio, error in ratios)
