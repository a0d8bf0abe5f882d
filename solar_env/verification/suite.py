"""The cases by name, and how to run them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from solar_env.verification.arrays import conservation, latching
from solar_env.verification.arrays import flexible as flexible_array
from solar_env.verification.arrays import impacts as array_impacts
from solar_env.verification.beams import (
    dynamics as beam_dynamics,
)
from solar_env.verification.beams import (
    elements as beam_elements,
)
from solar_env.verification.beams import (
    statics as beam_statics,
)
from solar_env.verification.beams import (
    vibration as beam_vibration,
)
from solar_env.verification.checks import Check, Row
from solar_env.verification.impacts import impact, sliding, stops
from solar_env.verification.linkages import chains, clearance_linkages, linkages, pendulum

CASES: dict[str, Callable[[], Iterator[Check]]] = {
    "restitution": impact.restitution_curve,
    "single-impact": impact.single_impact,
    "alternate-walls": impact.alternate_walls,
    "contact-stiffness": impact.contact_stiffness,
    "friction-creep": sliding.friction_creep,
    "sliding-speed": sliding.sliding_speed_readings,
    "wear": sliding.archard_wear,
    "pendulum": pendulum.pendulum_motion,
    "integration-order": pendulum.generalized_alpha_order,
    "multiplier-transients": pendulum.multiplier_transients,
    "double-pendulum": chains.double_pendulum_motion,
    "rigid-array": chains.rigid_array_motion,
    "slider-crank": linkages.slider_crank_cycle,
    "four-bar": linkages.four_bar_cycle,
    "slider-crank-clearance": clearance_linkages.slider_crank_clearance,
    "four-bar-clearance": clearance_linkages.four_bar_clearance,
    "slack-cable": stops.slack_cable,
    "undamped-stop": stops.undamped_stop,
    "damped-latch": stops.damped_latch,
    "latch-times": latching.latch_times,
    "paper-latch-time": latching.paper_latch_time,
    "conservation": conservation.free_array,
    "beam-mass": beam_elements.element_mass,
    "beam-strains": beam_elements.element_strains,
    "beam-tangent": beam_elements.element_tangent,
    "beam-loads": beam_elements.loaded_nodes,
    "beam-order": beam_elements.convergence,
    "elastica": beam_statics.tip_load,
    "rolled-beam": beam_statics.tip_moment,
    "beam-weight": beam_statics.own_weight,
    "panel-frequencies": beam_vibration.panel_frequencies,
    "material-damping": beam_vibration.material_damping,
    "spin-up": beam_dynamics.spin_up,
    "flexible-pendulum": beam_dynamics.falling_pendulum,
    "free-beam": beam_dynamics.free_flight,
    "flexible-integration-order": beam_dynamics.implicit_order,
    "rigid-limit": flexible_array.rigid_limit,
    "mesh-convergence": flexible_array.mesh_convergence,
    "clearance-limit": flexible_array.clearance_limit,
    "panel-counts": flexible_array.panel_counts,
    "flexible-conservation": flexible_array.flexible_clearance,
    "flexible-integrators": flexible_array.two_integrators,
    "flexible-agreement": flexible_array.two_integrators_tightly,
    "flexible-impacts": flexible_array.paper_phenomena,
    "array-impacts": array_impacts.rigid_array_impacts,
    "flexible-array-impacts": array_impacts.flexible_array_impacts,
}


def select(only: str | None = None) -> list[str]:
    """Names of the cases to run: all of them, or one.

    Raises:
        ValueError: if no case has that name.
    """
    if only is None:
        return list(CASES)
    if only not in CASES:
        raise ValueError(f"verification case {only!r} is unknown; the cases are {', '.join(CASES)}")
    return [only]


def run(only: str | None = None, announce: Callable[[str], None] | None = None) -> list[Row]:
    """Run all cases, or one.

    Args:
        only: name of a case, a key of CASES.
        announce: called with the name of every case before it runs.

    Raises:
        ValueError: if no case has that name.
        SimulationError: if a simulation cannot go on.
    """
    rows = []
    for name in select(only):
        if announce:
            announce(name)
        rows += [Row(case=name, **vars(check)) for check in CASES[name]()]
    return rows
