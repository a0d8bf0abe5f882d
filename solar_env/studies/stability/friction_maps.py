"""Stability map over the friction law's two speeds: where a contact that should stick creeps, or steps become short.

A torque of half the friction limit turns a loaded journal (`textbook.loaded_journal`). Coulomb friction would hold it;
friction that rises from zero at the speed v0 to its limit at v1 lets it creep at v0 + (v1 - v0) / 2 (Y. Li, C. Wang and
W. Huang, Mech. Syst. Signal Process. 117 (2019) 188, Eq 42, solved for the speed). Explicit steps shrink with v1 - v0.
"""

import math
from dataclasses import replace

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw, lankarani_damping
from solar_env.mechanics.mechanism import Bearing, Body, Load, loaded_journal
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.stability.maps import Axis, Finding, Kind, Said, StabilityMap, listen, log_range

LOAD, RADIUS, CLEARANCE = 10.0, 0.01, 2e-4  # N, m, m
FRICTION, SHARE, INERTIA = 0.15, 0.5, 0.01  # -, fraction of the friction limit, kg m2
MASS, MINIMUM_SPEED = 1.0, 1e-4  # kg, m/s
CONTACT = PowerLaw(7.39e10, damping=lankarani_damping(0.5))
SHORT_STEP = 1e-4  # s; a deployment of 30 s would take 300,000 such steps
SLOW_CREEP = 1e-3 / 30.0  # m/s; a millimetre in a deployment of 30 s
MOST_STEPS = 200_000
DURATION = 0.02  # s
EXPLICIT, IMPLICIT = "runge-kutta", "generalized-alpha, step 0.1 ms"
_INTEGRATORS: dict[str, Integrator] = {
    EXPLICIT: RungeKutta(max_steps=MOST_STEPS),
    IMPLICIT: GeneralizedAlpha(max_steps=MOST_STEPS),
}


def creep_speed(speed_zero: float, speed_full: float) -> float:
    """Return the sliding speed [m/s] at which friction, linear between the given speeds, is SHARE of its limit."""
    return speed_zero + (speed_full - speed_zero) * SHARE


def creep(panel: str, speed_zero: float, speed_full: float) -> Trajectory:
    """Simulate a loaded journal that creeps under half the limiting friction torque, and return its trajectory.

    Friction rises from zero at the sliding speed `speed_zero` [m/s] to its limit at `speed_full`. The text `panel`
    selects the integrator, and titles a subplot: "runge-kutta" or "generalized-alpha, step 0.1 ms".
    """
    bearing = Bearing(CLEARANCE, RADIUS, CONTACT, MINIMUM_SPEED, FRICTION, (speed_zero, speed_full))
    normal = LOAD / math.hypot(1.0, SHARE * FRICTION)
    torque = SHARE * FRICTION * normal * RADIUS
    journal = loaded_journal(bearing, LOAD, math.atan(SHARE * FRICTION))
    body = journal.bodies[0]
    assert isinstance(body, Body)
    # Start in the steady state: from rest the journal would first roll in its bearing for many seconds.
    creeping = replace(body, spin=creep_speed(speed_zero, speed_full) / RADIUS)
    settle = INERTIA * (speed_full - speed_zero) / (FRICTION * LOAD * RADIUS**2)
    duration = min(max(10.0 * settle, DURATION), 2.0)
    return simulate(
        replace(journal, bodies=(creeping,), loads=(Load("journal", torque=torque),)),
        duration,
        integrator=_INTEGRATORS[panel],
        output_step=duration / 50.0,
    )


def measure_friction(panel: str, speed_full: float, speed_zero: float) -> Finding:
    """Simulate a journal under half the limiting friction torque; return its final sliding speed [m/s] and an outcome.

    The outcome is "fine", "creeps", "stiff" (needs very short steps), "wrong value", or an error's, such as "blow-up".
    Friction rises from zero at the sliding speed `speed_zero` [m/s] to its limit at `speed_full`. The text `panel`
    selects the integrator, "runge-kutta" or "generalized-alpha, step 0.1 ms".
    """

    def judge(run: Trajectory) -> Finding:
        speed, expected = float(run.rates[-1, 0]) * RADIUS, creep_speed(speed_zero, speed_full)
        if abs(speed - expected) > 0.01 * expected:
            return Finding(Kind.WRONG, speed)
        if speed > SLOW_CREEP:
            share = run.metadata["creeping_share"]
            told = (Said.FIGURE, f"creeping_share = {share:.3g} of the samples in contact") if share > 0.0 else ()
            return Finding(Kind.CREEPS, speed, *told)
        steps, end = run.metadata["steps"], float(run.time[-1])
        if panel == EXPLICIT and end / steps < SHORT_STEP:
            return Finding(Kind.STIFF, speed, Said.FIGURE, f"steps = {steps} for {end:.3g} s")
        return Finding(Kind.FINE, speed)

    return listen(lambda: creep(panel, speed_zero, speed_full), judge)


FRICTION_MAP = StabilityMap(
    name="friction",
    title="Creep of a loaded contact under half the friction limit",
    x=Axis(
        "speed_full_m_s",
        "v1: sliding speed of full friction [m/s]",
        log_range(1e-6, 1e-2, 5),
        log_range(1e-7, 1e-1, 13),
    ),
    y=Axis(
        "speed_zero_m_s",
        "v0: sliding speed at which friction sets in [m/s]",
        (0.0, 1e-5, 1e-4),
        (0.0, *log_range(1e-7, 1e-2, 11)),
    ),
    panels=(EXPLICIT, IMPLICIT),
    quantity="sliding speed [m/s]",
    advice="Where a contact must stick, take v0 = 0 and v1 so small that v1 / 2 times the duration does not matter, "
    "0.03 mm/s for a millimetre in 30 s, but no smaller, or integrate with generalized-alpha: explicit steps shrink "
    "with v1 - v0. This law has no stiction; creeping_share tells how much of a run crept.",
    measure=measure_friction,
    limit=lambda panel, speed_zero: 2.0 * SLOW_CREEP - speed_zero if speed_zero < SLOW_CREEP else math.nan,
    limit_label="law in closed form: a millimetre in 30 s",
)
