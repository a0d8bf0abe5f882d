"""Maps of the friction law's two speeds: how fast a contact creeps that should stick, and the step that it needs.

A loaded journal is turned by a torque of half the friction limit (`textbook.loaded_journal`). Coulomb's friction
would hold it; the ramp between the speeds v0 and v1 lets it creep at v0 + (v1 - v0) / 2 (Y. Li, C. Wang and W. Huang,
Mech. Syst. Signal Process. 117 (2019) 188, Eq 42, solved for the speed).
"""

import math
from dataclasses import replace

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.joints.contact import lankarani_nikravesh
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.friction.ramp import RampedCoulomb
from solar_env.mechanics.mechanism.description import Bearing, Body, Load
from solar_env.mechanics.mechanism.textbook import loaded_journal
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.stability.maps import Axis, Cell, Kind, Said, StabilityMap, listen, log_range

LOAD, RADIUS, CLEARANCE = 10.0, 0.01, 2e-4  # N, m, m
FRICTION, SHARE, INERTIA = 0.15, 0.5, 0.01  # -, of the friction limit, kg m2
MASS, MINIMUM_SPEED = 1.0, 1e-4  # kg, m/s
CONTACT = PowerLaw(7.39e10, damping=lankarani_nikravesh.damping(0.5))
# 300,000 of them make the 30 s of a deployment.
SHORT_STEP = 1e-4  # s
# Less than a millimetre in the 30 s of a deployment.
SLOW_CREEP = 1e-3 / 30.0  # m/s
MOST_STEPS = 200_000
DURATION = 0.02  # s
EXPLICIT, IMPLICIT = "runge-kutta", "generalized-alpha, step 0.1 ms"
_INTEGRATORS: dict[str, Integrator] = {
    EXPLICIT: RungeKutta(max_steps=MOST_STEPS),
    IMPLICIT: GeneralizedAlpha(max_steps=MOST_STEPS),
}


def creep_speed(speed_zero: float, speed_full: float) -> float:
    """Sliding speed at which the ramp carries the torque [m/s]."""
    return speed_zero + (speed_full - speed_zero) * SHARE


def friction_step(speed_zero: float, speed_full: float) -> float:
    """Step [s] to which the ramp bounds four explicit stages of order four: 2.785 over the decay rate of sliding."""
    slope = FRICTION * LOAD / (speed_full - speed_zero)  # N s/m
    return 2.785 / (slope * (1.0 / MASS + RADIUS**2 / INERTIA))


def _creep(panel: str, speed_zero: float, speed_full: float) -> tuple[float, Trajectory]:
    """Sliding speed at the end [m/s], and the run."""
    bearing = Bearing(
        CLEARANCE,
        RADIUS,
        CONTACT,
        MINIMUM_SPEED,
        friction_coefficient=FRICTION,
        friction=RampedCoulomb(speed_zero, speed_full),
    )
    normal = LOAD / math.hypot(1.0, SHARE * FRICTION)
    torque = SHARE * FRICTION * normal * RADIUS
    journal = loaded_journal(bearing, LOAD, math.atan(SHARE * FRICTION))
    body = journal.bodies[0]
    assert isinstance(body, Body)
    # It starts in the steady state: from rest the journal would first roll in its bearing for many seconds.
    creeping = replace(body, spin=creep_speed(speed_zero, speed_full) / RADIUS)
    settle = INERTIA * (speed_full - speed_zero) / (FRICTION * LOAD * RADIUS**2)
    duration = min(max(10.0 * settle, DURATION), 2.0)
    run = simulate(
        replace(journal, bodies=(creeping,), loads=(Load("journal", torque=torque),)),
        duration,
        integrator=_INTEGRATORS[panel],
        output_step=duration / 50.0,
    )
    return float(run.rates[-1, 0]) * RADIUS, run


def measure_creep(panel: str, speed_full: float, speed_zero: float) -> Cell:
    """Sliding speed under half the friction limit."""

    def judge(result: tuple[float, Trajectory]) -> Cell:
        speed, run = result
        if abs(speed - creep_speed(speed_zero, speed_full)) > 0.01 * creep_speed(speed_zero, speed_full):
            return Cell(Kind.WRONG, speed)
        share = run.metadata["creeping_share"]
        if speed <= SLOW_CREEP or not share > 0.0:
            return Cell(Kind.FINE if speed <= SLOW_CREEP else Kind.CREEPS, speed)
        return Cell(Kind.CREEPS, speed, Said.FIGURE, f"creeping_share = {share:.3g} of the samples in contact")

    return listen(lambda: _creep(panel, speed_zero, speed_full)).cell(judge)


def measure_step(panel: str, speed_full: float, speed_zero: float) -> Cell:
    """Mean step under half the friction limit; stiff where it is shorter than SHORT_STEP."""

    def judge(result: tuple[float, Trajectory]) -> Cell:
        _, run = result
        steps = run.metadata["steps"]
        mean = float(run.time[-1]) / steps
        if mean < SHORT_STEP:
            return Cell(Kind.STIFF, mean, Said.FIGURE, f"steps = {steps} for {run.time[-1]:.3g} s")
        return Cell(Kind.FINE, mean)

    return listen(lambda: _creep(panel, speed_zero, speed_full)).cell(judge)


def step_limit(panel: str, speed_zero: float) -> float:
    """v1 below which the ramp bounds the explicit step to SHORT_STEP [m/s]."""
    return speed_zero + SHORT_STEP / friction_step(0.0, 1.0)


_FULL = Axis(
    "speed_full_m_s", "v1: sliding speed of full friction [m/s]", log_range(1e-6, 1e-2, 5), log_range(1e-7, 1e-1, 13)
)
_ZERO = Axis(
    "speed_zero_m_s",
    "v0: sliding speed at which friction sets in [m/s]",
    (0.0, 1e-5, 1e-4),
    (0.0, *log_range(1e-7, 1e-2, 11)),
)
CREEP = StabilityMap(
    name="friction-creep",
    title="Creep of a loaded contact under half the friction limit",
    x=_FULL,
    y=_ZERO,
    panels=(EXPLICIT, IMPLICIT),
    quantity="sliding speed [m/s]",
    advice="Where a contact must stick, take v0 = 0 and v1 so small that v1 / 2 times the duration does not matter, "
    "0.03 mm/s for a millimetre in 30 s: this law has no stiction; creeping_share tells how much of a run crept.",
    measure=measure_creep,
    limit=lambda panel, speed_zero: 2.0 * SLOW_CREEP - speed_zero if speed_zero < SLOW_CREEP else math.nan,
    limit_label="law in closed form: a millimetre in 30 s",
)
STEP = StabilityMap(
    name="friction-step",
    title="The explicit step that the friction ramp leaves",
    x=_FULL,
    y=_ZERO,
    panels=(EXPLICIT,),
    quantity="mean step [s]",
    advice="Take no narrower ramp v1 - v0 than the question asks for, or integrate with generalized-alpha: where the "
    "decay rate of sliding, friction force over mass and ramp, is high, explicit steps are short.",
    measure=measure_step,
    limit=step_limit,
    limit_label="theory: to the left the ramp bounds the step to less than 0.1 ms",
)
