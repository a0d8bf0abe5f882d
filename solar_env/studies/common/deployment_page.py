"""Deployments as pages show them: motions and charts over time, from trajectories."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build, main_body_corners
from solar_env.array.parameters.file import units
from solar_env.array.parameters.parameters import MAIN_BODY
from solar_env.array.parameters.ranges import Ranges
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.integrators.methods.table import METHODS
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.pictures.page.content import Chart, Line, Motion, Table
from solar_env.pictures.style import COLOURS, FORCE_DECADES, controller_looks

Array = NDArray[np.float64]

# Between two moments shown before the first latching, and from shortly before it on [s].
_SLOW, _FAST, _MARGIN = 0.05, 0.005, 0.1
_WINDOW = 0.2  # over which a line of several deployments takes its greatest [s]
_FEMTOMETRES = 1e15  # in a metre
_DASHES = ("solid", "dash", "dot")
_STORED = ("kinetic", "spring", "cable", "latch", "contact", "elastic")
_LOST = ("contact_dissipation", "friction_dissipation", "latch_dissipation", "material_dissipation")


def shown_samples(trajectory: Trajectory) -> NDArray[np.intp]:
    """Indices of the samples that a page shows: a few before the first latching, many from there on."""
    latched = trajectory.latch_times[np.isfinite(trajectory.latch_times)]
    begin = latched.min() - _MARGIN if len(latched) else np.inf
    step = np.where(trajectory.time < begin, _SLOW, _FAST)
    wanted = np.floor(trajectory.time / step + 1e-6) + 1e7 * (trajectory.time >= begin)
    return np.flatnonzero(np.diff(wanted, prepend=-1.0) != 0.0)


def peaks_between(trajectory: Trajectory, kept: NDArray[np.intp]) -> Array:
    """(kept, joints) greatest contact force [N] from each sample to the next of those shown.

    Every contact's own peak counts, at the greatest of the samples within it.
    """
    forces, contacts = trajectory.normal_force.copy(), trajectory.contacts
    begins = np.maximum(np.searchsorted(trajectory.time, contacts["start_s"]) - 1, 0)
    ends = np.searchsorted(trajectory.time, np.where(np.isnan(contacts["end_s"]), np.inf, contacts["end_s"]))
    for begin, end, joint, peak in zip(begins, ends, contacts["joint"], contacts["peak_force"], strict=True):
        place = begin + int(forces[begin : max(end, begin + 1), joint].argmax())
        forces[place, joint] = max(forces[place, joint], peak)
    return np.asarray(np.maximum.reduceat(forces, kept, axis=0))


def _in_words(values: Iterable[float]) -> str:
    """Numbers with few digits, as in "12.3 and 12.4"."""
    return " and ".join(f"{float(f'{value:.3g}'):g}" for value in values)


def motion_of(trajectory: Trajectory, name: str) -> Motion:
    """The array in motion.

    Args:
        trajectory: whose metadata tell model, integrator and parameters.
        name: in words.
    """
    kept, details = shown_samples(trajectory), trajectory.metadata
    parameters = ArrayParameters().with_changes(details["parameters"])
    model, _ = METHODS[details["integrator"]].formulation.compile(build(parameters, details["model"]))
    q = trajectory.coordinates[kept]
    bodies = (MAIN_BODY, *(joint.panel for joint in parameters.joints))
    axes = [centreline(model, q, body, 1) for body in bodies]
    clearance = trajectory.clearance
    return Motion(
        name=name,
        time=trajectory.time[kept],
        body=np.array([main_body_corners(parameters, ends) for ends in axes[0]]),
        panels=axes[1:],
        eccentricity=trajectory.eccentricity[kept] / np.where(clearance > 0.0, clearance, np.inf)[:, None],
        clearance=clearance,
        force=trajectory.normal_force[kept],
        latch_times=trajectory.latch_times,
        torque=trajectory.motor_torque[kept].sum(axis=1),
    )


def parameter_table(parameters: ArrayParameters, ranges: Ranges | None = None) -> Table:
    """Every parameter of an array with its unit, folded.

    Args:
        parameters: of the array.
        ranges: of what is drawn for every run, if anything is.
    """
    known, drawn = units(), ranges or {}
    columns = ("parameter", "value", "unit", *(("drawn between",) if drawn else ()))
    rows = []
    for name, value in parameters.to_dict().items():
        between = [" and ".join(map(_entered, drawn[name]))] if name in drawn else [""] if drawn else []
        rows.append([name, _entered(value), known[name], *between])
    return Table("Parameters of the array", columns, rows, folded=True)


def _entered(value: Any) -> str:
    """A value of a parameter as one would write it."""
    if isinstance(value, (list, tuple)):
        return f"({', '.join(map(_entered, value))})"
    if value is None or isinstance(value, bool):
        return {None: "from others", True: "yes", False: "no"}[value]
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def charts_of(trajectories: Mapping[str, Trajectory]) -> list[Chart]:
    """Angles, forces, gaps, torques, energies and wear of deployments by their names.

    A single deployment has a colour for each joint; of several each has that of its controller, and each joint a dash.
    Forces and gaps, which jump from impact to impact, would hide each other there: of several deployments each has one
    line, the greatest of all joints, window by window.
    """
    single, looks = len(trajectories) == 1, controller_looks(list(trajectories))

    def lines_of(read: Callable[[Trajectory], tuple[Array, Array]]) -> list[Line]:
        lines = []
        for name, trajectory in trajectories.items():
            x, values = read(trajectory)
            for j in range(values.shape[1]):
                label = f"joint {j + 1}" if single else f"{name}, joint {j + 1}"
                colour = COLOURS[j % len(COLOURS)] if single else looks[name]["color"]
                dash = "solid" if single else _DASHES[j % len(_DASHES)]
                lines.append(Line(label, x, values[:, j], colour, dash))
        return lines

    def by_joint(read: Callable[[Trajectory, NDArray[np.intp]], Array]) -> list[Line]:
        def shown(trajectory: Trajectory) -> tuple[Array, Array]:
            kept = shown_samples(trajectory)
            return trajectory.time[kept], read(trajectory, kept)

        return lines_of(shown)

    def worn(trajectory: Trajectory) -> tuple[Array, Array]:
        """Depth [fm] of the bearings' wear round them, in their bodies' own frames."""
        angles = np.linspace(0.0, 360.0, trajectory.wear_bearing.shape[1], endpoint=False)
        return angles, _FEMTOMETRES * trajectory.wear_bearing.T

    titles = _single_titles(next(iter(trajectories.values()))) if single else _titles(trajectories)
    charts = [Chart(titles["angles"], "time [s]", "angle [deg]", by_joint(lambda t, k: np.degrees(t.angles[k])))]
    if single:
        charts += [
            Chart(titles["forces"], "time [s]", "greatest from point to point [N]", by_joint(peaks_between)),
            Chart(titles["gaps"], "time [s]", "gap [mm], 0 in contact", by_joint(lambda t, k: -1e3 * t.penetration[k])),
        ]
    else:
        gaps = _compared(trajectories, lambda t: np.maximum(-1e3 * t.penetration, 0.0))
        label = f"greatest gap in {_WINDOW:g} s, any joint [mm]"
        charts += [_compared_forces(titles["forces"], trajectories), Chart(titles["gaps"], "time [s]", label, gaps)]
    charts.append(Chart(titles["torques"], "time [s]", "torque [N m]", by_joint(lambda t, k: t.latch_torque[k])))
    if any(t.motor_torque.any() for t in trajectories.values()):
        driven = by_joint(lambda t, k: t.motor_torque[k][:, t.motor_torque.any(axis=0)])
        charts.append(Chart(titles["motor"], "time [s]", "torque [N m]", driven))
    stored = "energy [J]" if single else "stored energy [J]"
    charts.append(Chart(titles["energies"], "time [s]", stored, _energies(trajectories)))
    if any(t.wear_depth.any() for t in trajectories.values()):
        charts.append(Chart(titles["wear"], "", "fm", lines_of(worn), False, polar=True))
    return charts


def _single_titles(trajectory: Trajectory) -> dict[str, str]:
    lost = sum(float(trajectory.energies[part][-1]) for part in _LOST) / trajectory.energy_put_in
    return {
        "angles": f"The joints latch after {' and '.join(f'{time:.2f}' for time in trajectory.latch_times)} s",
        "forces": f"Contact forces peak at {_in_words(trajectory.peak_force)} N",
        "torques": f"Latch torques reach {_in_words(np.abs(trajectory.latch_torque).max(axis=0))} N m",
        "gaps": f"Journals touch their bearings {_in_words(100.0 * _touching(trajectory))} % of the time",
        "motor": f"The motor turns with up to {np.abs(trajectory.motor_torque).max():.3g} N m",
        "energies": f"{lost:.0%} of the energy put in is lost by the end",
        "wear": f"Bearings wear by up to {_in_words(_FEMTOMETRES * trajectory.wear_bearing.max(axis=1))} fm (1e-15 m)",
    }


def _titles(trajectories: Mapping[str, Trajectory]) -> dict[str, str]:
    """Titles of figures of several deployments: which one stands out."""
    latest = {name: float(np.nanmax(t.latch_times, initial=0.0)) for name, t in trajectories.items()}
    peaks = {name: float(t.postlock_peak_force.max()) for name, t in trajectories.items()}
    torques = {name: float(np.abs(t.latch_torque).max()) for name, t in trajectories.items()}
    touching = {name: -float(_touching(t).mean()) for name, t in trajectories.items()}
    left = {name: sum(float(t.energies[part][-1]) for part in _STORED) for name, t in trajectories.items()}
    worn = {name: float(t.wear_bearing.max(initial=0.0)) for name, t in trajectories.items()}
    turned = {
        name: float(np.sqrt(np.square(t.motor_torque).sum(axis=1).mean()))
        for name, t in trajectories.items()
        if t.motor_torque.any()
    } or dict.fromkeys(trajectories, 0.0)
    compared = (latest, peaks, torques, touching, left, worn, turned)
    soonest, softest, least, closest, calmest, freshest, laziest = (min(v, key=v.__getitem__) for v in compared)
    return {
        "angles": f"{soonest} is the first to latch, after {latest[soonest]:.3g} s",
        "forces": f"{softest} lands softest: after latching at most {peaks[softest]:.3g} N",
        "torques": f"{least} loads the latches least, with {torques[least]:.3g} N m at most",
        "gaps": f"Journals touch longest under {closest}, {-touching[closest]:.0%} of the time",
        "motor": f"{laziest} needs the least torque, {turned[laziest]:.3g} N m (root mean square)",
        "energies": f"{calmest} is left with the least energy, {left[calmest]:.3g} J",
        "wear": f"{freshest} wears bearings least, by {_FEMTOMETRES * worn[freshest]:.3g} fm (1e-15 m) at most",
    }


def _touching(trajectory: Trajectory) -> Array:
    """Share of the time in which each journal touches its bearing."""
    return np.asarray(np.average(trajectory.penetration[1:] > 0.0, axis=0, weights=np.diff(trajectory.time)))


def greatest_in_windows(time: Array, values: Array) -> tuple[Array, Array]:
    """The beginnings of windows of time, and the greatest of (n, joints) values in each, at any joint."""
    number = np.floor(time / _WINDOW + 1e-6)
    starts = np.flatnonzero(np.diff(number, prepend=-1.0))
    return time[starts], np.asarray(np.maximum.reduceat(values.max(axis=1), starts))


def _compared(trajectories: Mapping[str, Trajectory], read: Callable[[Trajectory], Array]) -> list[Line]:
    looks = controller_looks(list(trajectories))
    return [
        Line(name, *greatest_in_windows(trajectory.time, read(trajectory)), looks[name]["color"])
        for name, trajectory in trajectories.items()
    ]


def _compared_forces(title: str, trajectories: Mapping[str, Trajectory]) -> Chart:
    """Forces of several deployments, on the scale of the frames: soft landings show beside hard ones."""
    lines = _compared(trajectories, lambda t: peaks_between(t, np.arange(len(t.time))))
    low, high = (10.0**decade for decade in FORCE_DECADES)
    limits = low, max(high, *(1.1 * float(line.y.max()) for line in lines))
    # What is zero lies a little below the axis, lest the line end there.
    lines = [replace(line, y=np.maximum(line.y, 0.63 * low)) for line in lines]
    label = f"greatest in {_WINDOW:g} s, any joint [N]"
    return Chart(title, "time [s]", label, lines, logarithmic="y", limits=limits)


def _energies(trajectories: Mapping[str, Trajectory]) -> list[Line]:
    """Parts of the energy of a single deployment; of several what each has stored, as in their title."""
    lines, looks = [], controller_looks(list(trajectories))
    for name, trajectory in trajectories.items():
        kept, energies = shown_samples(trajectory), trajectory.energies
        time, stored = trajectory.time[kept], np.sum([energies[part] for part in _STORED], axis=0)
        if len(trajectories) > 1:
            lines.append(Line(name, time, stored[kept], looks[name]["color"]))
            continue
        lost = np.sum([energies[part] for part in _LOST], axis=0)
        parts = {"kinetic": energies["kinetic"], "springs": energies["spring"], "all stored": stored, "lost": lost}
        lines += [Line(part, time, parts[part][kept], COLOURS[i]) for i, part in enumerate(parts)]
    return lines
