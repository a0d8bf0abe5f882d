"""Phases of contact, bursts, slides and lags, found by algorithms where the paper reads them off its figures."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate, correlation_lags
from scipy.stats import spearmanr

from solar_env.mechanics.running.trajectory import Trajectory

Array = NDArray[np.float64]

# s; a contact that lasts so long is no impact. Impacts last a millisecond, flights between them some milliseconds.
LASTING = 0.05
# s; of the windows in which impacts and latch torques are compared.
WINDOW = 0.25


@dataclass(frozen=True)
class Phases:
    """The three phases of a joint with clearance [s]: impacts after the start, lasting contact, impacts after latching.

    Attributes:
        settled: start of the first contact that lasts at least LASTING; nan if there is none.
        latched: when the joint latches; nan if it does not.
    """

    settled: float
    latched: float


def contacts_of(trajectory: Trajectory, joint: int) -> NDArray[np.void]:
    """The contacts of a joint in the order of their starts; those under way end with the run."""
    own = trajectory.contacts[trajectory.contacts["joint"] == joint].copy()
    own["end_s"] = np.where(np.isnan(own["end_s"]), trajectory.time[-1], own["end_s"])
    return own[np.argsort(own["start_s"], kind="stable")]


def find_phases(trajectory: Trajectory, joint: int) -> Phases:
    """Phases of contact of a joint."""
    contacts = contacts_of(trajectory, joint)
    lasting = contacts["start_s"][contacts["end_s"] - contacts["start_s"] >= LASTING]
    return Phases(float(lasting[0]) if len(lasting) else np.nan, float(trajectory.latch_times[joint]))


def contacts_in(trajectory: Trajectory, joint: int, phase: int) -> NDArray[np.void]:
    """Contacts of a joint that start in a phase; the one that settles the joint counts with neither."""
    phases, contacts = find_phases(trajectory, joint), contacts_of(trajectory, joint)
    start = contacts["start_s"]
    between = (start > phases.settled) & (start < phases.latched)
    return contacts[{1: start < phases.settled, 2: between, 3: start > phases.latched}[phase]]


def phase_of(trajectory: Trajectory, joint: int) -> NDArray[np.int64]:
    """(nt,) phase of every sample: 1 initial, 2 deployment, 3 after latching."""
    phases = find_phases(trajectory, joint)
    return 1 + (trajectory.time >= phases.settled).astype(np.int64) + (trajectory.time >= phases.latched)


def greatest_force(trajectory: Trajectory, joint: int, edges: Array) -> Array:
    """(k,) greatest contact force [N] in each of the windows between `edges` (k + 1,) [s].

    Samples alone would miss the peaks of impacts, which last a millisecond.
    """
    greatest = _maxima(trajectory.time, np.abs(trajectory.normal_force[:, joint]), edges)
    contacts = contacts_of(trajectory, joint)
    short = contacts[contacts["end_s"] - contacts["start_s"] < LASTING]
    return np.maximum(greatest, _maxima(short["start_s"], short["peak_force"], edges))


def greatest_torque(trajectory: Trajectory, joint: int, edges: Array) -> Array:
    """(k,) greatest magnitude of the latch torque [N m] in each of the windows between `edges` (k + 1,) [s]."""
    return _maxima(trajectory.time, np.abs(trajectory.latch_torque[:, joint]), edges)


def windows_after_latching(trajectory: Trajectory) -> Array:
    """Edges [s] of windows of WINDOW from the last latching to the end of the run."""
    return np.arange(float(np.nanmax(trajectory.latch_times)), trajectory.time[-1], WINDOW)


def rank_correlation(a: Array, b: Array) -> float:
    """Spearman's rank correlation of two signals: forces span decades."""
    return float(spearmanr(a, b).statistic)


def journal_angle(trajectory: Trajectory, joint: int) -> Array:
    """(nt,) direction [rad] from the centre of the bearing to that of the journal, continuous; inertial axes."""
    x, y = trajectory.eccentricity[:, joint].T
    return np.unwrap(np.arctan2(y, x))


def slide_at_latching(trajectory: Trajectory, joint: int, duration: float = 0.1) -> float:
    """Angle [rad] by which the journal slides round the wall in the time after the latching, anticlockwise positive."""
    angle, start = journal_angle(trajectory, joint), float(trajectory.latch_times[joint])
    window = (trajectory.time >= start) & (trajectory.time <= start + duration)
    moved = angle[window] - angle[window][0]
    return float(moved[np.abs(moved).argmax()])


def time_of_turning(trajectory: Trajectory, joint: int) -> float:
    """When [s], in the lasting contact of the deployment, the journal is furthest up or down."""
    phase, height = phase_of(trajectory, joint), trajectory.eccentricity[:, joint, 1]
    return float(trajectory.time[np.where(phase == 2, np.abs(height), -1.0).argmax()])


def vibration(trajectory: Trajectory, start: float, end: float, period: float = 0.5) -> float:
    """Root mean square [rad/s] of the joint rates about their running mean over `period` [s]."""
    step = float(trajectory.time[1] - trajectory.time[0])
    width = round(period / step)
    kernel = np.ones(width) / width
    inside = (trajectory.time >= start) & (trajectory.time <= end)
    rates = trajectory.rates[inside]
    means = np.stack([np.convolve(rate, kernel, "valid") for rate in rates.T], axis=1)
    first = (width - 1) // 2
    return float(np.sqrt(np.mean((rates[first : first + len(means)] - means) ** 2)))


def lag(reference: Trajectory, trajectory: Trajectory, joint: int, span: float = 10.0, longest: float = 1.0) -> float:
    """Time [s] by which the oscillation of a joint after latching lags that of a reference.

    The shift, within +- `longest`, with the greatest cross-correlation of the angles over `span` from either one's
    own last latching; a parabola through the maximum and its neighbours places it between samples.
    """
    step = float(trajectory.time[1] - trajectory.time[0])
    signals, late = [], []
    for motion in (trajectory, reference):
        latched = float(np.nanmax(motion.latch_times))
        start = int(np.searchsorted(motion.time, latched))
        late.append(float(motion.time[start]) - latched)
        angles = motion.angles[start : start + round(span / step), joint]
        signals.append(angles - angles.mean())
    shifts = correlation_lags(len(signals[0]), len(signals[1]))
    products = correlate(*signals) / (len(signals[0]) - np.abs(shifts))
    top = int(np.where(np.abs(shifts) * step <= longest, products, -np.inf).argmax())
    before, here, after = products[top - 1 : top + 2]
    between = 0.5 * (before - after) / (before - 2.0 * here + after)
    return step * (float(shifts[top]) + float(between)) + late[0] - late[1]


def _maxima(time: Array, values: Array, edges: Array) -> Array:
    """(k,) greatest value in each window; zero in windows without any."""
    greatest = np.zeros(len(edges) - 1)
    place = np.searchsorted(edges, time, side="right") - 1
    inside = (place >= 0) & (place < len(greatest))
    np.maximum.at(greatest, place[inside], values[inside])
    return greatest
