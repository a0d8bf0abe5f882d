"""Map of impacts: the fixed step that generalized-alpha needs in a contact, and what happens above it.

A block bounces between the two walls of its gap (`textbook.bouncing_block`). In free flight nothing acts, so that
the impact speeds of successive contacts are the exit speeds of the ones before: their ratio is the restitution of every
bounce, to be compared with the exact one of the law.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, steps_per_impact
from solar_env.mechanics.joints.laws import PowerLaw, lankarani_damping
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.simulation import simulate
from solar_env.studies.stability.maps import Axis, Cell, StabilityMap, classify_ratios, listen, log_range

MASS, CLEARANCE, SPEED = 6.0, 2e-4, 0.1  # kg, m, m/s
BOUNCES = 12
TOLERANCE = 0.01  # of the exit speed of every bounce
HERTZ, DAMPED = "Hertz (conserves energy)", "Lankarani-Nikravesh, Ce = 0.9"
_UNDAMPED = PowerLaw(7.39e10)
_LAWS = {HERTZ: _UNDAMPED, DAMPED: replace(_UNDAMPED, damping=lankarani_damping(0.9))}


@lru_cache(maxsize=1)
def contact_duration() -> float:
    """Duration of the first impact [s], without damping."""
    return _UNDAMPED.impact_scales(_UNDAMPED.parameters(), 1.0 / MASS, SPEED)[1]


def bounce_ratios(contact: PowerLaw, integrator: Integrator) -> NDArray[np.float64]:
    """(bounces,) exit speeds of a bouncing block over the exact ones.

    Raises:
        SimulationError: if the run cannot go on.
    """
    exact = contact.exit_speed_ratio()
    flights = sum(2.0 * CLEARANCE / (SPEED * exact**n) for n in range(BOUNCES))
    mechanism = bouncing_block(Bearing(CLEARANCE, 0.01, contact), MASS, SPEED)
    speeds = simulate(mechanism, flights, integrator=integrator, output_step=flights / 100.0).contacts["impact_speed"]
    # A block that never comes back has no ratio: all its speed is lost.
    return speeds[1:] / speeds[:-1] / exact if len(speeds) > 1 else np.zeros(1)


def measure_implicit(panel: str, share: float, rho_inf: float) -> Cell:
    """Bounces under generalized-alpha with a fixed step of `share` of the first impact's duration."""

    def judge(ratios: NDArray[np.float64]) -> Cell:
        worst = float(ratios[np.argmax(np.abs(ratios - 1.0))])
        return Cell(classify_ratios(ratios.min(), ratios.max(), TOLERANCE), worst)

    step = share * contact_duration()
    return listen(lambda: bounce_ratios(_LAWS[panel], GeneralizedAlpha(step=step, rho_inf=rho_inf)), judge)


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
    panels=(HERTZ, DAMPED),
    quantity="exit speed over the exact one, worst of all bounces",
    advice="Take eight steps or more in an impact, and up to 23 with rho_inf below 0.5, or give rtol, which does it by "
    "itself: with fewer, generalized-alpha takes energy from every bounce or adds to it, whatever rho_inf.",
    measure=measure_implicit,
    limit=lambda panel, rho_inf: 1.0 / steps_per_impact(rho_inf),
    limit_label="the library warns to the right of this line: 8 steps, or 1 % of the speed lost to algorithmic damping",
)
