"""Figures of a simulated deployment. Matplotlib is imported when a figure is made, not with this module."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from solar_env.pictures.style import BROWN, COLOURS, FAINT, GREY, STEEL, STYLE, VERMILLION, VIOLET
from solar_env.support.files import save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection
    from matplotlib.figure import Figure
    from matplotlib.patches import Polygon
    from matplotlib.projections.polar import PolarAxes

    from solar_env.mechanics.running.trajectory import Trajectory

SUFFIXES = (".pdf", ".png", ".svg")
COMPARED_TIME = (-0.2, 3.0)  # since the first latching [s]
HISTORY_WIDTH, BEARING_WIDTH, COMPARED_WIDTH = 7.4, 2.9, 4.4  # of a column of axes with its labels [inch]
STORED = ("kinetic", "spring", "cable", "latch", "contact", "elastic", "gravity")
PUT_IN = ("motor_work", "cable_work", "external_work")
DISSIPATED = ("contact_dissipation", "friction_dissipation", "latch_dissipation", "material_dissipation")

# Of the energies put in, then of what is dissipated, all of it and in the panels' material.
ENERGY_COLOURS = (*COLOURS[:7], GREY, BROWN, VIOLET, "black", "black")
LEGEND_COLUMNS = 7  # entries that one line of the energies' legend has room for
DATE_KEY = {".pdf": "CreationDate", ".svg": "Date"}


def plot_deployment(trajectory: Trajectory, path: str | Path, deflections: NDArray[np.float64] | None = None) -> None:
    """Write one figure of a deployment: motion, forces, energies and wear.

    Against time: angles with the latch times dotted, contact force of each joint (samples, and each contact's
    peak as a stem; of an ideal joint the joint force), latch and cable torques, deflections of flexible panels,
    energies and the residual of their balance. Of each joint with clearance also the path of the journal in the
    bearing and the wear round both surfaces. The same trajectory gives the same file.

    Args:
        trajectory: of any number of joints.
        path: file to write; its suffix, .pdf, .png or .svg, chooses the format.
        deflections: (nt, panels) of the panels' middles from their chords [m]; None leaves them out.

    Raises:
        ValueError: the suffix is none of these.
    """
    suffix = _checked_suffix(path)
    import matplotlib as mpl

    loose = np.flatnonzero(trajectory.clearance > 0.0)
    columns = 0 if len(loose) == 0 else 1 if len(loose) < 3 else 2
    rows = len(trajectory.clearance) + (6 if deflections is None else 7)
    with mpl.rc_context(STYLE):
        figure = _figure(HISTORY_WIDTH + BEARING_WIDTH * columns, 1.25 * rows)
        _draw_histories(figure, trajectory, deflections)
        if columns > 0:
            _draw_bearings(figure, trajectory, loose, columns)
        _save(figure, path, suffix)


def plot_comparison(
    trajectories: Sequence[Trajectory], deflections: Sequence[NDArray[np.float64]], path: str | Path
) -> None:
    """Write one figure of several deployments side by side: a column each, titled by its model and the peak force.

    Angles against time; then, from shortly before the first latching to some seconds after it, the contact force
    of each joint (samples, and each contact's peak as a stem) and the deflections of the panels. A row has one
    scale. The same trajectories give the same file.

    Args:
        trajectories: of the same number of joints, with the model's name in their metadata.
        deflections: of each trajectory, (nt, panels) of the panels' middles from their chords [m].
        path: file to write; its suffix, .pdf, .png or .svg, chooses the format.

    Raises:
        ValueError: the suffix is none of these, or no joint of a trajectory has latched.
    """
    suffix = _checked_suffix(path)
    for trajectory in trajectories:
        if np.all(np.isnan(trajectory.latch_times)):
            raise ValueError(f"no joint of {trajectory.metadata['model']} has latched; simulate for longer")
    import matplotlib as mpl

    joints = len(trajectories[0].clearance)
    with mpl.rc_context(STYLE):
        figure = _figure(COMPARED_WIDTH * len(trajectories) + 0.4, 1.4 * (joints + 2) + 1.0)
        edges = (0.75, 0.45, figure.get_figwidth() - 0.2, -0.3)
        grid = _cells(figure, joints + 2, len(trajectories), edges, hspace=0.36, wspace=0.1)
        axes = grid.subplots(sharex="row", sharey="row", squeeze=False)
        for column, trajectory, bend in zip(axes.T, trajectories, deflections, strict=True):
            _draw_compared(column, trajectory, bend)
        for axis in axes[:, 0]:
            axis.yaxis.set_label_coords(-0.45 / (COMPARED_WIDTH - 0.5), 0.5)
        for axis in axes[:, 1:].flat:
            axis.set_ylabel("")
        axes[0, 0].legend([f"joint {joint + 1}" for joint in range(joints)], loc="upper left")
        _save(figure, path, suffix)


def _draw_compared(axes: NDArray[Any], trajectory: Trajectory, deflections: NDArray[np.float64]) -> None:
    """A column of `plot_comparison`; axes (joints + 2,) from the top."""
    angles, *forces, bends = axes
    angles.set_title(_conclusion(trajectory))
    _draw_per_joint(angles, trajectory.time, np.degrees(trajectory.angles), "angle [deg]")
    angles.set_xlabel("time [s]")
    angles.set_xlim(trajectory.time[0], trajectory.time[-1])
    latching = float(np.nanmin(trajectory.latch_times))
    since = trajectory.time - latching
    for joint, axis in enumerate(forces):
        colour = COLOURS[joint % len(COLOURS)]
        contacts = trajectory.contacts[trajectory.contacts["joint"] == joint]
        stems = axis.vlines(contacts["start_s"] - latching, 0.0, contacts["peak_force"], color=colour, linewidth=0.5)
        stems.set(alpha=0.45, rasterized=True)
        axis.plot(since, trajectory.normal_force[:, joint], color=colour, linewidth=0.8)
        axis.set_ylabel(f"contact force\njoint {joint + 1} [N]")
        axis.tick_params(labelbottom=False)
    _draw_per_joint(bends, since, 1e3 * deflections, "deflection of\npanel [mm]")
    bends.set_xlabel("time since the first latching [s]")
    for axis in (*forces, bends):
        axis.set_xlim(COMPARED_TIME)


def _conclusion(trajectory: Trajectory) -> str:
    """Model, when its joints latched, and the greatest force after that."""
    model = trajectory.metadata["model"]
    latched = trajectory.latch_times[np.isfinite(trajectory.latch_times)]
    if len(latched) == 0:
        return f"{model}: no joint has latched"
    return f"{model}: latched at {latched.max():.1f} s, then up to {trajectory.postlock_peak_force.max():.0f} N"


def _checked_suffix(path: str | Path) -> str:
    """The suffix of a file name if it is one of SUFFIXES, else a ValueError."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"no figure format for {str(path)!r}: end the name in one of {', '.join(SUFFIXES)}")
    return suffix


def _figure(width: float, height: float) -> Figure:
    """An empty figure [inch] that needs no display."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height))


def _save(figure: Figure, path: str | Path, suffix: str) -> None:
    """Write a figure without the date, so that the same data give the same file."""
    save_figure(figure, path, dpi=160, metadata={DATE_KEY[suffix]: None} if suffix in DATE_KEY else {})


def _cells(figure: Figure, rows: int, columns: int, edges: tuple[float, float, float, float], **how: Any) -> Any:
    """A grid of axes. Edges: left, bottom, right [inch from the lower left], top [inch from the top].

    Placed by hand, because Matplotlib's automatic layouts differ in the last bits from run to run.
    """
    width, height = figure.get_size_inches()
    left, bottom, right, top = edges
    place = {"left": left / width, "bottom": bottom / height, "right": right / width, "top": 1.0 + top / height}
    return figure.add_gridspec(rows, columns, **place, **how)


def _draw_histories(figure: Figure, trajectory: Trajectory, deflections: NDArray[np.float64] | None) -> None:
    joints = trajectory.angles.shape[1]
    bent = [] if deflections is None else [0.9]
    heights = [1.2, *[0.9] * joints, 0.8, 0.8, *bent, 1.4, 0.7]
    edges = (0.85, 0.45, HISTORY_WIDTH - 0.1, -0.3)
    grid = _cells(figure, len(heights), 1, edges, height_ratios=heights, hspace=0.2)
    axes = grid.subplots(sharex=True)
    angles, *forces = axes[: joints + 1]
    latch, cable, *bends, energies, residual = axes[joints + 1 :]
    _draw_per_joint(angles, trajectory.time, np.degrees(trajectory.angles), "angle [deg]")
    angles.legend([f"joint {joint + 1}" for joint in range(joints)], loc="upper left", ncols=4)
    angles.set_title(_conclusion(trajectory))
    for joint, lock in enumerate(trajectory.latch_times):
        angles.axvline(lock, color=COLOURS[joint % len(COLOURS)], linewidth=0.7, linestyle=":")
    for joint, axis in enumerate(forces):
        _draw_force(axis, trajectory, joint)
    _draw_per_joint(latch, trajectory.time, trajectory.latch_torque, "latch torque\n[N m]")
    _draw_per_joint(cable, trajectory.time, trajectory.cable_torque, "cable torque\n[N m]")
    if deflections is not None:
        _draw_per_joint(bends[0], trajectory.time, 1e3 * deflections, "deflection of\npanel [mm]")
    _draw_energies(energies, trajectory)
    residual.plot(trajectory.time, trajectory.energies["residual"], color="black", linewidth=0.8)
    residual.set_ylabel("energy\nresidual [J]")
    residual.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2))
    residual.set_xlabel("time [s]")
    residual.set_xlim(trajectory.time[0], trajectory.time[-1])
    for axis in axes:
        axis.yaxis.set_label_coords(-0.45 / (HISTORY_WIDTH - 0.95), 0.5)  # 0.45 inch left of the axis


def _draw_per_joint(axis: Axes, time: NDArray[np.float64], values: NDArray[np.float64], label: str) -> None:
    for joint, column in enumerate(values.T):
        axis.plot(time, column, color=COLOURS[joint % len(COLOURS)])
    axis.set_ylabel(label)


def _draw_force(axis: Axes, trajectory: Trajectory, joint: int) -> None:
    colour = COLOURS[joint % len(COLOURS)]
    samples = trajectory.normal_force[:, joint]
    contacts = trajectory.contacts[trajectory.contacts["joint"] == joint]
    kind = "contact" if trajectory.clearance[joint] > 0.0 else "joint"
    axis.set_ylabel(f"{kind} force\njoint {joint + 1} [N]")
    axis.set_yscale("log")
    highest = max(float(np.max(samples)), float(np.max(contacts["peak_force"], initial=0.0))) or 1.0
    # Six decades: impacts of hundreds of newtons and the quiet contact of tenths both show.
    lowest = 1e-6 * highest
    axis.set_ylim(lowest, 2.0 * highest)
    stems = axis.vlines(contacts["start_s"], lowest, contacts["peak_force"], color=colour, linewidth=0.5)
    stems.set(alpha=0.45, rasterized=True)
    axis.plot(trajectory.time, np.where(samples > lowest, samples, np.nan), color=colour, linewidth=0.8)


def _draw_energies(axis: Axes, trajectory: Trajectory) -> None:
    energies = trajectory.energies
    curves = {name: energies[name] for name in (*STORED, *PUT_IN)}
    curves["dissipated"] = np.sum([energies[name] for name in DISSIPATED], axis=0)
    curves["in the material"] = energies["material_dissipation"]
    largest = max(float(np.max(np.abs(curve))) for curve in curves.values())
    for colour, (name, curve) in zip(ENERGY_COLOURS, curves.items(), strict=True):
        if np.max(np.abs(curve)) > 1e-3 * largest:  # a curve that would lie on the axis only fills the legend
            style = "--" if name in PUT_IN else ":" if name == "in the material" else "-"
            axis.plot(trajectory.time, curve, style, color=colour, label=name.replace("_", " "))
    axis.set_ylabel("energy [J]")
    # The first line of the legend lies above the axes, the others in room made for them.
    bottom, top = axis.get_ylim()
    more_lines = (len(axis.lines) - 1) // LEGEND_COLUMNS
    axis.set_ylim(bottom, top + 0.13 * more_lines * (top - bottom))
    place: Any = {"loc": "upper left", "bbox_to_anchor": (0.0, 1.12)}
    axis.legend(**place, ncols=LEGEND_COLUMNS, columnspacing=1.2, handlelength=1.4)


def _draw_bearings(figure: Figure, trajectory: Trajectory, loose: NDArray[np.intp], columns: int) -> None:
    left, right = HISTORY_WIDTH + 0.45, HISTORY_WIDTH + BEARING_WIDTH * columns - 0.3
    grid = _cells(figure, 2 * len(loose) // columns, columns, (left, 1.2, right, -0.45), hspace=0.4, wspace=0.35)
    for position, joint in enumerate(loose):
        path = _draw_locus(figure.add_subplot(grid[2 * position]), trajectory, int(joint))
        wear = figure.add_subplot(grid[2 * position + 1], projection="polar")
        surfaces = _draw_wear(cast("PolarAxes", wear), trajectory, int(joint))
    bar = figure.add_subplot(_cells(figure, 1, 1, (left, 0.75, right, 0.84 - figure.get_figheight()))[0])
    figure.colorbar(path, cax=bar, orientation="horizontal", label="time [s]")
    middle = 0.5 * (left + right) / figure.get_figwidth()
    figure.legend(handles=surfaces, loc="lower center", bbox_to_anchor=(middle, 0.0), ncols=2)


def _draw_locus(axis: Axes, trajectory: Trajectory, joint: int) -> PathCollection:
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    clearance = 1e6 * trajectory.clearance[joint]
    axis.plot(clearance * np.cos(angle), clearance * np.sin(angle), color=STEEL, linewidth=1.2, zorder=0)
    x, y = 1e6 * trajectory.eccentricity[:, joint].T
    axis.plot(x, y, color=FAINT, linewidth=0.3, rasterized=True, zorder=0)
    points = axis.scatter(x, y, c=trajectory.time, cmap="viridis", s=1.5, linewidths=0, rasterized=True)
    axis.set_aspect("equal")
    axis.set_title(f"joint {joint + 1}: path of the journal [µm]")
    return points


def _draw_wear(axis: PolarAxes, trajectory: Trajectory, joint: int) -> list[Polygon]:
    from matplotlib.ticker import MaxNLocator

    bearing, journal = trajectory.wear_bearing[joint], trajectory.wear_journal[joint]
    deepest = max(float(np.max(bearing)), float(np.max(journal)))
    exponent = int(np.floor(np.log10(deepest))) if deepest > 0.0 else 0
    edges = np.linspace(0.0, 2.0 * np.pi, len(bearing) + 1)
    surfaces = []
    for depth, colour, name in ((bearing, STEEL, "bearing"), (journal, VERMILLION, "journal")):
        steps, around = np.repeat(depth / 10.0**exponent, 2), np.repeat(edges, 2)[1:-1]
        surfaces += axis.fill(around, steps, color=colour, alpha=0.5, linewidth=0.8, label=name)
    axis.set_title(f"joint {joint + 1}: wear depth [$10^{{{exponent}}}$ m]")
    axis.set_xticks(np.arange(0.0, 2.0 * np.pi, np.pi / 2.0))
    axis.yaxis.set_major_locator(MaxNLocator(3))
    axis.set_rlabel_position(np.degrees(edges[np.argmin(bearing + journal)]))
    axis.tick_params(pad=0)
    axis.spines["polar"].set_color(STEEL)
    return surfaces
