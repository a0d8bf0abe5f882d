"""Verification cases of lasting contact: friction creep and wear of a loaded journal, calculated by hand.

A journal pressed by the weight W turns in a fixed bearing. Contact force and weight balance, so that normal force N and
friction T satisfy N^2 + T^2 = W^2; the journal's centre rests at the angle arctan(T / N) off the bottom.
"""

import math
from collections.abc import Iterator

import numpy as np

from solar_env.mechanics.arrays.columns import NORMAL, RATE, TANGENTIAL
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw, lankarani_damping
from solar_env.mechanics.mechanism import Bearing, loaded_journal
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.verification.checks import Check, compare

LOAD, RADIUS, CLEARANCE, STIFFNESS = 10.0, 0.01, 2e-4, 7.39e10  # N, m, m, N/m^1.5
FRICTION = 0.15
SPEED_ZERO, SPEED_FULL = 1e-4, 1e-3
WEAR, WIDTH, BINS = 1e-13, 0.05, 360
STATICS = "balance of forces and moments"
ARCHARD = "J. F. Archard, J. Appl. Phys. 24 (1953) 981: volume = k * force * sliding distance"


def _bearing() -> Bearing:
    return Bearing(
        CLEARANCE,
        RADIUS,
        contact=PowerLaw(STIFFNESS, damping=lankarani_damping(0.5)),
        friction_coefficient=FRICTION,
        friction_speeds=(SPEED_ZERO, SPEED_FULL),
        wear_coefficient=WEAR,
        width=WIDTH,
    )


def friction_creep() -> Iterator[Check]:
    """Check speed and forces of a slowly sliding journal whose friction balances a torque below the friction limit."""
    integrators: tuple[Integrator, ...] = (RungeKutta(rtol=1e-8), GeneralizedAlpha(step=1e-4))
    for integrator in integrators:
        for share in (0.3, 0.9):
            speed = SPEED_ZERO + (SPEED_FULL - SPEED_ZERO) * share
            # Torque balance: T R = torque; share = T / (cf N).
            normal = LOAD / math.hypot(1.0, share * FRICTION)
            friction = share * FRICTION * normal
            simulation = Simulation(loaded_journal(_bearing(), LOAD), integrator)
            simulation.set_motor_torque(0, friction * RADIUS)
            simulation.advance(3.0)
            loads = simulation.joint_loads()[0]
            figures = (
                ("sliding speed [m/s]", speed, loads[RATE] * RADIUS),
                ("normal force [N]", normal, loads[NORMAL]),
                ("friction force [N]", friction, abs(loads[TANGENTIAL])),
            )
            quantity = f"Ft = {share:g} cf Fn: {{}}, {integrator.name}"
            yield from compare(figures, quantity, 1e-5, f"exact: v0 + (v1 - v0) Ft / (cf Fn); {STATICS}", relative=True)


def archard_wear() -> Iterator[Check]:
    """Check wear of a journal that turns at a constant rate: worn volumes, and greatest depth in the contact arc."""
    rate, turns = 20.0, 2  # rad/s, -
    duration = turns * 2.0 * math.pi / rate
    mechanism = loaded_journal(_bearing(), LOAD, math.atan(FRICTION), rate, wear_bins=BINS)
    motion = simulate(mechanism, duration, integrator=RungeKutta(rtol=1e-8))
    # Steady sliding is faster than the friction ramp: T = cf N.
    normal = LOAD / math.hypot(1.0, FRICTION)
    volume = WEAR * normal * RADIUS * rate * duration
    bin_arc = 2.0 * math.pi / BINS
    bearing_radius = RADIUS + CLEARANCE
    depth = (normal / STIFFNESS) ** (2.0 / 3.0)
    half_arc = math.acos(CLEARANCE / (CLEARANCE + depth))
    # The contact arc does not move on the bearing: the bin of which it covers the largest part wears deepest.
    low = 1.5 * math.pi - math.atan(FRICTION) - half_arc
    high = low + 2.0 * half_arc
    edges = np.arange(BINS + 1) * bin_arc
    covered = np.clip(np.minimum(high, edges[1:]) - np.maximum(low, edges[:-1]), 0.0, None)
    deepest = volume / (WIDTH * bearing_radius * bin_arc) * covered.max() / (2.0 * half_arc)
    figures = (
        ("worn volume of the journal [m3]", volume, motion.wear_journal.sum() * RADIUS * bin_arc * WIDTH, 1e-6),
        ("worn volume of the bearing [m3]", volume, motion.wear_bearing.sum() * bearing_radius * bin_arc * WIDTH, 1e-6),
        ("deepest bin of the bearing [m]", deepest, motion.wear_bearing.max(), 1e-3),
        ("normal force [N]", normal, motion.normal_force[-1, 0], 1e-5),
        ("sliding work [J]", normal * RADIUS * rate * duration, motion.sliding_work[-1, 0], 1e-6),
        (
            "friction heat [J]",
            FRICTION * normal * RADIUS * rate * duration,
            motion.energies["friction_dissipation"][-1],
            1e-6,
        ),
    )
    yield from compare(figures, "{}", None, ARCHARD, relative=True)
