"""Cases of the rigid array's deployment: its motion and its latch times, against minimal coordinates."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from solar_env.array import ArrayParameters, build
from solar_env.array.deployment import simulate as simulate_array
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.running.simulation import simulate
from solar_env.verification.arrays.theory import joint_angles_over_time, latch_time, latch_time_by_quadrature
from solar_env.verification.checks import Check, compare
from solar_env.verification.linkages.chain_theory import MINIMAL

# A cable that hardly stretches and never slackens.
STIFF_CABLE: dict[str, Any] = {"cable_stiffness": 1e5, "cable_preload_force": 1e9}
PAPER = "Li, Wang and Huang, Mech. Syst. Signal Process. 117 (2019) 188"
COUPLE: dict[str, Any] = {"cable_torque_ratio": 1.0}
# name, changes to the parameters
REDUCTIONS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("main body fixed", {"body_fixed": True}),
    ("free, hinge at mid-side", {}),
    ("cable couple, main body fixed", {"body_fixed": True, **COUPLE}),
    ("cable couple, free, hinge at mid-side", COUPLE),
    ("cable couple, free, hinge at (0.5, -0.5)", {"hinge_y": -0.5, **COUPLE}),
    ("cable couple, free, hinge at (0.5, 0.5)", {"hinge_y": 0.5, **COUPLE}),
)


def latch_times() -> Iterator[Check]:
    """Rigid-ideal array with a stiff cable loop against the reduction to one degree of freedom."""
    integrators: tuple[Integrator, ...] = (RungeKutta(rtol=1e-8), GeneralizedAlpha(step=2e-3))
    for name, changes in REDUCTIONS:
        parameters = ArrayParameters(**changes, **STIFF_CABLE)
        conservative = "cable_torque_ratio" not in changes
        expected = latch_time_by_quadrature(parameters) if conservative else latch_time(parameters)
        source = "theta2 = 2 theta1: " + ("quadrature of the energy" if conservative else "reduced equation of motion")
        for integrator in integrators:
            motion = simulate(build(parameters, "rigid-ideal"), expected + 0.05, integrator=integrator, output_step=1.0)
            yield Check(f"latch time, {name} [s], {integrator.name}", expected, motion.latch_times.max(), 1e-3, source)


def paper_latch_time() -> Iterator[Check]:
    """The `paper` preset with clearance, beside the end of the paper's contact phase."""
    motion = simulate_array(ArrayParameters.preset("paper"), model="rigid-clearance", duration=13.5)
    figures = zip("12", (13.175, 13.183), motion.latch_times, strict=True)
    quantity = "rigid-clearance, paper preset: latch time of joint {} [s]"
    yield from compare(figures, quantity, 0.1, f"{PAPER}, end of the contact phase")


def rigid_array_motion() -> Iterator[Check]:
    """The free array with springs and cable loops; greatest difference of any joint angle over 10 s."""
    times = [float(t) for t in np.arange(0.0, 10.01, 0.1)]
    variants = (
        ("two panels", ArrayParameters()),
        ("two panels, paper preset", ArrayParameters.preset("paper")),
        ("two panels, main body fixed", ArrayParameters(body_fixed=True)),
        ("three panels", ArrayParameters(panel_count=3, spring_stiffness=(0.1, 0.075, 0.075))),
    )
    for name, parameters in variants:
        motion = simulate(
            build(parameters, "rigid-ideal"), times[-1], integrator=RungeKutta(rtol=1e-12), output_step=0.1
        )
        reference = joint_angles_over_time(parameters, times)
        obtained = np.abs(motion.angles - reference).max()
        yield Check(f"{name}: greatest difference of a joint angle [rad]", 0.0, obtained, 1e-9, MINIMAL)
