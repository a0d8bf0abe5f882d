"""Map of the contact laws: the restitution that they give.

A factor 1 + d rate / impact speed with d > 0 is singular as the impact speed vanishes, which the minimum impact speed
prevents.
"""

import math
from dataclasses import replace

from solar_env.array import ArrayParameters
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.joints.laws import CONTACT_LAWS, contact_law
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.diagnosis import LARGEST_RESTITUTION_ERROR
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.stability.maps import Axis, Cell, Kind, Said, StabilityMap, listen, log_range

ARRAY = ArrayParameters(contact_stiffness=None)
# Those that dissipate.
LAWS = tuple(name for name in CONTACT_LAWS if contact_law(name, ARRAY.surfaces(0), 0.5).exit_speed_ratio() < 1.0)
MASS = 6.0  # kg
SLOWEST = 1e-4  # m/s, the default minimum impact speed
_FLIGHT = 50.0  # of the way to the wall over that of an impact at full speed


def _bounce(law: str, restitution: float, speed: float) -> tuple[float, Trajectory]:
    """Exit over entry speed of one bounce as the array's parameters describe it, and its run."""
    bearing = replace(ARRAY, contact_law=law, restitution=restitution).bearing(0)
    way = _FLIGHT * speed * bearing.contact.impact_scales(bearing.contact.parameters(), 1.0 / MASS, speed)[1]
    bearing = replace(bearing, clearance=way, friction_coefficient=0.0, wear_coefficient=0.0)
    duration = 2.9 * way / speed  # before the other wall
    run = simulate(bouncing_block(bearing, MASS, speed), duration, integrator=RungeKutta(), output_step=duration)
    return -float(run.velocities[-1, 0]) / speed, run


def measure_restitution(law: str, restitution: float, speed: float) -> Cell:
    """Exit over entry speed of a bounce; wrong if it differs from the coefficient by more than 0.05."""

    def judge(result: tuple[float, Trajectory]) -> Cell:
        ratio, run = result
        kind = Kind.FINE if abs(ratio - restitution) <= LARGEST_RESTITUTION_ERROR else Kind.WRONG
        slow = run.metadata["slow_contacts"]
        if not slow:
            return Cell(kind, ratio)
        message = f"slow_contacts = {slow}: began below the minimum impact speed, {SLOWEST:g} m/s"
        return Cell(kind, ratio, Said.FIGURE, message)

    return listen(lambda: _bounce(law, restitution, speed), judge)


def restitution_limit(law: str, speed: float) -> float:
    """Coefficient below which the law's exit speed is off by more than 0.05; nan if there is none.

    Below the minimum impact speed the damping is weaker by the ratio of the two speeds.
    """
    for k in range(1000, 0, -1):
        contact = contact_law(law, ARRAY.surfaces(0), k / 1000.0)
        given = replace(contact, damping=contact.damping * min(1.0, speed / SLOWEST)).exit_speed_ratio()
        if abs(given - k / 1000.0) > LARGEST_RESTITUTION_ERROR:
            return k / 1000.0
    return math.nan


_COEFFICIENTS = (0.001, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0)
_FEW_COEFFICIENTS = (0.01, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 1.0)
RESTITUTION = StabilityMap(
    name="restitution",
    title="What a contact law makes of the restitution that it is given",
    x=Axis("restitution", "coefficient of restitution asked for", _FEW_COEFFICIENTS, _COEFFICIENTS),
    y=Axis("speed_m_s", "impact speed [m/s]", (1e-6, 1e-5, 1e-4, 1e-2, 1.0), log_range(1e-7, 10.0, 17)),
    panels=LAWS,
    quantity="exit over entry speed",
    advice="Below a restitution of 0.8 take contact_law = 'restitution'; and set minimum_impact_speed below the "
    "slowest impact that matters, for slower ones bounce as if undamped.",
    measure=measure_restitution,
    limit=restitution_limit,
    limit_label="to the left the law in closed form is off by more than 0.05",
)
