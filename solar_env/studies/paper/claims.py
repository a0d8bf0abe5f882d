"""The paper's statements about its deployments, each a measured figure with the interval in which it agrees."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

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


@dataclass(frozen=True)
class Claim:
    """A statement of the paper as a figure that a run either has or has not.

    Attributes:
        key: short name.
        statement: what the paper says, and the figure that is taken for it.
        paper: the paper's own figure, or the relation that it states.
        cases: deployments that the figure is taken from.
        measure: the figure of one member of an ensemble.
        low, high: where it agrees, both ends included.
        unit: of the figure.
        open_parameters: parameters that the paper leaves open and the figure hangs on; it is tested over their ranges.
        why: if it differs: why.
    """

    key: str
    statement: str
    paper: str
    cases: tuple[str, ...]
    measure: Callable[[Member], float]
    low: float
    high: float
    unit: str = ""
    open_parameters: tuple[str, ...] = ()
    why: str = ""

    def holds(self, value: float) -> bool:
        """Whether a figure agrees with the paper."""
        return self.low <= value <= self.high


def _within(figure: float, share: float) -> tuple[float, float]:
    return figure * (1.0 - share), figure * (1.0 + share)


def _latch_time(joint: int) -> Callable[[Member], float]:
    return lambda member: float(member[RIGID].latch_times[joint])


def _settled(case: str, joint: int) -> Callable[[Member], float]:
    return lambda member: phases.find_phases(member[case], joint).settled


def _decay(member: Member) -> float:
    ranks = []
    for joint in JOINTS:
        impacts = phases.contacts_in(member[RIGID], joint, 1)
        ranks.append(phases.rank_correlation(impacts["start_s"], impacts["impact_speed"]))
    return max(ranks)


def _one_sidedness(motion: Trajectory, joint: int, phase: int) -> float:
    """Length of the mean of the directions in which the journal touches: 1 for one side, 0 for both alike."""
    touching = (phases.phase_of(motion, joint) == phase) & (motion.penetration[:, joint] > -TOUCH_TOLERANCE)
    return float(np.abs(np.exp(1j * phases.journal_angle(motion, joint)[touching]).mean()))


def _flights(case: str) -> Callable[[Member], float]:
    return lambda member: float(sum(len(phases.contacts_in(member[case], joint, 2)) for joint in JOINTS))


def _force_in_deployment(member: Member) -> float:
    motion = member[RIGID]
    quiet = [motion.normal_force[phases.phase_of(motion, joint) == 2, joint].max() for joint in JOINTS]
    return float((np.array(quiet) / motion.postlock_peak_force).max())


def _slide(joint: int) -> Callable[[Member], float]:
    """Slide at latching [deg] as the paper sees it: its panels fold to the other side, so that it is mirrored."""
    return lambda member: -math.degrees(phases.slide_at_latching(member[RIGID], joint))


def _forces_by_window(motion: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """(2, windows) greatest contact forces and greatest latch torques after latching."""
    edges = phases.windows_after_latching(motion)
    forces = np.stack([phases.greatest_force(motion, joint, edges) for joint in JOINTS])
    return forces, np.stack([phases.greatest_torque(motion, joint, edges) for joint in JOINTS])


def _bursts(member: Member) -> float:
    forces, torques = _forces_by_window(member[RIGID])
    return phases.rank_correlation(forces.max(axis=0), torques.sum(axis=0))


def _synchrony(member: Member) -> float:
    forces, _ = _forces_by_window(member[RIGID])
    return phases.rank_correlation(*forces)


def _impacts_after_latching(motion: Trajectory) -> float:
    return float(sum(len(phases.contacts_in(motion, joint, 3)) for joint in JOINTS))


def _median_peak(motion: Trajectory, joint: int) -> float:
    return float(np.median(phases.contacts_in(motion, joint, 3)["peak_force"]))


def _ratio(figure: Callable[[Trajectory], float], case: str, reference: str) -> Callable[[Member], float]:
    return lambda member: figure(member[case]) / figure(member[reference])


def _first_latch_torque(motion: Trajectory) -> float:
    peaks = []
    for joint, latched in enumerate(motion.latch_times):
        soon = (motion.time >= latched) & (motion.time <= latched + FIRST_PEAK)
        peaks.append(np.abs(motion.latch_torque[soon, joint]).max())
    return float(max(peaks))


def _cable_amplitude(since: float) -> Callable[[Trajectory], float]:
    return lambda motion: float(np.abs(motion.cable_torque[motion.time >= since]).max())


def _lag(ideal: str, loose: str) -> Callable[[Member], float]:
    return lambda member: min(phases.lag(member[ideal], member[loose], joint) for joint in JOINTS)


# The joint whose clearance is the larger one of models 1 and 2 of the distribution is joint 2 and joint 1.
def _density(member: Member) -> float:
    small = [len(phases.contacts_in(member[f"distribution-{joint + 1}"], joint, 3)) for joint in JOINTS]
    large = [len(phases.contacts_in(member[f"distribution-{2 - joint}"], joint, 3)) for joint in JOINTS]
    return float(min(np.divide(small, large)))


def _size(joint: int) -> Callable[[Member], float]:
    def ratio(member: Member) -> float:
        large, small = (_median_peak(member[f"distribution-{number}"], joint) for number in (2 - joint, joint + 1))
        return large / small

    return ratio


def _worst_wear(motion: Trajectory) -> float:
    return float(motion.wear_depth.max())


def _unevenness(motion: Trajectory) -> float:
    return float(motion.wear_depth.max() / motion.wear_depth.min())


DISTRIBUTIONS = ("distribution-1", "distribution-2")
BOTH = (RIGID, FLEXIBLE)
_OPEN = ("cable_stiffness", "latch_stiffness", "latch_damping", "latch_gap")


def _claims() -> Iterator[Claim]:
    for joint, (latch, settled) in enumerate(((13.175, 0.950), (13.183, 0.972))):
        name = f"joint {joint + 1}"
        yield Claim(
            f"latch-{joint + 1}", f"rigid panels: {name} latches, within 0.5 %", f"{latch} s", (RIGID,),
            _latch_time(joint), *_within(latch, 0.005), unit="s",
        )  # fmt: skip
        yield Claim(
            f"initial-{joint + 1}", f"rigid panels: initial impacts of {name} end, within 10 %", f"{settled} s",
            (RIGID,), _settled(RIGID, joint), *_within(settled, 0.1), unit="s",
        )  # fmt: skip
    yield Claim(
        "decay", "initial impacts decay: rank correlation of impact speed with time", "below 0", (RIGID,), _decay,
        -1.0, -0.5,
    )  # fmt: skip
    yield Claim(
        "one-sided", "initial impacts are one-sided: length of the mean direction (1: one side, 0: both)", "one side",
        (RIGID,), lambda member: min(_one_sidedness(member[RIGID], joint, 1) for joint in JOINTS), 0.9, 1.0,
    )  # fmt: skip
    yield Claim(
        "continuous", "rigid panels deploy in continuous contact: flights between", "0", (RIGID,), _flights(RIGID),
        0.0, 0.0,
    )  # fmt: skip
    yield Claim(
        "quiet", "... with a force near zero: greatest, over the post-lock peak", "about 0", (RIGID,),
        _force_in_deployment, 0.0, 0.01,
    )  # fmt: skip
    yield Claim(
        "turning", "the journal reaches the peak of the wall at about", "10 s", (RIGID,),
        lambda member: phases.time_of_turning(member[RIGID], 0), *_within(10.0, 0.1), unit="s",
    )  # fmt: skip
    yield Claim(
        "slide-1", "at latching it slides round the wall: joint 1 clockwise (anticlockwise positive)", "below 0",
        (RIGID,), _slide(0), -math.inf, -30.0, unit="deg",
    )  # fmt: skip
    yield Claim(
        "slide-2", "... joint 2 anticlockwise", "above 0", (RIGID,), _slide(1), 30.0, math.inf, unit="deg"
    )  # fmt: skip
    yield Claim(
        "two-sided", "post-lock impacts are two-sided: length of the mean direction", "both sides", (RIGID,),
        lambda member: max(_one_sidedness(member[RIGID], joint, 3) for joint in JOINTS), 0.0, 0.3,
        open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "peak", "rigid panels: greatest post-lock contact force, within a factor of 2", "about 800 N", (RIGID,),
        lambda member: float(member[RIGID].postlock_peak_force.max()), 400.0, 1600.0, unit="N",
        open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "bursts", "impacts come in bursts with the latch torque: rank correlation of both by windows of 0.25 s",
        "together", (RIGID,), _bursts, 0.3, 1.0, open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "synchrony", "... and at both joints at once: rank correlation of their forces by window", "synchronous",
        (RIGID,), _synchrony, 0.5, 1.0, open_parameters=_OPEN,
    )  # fmt: skip
    for joint, settled in enumerate((1.143, 1.34)):
        yield Claim(
            f"flexible-initial-{joint + 1}", f"flexible panels: initial impacts of joint {joint + 1} end, within 25 %",
            f"{settled} s", (FLEXIBLE,), _settled(FLEXIBLE, joint), *_within(settled, 0.25), unit="s",
        )  # fmt: skip
    yield Claim(
        "longer", "flexible panels: the initial phase lasts longer than with rigid ones (ratio, both joints)",
        "above 1", BOTH,
        lambda member: min(_settled(FLEXIBLE, joint)(member) / _settled(RIGID, joint)(member) for joint in JOINTS),
        1.0, math.inf,
    )  # fmt: skip
    yield Claim(
        "impacts-later", "flexible panels: impacts during the deployment too", "some", (FLEXIBLE,),
        _flights(FLEXIBLE), 1.0, math.inf,
    )  # fmt: skip
    yield Claim(
        "denser", "flexible panels: post-lock impacts are much denser (ratio)", "above 1", BOTH,
        _ratio(_impacts_after_latching, FLEXIBLE, RIGID), 2.0, math.inf, open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "smaller", "... but smaller (ratio of median peak forces, both joints)", "below 1", BOTH,
        lambda member: max(_median_peak(member[FLEXIBLE], j) / _median_peak(member[RIGID], j) for j in JOINTS),
        0.0, 1.0, open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "latch-torque", "flexible panels: the first peak of the latch torque is smaller (ratio)", "below 1", BOTH,
        _ratio(_first_latch_torque, FLEXIBLE, RIGID), 0.0, 1.0, open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "cable-torque", "flexible panels: the cable torque's amplitude is much larger (ratio)", "above 1", BOTH,
        _ratio(_cable_amplitude(0.0), FLEXIBLE, RIGID), 1.5, math.inf, open_parameters=_OPEN,
        why="the greatest comes right after latching, when a part of the energy goes into bending; later on flexible "
        "panels swing further, for until 20 s the latches take 0.22 J from rigid ones and 0.12 J from them",
    )  # fmt: skip
    yield Claim(
        "cable-torque-late", "... after 20 s", "above 1", BOTH,
        _ratio(_cable_amplitude(LATE), FLEXIBLE, RIGID), 1.0, math.inf,
        open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "vibration", "ideal joints let flexible panels vibrate more in deployment than clearance (ratio of rates)",
        "above 1", ("flexible-ideal", FLEXIBLE),
        _ratio(lambda motion: phases.vibration(motion, *QUIET), "flexible-ideal", FLEXIBLE), 1.0, math.inf,
    )  # fmt: skip
    for panels in ("rigid", "flexible"):
        pair = (f"{panels}-ideal", f"{panels}-clearance")
        yield Claim(
            f"lag-{panels}", f"clearance makes the oscillation of {panels} panels after latching lag (least of both "
            "joints over 10 s)", "above 0", pair, _lag(*pair), 1e-9, math.inf, unit="s",
            open_parameters=_OPEN,
        )  # fmt: skip
    yield Claim(
        "distribution-density", "clearances of 0.1 against 0.2 mm: more impacts (least ratio of both joints)",
        "above 1", DISTRIBUTIONS, _density, 1.0, math.inf, open_parameters=_OPEN,
    )  # fmt: skip
    for joint in JOINTS:
        yield Claim(
            f"distribution-size-{joint + 1}",
            f"clearances of 0.2 against 0.1 mm: larger impacts (ratio of median peak forces), joint {joint + 1}",
            "above 1", DISTRIBUTIONS, _size(joint), 1.0, math.inf, open_parameters=_OPEN,
            why="where joint 2 has the small clearance joint 1 has the large one, and passes harder impacts on",
        )  # fmt: skip
    yield Claim(
        "distribution-wear", "model 2 wears much less at its worst joint than model 1 (ratio of deepest bins)",
        "below 1", DISTRIBUTIONS, _ratio(_worst_wear, *reversed(DISTRIBUTIONS)), 0.0, 0.9,
        open_parameters=("friction_sliding", *_OPEN),
        why="with the sliding speed of Eq 35 turning wears nothing; the points in contact slide most at joint 2, which "
        "turns by pi, and to it model 2 gives the small clearance",
    )  # fmt: skip
    yield Claim(
        "distribution-evenness", "... and more evenly (ratio of deeper to shallower joint, model 2 over model 1)",
        "below 1", DISTRIBUTIONS, _ratio(_unevenness, *reversed(DISTRIBUTIONS)), 0.0, 1.0,
        open_parameters=("friction_sliding", *_OPEN), why="as for the wear of the worst joint",
    )  # fmt: skip
    yield Claim(
        "wear-depth", "wear after 30 s is of the order of 1e-14 m; Archard's coefficient is chosen so", "1e-14 m",
        DISTRIBUTIONS, lambda member: max(_worst_wear(member[case]) for case in DISTRIBUTIONS), 3e-15, 1e-13, unit="m",
    )  # fmt: skip


CLAIMS: tuple[Claim, ...] = tuple(_claims())
