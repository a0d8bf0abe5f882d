"""Cases of the array with flexible panels, and of the limits that connect its four models."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism.beams import BEAM, PANEL, flexible_pendulum
from solar_env.mechanics.mechanism.description import Body, Load, Mechanism
from solar_env.mechanics.running.simulation import simulate
from solar_env.verification.arrays.conservation import conserved
from solar_env.verification.arrays.latching import PAPER
from solar_env.verification.beams import theory
from solar_env.verification.checks import Check, compare

LEAD = "exact: quasi-static deflection under a uniform angular acceleration"
PHASE_ERROR = "phase error of the lowest mode, of the order of (beta h)^4 / 1440 a radian"
HINGE_SHIFT = "a hinge out of its place by c changes inertias, and the time, by the order of c / L"
# The vibrations that the torques' sudden start excites die out within a second: the panels then bend quasi-statically.
QUIET: dict[str, Any] = {"panel_damping": 0.01}
QUASI_STATIC = "quasi-static deflection under the inertia forces is proportional to 1 / E"


def _parameters(panels: int = 2, **changes: Any) -> ArrayParameters:
    """The default array with another number of panels."""
    stiffness = (0.1, *[0.075] * (panels - 1))
    relaxed = (math.pi / 2, *[math.pi] * (panels - 1))
    return ArrayParameters(panel_count=panels, spring_stiffness=stiffness, spring_preload_angle=relaxed, **changes)


def without_rotary_inertia(mechanism: Mechanism) -> Mechanism:
    """Rigid panels with the inertia of a thin rod, as the beams have it."""
    bodies = [mechanism.bodies[0]]
    for body in mechanism.bodies[1:]:
        assert isinstance(body, Body)
        bodies.append(replace(body, inertia=body.mass * body.length**2 / 12.0))
    return replace(mechanism, bodies=tuple(bodies))


def rigid_limit() -> Iterator[Check]:
    """Flexible panels tend to rigid ones as their modulus grows; without a cable, which would swing undamped."""
    duration, moduli, settled = 6.0, (280e6, 560e6), 4

    def angles(mechanism: Mechanism) -> NDArray[np.float64]:
        motion = simulate(mechanism, duration, integrator=GeneralizedAlpha(step=2.5e-3), output_step=0.5)
        return motion.angles[settled:]

    for panels in (1, 2):
        parameters = _parameters(panels, cable_stiffness=0.0, **QUIET)
        rigid = angles(without_rotary_inertia(build(parameters, "rigid-ideal")))
        softer, stiffer = (
            float(np.abs(angles(build(replace(parameters, panel_young=E), "flexible-ideal:2 elements")) - rigid).max())
            for E in moduli
        )
        obtained = math.log2(softer / stiffer)
        quantity = f"{panels} panel{'s' * (panels > 1)}: order in 1 / E of the difference of the angles, 2 to 6 s"
        yield Check(quantity, 1.0, obtained, 0.01, QUASI_STATIC)
    # A torque at the root of a pinned panel: its root leads the rigid panel.
    torque, time, elements = 0.05, 2.0, 6
    panel = replace(PANEL, damping=0.01)
    mechanism = replace(flexible_pendulum(panel, elements, gravity=0.0), loads=(Load(BEAM, torque=torque),))
    motion = simulate(mechanism, time, integrator=GeneralizedAlpha(step=1e-3), output_step=0.5)
    lead = motion.angles[-1, 0] - 0.5 * torque / (panel.mass * panel.length**2 / 3.0) * time**2
    # Order of the elements; rotation stiffens by (rate / omega)^2 = (0.02 / 47)^2
    quantity = "lead of a panel's root over a rigid panel, under a constant torque on it [rad]"
    tolerance = elements**-4.0
    expected = theory.pinned_lead(panel.length, panel.bending_stiffness, torque)
    yield Check(quantity, expected, lead, tolerance, LEAD, relative=True)


def mesh_convergence() -> Iterator[Check]:
    """Latch time of two flexible panels against the number of elements of a panel."""
    counts, reference = (1, 2, 4, 6), 8
    motions = {
        elements: simulate(
            build(_parameters(), f"flexible-ideal:{elements} elements"),
            13.0,
            integrator=GeneralizedAlpha(step=2e-3),
            output_step=0.01,
        )
        for elements in (*counts, reference)
    }
    # Panels vibrate by the deflection of the springs' torque, at the lowest frequency of a pinned panel, say; too stiff
    # elements shift the phase with which they latch.
    finest = motions[reference]
    time = float(finest.latch_times.max())
    torque = 0.1 * math.pi / 2
    amplitude = torque * PANEL.length / PANEL.bending_stiffness
    rate = float(np.abs(np.diff(finest.angles[:, 0])[round(time / 0.01) - 100 : round(time / 0.01)]).mean() / 0.01)
    frequency = theory.bending_frequencies("pinned-free", PANEL, 1)[0]
    wave_number = float(theory.bending_wave_numbers("pinned-free", 1)[0]) / PANEL.length
    for elements in counts:
        error = theory.cubic_element_frequency_error(wave_number, PANEL.length / elements)
        phase = 2.0 * math.pi * frequency * time * error
        obtained = motions[elements].latch_times.max() - time
        quantity = f"latch time with {elements} element{'s' * (elements > 1)} a panel less that with {reference} [s]"
        yield Check(quantity, 0.0, obtained, amplitude / rate * min(2.0, phase), PHASE_ERROR)


def clearance_limit() -> Iterator[Check]:
    """Joints with clearance tend to ideal joints as it vanishes; without friction, whose torque does not vanish."""
    duration = 13.0
    ideal = simulate(
        build(_parameters(), "rigid-ideal"), duration, integrator=RungeKutta(rtol=1e-9), output_step=1.0
    ).latch_times
    clearances = (2e-4, 1e-4, 5e-5, 2.5e-5)
    differences = []
    for clearance in clearances:
        mechanism = build(_parameters(clearance=clearance, friction_coefficient=0.0), "rigid-clearance")
        motion = simulate(mechanism, duration, integrator=RungeKutta(rtol=1e-7), output_step=1.0)
        differences.append(np.abs(motion.latch_times - ideal))
        for joint, difference in enumerate(motion.latch_times - ideal):
            quantity = f"c = {clearance:g} m: latch time of joint {joint + 1} less that of an ideal one [s]"
            yield Check(quantity, 0.0, difference, 2.0 * float(ideal[joint]) * clearance / PANEL.length, HINGE_SHIFT)
    orders = np.log2(differences[0] / differences[-1]) / math.log2(clearances[0] / clearances[-1])
    yield from compare(
        zip("12", (1.0, 1.0), orders, strict=True),
        "order in c of the difference of the latch time of joint {}",
        tolerance=0.25,  # single runs, with impacts at the start
        source="the place of the hinge is proportional to c",
    )


def _conserved(mechanism: Mechanism, name: str, duration: float, integrator: Integrator) -> Iterator[Check]:
    """Latching, momenta and energy of a free array."""
    motion = simulate(mechanism, duration, integrator=integrator, output_step=0.05)
    obtained = np.isnan(motion.latch_times).sum()
    yield Check(f"{name}, {duration:g} s: joints that have not latched", 0.0, obtained, 0.0, "every joint latches")
    yield from conserved(f"{name}, {duration:g} s: {{}}", mechanism, motion)


def panel_counts() -> Iterator[Check]:
    """One to four panels deploy with ideal joints, rigid and flexible: latching, momenta, energy."""
    for model in ("rigid-ideal", "flexible-ideal:2 elements"):
        for panels, duration in ((1, 12.0), (2, 15.0), (3, 20.0), (4, 22.0)):
            mechanism = build(_parameters(panels), model)
            name = f"{panels} panel{'s' * (panels > 1)}, {model}"
            yield from _conserved(mechanism, name, duration, RungeKutta(rtol=1e-6))


def flexible_clearance() -> Iterator[Check]:
    """The whole model, with impacts, friction, latching, cable loop and flexible panels."""
    mechanism = build(_parameters(), "flexible-clearance:2 elements")
    yield from _conserved(mechanism, "flexible-clearance", 15.0, RungeKutta(rtol=1e-6))


def two_integrators() -> Iterator[Check]:
    """Explicit and implicit integration of the flexible array agree on the deployment up to latching."""
    mechanism = build(_parameters(), "flexible-ideal:2 elements")
    explicit, implicit = (
        simulate(mechanism, 13.0, integrator=integrator, output_step=0.1)
        for integrator in (RungeKutta(rtol=1e-8), GeneralizedAlpha(step=1e-3))
    )
    yield from compare(
        zip("12", explicit.latch_times, implicit.latch_times, strict=True),
        "latch time of joint {} [s], generalized-alpha",
        tolerance=1e-3,  # of vibrations of 1e-3 rad whose phase the step of 1e-3 s shifts
        source="runge-kutta at rtol 1e-8",
    )


def two_integrators_tightly() -> Iterator[Check]:
    """Explicit and implicit integration of the damped array with six elements a panel, at tight tolerances."""
    mechanism = build(_parameters(cable_stiffness=10.0), "flexible-ideal:6 elements")
    before_latch = 12.0

    def angles(integrator: Integrator) -> NDArray[np.float64]:
        return simulate(mechanism, before_latch, integrator=integrator, output_step=before_latch).angles[-1]

    explicit = angles(RungeKutta(rtol=1e-10))
    coarse, fine = (angles(GeneralizedAlpha(step=step)) for step in (1e-4, 5e-5))
    # The implicit method is of order two: extrapolated, its error is of the order of the step's fourth power.
    extrapolated = (4.0 * fine - coarse) / 3.0
    yield from compare(
        zip("12", explicit, extrapolated, strict=True),
        "angle of joint {} at 12 s [rad], generalized-alpha extrapolated from 0.1 and 0.05 ms",
        tolerance=1e-8,
        source="runge-kutta at rtol 1e-10",
    )


def paper_phenomena() -> Iterator[Check]:
    """Effect of flexible panels on the contacts in the bearings, as the paper reports it: their number and size."""
    duration, settled = 19.0, 2.0
    parameters = ArrayParameters.preset("paper")
    rigid, flexible = (
        simulate(build(parameters, model), duration, integrator=RungeKutta(rtol=1e-5), output_step=1e-2)
        for model in ("rigid-clearance", "flexible-clearance:6 elements")
    )

    def at_least(quantity: str, bound: float, obtained: float) -> Check:
        return Check(f"{quantity}: {obtained:.3g}, at least {bound:g}", 0.0, max(bound - obtained, 0.0), 0.0, PAPER)

    for joint in (0, 1):
        counts, peaks, endings = [], [], []
        for motion in (rigid, flexible):
            lock = float(np.min(motion.latch_times))
            contacts = motion.contacts[motion.contacts["joint"] == joint]
            start = contacts["start_s"]
            deploying = start[(start > settled) & (start < lock - 0.3)]
            counts.append((len(deploying), int(np.sum(start > lock))))
            peaks.append(float(np.median(contacts["peak_force"][start > lock])))
            endings.append(float(start[start < lock - 0.3].max()))
        label = f"joint {joint + 1}, paper preset"
        yield at_least(f"{label}: last impact before the latch, flexible - rigid [s]", 0.1, endings[1] - endings[0])
        yield Check(f"{label}, rigid: impacts from 2 s to the latch", 0.0, counts[0][0], 0.0, PAPER)
        yield at_least(f"{label}, flexible: impacts from 2 s to the latch", 20.0, counts[1][0])
        yield at_least(f"{label}: impacts after the latch, flexible / rigid", 3.0, counts[1][1] / counts[0][1])
        yield at_least(f"{label}: median peak force after the latch, rigid / flexible", 1.5, peaks[0] / peaks[1])
        torques = [float(np.abs(motion.latch_torque[:, joint]).max()) for motion in (rigid, flexible)]
        yield at_least(f"{label}: greatest latch torque, rigid / flexible", 1.0, torques[0] / torques[1])
