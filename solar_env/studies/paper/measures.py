"""Figures that are taken for the paper's statements, each of the deployments that a claim names, in their order.

`ratio`, `joint_2_over_1`, `over_joints` and `large_over_small` turn figures of any motion into such ones.
"""

import math
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate, correlation_lags
from scipy.stats import spearmanr

from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.paper import phases
from solar_env.studies.paper.cases import JOINTS

Figure = Callable[[Trajectory], float]
FigureOfJoint = Callable[[Trajectory, int], float]
Comparison = Callable[[Trajectory, Trajectory], float]

TOUCH_TOLERANCE = 1e-6  # m; a journal that comes so near the wall touches it
FIRST_PEAK = 0.4  # s; the first peak of a latch torque comes within this time of the latching
LATE = 20.0  # s
QUIET = (2.0, 12.5)  # s; of the deployment in which vibrations are compared, clear of the start and of the latching
RUNNING_MEAN = 0.5  # s; what is slower is no vibration
SLIDE = 0.1  # s; of the slide round the wall at latching
LAGGING, LONGEST_LAG = 10.0, 1.0  # s; of the oscillations that are compared, and of their shift at most
SETTLED = 0.25  # a lock torque has settled when it stays below this share of its greatest
BURSTS = (15.74, 17.63, 20.59, 28.48, 29.33)  # s; when the paper's Fig 10 shows bursts of impacts
LAST_BURSTS = 27.5  # s; the last two of them come after it


def ratio(figure: Figure) -> Comparison:
    """A figure of a motion over that of a second one."""
    return lambda motion, reference: figure(motion) / figure(reference)


def joint_2_over_1(figure: FigureOfJoint) -> Figure:
    """A figure of joint 2 over that of joint 1."""
    return lambda motion: figure(motion, 1) / figure(motion, 0)


def over_joints(choose: Callable[[Iterable[float]], float], figure: FigureOfJoint) -> Comparison:
    """A figure of a motion over that of a second one, the smaller or the greater ratio of both joints."""
    return lambda motion, reference: choose(figure(motion, joint) / figure(reference, joint) for joint in JOINTS)


def large_over_small(figure: FigureOfJoint, joint: int) -> Comparison:
    """A figure of a joint with 0.2 mm over that with 0.1 mm, of the models 1 and 2 of the clearances.

    Joint 1 has the larger clearance in model 2, joint 2 in model 1.
    """
    return lambda one, two: figure((two, one)[joint], joint) / figure((one, two)[joint], joint)


def latch_time(motion: Trajectory, joint: int) -> float:
    """When a joint latches [s]."""
    return float(motion.latch_times[joint])


def lead(motion: Trajectory) -> float:
    """By how much joint 1 latches before joint 2 [s]."""
    return latch_time(motion, 1) - latch_time(motion, 0)


def rank_correlation(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Spearman's rank correlation of two signals: forces span decades."""
    return float(spearmanr(a, b).statistic)


def decay(motion: Trajectory) -> float:
    """Rank correlation of the initial impacts' speeds with time, the greater one of both joints."""
    initial = [phases.contacts_in(motion, joint, 1) for joint in JOINTS]
    return max(rank_correlation(impacts["start_s"], impacts["impact_speed"]) for impacts in initial)


def one_sidedness(motion: Trajectory, joint: int, phase: int) -> float:
    """Length of the mean of the directions in which the journal touches: 1 for one side, 0 for both alike."""
    touching = (phases.phase_of(motion, joint) == phase) & (motion.penetration[:, joint] > -TOUCH_TOLERANCE)
    return float(np.abs(np.exp(1j * phases.journal_angle(motion, joint)[touching]).mean()))


def flights(motion: Trajectory) -> float:
    """Number of contacts that start during the deployment, of both joints."""
    return float(sum(len(phases.contacts_in(motion, joint, 2)) for joint in JOINTS))


def force_in_deployment(motion: Trajectory) -> float:
    """Greatest contact force of the deployment over that after latching, of both joints."""
    quiet = [motion.normal_force[phases.phase_of(motion, joint) == 2, joint].max() for joint in JOINTS]
    return float((np.array(quiet) / motion.postlock_peak_force).max())


def time_of_turning(motion: Trajectory, joint: int) -> float:
    """When [s], in the lasting contact of the deployment, the journal is furthest up or down."""
    phase, height = phases.phase_of(motion, joint), motion.eccentricity[:, joint, 1]
    return float(motion.time[np.where(phase == 2, np.abs(height), -1.0).argmax()])


def slide(motion: Trajectory, joint: int) -> float:
    """Angle [deg] by which the journal slides round the wall within SLIDE of the latching, as the paper sees it.

    Its panels fold to the other side, so that it is mirrored: anticlockwise here is negative.
    """
    angle, start = phases.journal_angle(motion, joint), float(motion.latch_times[joint])
    window = (motion.time >= start) & (motion.time <= start + SLIDE)
    moved = angle[window] - angle[window][0]
    return -math.degrees(float(moved[np.abs(moved).argmax()]))


def circling(motion: Trajectory) -> float:
    """Greatest angle [deg] by which a journal goes round its bearing within 0.1 s of latching."""
    return max(abs(slide(motion, joint)) for joint in JOINTS)


def impacts(motion: Trajectory, joint: int) -> float:
    """Number of contacts that start after the latching."""
    return float(len(phases.contacts_in(motion, joint, 3)))


def all_impacts(motion: Trajectory) -> float:
    """Number of contacts that start after latching, of both joints."""
    return sum(impacts(motion, joint) for joint in JOINTS)


def median_peak(motion: Trajectory, joint: int) -> float:
    """Median of the contacts' greatest forces after latching [N]."""
    return float(np.median(phases.contacts_in(motion, joint, 3)["peak_force"]))


def postlock_peak(motion: Trajectory) -> float:
    """Greatest contact force after latching [N], of both joints."""
    return float(motion.postlock_peak_force.max())


def window_forces(motion: Trajectory) -> NDArray[np.float64]:
    """(2, windows) greatest contact forces after latching [N]."""
    edges = phases.windows_after_latching(motion)
    return np.stack([phases.greatest_force(motion, joint, edges) for joint in JOINTS])


def window_force(motion: Trajectory, joint: int) -> float:
    """Mean over windows of 0.25 s after latching of the greatest contact force [N]: the height that an eye takes."""
    return float(window_forces(motion)[joint].mean())


def bursts(motion: Trajectory) -> float:
    """Rank correlation of forces and latch torques by windows."""
    edges = phases.windows_after_latching(motion)
    torques = np.sum([phases.greatest_torque(motion, joint, edges) for joint in JOINTS], axis=0)
    return rank_correlation(window_forces(motion).max(axis=0), torques)


def synchrony(motion: Trajectory) -> float:
    """Rank correlation of both joints' forces by windows."""
    return rank_correlation(*window_forces(motion))


def burst_rank(motion: Trajectory) -> float:
    """Mean rank, 0 to 1, of the greatest forces about the times of the paper's bursts among those of all windows."""
    edges, forces = phases.windows_after_latching(motion), window_forces(motion).max(axis=0)
    ranks = forces.argsort().argsort() / (len(forces) - 1)
    return float(np.mean([ranks[np.clip(np.searchsorted(edges, t) - 1, 0, len(ranks) - 1)] for t in BURSTS]))


def late_bursts(motion: Trajectory) -> float:
    """Greatest contact force after LAST_BURSTS over the greatest after latching, of both joints."""
    edges = np.array([LAST_BURSTS, motion.time[-1]])
    return max(float(phases.greatest_force(motion, joint, edges)[0]) for joint in JOINTS) / postlock_peak(motion)


def first_latch_torque(motion: Trajectory) -> float:
    """Greatest latch torque of either joint within FIRST_PEAK of its latching [N m]."""
    peaks = []
    for joint, latched in enumerate(motion.latch_times):
        soon = (motion.time >= latched) & (motion.time <= latched + FIRST_PEAK)
        peaks.append(np.abs(motion.latch_torque[soon, joint]).max())
    return float(max(peaks))


def lock_torque(motion: Trajectory, joint: int) -> float:
    """Greatest latch torque [N m]."""
    return float(np.abs(motion.latch_torque[:, joint]).max())


def settling_time(motion: Trajectory, joint: int) -> float:
    """Time [s] from the latching until the latch torque stays below a quarter of its greatest."""
    torque = np.abs(motion.latch_torque[:, joint])
    return float(motion.time[torque > SETTLED * torque.max()][-1] - motion.latch_times[joint])


def engagements(motion: Trajectory) -> float:
    """Number of times that the latches' torques set in, of both joints, as samples show them."""
    acting = motion.latch_torque[motion.time >= np.nanmin(motion.latch_times)] != 0.0
    return float((acting[1:] & ~acting[:-1]).sum())


def cable_amplitude(motion: Trajectory, since: float = 0.0) -> float:
    """Greatest cable torque from a time on [N m]."""
    return float(np.abs(motion.cable_torque[motion.time >= since]).max())


def swing(motion: Trajectory, joint: int) -> float:
    """Root mean square [rad] of the joint angle about its mean after the last latching."""
    return float(motion.angles[motion.time > np.nanmax(motion.latch_times), joint].std())


def vibration(motion: Trajectory) -> float:
    """Root mean square [rad/s] of the joint rates about their running mean, in the quiet part of the deployment."""
    width = round(RUNNING_MEAN / float(motion.time[1] - motion.time[0]))
    rates = motion.rates[(motion.time >= QUIET[0]) & (motion.time <= QUIET[1])]
    means = np.stack([np.convolve(rate, np.ones(width) / width, "valid") for rate in rates.T], axis=1)
    first = (width - 1) // 2
    return float(np.sqrt(np.mean((rates[first : first + len(means)] - means) ** 2)))


def lag(reference: Trajectory, motion: Trajectory, joint: int) -> float:
    """Time [s] by which the oscillation of a joint after latching lags that of a reference.

    The shift, within LONGEST_LAG, with the greatest cross-correlation of the angles over LAGGING from either one's
    own last latching; a parabola through the maximum and its neighbours places it between samples.
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


def least_lag(ideal: Trajectory, loose: Trajectory) -> float:
    """Time by which the oscillation with clearance lags [s], the smaller one of both joints."""
    return min(lag(ideal, loose, joint) for joint in JOINTS)


def density(one: Trajectory, two: Trajectory) -> float:
    """Number of impacts with 0.1 mm over that with 0.2 mm, the smaller ratio of both joints."""
    return min(large_over_small(impacts, joint)(two, one) for joint in JOINTS)


def worst_wear(motion: Trajectory) -> float:
    """Deepest bin of all [m]."""
    return float(motion.wear_depth.max())


def unevenness(motion: Trajectory) -> float:
    """Deepest bin of the joint that wears more over that of the other."""
    return float(motion.wear_depth.max() / motion.wear_depth.min())
