"""The paper's statements about its deployments, each a measured figure with the interval in which it agrees."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from solar_env.studies.paper import measures, phases
from solar_env.studies.paper.cases import Member, is_flexible
from solar_env.studies.paper.figures import JOINTS
from solar_env.studies.paper.measures import FLEXIBLE, LATE, QUIET, RIGID


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
        by_construction: if a parameter that the paper leaves open has been chosen for it: which.
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
    by_construction: str = ""

    @property
    def on_flexible_panels(self) -> bool:
        """Whether the figure is taken from panels that bend."""
        return any(map(is_flexible, self.cases))

    def holds(self, value: float) -> bool:
        """Whether a figure agrees with the paper."""
        return self.low <= value <= self.high

    def shortfall(self, value: float) -> float:
        """By how much a figure misses the interval, in units of the limit that it misses; nan where there is none."""
        missed = max(self.low - value, value - self.high)
        if math.isnan(value) or missed <= 0.0:
            return value if math.isnan(value) else 0.0
        limit = abs(self.low if value < self.low else self.high)
        return missed / (limit or 1.0)


def _within(figure: float, share: float) -> tuple[float, float]:
    return figure * (1.0 - share), figure * (1.0 + share)


DISTRIBUTIONS = ("distribution-1", "distribution-2")
BOTH = (RIGID, FLEXIBLE)
_OPEN = ("cable_stiffness", "latch_stiffness", "latch_damping", "latch_gap")
_OPEN_SLIDING = ("friction_sliding", *_OPEN)
# Of the models 1 and 2, whose clearances Eq 40 would have contacts of different stiffness for.
_OPEN_SIZES = (*_OPEN, "contact_stiffness")


def _claims() -> Iterator[Claim]:
    for joint, (latch, settled) in enumerate(((13.175, 0.950), (13.183, 0.972))):
        name = f"joint {joint + 1}"
        yield Claim(
            f"latch-{joint + 1}", f"rigid panels: {name} latches, within 0.5 %", f"{latch} s", (RIGID,),
            measures.latch_time(joint), *_within(latch, 0.005), unit="s",
            by_construction="hinge_y, cable_torque_ratio",
        )  # fmt: skip
        yield Claim(
            f"initial-{joint + 1}", f"rigid panels: initial impacts of {name} end, within 10 %", f"{settled} s",
            (RIGID,), measures.settled(RIGID, joint), *_within(settled, 0.1), unit="s",
        )  # fmt: skip
    yield Claim(
        "lead", "rigid panels: joint 1 latches before joint 2, within a factor of 2", "0.008 s", (RIGID,),
        measures.lead, 0.004, 0.016, unit="s",
        why="the cable loop keeps the angles at 1 : 2, so that both joints latch within a millisecond or two",
    )  # fmt: skip
    yield Claim(
        "decay", "initial impacts decay: rank correlation of impact speed with time", "below 0", (RIGID,),
        measures.decay, -1.0, -0.5,
    )  # fmt: skip
    yield Claim(
        "one-sided", "initial impacts are one-sided: length of the mean direction (1: one side, 0: both)", "one side",
        (RIGID,), lambda member: min(measures.one_sidedness(member[RIGID], joint, 1) for joint in JOINTS), 0.9, 1.0,
    )  # fmt: skip
    yield Claim(
        "continuous", "rigid panels deploy in continuous contact: flights between", "0", (RIGID,),
        measures.flights(RIGID), 0.0, 0.0,
    )  # fmt: skip
    yield Claim(
        "quiet", "... with a force near zero: greatest, over the post-lock peak", "about 0", (RIGID,),
        measures.force_in_deployment, 0.0, 0.01,
    )  # fmt: skip
    yield Claim(
        "turning", "the journal reaches the peak of the wall at about", "10 s", (RIGID,),
        lambda member: phases.time_of_turning(member[RIGID], 0), *_within(10.0, 0.1), unit="s",
    )  # fmt: skip
    yield Claim(
        "slide-1", "at latching it slides round the wall: joint 1 clockwise (anticlockwise positive)", "below 0",
        (RIGID,), measures.slide(0), -math.inf, -30.0, unit="deg",
    )  # fmt: skip
    yield Claim(
        "slide-2", "... joint 2 anticlockwise", "above 0", (RIGID,), measures.slide(1), 30.0, math.inf, unit="deg"
    )  # fmt: skip
    yield Claim(
        "two-sided", "post-lock impacts are two-sided: length of the mean direction", "both sides", (RIGID,),
        lambda member: max(measures.one_sidedness(member[RIGID], joint, 3) for joint in JOINTS), 0.0, 0.3,
        open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "peak", "rigid panels: greatest post-lock contact force, within a factor of 2", "about 800 N", (RIGID,),
        lambda member: float(member[RIGID].postlock_peak_force.max()), 400.0, 1600.0, unit="N",
        open_parameters=_OPEN, by_construction="latch_gap, latch_stiffness, latch_damping",
    )  # fmt: skip
    yield Claim(
        "bursts", "impacts come in bursts with the latch torque: rank correlation of both by windows of 0.25 s",
        "together", (RIGID,), measures.bursts, 0.3, 1.0, open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "synchrony", "... and at both joints at once: rank correlation of their forces by window", "synchronous",
        (RIGID,), measures.synchrony, 0.5, 1.0, open_parameters=_OPEN,
    )  # fmt: skip
    for joint, settled in enumerate((1.143, 1.34)):
        yield Claim(
            f"flexible-initial-{joint + 1}", f"flexible panels: initial impacts of joint {joint + 1} end, within 25 %",
            f"{settled} s", (FLEXIBLE,), measures.settled(FLEXIBLE, joint), *_within(settled, 0.25), unit="s",
        )  # fmt: skip
    yield Claim(
        "longer", "flexible panels: the initial phase lasts longer than with rigid ones (ratio, both joints)",
        "above 1", BOTH,
        measures.longer_settling, 1.0, math.inf,
    )  # fmt: skip
    yield Claim(
        "impacts-later", "flexible panels: impacts during the deployment too", "some", (FLEXIBLE,),
        measures.flights(FLEXIBLE), 1.0, math.inf,
    )  # fmt: skip
    yield Claim(
        "denser", "flexible panels: post-lock impacts are much denser (ratio)", "above 1", BOTH,
        measures.ratio(measures.impacts_after_latching, FLEXIBLE, RIGID), 2.0, math.inf, open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "smaller", "... but smaller (ratio of median peak forces, both joints)", "below 1", BOTH,
        measures.smaller_impacts, 0.0, 1.0, open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "latch-torque", "flexible panels: the first peak of the latch torque is smaller (ratio)", "below 1", BOTH,
        measures.ratio(measures.first_latch_torque, FLEXIBLE, RIGID), 0.0, 1.0, open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "cable-torque", "flexible panels: the cable torque's amplitude is much larger (ratio)", "above 1", BOTH,
        measures.ratio(measures.cable_amplitude(0.0), FLEXIBLE, RIGID), 1.5, math.inf, open_parameters=_OPEN,
        why="larger it is, by a fifth at a latch gap of 0.01 rad; the smaller the gap, the more energy is left in the "
        "panels' bending, and the belt feels more of it",
    )  # fmt: skip
    yield Claim(
        "cable-torque-late", "... after 20 s", "above 1", BOTH,
        measures.ratio(measures.cable_amplitude(LATE), FLEXIBLE, RIGID), 1.0, math.inf,
        open_parameters=_OPEN,
    )  # fmt: skip
    yield Claim(
        "vibration", "ideal joints let flexible panels vibrate more in deployment than clearance (ratio of rates)",
        "above 1", ("flexible-ideal", FLEXIBLE),
        measures.ratio(lambda motion: phases.vibration(motion, *QUIET), "flexible-ideal", FLEXIBLE), 1.0, math.inf,
    )  # fmt: skip
    for panels in ("rigid", "flexible"):
        pair = (f"{panels}-ideal", f"{panels}-clearance")
        yield Claim(
            f"lag-{panels}", f"clearance makes the oscillation of {panels} panels after latching lag (least of both "
            "joints over 10 s)", "above 0", pair, measures.lag(*pair), 1e-9, math.inf, unit="s",
            open_parameters=_OPEN,
        )  # fmt: skip
    yield from _joint_2_claims()
    yield Claim(
        "engagements", "flexible panels: the lock torque is denser (ratio of the times that it sets in)", "above 1",
        BOTH, measures.ratio(measures.engagements, FLEXIBLE, RIGID), 1.0, math.inf, open_parameters=_OPEN,
        why="latches engage less often where panels bend",
    )  # fmt: skip
    yield Claim(
        "circling", "flexible panels: no journal circles at latching (greatest angle within 0.1 s)", "below 90 deg",
        (FLEXIBLE,), measures.circling, 0.0, 90.0, unit="deg",
        why="journals go half round here, too, though in hops and less far than under rigid panels",
    )  # fmt: skip
    yield Claim(
        "burst-times", "impacts are strong at 15.74, 17.63, 20.59, 28.48 and 29.33 s: mean rank of these windows' "
        "forces among all (0.5 by chance)", "bursts", (RIGID,), measures.burst_rank, 0.75, 1.0, open_parameters=_OPEN,
        why="when bursts come hangs on the latch and on the cable, and after some seconds on chance",
    )  # fmt: skip
    yield Claim(
        "late-bursts", "... to the end: greatest contact force after 27.5 s over the greatest, at least a quarter",
        "bursts", (RIGID,), measures.late_bursts, 0.25, 1.0, open_parameters=_OPEN,
        why="friction and the latches' damping have taken most of the energy by then",
    )  # fmt: skip
    yield Claim(
        "distribution-force", "models 1 and 2 of the clearances: greatest contact force", "below 300 N", DISTRIBUTIONS,
        measures.greatest_distributed, 0.0, 300.0, unit="N", open_parameters=_OPEN_SIZES,
        why="equal clearances of 0.2 mm give about 600 N, 0.1 mm in joint 1 gives less, in joint 2 more",
    )  # fmt: skip
    yield Claim(
        "distribution-density", "clearances of 0.1 against 0.2 mm: more impacts (least ratio of both joints)",
        "above 1", DISTRIBUTIONS, measures.density, 1.0, math.inf, open_parameters=_OPEN_SIZES,
        why="the same joint has as many impacts with either clearance",
    )  # fmt: skip
    for joint in JOINTS:
        why = "where joint 2 has the small clearance joint 1 has the large one, and passes harder impacts on"
        yield Claim(
            f"distribution-size-{joint + 1}",
            f"clearances of 0.2 against 0.1 mm: larger impacts (ratio of median peak forces), joint {joint + 1}",
            "above 1", DISTRIBUTIONS, measures.size(joint), 1.0, math.inf, open_parameters=_OPEN_SIZES, why=why,
        )  # fmt: skip
        yield Claim(
            f"distribution-height-{joint + 1}", "... as an eye takes it (ratio of the mean of the greatest forces by "
            f"window), joint {joint + 1}", "above 1", DISTRIBUTIONS, measures.window_size(joint), 1.0, math.inf,
            open_parameters=_OPEN_SIZES, why=why,
        )  # fmt: skip
    yield Claim(
        "distribution-wear", "model 2 wears much less at its worst joint than model 1 (ratio of deepest bins)",
        "below 1", DISTRIBUTIONS, measures.ratio(measures.worst_wear, *reversed(DISTRIBUTIONS)), 0.0, 0.9,
        open_parameters=(*_OPEN_SLIDING, "contact_stiffness"),
        why="with the sliding speed of Eq 35 turning wears nothing; the points in contact slide most at joint 2, which "
        "turns by pi, and to it model 2 gives the small clearance", by_construction="friction_sliding",
    )  # fmt: skip
    yield Claim(
        "distribution-evenness", "... and more evenly (ratio of deeper to shallower joint, model 2 over model 1)",
        "below 1", DISTRIBUTIONS, measures.ratio(measures.unevenness, *reversed(DISTRIBUTIONS)), 0.0, 1.0,
        open_parameters=(*_OPEN_SLIDING, "contact_stiffness"), why="as for the wear of the worst joint",
        by_construction="friction_sliding",
    )  # fmt: skip
    yield Claim(
        "wear-depth", "wear after 30 s is of the order of 1e-14 m; Archard's coefficient is chosen so", "1e-14 m",
        DISTRIBUTIONS, lambda member: max(measures.worst_wear(member[case]) for case in DISTRIBUTIONS), 3e-15, 1e-13,
        unit="m",
        by_construction="wear_coefficient",
    )  # fmt: skip


def _joint_2_claims() -> Iterator[Claim]:
    """Claims of the paper on joint 2 against joint 1, with rigid panels."""
    why = "which joint's latch stops more, and is struck more, hangs on the hinge's place and on the torque ratio"
    for key, statement, figure in (
        ("lock-torque-2", "greatest lock torque", measures.lock_torque),
        ("settling-2", "time until the lock torque stays below a quarter of its greatest", measures.settling_time),
        ("swing-2", "swing of the panels (standard deviation of the angles)", measures.swing),
        ("stronger-2", "strength of the impacts (mean of the greatest forces by window)", measures.window_force),
        ("denser-2", "number of impacts", measures.impacts),
    ):
        yield Claim(
            key, f"rigid panels, joint 2 over joint 1 after latching: {statement}", "above 1", (RIGID,),
            measures.joint_2_over_1(figure), 1.0, math.inf, open_parameters=_OPEN, why=why,
        )  # fmt: skip


CLAIMS: tuple[Claim, ...] = tuple(_claims())
