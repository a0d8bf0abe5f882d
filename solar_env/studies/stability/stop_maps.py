"""Maps of stiff hinges: a cable that slackens, and a latch that nears a rigid one, against the step.

Both conserve energy, so that what a method gains or loses is the energy at the end over the energy at the start.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from solar_env.mechanics.analysis.linearization import natural_frequencies
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta, amplification_radius
from solar_env.mechanics.mechanism.description import GROUND, CableLoop, Joint, Mechanism, Stop
from solar_env.mechanics.mechanism.textbook import Link
from solar_env.mechanics.running.simulation import simulate
from solar_env.studies.stability.maps import Axis, Cell, Heard, Kind, StabilityMap, classify_ratios, listen, log_range

EXPLICIT, DAMPED, PAPER = "runge-kutta", "generalized-alpha, 0.8", "paper (beta = 1/4)"
METHODS = (EXPLICIT, DAMPED, PAPER)
TOLERANCE = 0.02  # of the energy
PERIODS, FEWEST_STEPS = 5.0, 20.0
SPIN = 1.0  # rad/s, of the outer link
PRELOAD = 0.1  # of the torque that the taut cable would reach
INERTIA, RATE, LOCK, GAP = 4.5, 0.3, 0.02, 0.01  # kg m2, rad/s, rad, rad
LATCH_TIME = 0.4  # s
DEPTH_TOLERANCE = 0.02
MOST_STEPS = 300_000


def _integrator(panel: str, step: float) -> Integrator:
    if panel == EXPLICIT:
        return RungeKutta(max_step=step, max_steps=MOST_STEPS)
    return GeneralizedAlpha(step=step, rho_inf=0.8 if panel == DAMPED else 1.0, max_steps=MOST_STEPS)


def cable_chain(stiffness: float, preload_torque: float = math.inf) -> Mechanism:
    """Two slender links in a row, the outer one spinning, with a cable loop over their hinges [N m/rad, N m]."""
    link = Link.slender(1.0, 1.0)
    bodies = (link.body("inner", 0j, 0.0, 0j, 0.0), link.body("outer", 1.0 + 0j, 0.0, 0j, SPIN))
    joints = (
        Joint("root", GROUND, "inner", (0.0, 0.0), (0.0, 0.0)),
        Joint("hinge", "inner", "outer", (1.0, 0.0), (0.0, 0.0)),
    )
    cable = CableLoop("root", "hinge", stiffness, wheel_ratio=2.0, torque_ratio=2.0, preload_torque=preload_torque)
    return Mechanism(bodies, joints, (cable,))


@lru_cache(maxsize=64)
def cable_frequency(stiffness: float) -> float:
    """Angular frequency of the links on the taut cable [rad/s]."""
    return 2.0 * math.pi * float(natural_frequencies(cable_chain(stiffness))[-1])


def _cable_energy(panel: str, step: float, stiffness: float) -> float:
    """Energy at the end over that at the start."""
    frequency = cable_frequency(stiffness)
    # A taut cable would reach a mismatch of about spin / frequency.
    chain = cable_chain(stiffness, PRELOAD * stiffness * SPIN / frequency)
    duration = max(PERIODS * 2.0 * math.pi / frequency, FEWEST_STEPS * step)
    run = simulate(chain, duration, integrator=_integrator(panel, step), output_step=duration)
    return 1.0 + float(run.energies["residual"][-1] / run.energies["kinetic"][0])


def measure_cable(panel: str, step: float, stiffness: float) -> Cell:
    """Energy after five vibrations on a cable whose strands go slack, over that at the start."""
    return listen(lambda: _cable_energy(panel, step, stiffness)).cell(_judge_energy)


def _judge_energy(kept: float) -> Cell:
    return Cell(classify_ratios(kept, kept, TOLERANCE), kept)


def cable_limit(panel: str, stiffness: float) -> float:
    """Step at which theory loses 2 % of the energy in five vibrations on a taut cable [s]; nan without damping."""
    if panel != DAMPED:
        return math.nan
    low, high = 1e-3, math.pi
    for _ in range(50):
        phase = math.sqrt(low * high)
        kept = amplification_radius(0.8, phase) ** (2.0 * PERIODS * 2.0 * math.pi / phase)
        low, high = (phase, high) if kept > 1.0 - TOLERANCE else (low, phase)
    return low / cable_frequency(stiffness)


def swinging_link(stiffness: float) -> Mechanism:
    """A link that turns about a fixed hinge into its latch, an undamped linear stop [N m/rad]."""
    stop = Stop(GAP, stiffness, exponent=1.0, ramp_depth=1e-3, damping=0.0)
    joint = Joint("hinge", GROUND, "link", (0.0, 0.0), (0.0, 0.0), stop=stop, lock_angle=LOCK)
    return Mechanism((Link(1.5, 6.0, INERTIA - 6.0 * 0.75**2).body("link", 0j, 0.0, 0j, RATE),), (joint,))


def impact_time(stiffness: float) -> float:
    """Half a period on the stop [s]: the time that the link stays in it."""
    return math.pi * math.sqrt(INERTIA / stiffness)


@lru_cache(maxsize=4096)
def _latch(panel: str, step: float, stiffness: float) -> Heard[tuple[float, float]]:
    """Energy at the end over that at the start, and greatest over exact depth, of some bounces in a latch."""

    def run() -> tuple[float, float]:
        duration = LATCH_TIME + 2.0 * impact_time(stiffness)
        sampled = duration / 5_000.0
        motion = simulate(swinging_link(stiffness), duration, integrator=_integrator(panel, step), output_step=sampled)
        latched = motion.time >= motion.latch_times[0]
        depth = np.abs(motion.angles[latched] - LOCK).max() - GAP
        energy = float(motion.energies["residual"][-1] / motion.energies["kinetic"][0])
        return 1.0 + energy, float(depth / (RATE * math.sqrt(INERTIA / stiffness)))

    return listen(run)


def measure_latch(panel: str, step: float, stiffness: float) -> Cell:
    """Energy after some bounces between the faces of a latch over that at the start."""
    return _latch(panel, step, stiffness).cell(lambda result: _judge_energy(result[0]))


def measure_depth(panel: str, step: float, stiffness: float) -> Cell:
    """Greatest depth in a latch over the exact one."""

    def judge(result: tuple[float, float]) -> Cell:
        return Cell(Kind.WRONG if abs(result[1] - 1.0) > DEPTH_TOLERANCE else Kind.FINE, result[1])

    return _latch(panel, step, stiffness).cell(judge)


_STEPS = Axis("step_s", "fixed step, or bound on adaptive ones [s]", (1e-4, 1e-3, 1e-2), log_range(1e-5, 3e-2, 11))
_LATCHES = Axis(
    "stiffness_Nm_rad", "stiffness of the latch [N m/rad]", (1e2, 1e4, 1e6, 1e8), tuple(10.0**k for k in range(2, 12))
)
CABLE = StabilityMap(
    name="cable",
    title="Vibration on a cable whose strands go slack",
    x=_STEPS,
    y=Axis(
        "stiffness_Nm_rad",
        "stiffness of the cable [N m/rad]",
        (1e1, 1e3, 1e5, 1e7),
        tuple(10.0**k for k in range(1, 10)),
    ),
    panels=METHODS,
    quantity="energy after five vibrations over that at the start",
    advice="Take a fixed step of a twentieth of the cable's period or less, or an adaptive method, which finds it; a "
    "cable stiffer than the question asks for only shortens the step.",
    measure=measure_cable,
    limit=cable_limit,
    limit_label="theory: 2 % of the energy of a taut vibration lost to algorithmic damping",
)
LATCH = StabilityMap(
    name="latch",
    title="Bounces in an undamped latch, from soft to rigid",
    x=_STEPS,
    y=_LATCHES,
    panels=METHODS,
    quantity="energy at the end over that at the start",
    advice="Take a fixed step of an eighth of the time in the stop, pi sqrt(inertia / stiffness), or less, or an "
    "adaptive method; and no latch stiffer than the depth by which it may yield asks for.",
    measure=measure_latch,
    limit=lambda panel, stiffness: math.nan if panel == EXPLICIT else impact_time(stiffness) / 8.0,
    limit_label="eight steps in the stop",
)
DEPTH = replace(
    LATCH,
    name="latch-depth",
    title="How far a link sinks into its latch",
    quantity="greatest depth over the exact one",
    measure=measure_depth,
)
