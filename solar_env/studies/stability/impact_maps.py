"""Maps of impacts: the step that each method needs in a contact, and what happens below it.

A block bounces between the two walls of its gap (`textbook.bouncing_block`). In free flight nothing acts, so that
the impact speeds of successive contacts are the exit speeds of the ones before: their ratio is the restitution of every
bounce, to be compared with the exact one of the law.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.integrators.settings import (
    FEWEST_EXPLICIT_STEPS,
    GeneralizedAlpha,
    Integrator,
    RungeKutta,
    steps_per_impact,
)
from solar_env.mechanics.joints.contact import lankarani_nikravesh
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.simulation import simulate
from solar_env.studies.stability.maps import Axis, Cell, StabilityMap, classify_ratios, listen, log_range

MASS, CLEARANCE, SPEED = 6.0, 2e-4, 0.1  # kg, m, m/s
BOUNCES = 12
TOLERANCE = 0.01  # of the exit speed of every bounce
HERTZ, DAMPED = "Hertz (conserves energy)", "Lankarani-Nikravesh, Ce = 0.9"
_UNDAMPED = PowerLaw(7.39e10)
_LAWS = {HERTZ: _UNDAMPED, DAMPED: replace(_UNDAMPED, damping=lankarani_nikravesh.damping(0.9))}
LIBRARY, UNCHECKED = "library", "without its check"


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


def _cell(contact: PowerLaw, make: Callable[[], Integrator]) -> Cell:
    def judge(ratios: NDArray[np.float64]) -> Cell:
        worst = float(ratios[np.argmax(np.abs(ratios - 1.0))])
        return Cell(classify_ratios(ratios.min(), ratios.max(), TOLERANCE), worst)

    return listen(lambda: bounce_ratios(contact, make())).cell(judge)


def measure_implicit(panel: str, share: float, rho_inf: float) -> Cell:
    """Bounces under generalized-alpha with a fixed step of `share` of the first impact's duration."""
    return _cell(_LAWS[panel], lambda: GeneralizedAlpha(step=share * contact_duration(), rho_inf=rho_inf))


def _unchecked(rtol: float, impact_resolution: float) -> RungeKutta:
    """Explicit Runge-Kutta with any number of steps per impact."""
    settings = RungeKutta(rtol=rtol)
    object.__setattr__(settings, "impact_resolution", impact_resolution)
    return settings


def measure_explicit(panel: str, steps: float, rtol: float) -> Cell:
    """Hertzian bounces under explicit Runge-Kutta with at least `steps` steps per predicted duration."""
    chosen = RungeKutta if panel == LIBRARY else _unchecked
    return _cell(_UNDAMPED, lambda: chosen(rtol=rtol, impact_resolution=steps))


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
EXPLICIT = StabilityMap(
    name="impact-explicit",
    title="Bounces under explicit Runge-Kutta",
    x=Axis(
        "steps_per_impact",
        "least steps per impact",
        (1.0, 2.0, 4.0, 8.0, 16.0),
        (0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 32.0),
    ),
    y=Axis("rtol", "tolerance rtol", (1e-6, 1e-3, 1e-1), (1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)),
    panels=(LIBRARY, UNCHECKED),
    quantity="exit speed over the exact one, worst of all bounces",
    advice="Leave impact_resolution at its 16 steps, or at 4 or more: with fewer, only a tight tolerance saves the "
    "bounces, and the library refuses them.",
    measure=measure_explicit,
    limit=lambda panel, rtol: float(FEWEST_EXPLICIT_STEPS),
    limit_label="fewer steps than this are refused",
    bare=(UNCHECKED,),
)
