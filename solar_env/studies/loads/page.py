"""Web page on an ensemble of deployments: results in words, animation, vibration modes, spectra and sensitivities."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from solar_env.array.construction import main_body_frame
from solar_env.array.deployment import compiled
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.pictures.page.content import Chart, Line, Page
from solar_env.pictures.style import COLOURS
from solar_env.studies.common.deployment_page import charts_of, motion_of, parameter_table, shown_samples
from solar_env.studies.loads.ensemble import Loads
from solar_env.studies.loads.report import answer, full_name, sureness, tables, what_changes, worst_joint
from solar_env.studies.loads.runs import FREQUENCIES, Deployment
from solar_env.studies.loads.sensitivity import SHARE, Effects
from solar_env.studies.loads.statics import first_modes
from solar_env.studies.loads.statistics import shortened

Array = NDArray[np.float64]

_BARS = 8  # greatest number of parameters in a chart of sensitivities


def loads_page(loads: Loads, nominal: Deployment, notes: Sequence[str], before: Sequence[str] = ()) -> Page:
    """Return a web page (`Page`) on an ensemble, with an animation and plots of the nominal array's run, `nominal`.

    The sentences `before`, known before any run, are inserted after the text's first sentence. `notes` close the page.
    """
    name = f"Nominal array, {loads.plan.levels[0].name}"
    charts = [
        *charts_of({name: nominal.trajectory}),
        *_hub_charts(nominal),
        *_ringing(nominal),
        *_modes(loads),
        *_spectra(loads),
        *_tornados(loads),
    ]
    motions = [motion_of(nominal.trajectory, name)]
    title = "How hard the hinges and the hub are hit"
    parameters = parameter_table(loads.plan.array.parameters, loads.plan.array.randomize)
    words = [*answer(loads, before), what_changes(loads)]
    return Page(title, words, motions, charts, [*tables(loads), parameters], notes)


def _hub_charts(nominal: Deployment) -> Iterator[Chart]:
    """Yield charts of the hub's rotation, and of peak force and torque on it from each plotted sample to the next."""
    kept, time = shown_samples(nominal.trajectory), nominal.trajectory.time
    turn = np.degrees(nominal.place[kept, 2] - nominal.place[0, 2])
    line = Line("hub", time[kept], turn, COLOURS[0])
    yield Chart(f"The nominal hub turns by up to {np.abs(turn).max():.3g} degrees", "time [s]", "angle [deg]", [line])
    begins = kept[kept < len(time) - 1]
    greatest = np.maximum.reduceat(nominal.hub_greatest, begins, axis=0)
    for k, (name, unit) in enumerate((("force of the root hinge", "N"), ("torque about its centroid", "N m"))):
        values = greatest[:, k]
        title = f"The nominal hub sees up to {shortened(values.max(), 3)} {unit}"
        yield Chart(title, "time [s]", f"greatest over 50 us [{unit}]", [Line(name, time[begins], values, COLOURS[0])])


def _ringing(nominal: Deployment) -> Iterator[Chart]:
    """Yield a chart of wing tip displacements along the hub's y axis after the last latching, less their means."""
    trajectory = nominal.trajectory
    after = np.flatnonzero(trajectory.time > trajectory.latch_times.max())
    if len(after) < 2:
        return
    lines, told = [], []
    p, model = compiled(trajectory)
    q, time = trajectory.coordinates[after], trajectory.time[after]
    centroid, _, across = main_body_frame(p, centreline(model, q, 0))
    for wing, joint in enumerate(p.joints[p.panel_count - 1 :: p.panel_count]):
        tip = centreline(model, q, joint.panel, 1)[:, -1] - centroid
        moved = 1e3 * np.sum(tip * across, axis=1)
        moved -= moved.mean()
        lines.append(Line(f"wing {wing + 1}", time, moved, COLOURS[wing]))
        told.append(f"{np.abs(moved).max():.2g} mm at {_main_frequency(moved, time[1] - time[0]):.2g} Hz")
    yield Chart(f"After the last latching the tip rings by up to {' and '.join(told)}", "time [s]", "tip [mm]", lines)


def _main_frequency(history: Array, step: float) -> float:
    """Return the frequency [Hz] of the highest spectral peak of `history` (time step `step` [s]), Hann-windowed."""
    padded = 8 * len(history)
    spectrum = np.abs(np.fft.rfft(history * np.hanning(len(history)), padded))
    return float(np.fft.rfftfreq(padded, step)[spectrum.argmax()])


def _modes(loads: Loads) -> Iterator[Chart]:
    """Yield two charts of the first vibration modes' shapes: with the hub held, and with the hub free."""
    for held in (True, False):
        modes = first_modes(loads.plan.array.parameters, held)
        frequencies = [f"{frequency:.3g}" for frequency in modes.frequencies]
        names = ["deployed", *(f"{frequency} Hz" for frequency in frequencies)]
        lines = [
            Line(name, axis[:, 0], axis[:, 1], COLOURS[k], "solid" if k else "dot")
            for k, (name, axis) in enumerate(zip(names, modes.axes, strict=True))
        ]
        title = f"Deployed, hub {'held' if held else 'free'}: the wing vibrates at {', '.join(frequencies)} Hz"
        yield Chart(title, "x [m]", "y, of modes to any scale [m]", lines, False)


def _spectra(loads: Loads) -> Iterator[Chart]:
    """Yield charts of shock spectra: mean and maximum of runs at the plan's model fidelity, and mean at the finest."""
    if not loads.hub_spectrum.size:
        return
    greatest = loads.hinge_spectrum[0].mean(axis=0).max(axis=0)
    worst, hub = int(greatest.argmax()), loads.hub_spectrum[0].mean(axis=0).max()
    hinges = [_spectrum(loads.hinge_spectrum[..., j], f"joint {j + 1}, ", j) for j in range(len(greatest))]
    title = f"hinge forces (Q = 10): up to {greatest[worst]:.3g} N, at hinge {worst + 1}"
    yield _spectrum_chart(title, "force [N]", [line for lines in hinges for line in lines])
    title = f"the hub (Q = 10): up to {hub:.2g} m/s2"
    yield _spectrum_chart(title, "acceleration [m/s2]", _spectrum(loads.hub_spectrum, "", 0))


def _spectrum_chart(what: str, y: str, lines: Sequence[Line]) -> Chart:
    return Chart(f"Shock response of {what}", "natural frequency [Hz]", y, lines, False, "xy")


def _spectrum(spectra: Array, prefix: str, colour: int) -> list[Line]:
    runs, finest = spectra
    rows = (
        ("mean", runs.mean(axis=0), "solid"),
        ("greatest", runs.max(axis=0), "dot"),
        ("finest level", finest.mean(axis=0), "dash"),
    )
    return [Line(prefix + name, FREQUENCIES, values, COLOURS[colour], dash) for name, values, dash in rows]


def _tornados(loads: Loads) -> Iterator[Chart]:
    """Yield a bar chart per quantity, with the parameters that change it most, at the joint where it is greatest."""
    for name, by_joint in loads.sensitivity.effects.items():
        joint = worst_joint(loads.figures[name])
        effects, what = by_joint[joint], full_name(loads, name, joint)
        if shown := effects.ranking[:_BARS]:
            title = f"{what[0].upper()}{what[1:]} changes most with {shown[0]}; {sureness(effects)}"
            yield _tornado(title, effects, shown)


def _tornado(title: str, effects: Effects, shown: Sequence[str]) -> Chart:
    places = np.repeat(np.arange(len(shown), dtype=float), 3)

    def bars(begin: Array, end: Array) -> Array:
        return np.column_stack([begin, end, np.full(len(shown), np.nan)]).ravel()

    low, high = (np.array([ends[name] for name in shown]) for ends in (effects.low, effects.high))
    if np.isfinite(effects.explained):
        middle = 0.5 * (low + high)
        lines = [
            Line("coefficient", bars(0.0 * middle, middle), places, COLOURS[0]),
            Line("its 95 % interval", bars(low, high), places + 0.28, COLOURS[1], "dash"),
        ]
        return Chart(title, "standardised coefficient", "", lines, False, bars=shown)
    lines = [
        Line(f"{100 * SHARE:g} % {word}", bars(0.0 * ends, 100.0 * ends), places, COLOURS[k])
        for k, (word, ends) in enumerate((("less", low), ("more", high)))
    ]
    return Chart(title, "change [%]", "", lines, False, bars=shown)
