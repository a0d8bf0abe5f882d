"""Table of the cases by name, and running them."""

from collections.abc import Callable, Iterator
from functools import partial

from solar_env.verification.arrays import conservation, flexible, impacts, latching
from solar_env.verification.beams import dynamics, elements, statics, vibration
from solar_env.verification.checks import Check, Row
from solar_env.verification.impacts import impact, sliding, stops
from solar_env.verification.linkages import four_bar, pendulum
from solar_env.verification.panels import dynamics as turning
from solar_env.verification.panels import method, modes, responses, struck
from solar_env.verification.panels import statics as bent

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
    "rigid-array": latching.rigid_array_motion,
    "four-bar": four_bar.four_bar_cycle,
    "four-bar-clearance": four_bar.four_bar_clearance,
    "slack-cable": stops.slack_cable,
    "undamped-stop": stops.undamped_stop,
    "damped-latch": stops.damped_latch,
    "latch-times": latching.latch_times,
    "paper-latch-time": latching.paper_latch_time,
    "conservation": conservation.free_array,
    "beam-mass": elements.element_mass,
    "beam-strains": elements.element_strains,
    "beam-tangent": elements.element_tangent,
    "beam-loads": elements.loaded_nodes,
    "beam-order": elements.convergence,
    "elastica": statics.tip_load,
    "rolled-beam": statics.tip_moment,
    "beam-weight": statics.own_weight,
    "panel-frequencies": vibration.panel_frequencies,
    "material-damping": vibration.material_damping,
    "spin-up": dynamics.spin_up,
    "flexible-pendulum": dynamics.falling_pendulum,
    "free-beam": dynamics.free_flight,
    "flexible-integration-order": dynamics.implicit_order,
    "modal-frequencies": modes.frequencies,
    "modal-flexibility": modes.static_flexibility,
    "modal-responses": responses.step_responses,
    "modal-struck-bar": struck.struck_along,
    "modal-struck-beam": struck.struck_across,
    "modal-elastica": bent.large_deflections,
    "modal-spin-up": turning.spin_up,
    "modal-pendulum": turning.falling_pendulum,
    "modal-turning-frame": turning.turning_frame,
    "modal-order": method.order,
    "modal-conservation": method.free_chain,
    "rigid-limit": flexible.rigid_limit,
    "mesh-convergence": flexible.mesh_convergence,
    "clearance-limit": flexible.clearance_limit,
    "panel-counts": flexible.panel_counts,
    "flexible-conservation": flexible.flexible_clearance,
    "flexible-integrators": flexible.two_integrators,
    "flexible-agreement": flexible.two_integrators_tightly,
    "flexible-impacts": flexible.paper_phenomena,
    "array-impacts": partial(impacts.deployment_impacts, "rigid-clearance", 30.0, 1000),
    "flexible-array-impacts": partial(impacts.deployment_impacts, "flexible-clearance:6 elements", 14.0, 300),
    "modal-array-impacts": partial(impacts.modal_impacts, 16.0, 150),
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
