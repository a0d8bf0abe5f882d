"""Cases of the torques about a hinge: a slack cable, and a link that swings into its latch or stow stop."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from scipy.integrate import quad, solve_ivp

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.arrays.columns import CABLE_TORQUE
from solar_env.mechanics.arrays.model import CABLE
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism.description import GROUND, CableLoop, Joint, Mechanism, Stop
from solar_env.mechanics.mechanism.textbook import Link
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.verification.checks import ENERGY, Check, compare

STORED = "exact: kinetic energy = k depth^(e + 1) / (e + 1)"
STRANDS = "two strands of stiffness K / 2 under a preload, neither of which can push"


def strand_torque(mismatch: float, stiffness: float, preload: float) -> float:
    """Torque [N m] of a closed loop on its outer joint: difference of two tensions, each clipped at zero."""
    half = 0.5 * stiffness * mismatch
    return max(preload + half, 0.0) - max(preload - half, 0.0)


def _stretched_loop(mismatch: float, stiffness: float, preload: float) -> tuple[float, float]:
    """The engine's cable torque [N m] and energy [J] at a mismatch of the wheel angles [rad]."""
    link = Link.slender(1.0, 1.0)
    turned = mismatch / 2.0
    bodies = (
        link.body("inner", 0j, turned, 0j, 0.0),
        link.body("outer", complex(math.cos(turned), math.sin(turned)), turned, 0j, 0.0),
    )
    joints = (
        Joint("root", GROUND, "inner", (0.0, 0.0), (0.0, 0.0)),
        Joint("hinge", "inner", "outer", (1.0, 0.0), (0.0, 0.0)),
    )
    cable = CableLoop("root", "hinge", stiffness, wheel_ratio=2.0, torque_ratio=2.0, preload_torque=preload)
    simulation = Simulation(Mechanism(bodies, joints, (cable,)))
    return float(simulation.joint_loads()[1, CABLE_TORQUE]), float(simulation.stored_energies()[CABLE])


def slack_cable() -> Iterator[Check]:
    """Torque and energy of the loop about the limit at which a strand slackens, and a run that passes it."""
    stiffness, preload = 20.0, 0.5
    limit = 2.0 * preload / stiffness
    for share in (0.5, 1.0 - 1e-9, 1.0 + 1e-9, 3.0, -3.0):
        mismatch = share * limit
        torque, energy = _stretched_loop(mismatch, stiffness, preload)
        work, _ = quad(
            strand_torque, 0.0, mismatch, args=(stiffness, preload), points=[math.copysign(limit, share)], epsabs=1e-14
        )
        figures = (
            ("torque [N m]", strand_torque(mismatch, stiffness, preload), torque),
            ("energy [J]", work, energy),
        )
        yield from compare(
            figures, f"{{}} at {share:.10g} of the mismatch at which a strand goes slack", 1e-12, STRANDS
        )
    parameters = ArrayParameters(cable_preload_force=0.2)
    motion = simulate(build(parameters, "rigid-ideal"), 10.0, integrator=RungeKutta(rtol=1e-8))
    preload = parameters.cable_preload_force * parameters.cable_wheel_radius
    mismatches = 2.0 * motion.angles[:, 0] - motion.angles[:, 1]
    expected = np.array([strand_torque(s, parameters.by_joint("cable_stiffness", 0), preload) for s in mismatches])
    least_tension = max(preload - 0.5 * float(np.abs(motion.cable_torque).max()), 0.0) / parameters.cable_wheel_radius
    zeros = (
        ("least tension of a strand [N]", least_tension, 0.0, STRANDS),
        (
            "greatest difference of the cable's torque [N m]",
            float(np.abs(motion.cable_torque[:, 1] - expected).max()),
            1e-12,
            STRANDS,
        ),
        (
            "energy residual over the energy put in",
            motion.energy_residual / motion.energy_put_in,
            1e-6,
            "conservation of energy across the limit",
        ),
    )
    for name, obtained, tolerance, source in zeros:
        yield Check(f"deployment with a preload of 0.2 N: {name}", 0.0, obtained, tolerance, source)


INERTIA = 4.5  # kg m2 about the hinge
LOCK, GAP = 0.5, 0.01  # rad
BOTH_INTEGRATORS: tuple[Integrator, ...] = (RungeKutta(rtol=1e-11), GeneralizedAlpha(step=1e-4))


def _swinging_link(stop: Stop, rate: float) -> Mechanism:
    """A link that turns about a fixed hinge towards its latch, or its stow stop if the rate is negative."""
    link = Link(1.5, 6.0, INERTIA - 6.0 * 0.75**2)
    joint = Joint("hinge", GROUND, "link", (0.0, 0.0), (0.0, 0.0), stop=stop, lock_angle=LOCK, stow_angle=0.0)
    return Mechanism((link.body("link", 0j, 0.0, 0j, rate),), (joint,))


def stop_torque(stop: Stop, angle: float, rate: float) -> float:
    """Torque of a latched joint's stop [N m]: ADAMS' BISTOP about the lock angle with STEP-ramped damping."""
    beyond = angle - LOCK
    depth, closing = abs(beyond) - stop.gap, rate * math.copysign(1.0, beyond)
    if depth <= 0.0:
        return 0.0
    share = min(depth / stop.ramp_depth, 1.0)
    damping = stop.damping * share**2 * (3.0 - 2.0 * share)
    return -math.copysign(max(stop.stiffness * depth**stop.exponent + damping * closing, 0.0), beyond)


def undamped_stop() -> Iterator[Check]:
    """A link runs into its latch, and into its stow stop, without damping: depth and energy."""
    rate, contact = 0.3, 0.3  # rad/s; s, longer than it takes to come to rest in the stop
    energy = 0.5 * INERTIA * rate**2
    for integrator in BOTH_INTEGRATORS:
        for exponent in (1.0, 1.5):
            stop = Stop(GAP, stiffness=1e3, exponent=exponent, ramp_depth=1e-3, damping=0.0)
            depth = (energy * (exponent + 1.0) / stop.stiffness) ** (1.0 / (exponent + 1.0))
            for name, start_rate, duration in (("latch", rate, LOCK / rate + contact), ("stow stop", -rate, contact)):
                motion = simulate(_swinging_link(stop, start_rate), duration, integrator=integrator, output_step=1e-4)
                beyond = motion.angles - LOCK if start_rate > 0.0 else -motion.angles
                obtained = float(beyond.max()) - GAP
                quantity = f"{name}, exponent {exponent:g}: greatest depth [rad], {integrator.name}"
                yield Check(quantity, depth, obtained, 1e-5, STORED, relative=True)
                obtained = motion.energy_residual
                quantity = f"{name}, exponent {exponent:g}: energy residual [J], {integrator.name}"
                yield Check(quantity, 0.0, obtained, 1e-5 * energy, ENERGY)


def _latched_swing(stop: Stop, rate: float, duration: float) -> tuple[float, float]:
    """Angle [rad] and rate [rad/s] a while after the link has latched, by SciPy."""

    def slope(_: float, motion: Sequence[float]) -> tuple[float, float]:
        return motion[1], stop_torque(stop, motion[0], motion[1]) / INERTIA

    # Steps that do not miss the ramp of the damping.
    solution = solve_ivp(slope, (0.0, duration), (LOCK, rate), method="DOP853", rtol=1e-11, atol=1e-12, max_step=1e-3)
    return float(solution.y[0, -1]), float(solution.y[1, -1])


def damped_latch() -> Iterator[Check]:
    """A link latches and swings to and fro between the faces of its damped stop."""
    rate, duration = 0.3, 0.5
    stop = Stop(GAP, stiffness=1e3, exponent=1.0, ramp_depth=1e-3, damping=10.0)
    angle, final_rate = _latched_swing(stop, rate, duration)
    for integrator in BOTH_INTEGRATORS:
        motion = simulate(_swinging_link(stop, rate), LOCK / rate + duration, integrator=integrator)
        lost = 0.5 * INERTIA * (rate**2 - final_rate**2) - motion.energies["latch"][-1]
        figures = (
            ("latch time [s]", LOCK / rate, motion.latch_times[0]),
            ("angle 0.5 s later [rad]", angle, motion.angles[-1, 0]),
            ("rate 0.5 s later [rad/s]", final_rate, motion.rates[-1, 0]),
            ("dissipated energy [J]", lost, motion.energies["latch_dissipation"][-1]),
        )
        source = "BISTOP with STEP, integrated by SciPy's DOP853 at rtol 1e-11"
        yield from compare(figures, f"{{}}, {integrator.name}", 1e-5, source)
