"""Stability maps of integration steps: index-3 multipliers after a change of the step, and bounces in stiff latches.

The first map varies new / old step and the rho_inf of generalized-alpha. A pendulum swings for a second; then the step
changes, and the library solves accelerations and multiplier afresh. The length constraint's exact multiplier follows
from position and velocity: m (v^2 - g . r) / L^2. With rho_inf = 1 errors of multipliers grow (A. Cardona and
M. Geradin, Comput. Struct. 33 (1989) 801, doi:10.1016/0045-7949(89)90255-6).

The second map varies the step and a latch's stiffness. A link swings into the latch, an undamped stop. The ratio of
final to initial energy shows the method's own gain or loss.
"""

import math

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism import GROUND, Joint, Link, Mechanism, Stop, pendulum
from solar_env.mechanics.running.diagnosis import LARGEST_FORCE_SHARE
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.stability.maps import Axis, Finding, Kind, StabilityMap, classify_ratios, listen, log_range

FIRST_STEP, CHANGE_TIME, STEPS = 1e-2, 1.0, 200  # s, s, number of steps after the change
EXPLICIT, DAMPED, PAPER = "runge-kutta", "generalized-alpha, 0.8", "paper (beta = 1/4)"
TOLERANCE = 0.02  # relative error allowed in the energy, and in the depth in the stop
INERTIA, RATE, LOCK, GAP = 4.5, 0.3, 0.02, 0.01  # kg m2, rad/s, rad, rad
LATCH_TIME = 0.4  # s
MOST_STEPS = 300_000


def multiplier_errors(ratio: float, rho_inf: float) -> NDArray[np.float64]:
    """Return (STEPS,) errors of a pendulum's constraint force, divided by the greatest force, after a step-size change.

    The time step of generalized-alpha changes from FIRST_STEP [s] to `ratio` * FIRST_STEP.
    """
    simulation = Simulation(pendulum(), GeneralizedAlpha(step=FIRST_STEP, rho_inf=rho_inf))
    simulation.advance(CHANGE_TIME)
    simulation.integrator = GeneralizedAlpha(step=ratio * FIRST_STEP, rho_inf=rho_inf)
    errors = np.zeros(STEPS)
    for k in range(STEPS):
        simulation.advance(CHANGE_TIME + (k + 1) * ratio * FIRST_STEP)
        defect, largest = simulation.constraint_force_defect()
        errors[k] = defect / largest
    simulation.check()
    return errors


def measure_multipliers(panel: str, ratio: float, rho_inf: float) -> Finding:
    """Return a pendulum's greatest constraint-force error after a change of the time step, and a class of the errors.

    Errors are divided by the greatest force. The class is "fine" if no error exceeds 0.2, "spikes" if no error in the
    last quarter of the steps does, or "growing". `ratio` is new step / old step. `panel` is not used.
    """

    def judge(errors: NDArray[np.float64]) -> Finding:
        tolerance = 2.0 * LARGEST_FORCE_SHARE
        recovers = errors[-STEPS // 4 :].max() <= tolerance
        kind = Kind.FINE if errors.max() <= tolerance else Kind.SPIKES if recovers else Kind.GROWING
        return Finding(kind, float(errors.max()))

    return listen(lambda: multiplier_errors(ratio, rho_inf), judge)


def swinging_link(stiffness: float) -> Mechanism:
    """Return a link that turns about a fixed hinge until an undamped linear latch of `stiffness` [N m/rad] stops it."""
    stop = Stop(GAP, stiffness, exponent=1.0, ramp_depth=1e-3, damping=0.0)
    joint = Joint("hinge", GROUND, "link", (0.0, 0.0), (0.0, 0.0), stop=stop, lock_angle=LOCK)
    return Mechanism((Link(1.5, 6.0, INERTIA - 6.0 * 0.75**2).body("link", 0j, 0.0, 0j, RATE),), (joint,))


def impact_time(stiffness: float) -> float:
    """Return the time [s] that the link stays in the stop: half the period of its vibration on the stop."""
    return math.pi * math.sqrt(INERTIA / stiffness)


def measure_latch(panel: str, step: float, stiffness: float) -> Finding:
    """Simulate a link in an undamped latch of `stiffness` [N m/rad]; return final energy / initial energy, and a class.

    The text `panel`, such as "runge-kutta", selects the integrator; `step` [s] is its fixed or longest step. The
    energy's error gives the class, such as "fine" (up to 2 %) or "growing". The class is "wrong value" if the energy is
    fine, but the link's greatest depth in the stop is more than 2 % off the closed form.
    """
    duration = LATCH_TIME + 2.0 * impact_time(stiffness)
    method: Integrator = RungeKutta(max_step=step, max_steps=MOST_STEPS)
    if panel != EXPLICIT:
        method = GeneralizedAlpha(step=step, rho_inf=0.8 if panel == DAMPED else 1.0, max_steps=MOST_STEPS)

    def judge(run: Trajectory) -> Finding:
        energy = 1.0 + float(run.energies["residual"][-1] / run.energies["kinetic"][0])
        kind = classify_ratios(energy, energy, TOLERANCE)
        depth = np.abs(run.angles[run.time >= run.latch_times[0]] - LOCK).max() - GAP
        sinks = abs(depth / (RATE * math.sqrt(INERTIA / stiffness)) - 1.0) > TOLERANCE
        return Finding(Kind.WRONG if sinks and kind == Kind.FINE else kind, energy)

    link = swinging_link(stiffness)
    return listen(lambda: simulate(link, duration, integrator=method, output_step=duration / 5_000.0), judge)


STEP_CHANGE = StabilityMap(
    name="step-change",
    title="Multipliers of generalized-alpha after a change of the step (pendulum, first step 0.01 s)",
    x=Axis(
        "step_ratio",
        "new step / old step",
        (0.01, 0.1, 0.5, 1.0, 2.0),
        (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0.8, 1.0, 1.25, 2.0, 4.0),
    ),
    y=Axis(
        "rho_inf",
        "rho_inf (1: the paper's beta = 1/4, gamma = 1/2)",
        (0.0, 0.5, 0.8, 1.0),
        (0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0),
    ),
    panels=("generalized-alpha",),
    quantity="greatest error of the multiplier over the force",
    advice="Take rho_inf of 0.9 or less: with rho_inf = 1 constraint forces alternate ever more, at a constant step "
    "too.",
    measure=measure_multipliers,
)
LATCH = StabilityMap(
    name="latch",
    title="Bounces in an undamped latch, from soft to rigid",
    x=Axis("step_s", "fixed step, or bound on adaptive ones [s]", (1e-4, 1e-3, 1e-2), log_range(1e-5, 3e-2, 11)),
    y=Axis("stiffness_Nm_rad", "stiffness of the latch [N m/rad]", (1e2, 1e4, 1e6, 1e8), log_range(1e2, 1e11, 10)),
    panels=(EXPLICIT, DAMPED, PAPER),
    quantity="energy at the end over that at the start",
    advice="Take a fixed step of an eighth of the time in the stop, pi sqrt(inertia / stiffness), or less, or an "
    "adaptive method; and no latch stiffer than the depth by which it may yield asks for.",
    measure=measure_latch,
    limit=lambda panel, stiffness: math.nan if panel == EXPLICIT else impact_time(stiffness) / 8.0,
    limit_label="eight steps in the stop",
)
