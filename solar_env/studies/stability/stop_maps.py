"""Map of stiff stops: a latch from soft to rigid, against the step.

It conserves energy, so that what a method gains or loses is the energy at the end over the energy at the start.
"""

import math

import numpy as np

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism.description import GROUND, Joint, Mechanism, Stop
from solar_env.mechanics.mechanism.textbook import Link
from solar_env.mechanics.running.simulation import simulate
from solar_env.studies.stability.maps import Axis, Cell, Kind, StabilityMap, classify_ratios, listen, log_range

EXPLICIT, DAMPED, PAPER = "runge-kutta", "generalized-alpha, 0.8", "paper (beta = 1/4)"
TOLERANCE = 0.02  # of the energy, and of the depth
INERTIA, RATE, LOCK, GAP = 4.5, 0.3, 0.02, 0.01  # kg m2, rad/s, rad, rad
LATCH_TIME = 0.4  # s
MOST_STEPS = 300_000


def _integrator(panel: str, step: float) -> Integrator:
    if panel == EXPLICIT:
        return RungeKutta(max_step=step, max_steps=MOST_STEPS)
    return GeneralizedAlpha(step=step, rho_inf=0.8 if panel == DAMPED else 1.0, max_steps=MOST_STEPS)


def swinging_link(stiffness: float) -> Mechanism:
    """A link that turns about a fixed hinge into its latch, an undamped linear stop [N m/rad]."""
    stop = Stop(GAP, stiffness, exponent=1.0, ramp_depth=1e-3, damping=0.0)
    joint = Joint("hinge", GROUND, "link", (0.0, 0.0), (0.0, 0.0), stop=stop, lock_angle=LOCK)
    return Mechanism((Link(1.5, 6.0, INERTIA - 6.0 * 0.75**2).body("link", 0j, 0.0, 0j, RATE),), (joint,))


def impact_time(stiffness: float) -> float:
    """Half a period on the stop [s]: the time that the link stays in it."""
    return math.pi * math.sqrt(INERTIA / stiffness)


def _latch(panel: str, step: float, stiffness: float) -> tuple[float, float]:
    """Energy at the end over that at the start, and greatest over exact depth, of some bounces in a latch."""
    duration = LATCH_TIME + 2.0 * impact_time(stiffness)
    sampled = duration / 5_000.0
    motion = simulate(swinging_link(stiffness), duration, integrator=_integrator(panel, step), output_step=sampled)
    latched = motion.time >= motion.latch_times[0]
    depth = np.abs(motion.angles[latched] - LOCK).max() - GAP
    energy = float(motion.energies["residual"][-1] / motion.energies["kinetic"][0])
    return 1.0 + energy, float(depth / (RATE * math.sqrt(INERTIA / stiffness)))


def measure_latch(panel: str, step: float, stiffness: float) -> Cell:
    """Energy after some bounces between the faces of a latch over that at the start; wrong if only the depth is."""

    def judge(result: tuple[float, float]) -> Cell:
        energy, depth = result
        kind = classify_ratios(energy, energy, TOLERANCE)
        sinks = kind == Kind.FINE and abs(depth - 1.0) > TOLERANCE
        return Cell(Kind.WRONG if sinks else kind, energy)

    return listen(lambda: _latch(panel, step, stiffness), judge)


LATCH = StabilityMap(
    name="latch",
    title="Bounces in an undamped latch, from soft to rigid",
    x=Axis("step_s", "fixed step, or bound on adaptive ones [s]", (1e-4, 1e-3, 1e-2), log_range(1e-5, 3e-2, 11)),
    y=Axis(
        "stiffness_Nm_rad",
        "stiffness of the latch [N m/rad]",
        (1e2, 1e4, 1e6, 1e8),
        tuple(10.0**k for k in range(2, 12)),
    ),
    panels=(EXPLICIT, DAMPED, PAPER),
    quantity="energy at the end over that at the start",
    advice="Take a fixed step of an eighth of the time in the stop, pi sqrt(inertia / stiffness), or less, or an "
    "adaptive method; and no latch stiffer than the depth by which it may yield asks for.",
    measure=measure_latch,
    limit=lambda panel, stiffness: math.nan if panel == EXPLICIT else impact_time(stiffness) / 8.0,
    limit_label="eight steps in the stop",
)
