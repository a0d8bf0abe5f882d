"""Phases of contact and forces by windows, found by algorithms where the paper reads them off its figures."""

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.running.trajectory import Trajectory

Array = NDArray[np.float64]

# s; a contact that lasts so long is no impact. Impacts last a millisecond, flights between them some milliseconds.
LASTING = 0.05
# s; of the windows in which impacts and latch torques are compared.
WINDOW = 0.25


def contacts_of(trajectory: Trajectory, joint: int) -> NDArray[np.void]:
    """The contacts of a joint in the order of their starts; those under way end with the run."""
    own = trajectory.contacts[trajectory.contacts["joint"] == joint].copy()
    own["end_s"] = np.where(np.isnan(own["end_s"]), trajectory.time[-1], own["end_s"])
    return own[np.argsort(own["start_s"], kind="stable")]


def settled(trajectory: Trajectory, joint: int) -> float:
    """When the initial impacts of a joint end [s]: at the first contact that lasts; nan if there is none."""
    contacts = contacts_of(trajectory, joint)
    lasting = contacts["start_s"][contacts["end_s"] - contacts["start_s"] >= LASTING]
    return float(lasting[0]) if len(lasting) else np.nan


def contacts_in(trajectory: Trajectory, joint: int, phase: int) -> NDArray[np.void]:
    """Contacts of a joint that start in a phase; the one that settles the joint counts with neither."""
    contacts, first, latched = contacts_of(trajectory, joint), settled(trajectory, joint), trajectory.latch_times[joint]
    start = contacts["start_s"]
    return contacts[{1: start < first, 2: (start > first) & (start < latched), 3: start > latched}[phase]]


def phase_of(trajectory: Trajectory, joint: int) -> NDArray[np.int64]:
    """(nt,) phase of every sample: 1 initial, 2 deployment, 3 after latching."""
    changes = settled(trajectory, joint), trajectory.latch_times[joint]
    return 1 + np.sum([trajectory.time >= change for change in changes], axis=0)


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


def journal_angle(trajectory: Trajectory, joint: int) -> Array:
    """(nt,) direction [rad] from the centre of the bearing to that of the journal, continuous; inertial axes."""
    x, y = trajectory.eccentricity[:, joint].T
    return np.unwrap(np.arctan2(y, x))


def _maxima(time: Array, values: Array, edges: Array) -> Array:
    """(k,) greatest value in each window; zero in windows without any."""
    greatest = np.zeros(len(edges) - 1)
    place = np.searchsorted(edges, time, side="right") - 1
    inside = (place >= 0) & (place < len(greatest))
    np.maximum.at(greatest, place[inside], values[inside])
    return greatest
