"""Figures that are taken for the paper's statements, each of one member of an ensemble or of one deployment."""

import math
from collections.abc import Callable

import numpy as np

from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.paper import phases
from solar_env.studies.paper.cases import Member
from solar_env.studies.paper.figures import JOINTS

RIGID, FLEXIBLE = "rigid-clearance", "flexible-clearance"
TOUCH_TOLERANCE = 1e-6  # m; a journal that comes so near the wall touches it
# s; the first peak of a latch torque comes within this time of the latching.
FIRST_PEAK = 0.4
LATE = 20.0  # s
# s; of the deployment in which vibrations are compared, clear of the start and of the latching.
QUIET = (2.0, 12.5)
# A lock torque has settled when it stays below this share of its greatest.
SETTLED = 0.25
# s; when the paper's Fig 10 shows bursts of impacts.
BURSTS = (15.74, 17.63, 20.59, 28.48, 29.33)
LAST_BURSTS = 27.5  # s; the last two of them come after it


def latch_time(joint: int) -> Callable[[Member], float]:
    """When a joint latches, with rigid panels [s]."""
    return lambda member: float(member[RIGID].latch_times[joint])


def lead(member: Member) -> float:
    """By how much joint 1 latches before joint 2, with rigid panels [s]."""
    return float(member[RIGID].latch_times[1] - member[RIGID].latch_times[0])


def settled(case: str, joint: int) -> Callable[[Member], float]:
    """When the initial impacts of a joint end [s]."""
    return lambda member: phases.find_phases(member[case], joint).settled


def decay(member: Member) -> float:
    """Rank correlation of the initial impacts' speeds with time, the greater one of both joints."""
    ranks = []
    for joint in JOINTS:
        impacts = phases.contacts_in(member[RIGID], joint, 1)
        ranks.append(phases.rank_correlation(impacts["start_s"], impacts["impact_speed"]))
    return max(ranks)


def one_sidedness(motion: Trajectory, joint: int, phase: int) -> float:
    """Length of the mean of the directions in which the journal touches: 1 for one side, 0 for both alike."""
    touching = (phases.phase_of(motion, joint) == phase) & (motion.penetration[:, joint] > -TOUCH_TOLERANCE)
    return float(np.abs(np.exp(1j * phases.journal_angle(motion, joint)[touching]).mean()))


def flights(case: str) -> Callable[[Member], float]:
    """Number of contacts that start during the deployment."""
    return lambda member: float(sum(len(phases.contacts_in(member[case], joint, 2)) for joint in JOINTS))


def force_in_deployment(member: Member) -> float:
    """Greatest contact force of the deployment over that after latching, of both joints."""
    motion = member[RIGID]
    quiet = [motion.normal_force[phases.phase_of(motion, joint) == 2, joint].max() for joint in JOINTS]
    return float((np.array(quiet) / motion.postlock_peak_force).max())


def slide(joint: int) -> Callable[[Member], float]:
    """Slide at latching [deg] as the paper sees it: its panels fold to the other side, so that it is mirrored."""
    return lambda member: -math.degrees(phases.slide_at_latching(member[RIGID], joint))


def forces_by_window(motion: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """(2, windows) greatest contact forces and greatest latch torques after latching."""
    edges = phases.windows_after_latching(motion)
    forces = np.stack([phases.greatest_force(motion, joint, edges) for joint in JOINTS])
    return forces, np.stack([phases.greatest_torque(motion, joint, edges) for joint in JOINTS])


def bursts(member: Member) -> float:
    """Rank correlation of forces and latch torques by windows."""
    forces, torques = forces_by_window(member[RIGID])
    return phases.rank_correlation(forces.max(axis=0), torques.sum(axis=0))


def synchrony(member: Member) -> float:
    """Rank correlation of both joints' forces by windows."""
    forces, _ = forces_by_window(member[RIGID])
    return phases.rank_correlation(*forces)


def impacts_after_latching(motion: Trajectory) -> float:
    """Number of contacts that start after latching, of both joints."""
    return float(sum(len(phases.contacts_in(motion, joint, 3)) for joint in JOINTS))


def median_peak(motion: Trajectory, joint: int) -> float:
    """Median of the contacts' greatest forces after latching [N]."""
    return float(np.median(phases.contacts_in(motion, joint, 3)["peak_force"]))


def ratio(figure: Callable[[Trajectory], float], case: str, reference: str) -> Callable[[Member], float]:
    """A figure of a case over that of another."""
    return lambda member: figure(member[case]) / figure(member[reference])


def first_latch_torque(motion: Trajectory) -> float:
    """Greatest latch torque of either joint within FIRST_PEAK of its latching [N m]."""
    peaks = []
    for joint, latched in enumerate(motion.latch_times):
        soon = (motion.time >= latched) & (motion.time <= latched + FIRST_PEAK)
        peaks.append(np.abs(motion.latch_torque[soon, joint]).max())
    return float(max(peaks))


def cable_amplitude(since: float) -> Callable[[Trajectory], float]:
    """Greatest cable torque from a time on [N m]."""
    return lambda motion: float(np.abs(motion.cable_torque[motion.time >= since]).max())


def lag(ideal: str, loose: str) -> Callable[[Member], float]:
    """Time by which the oscillation with clearance lags [s], the smaller one of both joints."""
    return lambda member: min(phases.lag(member[ideal], member[loose], joint) for joint in JOINTS)


# The joint whose clearance is the larger one of models 1 and 2 of the distribution is joint 2 and joint 1.
def density(member: Member) -> float:
    """Number of impacts with 0.1 mm over that with 0.2 mm, the smaller ratio of both joints."""
    small = [len(phases.contacts_in(member[f"distribution-{joint + 1}"], joint, 3)) for joint in JOINTS]
    large = [len(phases.contacts_in(member[f"distribution-{2 - joint}"], joint, 3)) for joint in JOINTS]
    return float(min(np.divide(small, large)))


def size(joint: int) -> Callable[[Member], float]:
    """Median peak force at a joint with 0.2 mm over that with 0.1 mm."""

    def ratio(member: Member) -> float:
        large, small = (median_peak(member[f"distribution-{number}"], joint) for number in (2 - joint, joint + 1))
        return large / small

    return ratio


def worst_wear(motion: Trajectory) -> float:
    """Deepest bin of all [m]."""
    return float(motion.wear_depth.max())


def unevenness(motion: Trajectory) -> float:
    """Deepest bin of the joint that wears more over that of the other."""
    return float(motion.wear_depth.max() / motion.wear_depth.min())


def longer_settling(member: Member) -> float:
    """Length of the initial phase with flexible over that with rigid panels, the smaller ratio of both joints."""
    return min(settled(FLEXIBLE, joint)(member) / settled(RIGID, joint)(member) for joint in JOINTS)


def smaller_impacts(member: Member) -> float:
    """Median peak force with flexible over that with rigid panels, the greater ratio of both joints."""
    return max(median_peak(member[FLEXIBLE], j) / median_peak(member[RIGID], j) for j in JOINTS)


def lock_torque(motion: Trajectory, joint: int) -> float:
    """Greatest latch torque [N m]."""
    return float(np.abs(motion.latch_torque[:, joint]).max())


def settling_time(motion: Trajectory, joint: int) -> float:
    """Time [s] from the latching until the latch torque stays below a quarter of its greatest."""
    torque = np.abs(motion.latch_torque[:, joint])
    return float(motion.time[torque > SETTLED * torque.max()][-1] - motion.latch_times[joint])


def swing(motion: Trajectory, joint: int) -> float:
    """Root mean square [rad] of the joint angle about its mean after the last latching."""
    return float(motion.angles[motion.time > np.nanmax(motion.latch_times), joint].std())


def window_force(motion: Trajectory, joint: int) -> float:
    """Mean over windows of 0.25 s after latching of the greatest contact force [N]: the height that an eye takes."""
    return float(phases.greatest_force(motion, joint, phases.windows_after_latching(motion)).mean())


def impacts(motion: Trajectory, joint: int) -> float:
    """Number of contacts that start after the latching."""
    return float(len(phases.contacts_in(motion, joint, 3)))


def engagements(motion: Trajectory) -> float:
    """Number of times that the latches' torques set in, of both joints, as samples show them."""
    acting = motion.latch_torque[motion.time >= np.nanmin(motion.latch_times)] != 0.0
    return float((acting[1:] & ~acting[:-1]).sum())


def joint_2_over_1(figure: Callable[[Trajectory, int], float], case: str = RIGID) -> Callable[[Member], float]:
    """A figure of joint 2 over that of joint 1."""
    return lambda member: figure(member[case], 1) / figure(member[case], 0)


def circling(member: Member) -> float:
    """Greatest angle [deg] by which a journal goes round its bearing within 0.1 s of latching, with flexible panels."""
    return max(abs(math.degrees(phases.slide_at_latching(member[FLEXIBLE], joint))) for joint in JOINTS)


def burst_rank(member: Member) -> float:
    """Mean rank, 0 to 1, of the greatest forces about the times of the paper's bursts among those of all windows."""
    motion = member[RIGID]
    edges = phases.windows_after_latching(motion)
    forces = np.stack([phases.greatest_force(motion, joint, edges) for joint in JOINTS]).max(axis=0)
    ranks = forces.argsort().argsort() / (len(forces) - 1)
    return float(np.mean([ranks[np.clip(np.searchsorted(edges, t) - 1, 0, len(ranks) - 1)] for t in BURSTS]))


def late_bursts(member: Member) -> float:
    """Greatest contact force after LAST_BURSTS over the greatest after latching, of both joints."""
    motion = member[RIGID]
    edges = np.array([LAST_BURSTS, motion.time[-1]])
    late = max(float(phases.greatest_force(motion, joint, edges)[0]) for joint in JOINTS)
    return late / float(motion.postlock_peak_force.max())


def greatest_distributed(member: Member) -> float:
    """Greatest contact force [N] of the two models of the distribution of clearances."""
    return max(float(member[f"distribution-{number}"].peak_force.max()) for number in (1, 2))


def window_size(joint: int) -> Callable[[Member], float]:
    """Mean of the windows' greatest forces at a joint with 0.2 mm over that with 0.1 mm."""
    return lambda member: (
        window_force(member[f"distribution-{2 - joint}"], joint)
        / window_force(member[f"distribution-{joint + 1}"], joint)
    )
