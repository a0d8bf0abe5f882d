"""Content of web pages and films that show deployments: animations, frames and charts, made from trajectories."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, Ranges, main_body_corners
from solar_env.array.deployment import compiled
from solar_env.array.parameters.file import units
from solar_env.array.parameters.parameters import MAIN_BODY
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.pictures.frame import Scene
from solar_env.pictures.page.content import Chart, Line, Motion, Table
from solar_env.pictures.plots import DISSIPATED, STORED
from solar_env.pictures.style import COLOURS, FORCE_DECADES, controller_looks

Array = NDArray[np.float64]
Samples = NDArray[np.intp]
Reading = Callable[[Trajectory], tuple[Array, Array]]  # (n,) horizontal values, (n, lines) vertical values

# Times between shown samples [s], at first and later; the later interval begins _MARGIN [s] before the first latching.
_SLOW, _FAST, _MARGIN = 0.05, 0.005, 0.1
_WINDOW = 0.2  # length [s] of the windows whose greatest values are drawn when a chart compares several deployments
_FEMTOMETRES = 1e15  # femtometres per metre
_DASHES = ("solid", "dash", "dot")


def shown_samples(trajectory: Trajectory) -> Samples:
    """Return indices of the samples that a page shows: every 50 ms; every 5 ms from 0.1 s before the first latching."""
    latched = trajectory.latch_times[np.isfinite(trajectory.latch_times)]
    begin = latched.min() - _MARGIN if len(latched) else np.inf
    step = np.where(trajectory.time < begin, _SLOW, _FAST)
    wanted = np.floor(trajectory.time / step + 1e-6) + 1e7 * (trajectory.time >= begin)
    return np.flatnonzero(np.diff(wanted, prepend=-1.0) != 0.0)


def peaks_between(trajectory: Trajectory, kept: Samples) -> Array:
    """Return (kept, joints) greatest contact forces [N] from each sample index in `kept` to the next, or to the end.

    Samples may miss a contact's peak. The contact's recorded peak force therefore replaces its greatest sampled force.
    """
    forces, contacts = trajectory.normal_force.copy(), trajectory.contacts
    begins = np.maximum(np.searchsorted(trajectory.time, contacts["start_s"]) - 1, 0)
    ends = np.searchsorted(trajectory.time, np.where(np.isnan(contacts["end_s"]), np.inf, contacts["end_s"]))
    for begin, end, joint, peak in zip(begins, ends, contacts["joint"], contacts["peak_force"], strict=True):
        place = begin + int(forces[begin : max(end, begin + 1), joint].argmax())
        forces[place, joint] = max(forces[place, joint], peak)
    return np.asarray(np.maximum.reduceat(forces, kept, axis=0))


def motion_of(trajectory: Trajectory, name: str) -> Motion:
    """Return the animation that a page shows as `name`, from a trajectory whose metadata hold model and parameters."""
    kept = shown_samples(trajectory)
    body, panels = _lines(trajectory, kept)
    clearance = trajectory.clearance
    return Motion(
        name=name,
        time=trajectory.time[kept],
        body=body,
        panels=panels,
        eccentricity=trajectory.eccentricity[kept] / np.where(clearance > 0.0, clearance, np.inf)[:, None],
        clearance=clearance,
        force=trajectory.normal_force[kept],
        latch_times=trajectory.latch_times,
        torque=_motors(trajectory)[kept],
    )


def _lines(trajectory: Trajectory, kept: Samples) -> tuple[Array, list[Array]]:
    """Return the main body's corners (kept, 4, 2) and a list of panel axes (kept, points, 2) [m] at samples `kept`."""
    parameters, model = compiled(trajectory)
    bodies = (MAIN_BODY, *(joint.panel for joint in parameters.joints))
    axes = [centreline(model, trajectory.coordinates[kept], body, 1) for body in bodies]
    return main_body_corners(parameters, axes[0]), axes[1:]


def _motors(trajectory: Trajectory) -> Array:
    """Return the (nt, motors) torques [N m] of all motors that ever acted; if no motor did, one column of zeros."""
    turned = np.flatnonzero(trajectory.motor_torque.any(axis=0))
    return trajectory.motor_torque[:, turned if len(turned) else [0]]


def scenes_of(trajectory: Trajectory, interval: float) -> list[Scene]:
    """Return a film's frames, one every `interval` [s]; each has a history of peak forces, one per earlier interval."""
    times = np.arange(0.0, trajectory.time[-1] + 0.5 * interval, interval)
    kept = np.minimum(np.searchsorted(trajectory.time, times - 1e-9), len(trajectory.time) - 1)
    body, panels = _lines(trajectory, kept)
    peaks, motors = peaks_between(trajectory, kept), _motors(trajectory)
    history = np.concatenate([np.zeros_like(peaks[:1]), peaks])
    return [
        Scene(
            time=float(times[k]),
            main_body=body[k],
            panels=tuple(panel[k] for panel in panels),
            hinges=np.array([panel[k, 0] for panel in panels]) - trajectory.eccentricity[sample],
            eccentricity=trajectory.eccentricity[sample],
            clearance=trajectory.clearance,
            in_contact=trajectory.penetration[sample] > 0.0,
            normal_force=trajectory.normal_force[sample],
            latched=trajectory.latch_times <= times[k],
            motor_torques=tuple(motors[sample].tolist()),
            force_times=times[: k + 1],
            force_history=history[: k + 1],
            wings=trajectory.metadata["parameters"].get("wings", 1),
        )
        for k, sample in enumerate(kept.tolist())
    ]


def parameter_table(parameters: ArrayParameters, ranges: Ranges | None = None) -> Table:
    """Return a collapsible table of all parameters: value, unit, whether it is the default one, sampled range."""
    known, drawn, default = units(), ranges or {}, ArrayParameters().to_dict()
    columns = ("parameter", "value", "unit", "default", *(("drawn between",) if drawn else ()))
    rows = []
    for name, value in parameters.to_dict().items():
        between = [" and ".join(map(_entered, drawn[name]))] if name in drawn else [""] if drawn else []
        rows.append([name, _entered(value), known[name], "yes" if value == default[name] else "no", *between])
    return Table("Parameters of the array", columns, rows, folded=True)


def _entered(value: object) -> str:
    """Format a parameter's value as a user would write it."""
    if isinstance(value, (list, tuple)):
        return f"({', '.join(map(_entered, value))})"
    if value is None or isinstance(value, bool):
        return {None: "from others", True: "yes", False: "no"}[value]
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def charts_of(trajectories: Mapping[str, Trajectory]) -> list[Chart]:
    """Return charts of joint angles, contact forces, gaps, torques, energies and wear, for runs given by name.

    With one run, every joint has a colour. With several, every run (controller) has a colour, every joint a dash style.
    Forces and gaps jump from impact to impact, and the lines of several runs would hide each other. Each of several
    runs therefore has one line of forces and one of gaps: the greatest of all joints in each time window.
    """
    single = len(trajectories) == 1

    def lines(read: Reading, parts: Sequence[str] = ()) -> list[Line]:
        found = []
        for name, look in controller_looks(list(trajectories)).items():
            x, values = read(trajectories[name])
            for k, y in enumerate(values.T):
                part = parts[k] if parts else f"joint {k + 1}"
                if single:
                    found.append(Line(part, x, y, COLOURS[k % len(COLOURS)]))
                else:
                    label = name if len(values.T) == 1 else f"{name}, {part}"
                    found.append(Line(label, x, y, look["color"], _DASHES[k % len(_DASHES)]))
        return found

    def chart(key: str, y: str, read: Reading, parts: Sequence[str] = ()) -> Chart:
        return Chart(_title(key, trajectories), "time [s]", y, lines(read, parts))

    charts = [chart("angles", "angle [deg]", _shown(lambda t, k: np.degrees(t.angles[k])))]
    if single:
        charts.append(chart("forces", "greatest from point to point [N]", _shown(peaks_between)))
        charts.append(chart("gaps", "gap [mm], 0 in contact", _shown(lambda t, k: -1e3 * t.penetration[k])))
    else:
        within = f"in {_WINDOW:g} s, any joint"
        forces = _greatest(lambda t: peaks_between(t, np.arange(len(t.time))))
        charts.append(_on_scale_of_forces(chart("forces", f"greatest {within} [N]", forces)))
        gaps = _greatest(lambda t: np.maximum(-1e3 * t.penetration, 0.0))
        charts.append(chart("gaps", f"greatest gap {within} [mm]", gaps))
    charts.append(chart("torques", "torque [N m]", _shown(lambda t, k: t.latch_torque[k])))
    if any(t.motor_torque.any() for t in trajectories.values()):
        driven = _shown(lambda t, k: t.motor_torque[k][:, t.motor_torque.any(axis=0)])
        charts.append(chart("motor", "torque [N m]", driven))
    if single:
        charts.append(chart("energies", "energy [J]", _shown(_energies), ("kinetic", "springs", "all stored", "lost")))
    else:
        charts.append(chart("energies", "stored energy [J]", _shown(lambda t, k: _energies(t, k)[:, 2:3])))
    if any(t.wear_depth.any() for t in trajectories.values()):
        charts.append(Chart(_title("wear", trajectories), "", "fm", lines(_worn), False, polar=True))
    return charts


def _shown(read: Callable[[Trajectory, Samples], Array]) -> Reading:
    """Return a function from a trajectory to the times of `shown_samples` and the values of `read` at these samples."""

    def reading(trajectory: Trajectory) -> tuple[Array, Array]:
        kept = shown_samples(trajectory)
        return trajectory.time[kept], read(trajectory, kept)

    return reading


def _greatest(read: Callable[[Trajectory], Array]) -> Reading:
    return lambda trajectory: greatest_in_windows(trajectory.time, read(trajectory))


def greatest_in_windows(time: Array, values: Array) -> tuple[Array, Array]:
    """Return start times [s] of 0.2 s windows, and the (windows, 1) maxima of `values` (n, joints) over all joints."""
    starts = np.flatnonzero(np.diff(np.floor(time / _WINDOW + 1e-6), prepend=-1.0))
    return time[starts], np.maximum.reduceat(values.max(axis=1, keepdims=True), starts)


def _energies(trajectory: Trajectory, kept: Samples) -> Array:
    """Return (kept, 4) energies [J] at the sample indices `kept`: kinetic, spring, total stored, total dissipated."""
    energies = trajectory.energies
    stored, lost = (np.sum([energies[part] for part in parts], axis=0) for parts in (STORED, DISSIPATED))
    return np.column_stack([energies["kinetic"], energies["spring"], stored, lost])[kept]


def _worn(trajectory: Trajectory) -> tuple[Array, Array]:
    """Return (bins,) angles [deg] round a bearing, in its body's frame, and (bins, joints) wear depths there [fm]."""
    angles = np.linspace(0.0, 360.0, trajectory.wear_bearing.shape[1], endpoint=False)
    return angles, _FEMTOMETRES * trajectory.wear_bearing.T


def _on_scale_of_forces(chart: Chart) -> Chart:
    """Return a chart with a logarithmic axis of forces from 0.01 N to 1 kN or above; zeros are drawn below 0.01 N."""
    low, high = (10.0**decade for decade in FORCE_DECADES)
    limits = low, max(high, *(1.1 * float(line.y.max()) for line in chart.lines))
    lines = [replace(line, y=np.maximum(line.y, 0.63 * low)) for line in chart.lines]
    return replace(chart, lines=lines, logarithmic="y", limits=limits)


# Chart -> title, and reader of the title's values (one per joint, or one); comparisons show the greatest value.
_TITLES: Mapping[str, tuple[str, Callable[[Trajectory], Array]]] = {
    "angles": ("Joints latch after {} s", lambda t: t.latch_times),
    "forces": ("Contact forces after latching peak at {} N", lambda t: t.postlock_peak_force),
    "torques": ("Latch torques reach {} N m", lambda t: np.abs(t.latch_torque).max(axis=0)),
    "gaps": (
        "Journals touch their bearings {} % of the time",
        lambda t: 100.0 * np.average(t.penetration[1:] > 0.0, axis=0, weights=np.diff(t.time)),
    ),
    "motor": ("The motor turns with up to {} N m", lambda t: np.abs(t.motor_torque).max().reshape(1)),
    "energies": ("{} J of energy are left at the end", lambda t: _energies(t, np.array([-1]))[:, 2]),
    "wear": ("Bearings wear by up to {} fm (1e-15 m)", lambda t: _FEMTOMETRES * t.wear_bearing.max(axis=1)),
}


def _title(key: str, trajectories: Mapping[str, Trajectory]) -> str:
    sentence, read = _TITLES[key]
    values = {name: read(trajectory) for name, trajectory in trajectories.items()}
    if len(values) == 1:
        told = [_short(value) for by_joint in values.values() for value in by_joint]
    else:
        told = [f"{_short(by_joint.max())} ({name})" for name, by_joint in values.items()]
    return sentence.format(" and ".join(told))


def _short(value: float) -> str:
    return f"{float(f'{value:.3g}'):g}"
