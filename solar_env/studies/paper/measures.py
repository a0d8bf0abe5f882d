"""Quantities that test the paper's claims; each is a function of the trajectories of a claim's deployments, in order.

`ratio`, `both`, `joint_2_over_1`, `over_joints` and `large_over_small` make such functions from simpler quantities.
"""

import math
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate, correlation_lags
from scipy.stats import spearmanr

from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.paper.cases import JOINTS

Array = NDArray[np.float64]
Figure = Callable[[Trajectory], float]
FigureOfJoint = Callable[[Trajectory, int], float]
Comparison = Callable[[Trajectory, Trajectory], float]

LASTING = 0.05  # s; a contact this long or longer is no impact: impacts last a millisecond, flights some milliseconds
WINDOW = 0.25  # s; length of the windows in which impacts and latch torques are compared
TOUCH_TOLERANCE = 1e-6  # m; a journal nearer to the wall than this touches it
FIRST_PEAK = 0.4  # s; the first peak of a latch torque comes within this time of the latching
LATE = 20.0  # s; time after which the late cable torque is compared
QUIET = (2.0, 12.5)  # s; times between which vibrations are compared, clear of the start and of the latching
RUNNING_MEAN = 0.5  # s; width of the running mean; slower motion does not count as vibration
SLIDE = 0.1  # s; duration of the slide round the wall at latching
LAGGING, LONGEST_LAG = 10.0, 1.0  # s; duration of the compared oscillations, and their greatest shift
SETTLED = 0.25  # fraction of the greatest lock torque below which a settled lock torque stays
BURSTS = (15.74, 17.63, 20.59, 28.48, 29.33)  # s; times at which the paper's Fig 10 shows bursts of impacts
LAST_BURSTS = 27.5  # s; the last two bursts come after this time


def ratio(figure: Figure) -> Comparison:
    """Return a function of two trajectories: the quantity `figure` of the first divided by the second's."""
    return lambda motion, reference: figure(motion) / figure(reference)


def both(choose: Callable[[Iterable[float]], float], figure: Callable[..., float]) -> Callable[..., float]:
    """Return a function of trajectories: `choose`, such as `max`, of figure(*trajectories, joint=j) for j = 0 and 1."""
    return lambda *motions: choose(figure(*motions, joint=joint) for joint in JOINTS)


def joint_2_over_1(figure: FigureOfJoint) -> Figure:
    """Return a function of a trajectory: the quantity `figure` of joint 2 divided by joint 1's."""
    return lambda motion: figure(motion, 1) / figure(motion, 0)


def over_joints(choose: Callable[[Iterable[float]], float], figure: FigureOfJoint) -> Comparison:
    """Return a function of trajectories a, b: `choose`, such as `max`, of all figure(a, joint) / figure(b, joint)."""
    return lambda motion, reference: choose(figure(motion, joint) / figure(reference, joint) for joint in JOINTS)


def large_over_small(figure: FigureOfJoint, joint: int) -> Comparison:
    """Return a function: a joint's quantity `figure` at 0.2 mm clearance, divided by its value at 0.1 mm.

    The function takes two trajectories. In the first, joint 0 has 0.1 mm and joint 1 has 0.2 mm (distribution 1); in
    the second, conversely (distribution 2). For `joint` 0 the second is thus the numerator, for `joint` 1 the first.
    """
    return lambda one, two: figure((two, one)[joint], joint) / figure((one, two)[joint], joint)


def contacts_of(motion: Trajectory, joint: int) -> NDArray[np.void]:
    """Return a joint's contact records, sorted by start time; a contact still open at the end of the run ends there."""
    contacts = motion.contacts[motion.contacts["joint"] == joint].copy()
    contacts["end_s"] = np.where(np.isnan(contacts["end_s"]), motion.time[-1], contacts["end_s"])
    return contacts[np.argsort(contacts["start_s"], kind="stable")]


def settled(motion: Trajectory, joint: int) -> float:
    """Return the end of a joint's initial impacts [s]: the start of its first contact of 0.05 s or more, or nan."""
    contacts = contacts_of(motion, joint)
    lasting = contacts["start_s"][contacts["end_s"] - contacts["start_s"] >= LASTING]
    return float(lasting[0]) if len(lasting) else np.nan


def contacts_in(motion: Trajectory, joint: int, phase: int) -> NDArray[np.void]:
    """Return a joint's contacts that start in a phase: 1 initial impacts, 2 later deployment, 3 after its latching.

    The first contact of 0.05 s or more, which ends the initial impacts, is left out.
    """
    contacts, first, latched = contacts_of(motion, joint), settled(motion, joint), motion.latch_times[joint]
    start = contacts["start_s"]
    return contacts[{1: start < first, 2: (start > first) & (start < latched), 3: start > latched}[phase]]


def phase_of(motion: Trajectory, joint: int) -> NDArray[np.int64]:
    """Return a joint's (nt,) phase at every sample: 1 initial impacts, 2 later deployment, 3 after its latching."""
    changes = settled(motion, joint), motion.latch_times[joint]
    return 1 + np.sum([motion.time >= change for change in changes], axis=0)


def greatest_force(motion: Trajectory, joint: int, edges: Array) -> Array:
    """Return the (k,) greatest contact forces [N], impacts included, in the windows between `edges` (k + 1,) [s]."""
    greatest = _maxima(motion.time, np.abs(motion.normal_force[:, joint]), edges)
    contacts = contacts_of(motion, joint)
    short = contacts[contacts["end_s"] - contacts["start_s"] < LASTING]
    return np.maximum(greatest, _maxima(short["start_s"], short["peak_force"], edges))


def greatest_torque(motion: Trajectory, joint: int, edges: Array) -> Array:
    """Return the (k,) greatest latch torque magnitude [N m] in each of the windows between `edges` (k + 1,) [s]."""
    return _maxima(motion.time, np.abs(motion.latch_torque[:, joint]), edges)


def windows_after_latching(motion: Trajectory) -> Array:
    """Return the edges [s] of time windows of length WINDOW, from the last latching to the end of the run."""
    return np.arange(float(np.nanmax(motion.latch_times)), motion.time[-1], WINDOW)


def journal_angle(motion: Trajectory, joint: int) -> Array:
    """Return the (nt,) continuous direction [rad] from the bearing's to the journal's centre, in inertial axes."""
    x, y = motion.eccentricity[:, joint].T
    return np.unwrap(np.arctan2(y, x))


def _maxima(time: Array, values: Array, edges: Array) -> Array:
    """Return the (k,) maxima of `values`, sampled at `time`, in windows between `edges` (k + 1,); 0 in empty ones."""
    greatest = np.zeros(len(edges) - 1)
    place = np.searchsorted(edges, time, side="right") - 1
    inside = (place >= 0) & (place < len(greatest))
    np.maximum.at(greatest, place[inside], values[inside])
    return greatest


def rank_correlation(a: Array, b: Array) -> float:
    """Return Spearman's rank correlation of two signals; ranks suit forces, which span decades."""
    return float(spearmanr(a, b).statistic)


def decay(motion: Trajectory, joint: int) -> float:
    """Return the rank correlation of a joint's impact speeds with time, before its first contact of 0.05 s or more."""
    initial = contacts_in(motion, joint, 1)
    return rank_correlation(initial["start_s"], initial["impact_speed"])


def one_sidedness(motion: Trajectory, joint: int, phase: int) -> float:
    """Return the length of the mean unit vector of a joint's contact directions: 1 one-sided, 0 all round.

    Only samples in contact during `phase` count: 1 initial impacts, 2 later deployment, 3 after the joint's latching.
    """
    touching = (phase_of(motion, joint) == phase) & (motion.penetration[:, joint] > -TOUCH_TOLERANCE)
    return float(np.abs(np.exp(1j * journal_angle(motion, joint)[touching]).mean()))


def impacts(motion: Trajectory, joint: int, phase: int = 3) -> float:
    """Return the number of a joint's contacts that start in a phase: 1 initial, 2 deployment, 3 after latching."""
    return float(len(contacts_in(motion, joint, phase)))


def force_in_deployment(motion: Trajectory, joint: int) -> float:
    """Return a joint's greatest contact force in the deployment phase divided by the greatest force after latching."""
    quiet = motion.normal_force[phase_of(motion, joint) == 2, joint].max()
    return float(quiet / motion.postlock_peak_force[joint])


def time_of_turning(motion: Trajectory, joint: int) -> float:
    """Return the time [s] in the deployment phase at which the journal is furthest from the bearing's centre in y."""
    phase, height = phase_of(motion, joint), motion.eccentricity[:, joint, 1]
    return float(motion.time[np.where(phase == 2, np.abs(height), -1.0).argmax()])


def slide(motion: Trajectory, joint: int) -> float:
    """Return the angle [deg] by which a journal moves round its bearing in the first 0.1 s (SLIDE) after its latching.

    It is the angle of greatest magnitude in that time. Clockwise is positive: in the paper, whose panels fold to the
    other side, the same motion is anticlockwise.
    """
    angle, start = journal_angle(motion, joint), float(motion.latch_times[joint])
    window = (motion.time >= start) & (motion.time <= start + SLIDE)
    moved = angle[window] - angle[window][0]
    return -math.degrees(float(moved[np.abs(moved).argmax()]))


def median_peak(motion: Trajectory, joint: int) -> float:
    """Return the median peak force [N] of a joint's contacts after latching."""
    return float(np.median(contacts_in(motion, joint, 3)["peak_force"]))


def window_forces(motion: Trajectory) -> Array:
    """Return the (2, windows) greatest contact forces [N] of both joints in 0.25 s windows after the last latching."""
    edges = windows_after_latching(motion)
    return np.stack([greatest_force(motion, joint, edges) for joint in JOINTS])


def window_force(motion: Trajectory, joint: int) -> float:
    """Return a joint's greatest contact force [N] in a 0.25 s window, averaged over windows after the last latching."""
    return float(window_forces(motion)[joint].mean())


def bursts(motion: Trajectory) -> float:
    """Return the rank correlation of peak contact force and peak latch torque in 0.25 s windows after latching.

    The force is the greater of both joints' peaks; the torque is the sum of both joints' peaks.
    """
    edges = windows_after_latching(motion)
    torques = np.sum([greatest_torque(motion, joint, edges) for joint in JOINTS], axis=0)
    return rank_correlation(window_forces(motion).max(axis=0), torques)


def synchrony(motion: Trajectory) -> float:
    """Return the rank correlation of both joints' greatest contact forces in 0.25 s windows after latching."""
    return rank_correlation(*window_forces(motion))


def burst_rank(motion: Trajectory) -> float:
    """Return the mean rank of the 0.25 s windows in which the paper's Fig 10 shows bursts of impacts (BURSTS).

    All windows after the last latching are ranked by peak contact force, from 0 (least) to 1 (greatest).
    """
    edges, forces = windows_after_latching(motion), window_forces(motion).max(axis=0)
    ranks = forces.argsort().argsort() / (len(forces) - 1)
    return float(np.mean([ranks[np.clip(np.searchsorted(edges, t) - 1, 0, len(ranks) - 1)] for t in BURSTS]))


def late_bursts(motion: Trajectory) -> float:
    """Return the greatest contact force of all joints after 27.5 s divided by the greatest after the first latching."""
    edges = np.array([LAST_BURSTS, motion.time[-1]])
    return max(float(greatest_force(motion, joint, edges)[0]) for joint in JOINTS) / float(
        motion.postlock_peak_force.max()
    )


def first_latch_torque(motion: Trajectory, joint: int) -> float:
    """Return a joint's greatest latch torque [N m] within 0.4 s (FIRST_PEAK) after its latching."""
    since = motion.time - motion.latch_times[joint]
    return float(np.abs(motion.latch_torque[(since >= 0.0) & (since <= FIRST_PEAK), joint]).max())


def lock_torque(motion: Trajectory, joint: int) -> float:
    """Return the greatest latch torque [N m] of a joint in the whole run."""
    return float(np.abs(motion.latch_torque[:, joint]).max())


def settling_time(motion: Trajectory, joint: int) -> float:
    """Return the time [s] from the latching until the latch torque stays below a quarter of its greatest value."""
    torque = np.abs(motion.latch_torque[:, joint])
    return float(motion.time[torque > SETTLED * torque.max()][-1] - motion.latch_times[joint])


def engagements(motion: Trajectory) -> float:
    """Count how often the sampled latch torques of both joints change from zero to nonzero after the first latching."""
    acting = motion.latch_torque[motion.time >= np.nanmin(motion.latch_times)] != 0.0
    return float((acting[1:] & ~acting[:-1]).sum())


def cable_amplitude(motion: Trajectory, since: float = 0.0) -> float:
    """Return the greatest magnitude of the cable torque [N m] from the time `since` [s] on."""
    return float(np.abs(motion.cable_torque[motion.time >= since]).max())


def swing(motion: Trajectory, joint: int) -> float:
    """Return the standard deviation [rad] of the joint angle after the last latching."""
    return float(motion.angles[motion.time > np.nanmax(motion.latch_times), joint].std())


def vibration(motion: Trajectory) -> float:
    """Return the root mean square [rad/s] of the rates of all joints together, less their running means over 0.5 s.

    Only times between 2 and 12.5 s (QUIET) count, clear of the start and of the latching.
    """
    width = round(RUNNING_MEAN / float(motion.time[1] - motion.time[0]))
    rates = motion.rates[(motion.time >= QUIET[0]) & (motion.time <= QUIET[1])]
    means = np.stack([np.convolve(rate, np.ones(width) / width, "valid") for rate in rates.T], axis=1)
    first = (width - 1) // 2
    return float(np.sqrt(np.mean((rates[first : first + len(means)] - means) ** 2)))


def lag(reference: Trajectory, motion: Trajectory, joint: int) -> float:
    """Return the time [s] by which a joint's oscillation after latching lags the same oscillation of a reference.

    The lag is the shift up to 1 s (LONGEST_LAG) that maximizes the cross-correlation of the angles over 10 s (LAGGING)
    after each run's last latching. A parabola through the maximum and its neighbours refines the lag.
    """
    step = float(motion.time[1] - motion.time[0])
    signals, late = [], []
    for one in (motion, reference):
        latched = float(np.nanmax(one.latch_times))
        start = int(np.searchsorted(one.time, latched))
        late.append(float(one.time[start]) - latched)
        angles = one.angles[start : start + round(LAGGING / step), joint]
        signals.append(angles - angles.mean())
    shifts = correlation_lags(len(signals[0]), len(signals[1]))
    products = correlate(*signals) / (len(signals[0]) - np.abs(shifts))
    top = int(np.where(np.abs(shifts) * step <= LONGEST_LAG, products, -np.inf).argmax())
    before, here, after = products[top - 1 : top + 2]
    between = 0.5 * (before - after) / (before - 2.0 * here + after)
    return step * (float(shifts[top]) + float(between)) + late[0] - late[1]


def worst_wear(motion: Trajectory) -> float:
    """Return the depth [m] of the deepest wear bin of all joints."""
    return float(motion.wear_depth.max())
