"""Verification cases of whole deployments: comparison with minimal coordinates, limiting cases, conservation."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from solar_env.array import ArrayParameters, build
from solar_env.array.construction import build_deployed
from solar_env.array.methods import default_integrator
from solar_env.mechanics.analysis.linearization import natural_frequencies
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism import Body, Mechanism
from solar_env.mechanics.running.simulation import simulate
from solar_env.verification.arrays.theory import (
    MINIMAL,
    frequencies_on_latches,
    joint_angles_over_time,
    latch_time,
)
from solar_env.verification.beams.fields import momenta
from solar_env.verification.checks import ARNOLD_BRULS, ENERGY, Check, compare

REDUCED = "theta2 = 2 theta1: reduced equation of motion"
MINIMAL_MASSES = "generalized eigenvalues of the mass matrix and the hinge springs in minimal coordinates"
DOUBLE_DOOR = (
    "double door of J. Rupp and B. Schweizer's DeployStructLib (Modelica Conf. 2018, doi:10.3384/ecp18154187), rigid: "
    "Lagrange's equations, integrated by SciPy's DOP853"
)
ELEMENTS = "16 elements a panel"
MIRROR = "mirror symmetry of two wings"
NO_LOADS = "no external force or moment acts"
HINGE_SHIFT = "a hinge out of its place by c changes inertias, and the time, by the order of c / L"
QUASI_STATIC = "quasi-static deflection under the inertia forces is proportional to 1 / E"
# Parameters of a cable that hardly stretches and never slackens.
STIFF_CABLE: dict[str, Any] = {"cable_stiffness": 5e3, "cable_preload_force": 1e4}
COUPLE: dict[str, Any] = {"cable_torque_ratio": 1.0}
_SPRING = (((0.0, 0.2), (0.5, 0.12), (1.2, 0.15), (1.6, 0.02)), ((0.0, 0.05), (2.0, 0.02), (3.2, 0.04)))
_GROUND: dict[str, Any] = {"body_fixed": True, "gravity": 9.81, "gravity_angle": 1.0, "cable_stiffness": 0.0}
_HANGERS: dict[str, Any] = {"offloading_share": 0.999, "offloading_friction": 5e-4, "hinge_friction_rate": 0.02}
_HARNESS = ((0.0, 0.04), (0.8, 0.0), (2.0, -0.02), (3.2, -0.05))
# Pairs of a name and changes to the default parameters.
REDUCTIONS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("main body fixed", {"body_fixed": True}),
    ("free, hinge at mid-side", {}),
    ("cable couple, main body fixed", {"body_fixed": True, **COUPLE}),
    ("cable couple, free, hinge at mid-side", COUPLE),
    ("cable couple, free, hinge at (0.5, -0.5)", {"hinge_y": -0.5, **COUPLE}),
    ("cable couple, free, hinge at (0.5, 0.5)", {"hinge_y": 0.5, **COUPLE}),
)


def rigid_array_motion() -> Iterator[Check]:
    """Check joint angles of rigid arrays, under all hinge torques, against a solution in minimal coordinates."""
    times = [float(t) for t in np.arange(0.0, 10.01, 0.1)]
    variants = (
        ("two panels", ArrayParameters()),
        ("two panels, paper preset", ArrayParameters.preset("paper")),
        ("two panels, main body fixed", ArrayParameters(body_fixed=True)),
        ("three panels", ArrayParameters(panel_count=3, spring_stiffness=(0.1, 0.075, 0.075))),
        ("dampers in the hinges", ArrayParameters(hinge_damping=(0.5, 0.2), cable_stiffness=0.0)),
        ("dry friction in the hinges", ArrayParameters(hinge_friction_torque=0.02, hinge_friction_rate=0.02)),
        ("springs and harness by tables", ArrayParameters(spring_torque=_SPRING, harness_torque=_HARNESS)),
        ("a yoke and a panel", ArrayParameters(panel_length=(0.3, 1.5), panel_area_mass=(8.0, 3.0))),
        ("fittings on the panels", ArrayParameters(panel_masses=((1, 0.1, 0.8), (1, 1.4, 0.5), (2, 0.0, 0.5)))),
        ("hinges that open in one sense", ArrayParameters(folding="wrap", cable_stiffness=0.0)),
        ("on the ground", ArrayParameters(**_GROUND, spring_stiffness=40.0)),
        ("on the ground, on hangers", ArrayParameters(**_GROUND, **_HANGERS)),
        ("a root that opens by a half turn", ArrayParameters(fold_angle=math.pi, spring_preload_angle=3.5)),
    )
    for name, parameters in variants:
        array = build(parameters, "rigid-ideal")
        motion = simulate(array, times[-1], integrator=RungeKutta(rtol=1e-12), output_step=0.1)
        opening = motion.time < np.nanmin(motion.latch_times, initial=math.inf)
        obtained = np.abs(motion.angles - joint_angles_over_time(parameters, times))[opening].max()
        yield Check(f"{name}: greatest difference of a joint angle [rad]", 0.0, obtained, 1e-9, MINIMAL)


def double_door() -> Iterator[Check]:
    """Check a published array of two panels that swing in one sense into non-latching stops: times, rates, torques."""
    # Two masses beside the centre of a fitting have its inertia of 1e-6 kg m2.
    apart, half = math.sqrt(1e-6 / 0.05), 0.025
    places = ((1, 0.02), (1, 0.28), (2, 0.02))
    fittings = tuple((panel, place + side * apart, half) for panel, place in places for side in (-1.0, 1.0))
    door = ArrayParameters(
        body_fixed=True, folding="wrap", fold_angle=math.pi / 2, panel_length=(0.3, 0.15), panel_width=(0.6, 0.5),
        panel_thickness=0.007, panel_density=(195.1, 193.2), panel_masses=fittings, spring_stiffness=0.05,
        spring_preload_angle=math.pi, hinge_damping=0.03, cable_stiffness=0.0, latching=0, latch_gap=0.0,
        latch_stiffness=1000.0, latch_damping=0.0,
    )  # fmt: skip
    exact = RungeKutta(rtol=1e-11, max_step=1e-4)
    motion = simulate(build(door, "rigid-ideal"), 3.25, integrator=exact, output_step=2e-5)
    beyond = [CubicHermiteSpline(motion.time, motion.angles[:, j] - math.pi / 2, motion.rates[:, j]) for j in (0, 1)]
    parting, returning = np.transpose([spline.roots(extrapolate=False)[1:3] for spline in beyond])
    rates = [-spline(time, 1) for spline, time in zip(beyond, parting, strict=True)]
    pairs = (
        ("time at which hinge {} meets its stop [s]", (0.975177, 0.461077), motion.latch_times),
        ("rate of hinge {} then [rad/s]", (2.565235, 2.351542), motion.latch_rates),
        ("greatest torque of the stop of hinge {} [N m]", (14.2022, 1.70963), motion.peak_latch_torque),
        ("time at which hinge {} leaves its stop [s]", (0.992808, 0.463164), parting),
        ("rate of hinge {} then, backwards [rad/s]", (2.524259, 2.173655), rates),
        ("time at which hinge {} meets its stop again [s]", (2.267553, 0.483879), returning),
    )
    for quantity, expected, obtained in pairs:
        yield from compare(zip("12", expected, obtained, strict=True), quantity, 1e-5, DOUBLE_DOOR, relative=True)
    # The published panels also bend. Modal panels take no fittings: with fittings, 8 elements are compared with 16.
    soft = replace(door, panel_young=7e8, panel_damping=1e-3)
    explicit = replace(default_integrator("flexible-ideal:8 elements"), rtol=1e-6)
    modal = replace(default_integrator("flexible-ideal"), rtol=1e-4)
    for name, parameters, panels, method in (
        ("with fittings, 8 elements", soft, "8 elements", explicit),
        ("without fittings, 8 modes", replace(soft, panel_masses=()), "8 modes", modal),
    ):
        fine = simulate(build(parameters, "flexible-ideal:16 elements"), 1.2, integrator=explicit)
        found = simulate(build(parameters, f"flexible-ideal:{panels}"), 1.2, integrator=method)
        for quantity, attribute, tolerance in (
            ("time at which hinge {} meets its stop [s]", "latch_times", 2e-7),
            ("rate of hinge {} then [rad/s]", "latch_rates", 2e-7),
            ("greatest torque of the stop of hinge {} [N m]", "peak_latch_torque", 1e-3),
        ):
            figures = zip("12", getattr(fine, attribute), getattr(found, attribute), strict=True)
            yield from compare(figures, f"{name}: {quantity}", tolerance, ELEMENTS, relative=True)


def two_wings() -> Iterator[Check]:
    """Check symmetry of two mirrored wings, rigid and flexible: joint angles, turn and sideways shift of the hub."""
    for model in ("rigid-ideal", "flexible-ideal:2 elements"):
        parameters = ArrayParameters(wings=2)
        motion = simulate(build(parameters, model), 10.0, integrator=default_integrator(model), output_step=0.1)
        one, other = np.split(motion.angles, 2, axis=1)
        base = motion.coordinates[:, :4] - motion.coordinates[0, :4]
        for quantity, obtained in (
            ("difference of a joint's angle from its mirror image [rad]", one - other),
            ("turn of the hub [rad]", base[:, 3] - base[:, 1]),
            ("way of the hub across the axis of symmetry [m]", base[:, 0]),
        ):
            yield Check(f"{model}: {quantity}", 0.0, float(np.abs(obtained).max()), 1e-11, MIRROR)


def deployed_frequencies() -> Iterator[Check]:
    """Check frequencies of deployed rigid panels on their latch springs against theory in minimal coordinates."""
    wing = ArrayParameters(panel_count=3, body_mass=120.0, body_inertia=12.8, cable_stiffness=0.0)
    variants = (
        ("two panels, hub held", ArrayParameters(body_fixed=True, cable_stiffness=0.0)),
        ("three panels, hub free", wing),
        ("a yoke, an angle between panels, hub free", replace(wing, panel_length=(0.3, 1.5), lock_angle=(1.2, 3.0))),
    )
    for name, parameters in variants:
        found = natural_frequencies(build_deployed(parameters, "rigid-ideal"))[-parameters.panel_count :]
        expected = frequencies_on_latches(parameters)
        pairs = zip(map(str, range(1, 9)), expected, found, strict=False)
        yield from compare(pairs, f"{name}: frequency {{}} [Hz]", 1e-9, MINIMAL_MASSES, relative=True)


def latch_times() -> Iterator[Check]:
    """Check latch times of rigid arrays with ideal hinges and stiff cable loops against a model with one coordinate."""
    integrators: tuple[Integrator, ...] = (RungeKutta(rtol=1e-8), GeneralizedAlpha(step=2e-3))
    for name, changes in REDUCTIONS:
        parameters = ArrayParameters(**changes, **STIFF_CABLE)
        expected = latch_time(parameters)
        for integrator in integrators:
            motion = simulate(build(parameters, "rigid-ideal"), expected + 0.05, integrator=integrator, output_step=1.0)
            obtained = motion.latch_times.max()
            yield Check(f"latch time, {name} [s], {integrator.name}", expected, obtained, 1e-3, REDUCED)


def clearance_limit() -> Iterator[Check]:
    """Check that latch times with clearance tend to latch times with ideal joints as the clearance vanishes."""

    def latched(parameters: ArrayParameters, model: str, rtol: float) -> NDArray[np.float64]:
        return simulate(build(parameters, model), 13.0, integrator=RungeKutta(rtol=rtol), output_step=1.0).latch_times

    ideal, clearances = latched(ArrayParameters(), "rigid-ideal", 1e-9), (2e-4, 1e-4, 5e-5, 2.5e-5)
    differences = []
    for clearance in clearances:
        parameters = ArrayParameters(clearance=clearance, friction_coefficient=0.0)  # friction would not vanish with it
        differences.append(latched(parameters, "rigid-clearance", 1e-7) - ideal)
        for joint, difference in enumerate(differences[-1]):
            quantity = f"c = {clearance:g} m: latch time of joint {joint + 1} less that of an ideal one [s]"
            tolerance = 2.0 * float(ideal[joint]) * clearance / parameters.panel(0).length
            yield Check(quantity, 0.0, difference, tolerance, HINGE_SHIFT)
    orders = np.log2(np.abs(differences[0] / differences[-1])) / math.log2(clearances[0] / clearances[-1])
    yield from compare(
        zip("12", (1.0, 1.0), orders, strict=True),
        "order in c of the difference of the latch time of joint {}",
        tolerance=0.25,  # wide: orders rest on single runs, which begin with impacts
        source="the place of the hinge is proportional to c",
    )


def without_rotary_inertia(mechanism: Mechanism) -> Mechanism:
    """Return the mechanism with every rigid panel's inertia set to m L^2 / 12, as beam elements lack rotary inertia."""
    bodies = [mechanism.bodies[0]]
    for body in mechanism.bodies[1:]:
        assert isinstance(body, Body)
        bodies.append(replace(body, inertia=body.mass * body.length**2 / 12.0))
    return replace(mechanism, bodies=tuple(bodies))


def rigid_limit() -> Iterator[Check]:
    """Check that joint angles with flexible panels tend to angles with rigid panels as Young's modulus rises.

    The cable is left out, because its oscillation is undamped. Material damping makes the panels bend quasi-statically.
    """

    def angles(mechanism: Mechanism) -> NDArray[np.float64]:
        motion = simulate(mechanism, 6.0, integrator=GeneralizedAlpha(step=2.5e-3), output_step=0.5)
        return motion.angles[4:]

    two = ArrayParameters(cable_stiffness=0.0, panel_damping=0.01)
    one = replace(two, panel_count=1, spring_stiffness=0.1, spring_preload_angle=math.pi / 2)
    for name, parameters in (("1 panel", one), ("2 panels", two)):
        rigid = angles(without_rotary_inertia(build(parameters, "rigid-ideal")))
        softer, stiffer = (
            np.abs(angles(build(replace(parameters, panel_young=E), "flexible-ideal:2 elements")) - rigid).max()
            for E in (280e6, 560e6)
        )
        quantity = f"{name}: order in 1 / E of the difference of the angles, 2 to 6 s"
        yield Check(quantity, 1.0, math.log2(softer / stiffer), 0.01, QUASI_STATIC)


def two_integrators() -> Iterator[Check]:
    """Check that explicit and implicit integration of damped flexible panels agree; check the implicit one's order."""
    parameters, end = ArrayParameters(cable_stiffness=10.0, panel_damping=3e-4), 3.0
    mechanism = build(parameters, "flexible-ideal:2 elements")

    def angles(integrator: Integrator) -> NDArray[np.float64]:
        return simulate(mechanism, end, integrator=integrator, output_step=end).angles[-1]

    explicit = angles(RungeKutta(rtol=1e-10))
    coarse, fine = (angles(GeneralizedAlpha(step=step)) for step in (4e-4, 2e-4))
    orders = np.log2((coarse - explicit) / (fine - explicit))
    yield from compare(zip("12", (2.0, 2.0), orders, strict=True), "order in the angle of joint {}", 0.05, ARNOLD_BRULS)
    # The method has order two. Extrapolation leaves an error proportional to the fourth power of the step.
    yield from compare(
        zip("12", explicit, (4.0 * fine - coarse) / 3.0, strict=True),
        "angle of joint {} at 3 s [rad], generalized-alpha extrapolated from 0.4 and 0.2 ms",
        tolerance=1e-9,
        source="runge-kutta at rtol 1e-10",
    )


def conservation() -> Iterator[Check]:
    """Check that a free array with a cable loop conserves momenta and energy through impacts, friction and latching."""
    # Momentum errors grow with the steps, longest while journals rest; generalized-alpha adds Newton's tolerance.
    runs: tuple[tuple[str, Integrator, float, float, float], ...] = (
        ("rigid-clearance", RungeKutta(rtol=1e-6), 30.0, 1.5e-14, 3e-6),
        ("rigid-clearance", GeneralizedAlpha(step=1.5e-5), 13.0, 1e-8, 1e-5),
        ("flexible-clearance:2 elements", RungeKutta(rtol=1e-6), 15.0, 1e-13, 3e-7),
    )
    for model, integrator, duration, linear_tolerance, angular_tolerance in runs:
        mechanism, name = build(ArrayParameters(), model), f"{model}, {duration:g} s, {integrator.name}"
        motion = simulate(mechanism, duration, integrator=integrator, output_step=0.05)
        obtained = np.isnan(motion.latch_times).sum()
        yield Check(f"{name}: joints that have not latched", 0.0, obtained, 0.0, "every joint latches")
        linear, angular = momenta(mechanism, motion)
        # Linear momentum has rounding errors alone; angular momentum, a product, also has the local error of the steps.
        for kind, both, tolerance in (("linear", linear, linear_tolerance), ("angular", angular, angular_tolerance)):
            obtained = np.abs(both.sum(axis=1)).max() / np.abs(both).sum(axis=1).max()
            yield Check(f"{name}: {kind} momentum over the sum of the bodies' ones", 0.0, obtained, tolerance, NO_LOADS)
        # The tolerance is some ten times the local tolerance.
        obtained = motion.energy_residual / motion.energy_put_in
        yield Check(f"{name}: energy residual over the energy put in", 0.0, obtained, 1e-5, ENERGY)
