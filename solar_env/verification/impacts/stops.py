"""Verification cases of torques about a hinge: a slack cable, and a link that swings into its latch or stow stop."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from scipy.integrate import solve_ivp

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, RungeKutta
from solar_env.mechanics.mechanism import GROUND, Joint, Link, Mechanism, Stop
from solar_env.mechanics.running.simulation import simulate
from solar_env.verification.checks import ENERGY, Check, compare

STRANDS = "two strands of stiffness K / 2 under a preload, neither of which can push"
STORED = "exact: kinetic energy = k depth^(e + 1) / (e + 1)"
BISTOP = "BISTOP with STEP, integrated by SciPy's DOP853 at rtol 1e-11"
INERTIA = 4.5  # kg m2 about the hinge
LOCK, GAP = 0.5, 0.01  # rad


def slack_cable() -> Iterator[Check]:
    """Check cable torque and energy of a deployment in which one of the cable loop's two strands slackens."""
    parameters = ArrayParameters(cable_preload_force=0.2)
    motion = simulate(build(parameters, "rigid-ideal"), 10.0, integrator=RungeKutta(rtol=1e-8))
    preload = parameters.cable_preload_force * parameters.cable_wheel_radius
    half = 0.5 * parameters.by_joint("cable_stiffness", 0) * (2.0 * motion.angles[:, 0] - motion.angles[:, 1])
    expected = np.maximum(preload + half, 0.0) - np.maximum(preload - half, 0.0)
    slack = float(np.mean(np.abs(half) > preload))
    quantity = f"share of the run with a slack strand: {slack:.2g}, at least 0.1"
    yield Check(quantity, 0.0, max(0.1 - slack, 0.0), 0.0, STRANDS)
    obtained = np.abs(motion.cable_torque[:, 1] - expected).max()
    yield Check("greatest difference of the cable's torque [N m]", 0.0, obtained, 1e-12, STRANDS)
    obtained = motion.energy_residual / motion.energy_put_in
    yield Check("energy residual over the energy put in", 0.0, obtained, 1e-6, ENERGY)


def stop_torque(stop: Stop, angle: float, rate: float) -> float:
    """Return a latched joint's stop torque [N m]: ADAMS' BISTOP about the lock angle, with damping ramped by STEP."""
    beyond = angle - LOCK
    depth, closing = abs(beyond) - stop.gap, rate * math.copysign(1.0, beyond)
    if depth <= 0.0:
        return 0.0
    share = min(depth / stop.ramp_depth, 1.0)
    damping = stop.damping * share**2 * (3.0 - 2.0 * share)
    return -math.copysign(max(stop.stiffness * depth**stop.exponent + damping * closing, 0.0), beyond)


def _latched_swing(stop: Stop, rate: float, duration: float) -> tuple[float, float]:
    """Integrate a link by SciPy for `duration` [s] after it latches at `rate` [rad/s]; return angle [rad] and rate."""

    def slope(_: float, motion: Sequence[float]) -> tuple[float, float]:
        return motion[1], stop_torque(stop, motion[0], motion[1]) / INERTIA

    # The step limit resolves the ramp of the damping.
    solution = solve_ivp(slope, (0.0, duration), (LOCK, rate), method="DOP853", rtol=1e-11, atol=1e-12, max_step=1e-3)
    return float(solution.y[0, -1]), float(solution.y[1, -1])


def _swinging_link(stop: Stop, rate: float) -> Mechanism:
    """Return a mechanism of a link on a fixed hinge, whose latch and stow stop both have the parameters `stop`.

    The initial `rate` [rad/s] turns the link towards the latch if positive, towards the stow stop if negative.
    """
    link = Link(1.5, 6.0, INERTIA - 6.0 * 0.75**2)
    joint = Joint("hinge", GROUND, "link", (0.0, 0.0), (0.0, 0.0), stop=stop, lock_angle=LOCK, stow_angle=0.0)
    return Mechanism((link.body("link", 0j, 0.0, 0j, rate),), (joint,))


def swings_into_stops() -> Iterator[Check]:
    """Check depth and energy as a link runs into an undamped latch or stow stop, and its motion in a damped latch."""
    rate, duration = 0.3, 0.5
    energy = 0.5 * INERTIA * rate**2
    latch = Stop(GAP, stiffness=1e3, exponent=1.0, ramp_depth=1e-3, damping=10.0)
    angle, final_rate = _latched_swing(latch, rate, duration)
    for integrator in (RungeKutta(rtol=1e-11), GeneralizedAlpha(step=1e-4)):
        for exponent in (1.0, 1.5):
            stop = Stop(GAP, stiffness=1e3, exponent=exponent, ramp_depth=1e-3, damping=0.0)
            depth = (energy * (exponent + 1.0) / stop.stiffness) ** (1.0 / (exponent + 1.0))
            # Each run lasts until the link has come to rest in the stop, and a little longer.
            for name, start_rate, end in (("latch", rate, LOCK / rate + 0.3), ("stow stop", -rate, 0.3)):
                motion = simulate(_swinging_link(stop, start_rate), end, integrator=integrator, output_step=1e-4)
                beyond = motion.angles - LOCK if start_rate > 0.0 else -motion.angles
                quantity = f"{name}, exponent {exponent:g}: {{}}, {integrator.name}"
                obtained = float(beyond.max()) - GAP
                yield Check(quantity.format("greatest depth [rad]"), depth, obtained, 1e-5, STORED, relative=True)
                obtained = motion.energy_residual
                yield Check(quantity.format("energy residual [J]"), 0.0, obtained, 1e-5 * energy, ENERGY)
        motion = simulate(_swinging_link(latch, rate), LOCK / rate + duration, integrator=integrator)
        lost = 0.5 * INERTIA * (rate**2 - final_rate**2) - motion.energies["latch"][-1]
        figures = (
            ("latch time [s]", LOCK / rate, motion.latch_times[0]),
            ("angle 0.5 s later [rad]", angle, motion.angles[-1, 0]),
            ("rate 0.5 s later [rad/s]", final_rate, motion.rates[-1, 0]),
            ("dissipated energy [J]", lost, motion.energies["latch_dissipation"][-1]),
        )
        yield from compare(figures, f"damped latch: {{}}, {integrator.name}", 1e-5, BISTOP)
