"""Table of the verification cases by name (`CASES`), and the function that runs a case."""

from collections.abc import Callable, Iterator
from dataclasses import replace

from threadpoolctl import threadpool_limits

from solar_env.verification.arrays import deployments, hand_checks, impacts
from solar_env.verification.beams import dynamics, statics
from solar_env.verification.checks import Check
from solar_env.verification.impacts import impact, sliding, stops
from solar_env.verification.linkages import four_bar, hinges, pendulum
from solar_env.verification.panels import method, motion, struck

CASES: dict[str, Callable[[], Iterator[Check]]] = {
    "restitution": impact.restitution_curve,
    "single-impact": impact.single_impact,
    "friction-creep": sliding.friction_creep,
    "wear": sliding.archard_wear,
    "pendulum": pendulum.pendulum_motion,
    "integration-order": pendulum.generalized_alpha_order,
    "hinge-elements": hinges.hinge_elements,
    "four-bar": four_bar.four_bar_cycle,
    "four-bar-clearance": four_bar.four_bar_clearance,
    "slack-cable": stops.slack_cable,
    "stops": stops.swings_into_stops,
    "rigid-array": deployments.rigid_array_motion,
    "deployed-frequencies": deployments.deployed_frequencies,
    "double-door": deployments.double_door,
    "two-wings": deployments.two_wings,
    "latch-times": deployments.latch_times,
    "hand-checks": hand_checks.hand_checks,
    "clearance-limit": deployments.clearance_limit,
    "rigid-limit": deployments.rigid_limit,
    "flexible-agreement": deployments.two_integrators,
    "conservation": deployments.conservation,
    "array-impacts": impacts.explicit_impacts,
    "modal-array-impacts": impacts.modal_impacts,
    "beam-order": statics.orders,
    "elastica": statics.tip_load,
    "rolled-beam": statics.tip_moment,
    "panel-frequencies": statics.panel_frequencies,
    "material-damping": statics.material_damping,
    "spin-up": dynamics.spin_up,
    "flexible-pendulum": dynamics.falling_pendulum,
    "free-beam": dynamics.free_flight,
    "modal-responses": motion.step_responses,
    "modal-elastica": motion.large_deflections,
    "modal-struck-bar": struck.struck_along,
    "modal-struck-beam": struck.struck_across,
    "modal-spin-up": motion.spin_up,
    "modal-pendulum": motion.falling_pendulum,
    "modal-order": method.order,
    "modal-conservation": method.free_chain,
}


def run(name: str) -> list[Check]:
    """Run a verification case, and return its checks.

    Args:
        name: a key of CASES.

    Raises:
        ValueError: if no case has that name.
        SimulationError: if a simulation cannot go on.
    """
    if name not in CASES:
        raise ValueError(f"verification case {name!r} is unknown; the cases are {', '.join(CASES)}")
    # Matrices are small: threads of the linear algebra would only wait for each other.
    with threadpool_limits(1):
        return [replace(check, case=name) for check in CASES[name]()]
