"""Figure of a simulated deployment. Matplotlib is imported when the figure is made, not with this module."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solar_env.pictures.style import BROWN, COLOURS, FAINT, GREY, STEEL, STYLE, VERMILLION, VIOLET
from solar_env.support.files import save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from solar_env.mechanics.running.trajectory import Trajectory

SUFFIXES = (".pdf", ".png", ".svg")
HISTORY_WIDTH, BEARING_WIDTH = 7.4, 2.9  # widths of a column of axes with its labels [inch]
STORED = ("kinetic", "spring", "cable", "latch", "contact", "elastic", "gravity")
PUT_IN = ("motor_work", "cable_work", "external_work")
DISSIPATED = ("contact_dissipation", "friction_dissipation", "latch_dissipation", "material_dissipation")

# Colours of energies: stored, put in, dissipated in total, and dissipated in the panels' material.
ENERGY_COLOURS = (*COLOURS[:7], GREY, BROWN, VIOLET, "black", "black")


def plot_deployment(trajectory: Trajectory, path: str | Path, deflections: NDArray[np.float64] | None = None) -> None:
    """Write one figure of a deployment: motion, forces, energies and wear.

    Time histories show angles with dotted latch times, the contact force of each joint (samples, and each
    contact's peak as a stem; the joint force for an ideal joint), latch and cable torques, deflections of flexible
    panels, energies and the residual of the energy balance. Further axes show, for each joint with clearance, the
    path of the journal in the bearing and the wear round both surfaces.

    Args:
        trajectory: the deployment, with any number of joints.
        path: file to write; its suffix, .pdf, .png or .svg, chooses the format.
        deflections: (nt, panels) deflections of the panels' midpoints relative to their chords [m]; None omits them.

    Raises:
        ValueError: Matplotlib does not write the suffix's format.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    loose = np.flatnonzero(trajectory.clearance > 0.0)
    columns = 0 if len(loose) == 0 else 1 if len(loose) < 3 else 2
    rows = len(trajectory.clearance) + (6 if deflections is None else 7)
    widths = [HISTORY_WIDTH, *[BEARING_WIDTH * columns] * (columns > 0)]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(sum(widths), 1.25 * rows), layout="constrained")
        histories, *bearings = figure.subfigures(1, len(widths), width_ratios=widths, squeeze=False)[0]
        _draw_histories(histories, trajectory, deflections)
        for part in bearings:
            _draw_bearings(part, trajectory, loose, columns)
        save_figure(figure, path, dpi=160)


def _draw_histories(figure: Any, trajectory: Trajectory, deflections: NDArray[np.float64] | None) -> None:
    time, joints = trajectory.time, trajectory.angles.shape[1]
    bent = [] if deflections is None else [0.9]
    heights = [1.2, *[0.9] * joints, 0.8, 0.8, *bent, 1.4, 0.7]
    axes = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    angles, *forces = axes[: joints + 1]
    latch, cable, *bends, energies, residual = axes[joints + 1 :]
    _draw_per_joint(angles, time, np.degrees(trajectory.angles), "angle [deg]")
    angles.legend([f"joint {joint + 1}" for joint in range(joints)], loc="upper left", ncols=4)
    angles.set_title(_conclusion(trajectory))
    for joint, lock in enumerate(trajectory.latch_times):
        angles.axvline(lock, color=COLOURS[joint % len(COLOURS)], linewidth=0.7, linestyle=":")
    for joint, axis in enumerate(forces):
        _draw_force(axis, trajectory, joint)
    _draw_per_joint(latch, time, trajectory.latch_torque, "latch torque\n[N m]")
    _draw_per_joint(cable, time, trajectory.cable_torque, "cable torque\n[N m]")
    if deflections is not None:
        _draw_per_joint(bends[0], time, 1e3 * deflections, "deflection of\npanel [mm]")
    _draw_energies(energies, trajectory)
    residual.plot(time, trajectory.energies["residual"], color="black", linewidth=0.8)
    residual.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2))
    residual.set(ylabel="energy\nresidual [J]", xlabel="time [s]", xlim=(time[0], time[-1]))
    figure.align_ylabels()


def _conclusion(trajectory: Trajectory) -> str:
    """Return the figure's title: the model, the time of the last latching, and the greatest force afterwards."""
    model = trajectory.metadata["model"]
    latched = trajectory.latch_times[np.isfinite(trajectory.latch_times)]
    if len(latched) == 0:
        return f"{model}: no joint has latched"
    return f"{model}: latched at {latched.max():.1f} s, then up to {trajectory.postlock_peak_force.max():.0f} N"


def _draw_per_joint(axis: Axes, time: NDArray[np.float64], values: NDArray[np.float64], label: str) -> None:
    for joint, column in enumerate(values.T):
        axis.plot(time, column, color=COLOURS[joint % len(COLOURS)])
    axis.set_ylabel(label)


def _draw_force(axis: Axes, trajectory: Trajectory, joint: int) -> None:
    colour = COLOURS[joint % len(COLOURS)]
    samples = trajectory.normal_force[:, joint]
    contacts = trajectory.contacts[trajectory.contacts["joint"] == joint]
    kind = "contact" if trajectory.clearance[joint] > 0.0 else "joint"
    highest = max(float(np.max(samples)), float(np.max(contacts["peak_force"], initial=0.0))) or 1.0
    # Six decades show both impacts of hundreds of newtons and quiet contact of tenths.
    lowest = 1e-6 * highest
    axis.set(ylabel=f"{kind} force\njoint {joint + 1} [N]", yscale="log", ylim=(lowest, 2.0 * highest))
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
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=7, columnspacing=1.2, handlelength=1.4)


def _draw_bearings(figure: Any, trajectory: Trajectory, loose: NDArray[np.intp], columns: int) -> None:
    grid = figure.add_gridspec(-(-2 * len(loose) // columns), columns)
    for position, joint in enumerate(loose):
        points = _draw_locus(figure.add_subplot(grid[2 * position]), trajectory, int(joint))
        surfaces = _draw_wear(figure.add_subplot(grid[2 * position + 1], projection="polar"), trajectory, int(joint))
    figure.colorbar(points, ax=figure.axes, location="bottom", label="time [s]")
    figure.legend(handles=surfaces, loc="outside lower center", ncols=2)


def _draw_locus(axis: Axes, trajectory: Trajectory, joint: int) -> Any:
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    clearance = 1e6 * trajectory.clearance[joint]
    axis.plot(clearance * np.cos(angle), clearance * np.sin(angle), color=STEEL, linewidth=1.2, zorder=0)
    x, y = 1e6 * trajectory.eccentricity[:, joint].T
    axis.plot(x, y, color=FAINT, linewidth=0.3, rasterized=True, zorder=0)
    points = axis.scatter(x, y, c=trajectory.time, cmap="viridis", s=1.5, linewidths=0, rasterized=True)
    axis.set_aspect("equal")
    axis.set_title(f"joint {joint + 1}: path of the journal [µm]")
    return points


def _draw_wear(axis: Any, trajectory: Trajectory, joint: int) -> list[Any]:
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
    return surfaces
