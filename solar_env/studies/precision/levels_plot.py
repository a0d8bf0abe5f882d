"""The convergence of the panels as a figure and as a table, from the measured tables alone."""

import math
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from solar_env.pictures.style import LEVEL_LOOKS, STYLE, Look, look_of
from solar_env.studies.common.bootstrap import mean_band
from solar_env.studies.common.drawing import make_figure, save, use_decades
from solar_env.studies.common.tables import Table
from solar_env.support.files import write_text
from solar_env.support.markdown import markdown_table

ERRORS = {
    "angle_error_rad": "error of angles before the latch [rad]",
    "latch_error_s": "error of latch times [s]",
    "reaction_error": "error of peak reactions",
}
# Label, and how many of its units make one of the table's.
MEANS = {
    "peak_force_N": ("peak force [N]", 1.0),
    "impulse_Ns": ("impulse [N s]", 1.0),
    "sliding_work_J": ("sliding work [mJ]", 1e3),
    "impacts": ("number of impacts", 1.0),
    "wear_depth_m": ("deepest wear [fm]", 1e15),
}
_BEYOND = 3.0  # standard errors that ten differences of equal means hardly ever exceed
BEAMS, MODES = "ancf", "modal"


def draw_levels(rows: Table, members: Table, folder: Path) -> list[Path]:
    """Draw errors with ideal joints and means with clearance against wall time, and write both; returns the files."""
    looks = {str(name): look_of(str(name), LEVEL_LOOKS) for name in rows.values("level")}
    joints = members.values("joint")
    figure, axes = make_figure(1 + len(joints), len(MEANS), (2.6, 2.1), len(looks), gap=0.7)
    reference = str(rows.rows[-1]["reference"])
    with mpl.rc_context(STYLE):
        for axis, (error, label) in zip(axes[0], ERRORS.items(), strict=False):
            _draw_errors(axis, rows.where(reference=reference), error, looks)
            axis.set_title(f"ideal joints, against {reference}")
            axis.set_xlabel(label)
            axis.set_ylabel("wall time [s]")
        for axis in axes[0, len(ERRORS) :]:
            axis.set_axis_off()
        for joint, line in zip(joints, axes[1:], strict=True):
            for axis, (statistic, (label, _)) in zip(line, MEANS.items(), strict=True):
                _draw_means(axis, members.where(joint=joint), statistic, looks)
                axis.set_title(f"clearance, joint {joint}")
                axis.set_xlabel(label)
                axis.set_ylabel("wall time [s]")
    picture, page = folder / "levels.png", folder / "levels.md"
    note = "with clearance: after the first latching (wear: of the whole run), means and their 95 % bootstrap bands"
    save(figure, picture, looks, conclusion(members), note)
    write_text(page, _page(rows, members))
    return [picture, page]


def difference(first: Table, second: Table, statistic: str) -> tuple[float, float]:
    """How far the mean of one ensemble is from that of another, relative to the latter, and the standard error of that.

    Runs of both are taken to scatter alike, for one of them may have few.
    """
    values = [table.column(statistic) for table in (first, second)]
    counts = [len(own) for own in values]
    mean = float(values[1].mean())
    squares = sum(float(((own - own.mean()) ** 2).sum()) for own in values)
    if mean == 0.0 or sum(counts) < 3:
        return math.nan, math.nan
    scatter = math.sqrt(squares / (sum(counts) - 2) * sum(1.0 / count for count in counts))
    return float(values[0].mean()) / mean - 1.0, scatter / abs(mean)


def conclusion(members: Table) -> str:
    """Whether the finest of beams and the finest of modes have the same means, or by how much they differ."""
    families = [members.where(family=kind) for kind in (BEAMS, MODES)]
    beams, modes = (family.where(level=family.values("level")[-1]) for family in families)
    found = [
        (*difference(beams.where(joint=joint), modes.where(joint=joint), statistic), label.partition(" [")[0], joint)
        for joint in members.values("joint")
        for statistic, (label, _) in MEANS.items()
    ]
    found = [entry for entry in found if math.isfinite(entry[0])]
    if not found:
        return "Nothing was struck: no joint has latched"
    beyond = [entry for entry in found if abs(entry[0]) > _BEYOND * entry[1]]
    names = " and ".join(str(finest.rows[0]["level"]) for finest in (beams, modes))
    if not beyond:
        change, error, label, joint = max(found, key=lambda entry: abs(entry[0]))
        return (
            f"Beams and modes go to one limit within sampling: {names} differ by {change:+.1%} ± {error:.1%} at most "
            f"({label}, joint {joint})"
        )
    listed = "; ".join(
        f"{label} of joint {joint} by {change:+.1%} ± {error:.1%}"
        for change, error, label, joint in sorted(beyond, key=lambda entry: -abs(entry[0]))
    )
    return f"Beams and modes have not met: {names} differ in {listed}"


def _page(rows: Table, members: Table) -> str:
    """Both tables in Markdown."""
    references = rows.values("reference")
    ideal = [
        [
            str(level),
            f"{own.column('wall_s')[0]:.3g}",
            *(" / ".join(f"{value:.1e}" for value in own.column(error)) for error in ERRORS),
        ]
        for level in rows.values("level")
        for own in [rows.where(level=level)]
    ]
    clearance = []
    for level in members.values("level"):
        own = members.where(level=level)
        by_joint = [own.where(joint=joint) for joint in own.values("joint")]
        means = (" / ".join(mean_and_error(of, statistic) for of in by_joint) for statistic in MEANS)
        clearance.append([str(level), str(len(by_joint[0].rows)), f"{np.median(own.column('wall_s')):.3g}", *means])
    return "\n".join(
        [
            f"With ideal joints, errors against {' / against '.join(map(str, references))}:\n",
            markdown_table(("level", "wall time [s]", *ERRORS.values()), ideal),
            "",
            "With clearance, means of joints 1 / 2 ± their standard errors:\n",
            markdown_table(("level", "runs", "wall time [s]", *(label for label, _ in MEANS.values())), clearance),
            "",
            f"{conclusion(members)}.\n",
        ]
    )


def mean_and_error(rows: Table, statistic: str) -> str:
    """Mean and, if there are two runs or more, its standard error, with as many digits as that allows."""
    values = MEANS[statistic][1] * rows.column(statistic)
    error = values.std(ddof=1) / math.sqrt(len(values)) if len(values) > 1 else 0.0
    if error == 0.0:
        return f"{values.mean():.3g}"
    digits = max(0, 1 - math.floor(math.log10(2.0 * error)))
    return f"{values.mean():.{digits}f} ± {error:.{digits}f}"


def _draw_errors(axis: Axes, rows: Table, error: str, looks: dict[str, Look]) -> None:
    axis.set_xscale("log")
    axis.set_yscale("log")
    for name, x, y in zip(rows.values("level"), rows.column(error), rows.column("wall_s"), strict=True):
        if np.isfinite(x) and x > 0.0:
            axis.plot([x], [y], markersize=4.5, **looks[str(name)])
    use_decades(axis, "x")
    use_decades(axis, "y")


def _draw_means(axis: Axes, rows: Table, statistic: str, looks: dict[str, Look]) -> None:
    axis.set_yscale("log")
    for level in rows.values("level"):
        own = rows.where(level=level)
        mean, low, high = mean_band(MEANS[statistic][1] * own.column(statistic))
        wall = float(np.median(own.column("wall_s")))
        style = looks[str(level)]
        axis.errorbar([mean], [wall], xerr=[[mean - low], [high - mean]], markersize=4.5, linewidth=0.8, **style)
    use_decades(axis, "y")
