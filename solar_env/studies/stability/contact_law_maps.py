"""Maps of the contact laws: the restitution that they give, and where their damping pulls.

A factor 1 + d rate / impact speed with d > 0 is singular as the impact speed vanishes, which the minimum impact speed
prevents; and it attracts where the surfaces part faster than impact speed / d, which the library cuts off.
"""

import math
from dataclasses import replace

from scipy.optimize import brentq

from solar_env.array import ArrayParameters
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.joints.contact.laws import CONTACT_LAWS, contact_law
from solar_env.mechanics.mechanism.description import Bearing, Body
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
_DEPTH = 1e-6  # m, from which a journal is pulled
_ELASTIC = 0.1  # of the pull


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
    heard = listen(lambda: _bounce(law, restitution, speed))

    def judge(result: tuple[float, Trajectory]) -> Cell:
        ratio, run = result
        kind = Kind.FINE if abs(ratio - restitution) <= LARGEST_RESTITUTION_ERROR else Kind.WRONG
        slow = run.metadata["slow_contacts"]
        if not slow or heard.said:
            return Cell(kind, ratio)
        message = f"slow_contacts = {slow}: began below the minimum impact speed, {SLOWEST:g} m/s"
        return Cell(kind, ratio, Said.FIGURE, message)

    return heard.cell(judge)


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


def _pull_off(law: str, restitution: float, ratio: float) -> tuple[float, Trajectory]:
    """Speed at which a pulled journal leaves the wall over that without damping, and its run."""
    pull = (ratio * SLOWEST) ** 2 / (2.0 * _DEPTH)  # m/s2
    contact = contact_law(law, ARRAY.surfaces(0), restitution)
    _, elastic, _, _ = contact.force(contact.parameters(), _DEPTH, 0.0, SLOWEST)
    mass = elastic / (_ELASTIC * pull)
    clearance = 100.0 * _DEPTH
    free = bouncing_block(Bearing(clearance, ARRAY.journal_radius, contact, SLOWEST), mass, speed=0.0)
    body = free.bodies[0]
    assert isinstance(body, Body)
    pressed = replace(body, position=(clearance + _DEPTH, 0.0))
    duration = 1.2 * ratio * SLOWEST / pull
    run = simulate(
        replace(free, bodies=(pressed,), gravity=(-pull, 0.0)),
        duration,
        integrator=RungeKutta(rtol=1e-8),
        output_step=duration / 500.0,
    )
    inside = int((run.penetration[:, 0] > 0.0).sum())
    undamped = math.sqrt(2.0 * (_DEPTH * pull + contact.energy(contact.parameters(), _DEPTH) / mass))
    return -float(run.velocities[min(inside, len(run.time) - 1), 0]) / undamped, run


def measure_pull_off(law: str, restitution: float, ratio: float) -> Cell:
    """Speed of leaving over that without damping; cut off if the damping would have pulled on the way."""

    def judge(result: tuple[float, Trajectory]) -> Cell:
        speed, run = result
        share = run.metadata["cut_off_share"]
        # The first sample is taken before the contact begins.
        cut_off = (run.normal_force[1:][run.penetration[1:] > 0.0] == 0.0).any()
        if cut_off and share > 0.0:
            return Cell(Kind.CUT_OFF, speed, Said.FIGURE, f"cut_off_share = {share:.3g} of the samples in contact")
        return Cell(Kind.CUT_OFF if cut_off else Kind.FINE, speed)

    return listen(lambda: _pull_off(law, restitution, ratio)).cell(judge)


def pull_off_limit(law: str, ratio: float) -> float:
    """Coefficient below which the law attracts before the surfaces have parted, as d exceeds 1 / ratio; 0 for none."""

    def excess(restitution: float) -> float:
        return contact_law(law, ARRAY.surfaces(0), restitution).damping - 1.0 / ratio

    return float(brentq(excess, 1e-9, 1.0)) if excess(1e-9) > 0.0 else 0.0


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
PULL_OFF = StabilityMap(
    name="pull-off",
    title="Where the damping of a contact law attracts",
    x=Axis("restitution", "coefficient of restitution asked for", _FEW_COEFFICIENTS, _COEFFICIENTS),
    y=Axis(
        "separation_over_impact", "speed of parting / impact speed", (0.5, 2.0, 10.0, 100.0), log_range(0.2, 1000.0, 15)
    ),
    panels=LAWS,
    quantity="speed of leaving over that without damping",
    advice="Nothing need be done: forces are cut off at zero, so that no law attracts, and cut_off_share of a run "
    "tells how often; a higher minimum_impact_speed makes it rarer.",
    measure=measure_pull_off,
    limit=pull_off_limit,
    limit_label="to the left the damping outweighs the elastic force before the surfaces have parted",
)
