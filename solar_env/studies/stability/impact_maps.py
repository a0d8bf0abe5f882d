"""Stability maps of impacts: fixed steps that generalized-alpha needs in a contact, and restitution of contact laws.

A block bounces between the two walls of its gap (`textbook.bouncing_block`). Nothing acts in free flight, so that the
ratio of successive impact speeds is the restitution of a bounce. It is compared with the contact law's exact
restitution. Damping multiplies the contact force by 1 + d * (depth rate / impact speed), with the damping factor d. A
minimum impact speed keeps this finite.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta, steps_per_impact
from solar_env.mechanics.joints.laws import CONTACT_LAWS, PowerLaw, contact_law, lankarani_damping
from solar_env.mechanics.mechanism import Bearing
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.diagnosis import LARGEST_RESTITUTION_ERROR
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.stability.maps import Axis, Finding, Kind, Said, StabilityMap, classify_ratios, listen, log_range

MASS, CLEARANCE, SPEED = 6.0, 2e-4, 0.1  # kg, m, m/s
BOUNCES = 12
TOLERANCE = 0.01  # relative error allowed in the exit speed of every bounce
_UNDAMPED = PowerLaw(7.39e10)
_LAWS = {
    "Hertz (conserves energy)": _UNDAMPED,
    "Lankarani-Nikravesh, Ce = 0.9": replace(_UNDAMPED, damping=lankarani_damping(0.9)),
}
ARRAY = ArrayParameters(contact_stiffness=None)
# Names of the contact laws that dissipate energy.
DISSIPATING = tuple(name for name in CONTACT_LAWS if contact_law(name, ARRAY.surfaces(0), 0.5).exit_speed_ratio() < 1.0)
SLOWEST = 1e-4  # m/s, the default minimum impact speed
_FLIGHT = 50.0  # time of flight to the wall divided by the duration of an impact


def contact_duration() -> float:
    """Return the duration [s] of an undamped Hertzian impact of a block (MASS at SPEED) on a wall."""
    return _UNDAMPED.impact_scales(_UNDAMPED.parameters(), 1.0 / MASS, SPEED)[1]


def bounce_ratios(contact: PowerLaw, integrator: Integrator) -> NDArray[np.float64]:
    """Return the (bounces,) ratios of a bouncing block's simulated exit speed to the exact exit speed."""
    exact = contact.exit_speed_ratio()
    flights = sum(2.0 * CLEARANCE / (SPEED * exact**n) for n in range(BOUNCES))
    mechanism = bouncing_block(Bearing(CLEARANCE, 0.01, contact), MASS, SPEED)
    speeds = simulate(mechanism, flights, integrator=integrator, output_step=flights / 100.0).contacts["impact_speed"]
    # A block that never comes back has lost all its speed: its ratio is zero.
    return speeds[1:] / speeds[:-1] / exact if len(speeds) > 1 else np.zeros(1)


def measure_implicit(panel: str, share: float, rho_inf: float) -> Finding:
    """Simulate a bouncing block by generalized-alpha; return the worst ratio of its exit speed to the exact one.

    A class is returned too, such as "fine" (ratios within 1 % of 1) or "over-damped". The subplot `panel` names the
    contact law. The step is `share` times the undamped duration of the first impact.
    """

    def judge(ratios: NDArray[np.float64]) -> Finding:
        worst = float(ratios[np.argmax(np.abs(ratios - 1.0))])
        return Finding(classify_ratios(ratios.min(), ratios.max(), TOLERANCE), worst)

    step = share * contact_duration()
    return listen(lambda: bounce_ratios(_LAWS[panel], GeneralizedAlpha(step=step, rho_inf=rho_inf)), judge)


def measure_restitution(law: str, restitution: float, speed: float) -> Finding:
    """Simulate a bounce at `speed` [m/s] by contact `law`; return the ratio of exit to entry speed, and a class.

    The class is fine if the ratio differs from `restitution`, which the law is given, by at most 0.05; else wrong.
    """

    def bounce() -> Trajectory:
        bearing = replace(ARRAY, contact_law=law, restitution=restitution).bearing(0)
        way = _FLIGHT * speed * bearing.contact.impact_scales(bearing.contact.parameters(), 1.0 / MASS, speed)[1]
        bearing = replace(bearing, clearance=way, friction_coefficient=0.0, wear_coefficient=0.0)
        duration = 2.9 * way / speed  # ends before the block reaches the other wall
        block = bouncing_block(bearing, MASS, speed)
        return simulate(block, duration, integrator=RungeKutta(), output_step=duration)

    def judge(run: Trajectory) -> Finding:
        ratio, slow = -float(run.velocities[-1, 0]) / speed, run.metadata["slow_contacts"]
        kind = Kind.FINE if abs(ratio - restitution) <= LARGEST_RESTITUTION_ERROR else Kind.WRONG
        message = f"slow_contacts = {slow}: began below the minimum impact speed, {SLOWEST:g} m/s"
        return Finding(kind, ratio, Said.FIGURE, message) if slow else Finding(kind, ratio)

    return listen(bounce, judge)


def restitution_limit(law: str, speed: float) -> float:
    """Return the greatest prescribed restitution from which a contact law's own differs by more than 0.05, or nan.

    The law's own restitution is the ratio of exit to impact speed in closed form. If the impact `speed` [m/s] is below
    SLOWEST, the default minimum impact speed, damping is weaker by the ratio of the two speeds.
    """
    for asked in np.arange(1000, 0, -1) / 1000.0:
        contact = contact_law(law, ARRAY.surfaces(0), float(asked))
        given = replace(contact, damping=contact.damping * min(1.0, speed / SLOWEST)).exit_speed_ratio()
        if abs(given - asked) > LARGEST_RESTITUTION_ERROR:
            return float(asked)
    return math.nan


IMPLICIT = StabilityMap(
    name="impact-implicit",
    title="Generalized-alpha bounces wrongly with a fixed step above an eighth of the impact",
    x=Axis(
        "step_over_duration", "step / duration of the impact", log_range(1 / 32, 2.0, 7), log_range(1 / 64, 2.0, 22)
    ),
    y=Axis(
        "rho_inf",
        "rho_inf (1: the paper's beta = 1/4, gamma = 1/2)",
        (0.0, 0.5, 0.8, 1.0),
        (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0),
    ),
    panels=tuple(_LAWS),
    quantity="ratio of the exit speed to the exact one, worst of all bounces",
    advice="Take eight steps or more in an impact, and up to 23 with rho_inf below 0.5, or take a method that does so "
    "by itself: with fewer, generalized-alpha takes energy from every bounce or adds to it, whatever rho_inf.",
    measure=measure_implicit,
    limit=lambda panel, rho_inf: 1.0 / steps_per_impact(rho_inf),
    limit_label="the library warns to the right of this line: 8 steps, or 1 % of the speed lost to algorithmic damping",
)
RESTITUTION = StabilityMap(
    name="restitution",
    title="What a contact law makes of the restitution that it is given",
    x=Axis(
        "restitution",
        "coefficient of restitution asked for",
        (0.01, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 1.0),
        (0.001, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0),
    ),
    y=Axis("speed_m_s", "impact speed [m/s]", (1e-6, 1e-5, 1e-4, 1e-2, 1.0), log_range(1e-7, 10.0, 17)),
    panels=DISSIPATING,
    quantity="ratio of exit to entry speed",
    advice="Below a restitution of 0.8 take contact_law = 'restitution'; and set minimum_impact_speed below the "
    "slowest impact that matters, for slower ones bounce as if undamped.",
    measure=measure_restitution,
    limit=restitution_limit,
    limit_label="to the left the law in closed form is off by more than 0.05",
)
