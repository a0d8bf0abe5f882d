"""Claims of the paper about deployments, each tested by a measured quantity that must lie in an interval."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.paper import measures
from solar_env.studies.paper.cases import JOINTS, is_flexible
from solar_env.studies.paper.measures import both, joint_2_over_1, large_over_small, over_joints, ratio


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, tested by a measured quantity that must lie in an interval.

    Attributes:
        key: short name.
        statement: the paper's statement, with the quantity measured to test the statement.
        paper: the paper's value of the quantity, or the relation that the paper states.
        cases: names of the deployments on which the quantity is measured.
        measure: function from the trajectories of `cases`, one argument per case in order, to the quantity.
        low, high: ends of the interval in which the quantity agrees with the paper, both included.
        unit: unit of the quantity.
        open_parameters: parameters that the quantity depends on and the paper leaves open; `survey` varies them.
        why: reason for a disagreement, if the quantity disagrees.
        by_construction: parameters left open by the paper that have been chosen to meet the claim, if any.
    """

    key: str
    statement: str
    paper: str
    cases: tuple[str, ...]
    measure: Callable[..., float]
    low: float
    high: float
    unit: str = ""
    open_parameters: tuple[str, ...] = ()
    why: str = ""
    by_construction: str = ""

    @property
    def on_flexible_panels(self) -> bool:
        """True if the quantity is measured on a deployment with flexible panels."""
        return any(map(is_flexible, self.cases))

    def value(self, motions: Mapping[str, Trajectory]) -> float:
        """Return the quantity for one ensemble member; `motions` maps case names to the member's trajectories."""
        return self.measure(*(motions[case] for case in self.cases))

    def holds(self, value: float) -> bool:
        """Return whether a value of the quantity agrees with the paper."""
        return self.low <= value <= self.high


def within(figure: float, share: float) -> tuple[float, float]:
    """Return the interval (low, high) of values that differ from `figure` by at most `share` * `figure`."""
    return figure * (1.0 - share), figure * (1.0 + share)


def above(limit: float) -> tuple[float, float]:
    """Return the interval from a limit to infinity."""
    return limit, math.inf


RIGID, FLEXIBLE = ("rigid-clearance",), ("flexible-clearance",)
FLEXIBLE_OVER_RIGID = (*FLEXIBLE, *RIGID)
MODELS_1_2 = ("distribution-1", "distribution-2")
MODEL_2_OVER_1 = ("distribution-2", "distribution-1")
_OPEN = ("cable_stiffness", "latch_stiffness", "latch_damping", "latch_gap")
# Open parameters of distribution models 1 and 2, whose different clearances have different stiffnesses by Eq 40.
_OPEN_SIZES = (*_OPEN, "contact_stiffness")
_OPEN_WEAR = ("friction_sliding", *_OPEN_SIZES)
_HINGE = "hinge_y, cable_torque_ratio"
_JOINT_2 = "rigid panels, ratio of joint 2 to joint 1 after latching: "
_WHY_JOINT_2 = "the place of the hinge and the torque ratio decide which joint's latch stops more and is struck more"
_WHY_SIZE = "if joint 2 has the small clearance, joint 1 has the large one, and passes harder impacts on"

CLAIMS: tuple[Claim, ...] = (
    Claim(
        "latch-1", "rigid panels: joint 1 latches, within 0.5 %", "13.175 s", RIGID,
        lambda motion: float(motion.latch_times[0]), *within(13.175, 0.005), "s", by_construction=_HINGE,
    ),
    Claim(
        "initial-1", "rigid panels: initial impacts of joint 1 end, within 10 %", "0.95 s", RIGID,
        partial(measures.settled, joint=0), *within(0.95, 0.1), "s",
    ),
    Claim(
        "latch-2", "rigid panels: joint 2 latches, within 0.5 %", "13.183 s", RIGID,
        lambda motion: float(motion.latch_times[1]), *within(13.183, 0.005), "s", by_construction=_HINGE,
    ),
    Claim(
        "initial-2", "rigid panels: initial impacts of joint 2 end, within 10 %", "0.972 s", RIGID,
        partial(measures.settled, joint=1), *within(0.972, 0.1), "s",
    ),
    Claim(
        "lead", "rigid panels: joint 1 latches before joint 2, within a factor of 2", "0.008 s", RIGID,
        lambda motion: float(np.diff(motion.latch_times)[0]), 0.004, 0.016, "s",
        why="the cable loop keeps the angles at 1 : 2, so that both joints latch within a millisecond or two",
    ),
    Claim(
        "decay", "initial impacts decay: rank correlation of impact speed with time", "below 0", RIGID,
        both(max, measures.decay), -1.0, -0.5,
    ),
    Claim(
        "one-sided", "initial impacts are one-sided: length of the mean direction (1: one side, 0: both)", "one side",
        RIGID, both(min, partial(measures.one_sidedness, phase=1)), 0.9, 1.0,
    ),
    Claim(
        "continuous", "rigid panels deploy in continuous contact: flights between", "0", RIGID,
        both(sum, partial(measures.impacts, phase=2)), 0.0, 0.0,
    ),
    Claim(
        "quiet", "... with a force near zero: greatest, divided by the post-lock peak", "about 0", RIGID,
        both(max, measures.force_in_deployment), 0.0, 0.01,
    ),
    Claim(
        "turning", "the journal reaches the peak of the wall at about", "10 s", RIGID,
        partial(measures.time_of_turning, joint=0), *within(10.0, 0.1), "s",
    ),
    Claim(
        "slide-1", "at latching it slides round the wall: joint 1 clockwise (anticlockwise positive)", "below 0", RIGID,
        partial(measures.slide, joint=0), -math.inf, -30.0, "deg",
    ),
    Claim(
        "slide-2", "... joint 2 anticlockwise", "above 0", RIGID, partial(measures.slide, joint=1), *above(30.0), "deg",
    ),
    Claim(
        "two-sided", "post-lock impacts are two-sided: length of the mean direction", "both sides", RIGID,
        both(max, partial(measures.one_sidedness, phase=3)), 0.0, 0.3,
        open_parameters=_OPEN,
    ),
    Claim(
        "peak", "rigid panels: greatest post-lock contact force, within a factor of 2", "about 800 N", RIGID,
        lambda motion: float(motion.postlock_peak_force.max()), 400.0, 1600.0, "N", _OPEN,
        by_construction="latch_gap, latch_stiffness, latch_damping",
    ),
    Claim(
        "bursts", "impacts come in bursts with the latch torque: rank correlation of both by windows of 0.25 s",
        "together", RIGID, measures.bursts, 0.3, 1.0, open_parameters=_OPEN,
    ),
    Claim(
        "synchrony", "... and at both joints at once: rank correlation of their forces by window", "synchronous", RIGID,
        measures.synchrony, 0.5, 1.0, open_parameters=_OPEN,
    ),
    Claim(
        "flexible-initial-1", "flexible panels: initial impacts of joint 1 end, within 25 %", "1.143 s", FLEXIBLE,
        partial(measures.settled, joint=0), *within(1.143, 0.25), "s",
        why="by chance joint 1 rests from 0.79 s or, one bounce later, from 1.00 s; the interval begins between them",
    ),
    Claim(
        "flexible-initial-2", "flexible panels: initial impacts of joint 2 end, within 25 %", "1.34 s", FLEXIBLE,
        partial(measures.settled, joint=1), *within(1.34, 0.25), "s",
        why="by chance joint 2 rests from 0.90 s or, one bounce later, from 1.08 s; the interval begins between them; "
        "of 192 runs 40 % agree, 49 % at a tenth of the tolerance",
    ),
    Claim(
        "longer", "flexible panels: the initial phase lasts longer than with rigid ones (ratio, both joints)",
        "above 1", FLEXIBLE_OVER_RIGID, over_joints(min, measures.settled), *above(1.0),
        why="by chance joint 2 rests from 0.90 s or, one bounce later, from 1.08 s, with rigid panels from 0.94 s; "
        "of 192 runs 39 % agree, 43 % at a tenth of the tolerance",
    ),
    Claim(
        "impacts-later", "flexible panels: impacts during the deployment too", "some", FLEXIBLE,
        both(sum, partial(measures.impacts, phase=2)), *above(1.0),
    ),
    Claim(
        "denser", "flexible panels: post-lock impacts are much denser (ratio)", "above 1", FLEXIBLE_OVER_RIGID,
        ratio(both(sum, measures.impacts)), *above(2.0), open_parameters=_OPEN,
    ),
    Claim(
        "smaller", "... but smaller (ratio of median peak forces, both joints)", "below 1", FLEXIBLE_OVER_RIGID,
        over_joints(max, measures.median_peak), 0.0, 1.0, open_parameters=_OPEN,
    ),
    Claim(
        "latch-torque", "flexible panels: the first peak of the latch torque is smaller (ratio)", "below 1",
        FLEXIBLE_OVER_RIGID, ratio(both(max, measures.first_latch_torque)), 0.0, 1.0, open_parameters=_OPEN,
    ),
    Claim(
        "cable-torque", "flexible panels: the cable torque's amplitude is much larger (ratio)", "above 1",
        FLEXIBLE_OVER_RIGID, ratio(measures.cable_amplitude), *above(1.5), open_parameters=_OPEN,
        why="it is larger by a fifth at a latch gap of 0.01 rad; a smaller gap leaves more energy in the panels' "
        "bending, which the cable feels",
    ),
    Claim(
        "cable-torque-late", "... after 20 s", "above 1", FLEXIBLE_OVER_RIGID,
        ratio(partial(measures.cable_amplitude, since=measures.LATE)), *above(1.0), open_parameters=_OPEN,
    ),
    Claim(
        "vibration", "ideal joints let flexible panels vibrate more in deployment than clearance (ratio of rates)",
        "above 1", ("flexible-ideal", *FLEXIBLE), ratio(measures.vibration), *above(1.0),
    ),
    *(
        Claim(
            f"lag-{panels}", f"clearance makes the oscillation of {panels} panels after latching lag (least of both "
            "joints over 10 s)", "above 0", (f"{panels}-ideal", f"{panels}-clearance"),
            both(min, measures.lag), *above(1e-9), "s", _OPEN,
        )
        for panels in ("rigid", "flexible")
    ),
    *(
        Claim(key, _JOINT_2 + what, "above 1", RIGID, joint_2_over_1(figure), *above(1.0), "", _OPEN, _WHY_JOINT_2)
        for key, what, figure in (
            ("lock-torque-2", "greatest lock torque", measures.lock_torque),
            ("settling-2", "time until the lock torque stays below a quarter of its greatest", measures.settling_time),
            ("swing-2", "swing of the panels (standard deviation of the angles)", measures.swing),
            ("stronger-2", "strength of the impacts (mean of the greatest forces by window)", measures.window_force),
            ("denser-2", "number of impacts", measures.impacts),
        )
    ),
    Claim(
        "engagements", "flexible panels: the lock torque is denser (ratio of the times that it sets in)", "above 1",
        FLEXIBLE_OVER_RIGID, ratio(measures.engagements), *above(1.0), open_parameters=_OPEN,
        why="latches engage less often where panels bend",
    ),
    Claim(
        "circling", "flexible panels: no journal circles at latching (greatest angle within 0.1 s)", "below 90 deg",
        FLEXIBLE, lambda motion: max(abs(measures.slide(motion, joint)) for joint in JOINTS), 0.0, 90.0, "deg",
        why="journals go half round the wall here, too, but in hops and less far than under rigid panels",
    ),
    Claim(
        "burst-times", "impacts are strong at 15.74, 17.63, 20.59, 28.48 and 29.33 s: mean rank of these windows' "
        "forces among all (0.5 by chance)", "bursts", RIGID, measures.burst_rank, 0.75, 1.0, open_parameters=_OPEN,
        why="the latch and the cable decide when bursts come; after some seconds chance does",
    ),
    Claim(
        "late-bursts", "... to the end: greatest contact force after 27.5 s, at least a quarter of the greatest of all",
        "bursts", RIGID, measures.late_bursts, 0.25, 1.0, open_parameters=_OPEN,
        why="friction and the latches' damping have taken most of the energy by then",
    ),
    Claim(
        "distribution-force", "models 1 and 2 of the clearances: greatest contact force", "below 300 N", MODELS_1_2,
        lambda *motions: max(float(motion.peak_force.max()) for motion in motions), 0.0, 300.0, "N", _OPEN_SIZES,
        why="equal clearances of 0.2 mm give about 600 N, 0.1 mm in joint 1 gives less, in joint 2 more",
    ),
    Claim(
        "distribution-density", "clearances of 0.1 against 0.2 mm: more impacts (least ratio of both joints)",
        "above 1", MODELS_1_2,
        lambda one, two: min(large_over_small(measures.impacts, joint)(two, one) for joint in JOINTS),
        *above(1.0), open_parameters=_OPEN_SIZES,
    ),
    *(
        Claim(
            f"distribution-{key}-{joint + 1}", f"{what}, joint {joint + 1}", "above 1", MODELS_1_2,
            large_over_small(figure, joint), *above(1.0), "", _OPEN_SIZES, _WHY_SIZE,
        )
        for joint in JOINTS
        for key, what, figure in (
            ("size", "clearances of 0.2 against 0.1 mm: larger impacts (ratio of median peak forces)",
             measures.median_peak),
            ("height", "... as an eye takes it (ratio of the mean of the greatest forces by window)",
             measures.window_force),
        )
    ),
    Claim(
        "distribution-wear", "model 2 wears much less at its worst joint than model 1 (ratio of deepest bins)",
        "below 1", MODEL_2_OVER_1, ratio(measures.worst_wear), 0.0, 0.9, "", _OPEN_WEAR,
        why="with the sliding speed of Eq 35 turning wears nothing; the points in contact slide most at joint 2, which "
        "turns by pi, and to it model 2 gives the small clearance", by_construction="friction_sliding",
    ),
    Claim(
        "distribution-evenness", "... and more evenly (ratio of deeper to shallower joint, model 2 divided by model 1)",
        "below 1", MODEL_2_OVER_1, ratio(lambda motion: float(motion.wear_depth.max() / motion.wear_depth.min())),
        0.0, 1.0, "", _OPEN_WEAR,
        why="as for the wear of the worst joint", by_construction="friction_sliding",
    ),
    Claim(
        "wear-depth", "wear after 30 s is of the order of 1e-14 m; Archard's coefficient is chosen so", "1e-14 m",
        MODELS_1_2, lambda *motions: max(map(measures.worst_wear, motions)), 3e-15, 1e-13, "m",
        by_construction="wear_coefficient",
    ),
)  # fmt: skip
